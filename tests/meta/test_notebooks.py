"""The notebooks run from top to bottom without a screen, and are stored without output."""

import json
import runpy
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples").glob("*.ipynb"))
ids = [path.stem for path in NOTEBOOKS]


def test_there_are_three() -> None:
    assert [path.name[:2] for path in NOTEBOOKS] == ["12", "13", "14"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=ids)
def test_a_notebook_is_stored_without_output(path: Path) -> None:
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=ids)
def test_a_notebook_runs_and_draws(path: Path) -> None:
    """By the tool that puts it on the site."""
    pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    pytest.importorskip("mkdocs", reason="mkdocs is not installed")
    tool = runpy.run_path(str(path.parents[1] / "tools" / "docs_site.py"))
    page = tool["notebook"](path)
    assert 'src="data:image/png;base64,' in page
    assert f"`examples/{path.name}`" in page


@pytest.mark.parametrize("path", NOTEBOOKS, ids=ids)
def test_a_notebook_is_in_the_page_on_python(path: Path) -> None:
    page = (path.parents[1] / "docs" / "python-api.md").read_text(encoding="utf-8")
    assert f"(../examples/{path.name})" in page
