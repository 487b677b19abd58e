"""The pages on random tasks agree with the published rows, and name their sources."""

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from pushpressslide_studies.paper.documents import renewed

ROOT = Path(__file__).parents[3]
pytest.importorskip("pydrake", reason="Drake is not installed")


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.chdir(ROOT)
    path = ROOT / "studies" / "tools" / "random_tasks.py"
    spec = importlib.util.spec_from_file_location("random_tasks", path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "random_tasks", made)
    spec.loader.exec_module(made)
    return made


@pytest.fixture
def rows_tool(
    tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> ModuleType:
    """The tool with rows in a folder of its own: none yet."""
    monkeypatch.setattr(tool, "DATA", tmp_path)
    return tool


def draw(tool: ModuleType, table: Any, contact: str, *statuses: str) -> None:
    """Publish rows of a table, and who made them."""
    rows = [
        {
            "key": table.name,
            "index": index,
            "task": f"{table.task}-random-{table.seed}-{index:03d}",
            "status": status,
            "reason": status,
            "final_position_error": 0.001,
            "final_yaw_error": 0.01,
        }
        for index, status in enumerate(statuses)
    ]
    table.rows.write_text("".join(json.dumps(row) + "\n" for row in rows))
    tool.note(table, tool.Sources(table.name, "0123456", "2026-11-26", contact))


def test_the_page_and_the_readme_are_those_of_the_rows(tool: ModuleType) -> None:
    for page, mark, lines in (
        (tool.PAGE, "rates", tool.page()),
        (tool.README, "fact", [tool.fact()]),
    ):
        text = page.read_text(encoding="utf-8")
        assert renewed(text, mark, "\n".join(lines)) == text, "random_tasks.py write"


def test_all_published_rows_have_a_note_of_their_sources(tool: ModuleType) -> None:
    published = [table for table in tool.TABLES if tool.read(table)[0]]
    known = tool.all_sources()
    counted = {name for name, made in known.items() if made.attempted}  # rows not kept
    assert {table.name for table in published} | counted == {*known}
    for table in published:
        assert tool.sources_of(table) is not None, table.name


def test_every_table_has_a_seed_of_its_own(tool: ModuleType) -> None:
    drawn_once = tool.KNOWN + tool.REFUSED + tool.UNCERTAIN
    assert len({table.seed for table in drawn_once}) == len(drawn_once)
    assert [table.seed for table in tool.KNOWN[:2]] == [2400, 2401]


def test_rows_by_another_contact_solver_say_so_wherever_they_count(
    rows_tool: ModuleType,
) -> None:
    today, older = rows_tool.KNOWN[:2]
    draw(rows_tool, today, rows_tool.contact_solver(), "reached")
    draw(rows_tool, older, "kOther", "reached")
    lines = rows_tool.lines_of((today, older))
    fresh, old = [line for line in lines if "0123456" in line]
    assert "older contact solver" not in fresh
    assert old.endswith("0123456 of 2026-11-26, older contact solver |")
    (note, _) = rows_tool.on_older_sources()
    assert note.startswith("**1 of 2 tables are by an older contact solver.**")
    assert "`kOther`" in note


def test_nothing_is_said_of_older_solvers_where_there_are_none(
    rows_tool: ModuleType,
) -> None:
    draw(rows_tool, rows_tool.KNOWN[0], rows_tool.contact_solver(), "reached")
    assert rows_tool.on_older_sources() == []
    assert rows_tool.by_older(rows_tool.KNOWN) == ""


def test_rows_without_a_note_are_of_unknown_sources(rows_tool: ModuleType) -> None:
    table = rows_tool.KNOWN[0]
    draw(rows_tool, table, "kOther", "reached")
    (rows_tool.DATA / "sources.json").unlink()
    assert rows_tool.named(rows_tool.sources_of(table)) == "unknown"


def test_a_note_is_that_of_its_rows_and_no_others(rows_tool: ModuleType) -> None:
    table = rows_tool.KNOWN[0]
    draw(rows_tool, table, "kOther", "reached")
    rows_tool.note(
        table, rows_tool.Sources(table.name, "7654321", "2026-11-27", "kOther")
    )
    assert rows_tool.sources_of(table).commit == "0123456"
    rows_tool.note(
        table, rows_tool.Sources("another", "7654321", "2026-11-27", "kOther")
    )
    assert rows_tool.sources_of(table) is None


def test_a_rate_is_of_the_attempted_with_the_refused_beside(
    rows_tool: ModuleType,
) -> None:
    table = rows_tool.KNOWN[0]
    draw(
        rows_tool, table, "kOther", "refused", "reached", "missed", "refused", "reached"
    )
    (line,) = (row for row in rows_tool.lines_of((table,)) if "0123456" in row)
    cells = line.split(" | ")
    assert cells[2:6] == [
        "5",
        "3 of 60 so far: 60 % (23 to 88)",
        "2",
        "67 % (21 to 94)",
    ]
    draw(rows_tool, rows_tool.KNOWN[-1], "kOther", "refused", "reached")
    assert "Of 2 random tasks with no mode given, 1 were attempted" in rows_tool.fact()


def test_a_table_that_was_not_drawn_says_so(rows_tool: ModuleType) -> None:
    for lines in (
        rows_tool.lines_of(rows_tool.KNOWN),
        rows_tool.lines_of_all(rows_tool.KNOCKS),
    ):
        head, _, *rest = lines
        assert rest
        for line in rest:
            assert "not drawn yet" in line
            assert line.count("|") == head.count("|")


def test_a_run_publishes_rows_with_their_sources(
    rows_tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = rows_tool.KNOWN[0]

    def sweep(task: object, options: object, folder: Path) -> None:
        row = {"key": "new", "index": 0, "task": f"-{table.seed}-", "status": "refused"}
        with (folder / "rows.jsonl").open("a") as file:
            file.write(json.dumps(row) + "\n")

    draw(rows_tool, table, "kOther", "reached")
    monkeypatch.setattr(rows_tool, "WORK", tmp_path / "work")
    monkeypatch.setattr(
        rows_tool, "commit_of_sources", lambda: ("7654321", "2026-11-27")
    )
    monkeypatch.setattr("pushpressslide.jobs.sweep.sweep", sweep)
    rows_tool.run(table, 1)
    made = rows_tool.sources_of(table)
    assert made == rows_tool.Sources(
        "new", "7654321", "2026-11-27", rows_tool.contact_solver()
    )
    assert [row["status"] for row in rows_tool.read(table)[0]] == ["refused"]


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_sources_without_a_commit_make_no_rows(
    tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "package"
    package.mkdir()
    source = package / "__init__.py"
    source.touch()
    monkeypatch.setattr(tool.pushpressslide, "__file__", str(source))
    who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    for words in (["init"], ["add", "."], [*who, "commit", "-m", "first"]):
        subprocess.run(["git", "-C", str(tmp_path), *words], check=True)
    commit, date = tool.commit_of_sources()
    assert len(commit) == 7
    assert len(date.split("-")) == 3
    source.write_text("changed = True\n")
    with pytest.raises(SystemExit, match="not committed"):
        tool.commit_of_sources()
