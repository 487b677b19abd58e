"""The documents show the results of the studies, and the paper map is right."""

import importlib
import json
import re
import runpy
from pathlib import Path

import pytest

from pushpressslide.taskfile.load import shipped_tasks
from pushpressslide_studies.bench.engine_table import EngineRun, table
from pushpressslide_studies.bench.footprints import Errors, page
from pushpressslide_studies.paper.documents import renewed, summary_of

ROOT = Path(__file__).parents[3]
STUDIES = ROOT / "studies"
README = (ROOT / "README.md").read_text(encoding="utf-8")


def rows_of_the_paper_map():
    text = (STUDIES / "docs" / "paper-map.md").read_text(encoding="utf-8")
    return re.findall(r"\| `([a-z_.A-Z]+)` \| `([a-z_/]+\.py)` \|", text)


def test_the_paper_map_has_rows() -> None:
    assert len(rows_of_the_paper_map()) >= 20


@pytest.mark.parametrize(("function", "test"), rows_of_the_paper_map())
def test_the_paper_map_names_real_functions_and_tests(function: str, test: str) -> None:
    own = function.startswith("pushpressslide_studies.")
    parts = function.split(".") if own else ["pushpressslide", *function.split(".")]
    source = STUDIES / "src" if own else ROOT / "src"
    depth = next(
        n
        for n in range(len(parts), 0, -1)
        if source.joinpath(*parts[:n]).with_suffix(".py").is_file()
    )
    thing = importlib.import_module(".".join(parts[:depth]))
    for part in parts[depth:]:
        thing = getattr(thing, part)
    assert (ROOT / test if own else ROOT / "tests" / test).exists()


def test_the_readme_counts_what_the_results_count() -> None:
    results = (STUDIES / "docs" / "results.md").read_text(encoding="utf-8")
    table = results.partition("results: begin (generated) -->")[2]
    assert renewed(README, "results", summary_of(table)) == README


def test_the_table_of_other_planners_is_that_of_its_rows() -> None:
    tool = runpy.run_path(str(STUDIES / "tools" / "other_planners.py"))
    rows = json.loads(tool["DATA"].read_text(encoding="utf-8"))
    assert [row["task"] for row in rows] == list(tool["TASKS"])
    page = tool["PAGE"].read_text(encoding="utf-8")
    assert renewed(page, "planners", tool["table"](rows)) == page


def test_the_table_of_footprints_is_that_of_its_rows() -> None:
    rows = json.loads(
        (STUDIES / "docs" / "data" / "footprints.json").read_text("utf-8")
    )
    text = (STUDIES / "docs" / "footprints.md").read_text(encoding="utf-8")
    tables = page([Errors(**row) for row in rows])
    assert renewed(text, "footprints", tables) == text
    assert len({row["engine"] for row in rows}) == 6
    assert len({row["footprint"] for row in rows}) == 5


def test_the_finger_of_the_page_keeps_what_it_pushes(
    capsys: pytest.CaptureFixture[str],
) -> None:
    page = (STUDIES / "docs" / "stable-push.md").read_text(encoding="utf-8")
    example = page.split("```python\n")[1].split("```")[0]
    exec(compile(example, "stable-push", "exec"), {})
    assert capsys.readouterr().out.startswith("True ")


def test_the_table_of_engines_is_that_of_its_rows() -> None:
    rows = json.loads((STUDIES / "docs" / "data" / "engines.json").read_text("utf-8"))
    runs = [EngineRun(**row) for row in rows["runs"]]
    text = (STUDIES / "docs" / "engines.md").read_text(encoding="utf-8")
    assert renewed(text, "engines", table(runs)) == text
    assert {run.task for run in runs} == set(shipped_tasks())
    assert len(runs) == 3 * len(shipped_tasks())
