"""The figures of the documents are those made by the tools."""

import re
import runpy
from pathlib import Path

import pytest

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


def tutorial():
    return runpy.run_path(str(ROOT / "tools" / "tutorial_figures.py"))


def test_every_picture_of_the_tutorial_is_made_by_its_commands() -> None:
    page = (ROOT / "docs" / "getting-started.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"\(figures/([a-z-]+\.png)\)", page))
    assert shown - {"rear-push-left.png"} == set(tutorial()["PICTURES"].values())
    assert len(tutorial()["commands"](page)) == 6
    assert len(re.findall(r"^## [1-6]\. ", page, re.MULTILINE)) == 6


@pytest.mark.long
def test_the_commands_of_the_tutorial_write_its_pictures(tmp_path: Path) -> None:
    for path in tutorial()["make"](tmp_path):
        assert path.read_bytes().startswith(PNG)
