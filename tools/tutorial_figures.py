"""Make the pictures of docs/getting-started.md, by the commands that it shows.

python tools/tutorial_figures.py docs/figures
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "getting-started.md"
PICTURES = {
    "runs/plan/plan.png": "tutorial-plan.png",
    "runs/first/plots/forces.png": "tutorial-forces.png",
    "runs/own/plots/path.png": "tutorial-own.png",
    "runs/post/legs.png": "post-legs.png",
    "runs/otherwise/plots/tracking.png": "tutorial-otherwise.png",
    "tutorial-python.png": "tutorial-python.png",
}
"""What the page's commands write, and its names in docs/figures."""


def commands(page: str) -> list[list[str]]:
    """Return the commands of the page that write a file, in order."""
    lines = page.replace("\\\n", " ")
    found = re.findall(r"^    pps ((?:new|plan|run) .*)$", lines, re.MULTILINE)
    return [shlex.split(line) for line in found if "--out" in line or "new " in line]


def program(page: str) -> str:
    """Return the page's Python."""
    return page.split("```python\n")[1].split("```")[0]


def make(folder: Path) -> list[Path]:
    """Run what the page shows in ``folder``; return the pictures there."""
    page = PAGE.read_text(encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(PAGE.parents[1] / "src")}
    pps = [sys.executable, "-m", "pushpressslide"]
    calls = [[*pps, *command] for command in commands(page)]
    for call in [*calls, [sys.executable, "-c", program(page)]]:
        subprocess.run(call, cwd=folder, env=environment, check=True)
    return [folder / name for name in PICTURES]


if __name__ == "__main__":
    out = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        for picture in make(Path(folder)):
            name = PICTURES[str(picture.relative_to(folder))]
            print(shutil.copyfile(picture, out / name))
