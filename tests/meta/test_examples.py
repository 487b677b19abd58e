"""The numbered examples run, each as a program of its own."""

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("[0-9]*.py"))


def test_every_program_is_there() -> None:
    numbers = [*range(1, 12), 15]
    assert [path.name[:2] for path in EXAMPLES] == [f"{i:02}" for i in numbers]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_in_the_page_on_python(path: Path) -> None:
    page = (path.parents[1] / "docs" / "python-api.md").read_text(encoding="utf-8")
    assert f"(../examples/{path.name})" in page
