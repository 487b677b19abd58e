"""Run the tasks of studies/docs/other-planners.md, and write what came of them there.

python studies/tools/other_planners.py
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pushpressslide as pps
from pushpressslide.core.whole_file import write_whole
from pushpressslide_studies.paper.documents import renewed

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "other-planners.md"
DATA = DOCS / "data" / "other-planners.json"
TASKS = {
    "sugar-box": (),
    "tee": (),
    "sugar-box, tip friction 0.1": ("contact.friction=0.1",),
}
"""What is run, and the fields that are set."""
MEASURED = ("success", "duration", "final_position_error", "final_yaw_error")


def run(name: str, sets: tuple[str, ...]) -> dict[str, Any]:
    """Run a task in Drake, and return what is shown of it."""
    with TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pushpressslide", "run", name.split(",")[0]]
        command += ["--quiet", "--force", "--out", folder]
        command += [word for one in sets for word in ("--set", one)]
        subprocess.run(command, check=False)
        made = pps.load_run(folder)
    planning = made.result["planning_time"]
    return {
        "task": name,
        "motions": len(made.plan.segments),
        "planned": sum(planning.values()),
        **{key: made.result[key] for key in MEASURED},
    }


def table(rows: list[dict[str, Any]]) -> str:
    """Return the rows as the table of the page."""
    lines = [
        "| task | pushes | planned in | simulated | off in the end |",
        "|---|---|---|---|---|",
    ]
    for row in rows:
        end = f"{1e3 * row['final_position_error']:.1f} mm"
        end += f", {math.degrees(row['final_yaw_error']):.1f}°"
        lines.append(
            f"| {row['task']} | {row['motions']} | {row['planned']:.1f} s | "
            f"{row['duration']:.0f} s | {end if row['success'] else 'missed'} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run, and write rows and page."""
    rows = [run(name, sets) for name, sets in TASKS.items()]
    write_whole(DATA, json.dumps(rows, indent=1) + "\n")
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(renewed(page, "planners", table(rows)), encoding="utf-8")


if __name__ == "__main__":
    main()
