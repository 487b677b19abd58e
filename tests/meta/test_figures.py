"""The figures of docs/mechanics.md are those that the tool draws."""

import re
import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]
PNG = b"\x89PNG"


def test_every_figure_of_the_mechanics_is_drawn(tmp_path: Path) -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "mechanics_figures.py"))
    drawn = {path.name: path.read_bytes() for path in tool["draw"](tmp_path)}
    assert all(data.startswith(PNG) for data in drawn.values())
    page = (ROOT / "docs" / "mechanics.md").read_text(encoding="utf-8")
    shown = re.findall(r"\(figures/(mechanics-[a-z-]+\.png)\)", page)
    assert sorted(shown) == sorted(drawn)
    assert all((ROOT / "docs" / "figures" / name).is_file() for name in drawn)
