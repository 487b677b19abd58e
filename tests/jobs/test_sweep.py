"""Sweeps: reuse of finished samples, the samples that count, and the result of a
refused task that is run nevertheless.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pushpressslide.core.errors import InfeasibleTaskError, PushPressSlideError
from pushpressslide.core.pose import Pose2
from pushpressslide.jobs import sample as sample_module
from pushpressslide.jobs import sweep as module
from pushpressslide.jobs.rows import Row, Rows, key_of
from pushpressslide.jobs.sample import FORCED, run_forced, run_sample
from pushpressslide.jobs.summary import interval, summarise, table_line, write_table
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.taskfile.load import load_task

TASK = load_task("rear-push-rear")
OPTIONS = SweepOptions(3, engine="planar")
REACHED = {
    "index": 0,
    "status": "reached",
    "reason": "",
    "choice": "quickest",
    "final_position_error": 0.001,
    "final_yaw_error": 0.0,
    "duration": 2.0,
}
REFUSED = {"index": 1, "status": "refused", "reason": "too slippery | too light"}


def key(task: Any = TASK, options: SweepOptions = OPTIONS) -> str:
    return key_of(options.settings(task))


@pytest.mark.parametrize(
    "change",
    [
        {"vary": "tasks"},
        {"seed": 1},
        {"engine": "drake"},
        {"draw": "any"},
        {"world": "uncertain"},
    ],
)
def test_rows_of_other_options_do_not_count(change: dict[str, Any]) -> None:
    assert key(options=replace(OPTIONS, **change)) != key()


def test_rows_of_a_task_that_was_changed_do_not_count() -> None:
    """A sweep that goes on with another ``--set`` must not mix both."""
    assert key(load_task("rear-push-rear", ["contact.friction=0.7"])) != key()


def test_rows_of_other_sources_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    before = key()
    monkeypatch.setattr(module, "source_hash", lambda: "another")
    assert key() != before


def test_more_samples_or_processes_leave_the_finished_rows_valid() -> None:
    other = replace(
        OPTIONS, samples=9, jobs=2, force=True, check_refusals=5, sample_time=3.0
    )
    assert key(options=other) == key()


def test_settings_are_the_same_after_a_file() -> None:
    settings = OPTIONS.settings(TASK)
    assert key_of(json.loads(json.dumps(settings))) == key_of(settings)


def test_rows_survive_a_process_and_a_line_that_was_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    rows = Rows(path, "mine")
    for index in (2, 0):
        rows.add({"index": index, "status": "reached", "value": index})
    Rows(path, "other").add({"index": 1, "status": "missed"})
    rows.add({"index": 1, "status": "refused"})
    rows.add({"index": 1, "rank": 0, "status": "missed"})
    with path.open("ab") as file:
        file.write(b'{"key": "mine", "index": 3, "sta')
    again = Rows(path, "mine")
    assert len(again) == 3
    assert [row["index"] for row in again.read(3)] == [0, 1, 2]
    assert again.status(1) == "refused"
    assert 3 not in again
    assert again.has_forced(1, 0)
    assert not again.has_forced(1, 1)
    assert [row["rank"] for row in again.read_forced(3)] == [0]


def test_a_share_of_nothing_is_none() -> None:
    assert summarise([], [])["attempted_share"] is None
    figures = summarise([REFUSED], [])
    assert figures["attempted_share"] == 0.0
    assert figures["reached_share"] is None
    assert figures["duration"] is None


def test_an_error_of_ours_counts_as_an_attempt_that_did_not_reach() -> None:
    figures = summarise([REACHED, REFUSED, {"index": 2, "status": "failed"}], [])
    assert figures["attempted"] == 2
    assert figures["reached_share"] == 0.5


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [
        (["missed", "missed", "not run"], (1, 0, 1, 1)),
        (["missed", "reached"], (1, 0, 1, 0)),
        (["not run", "not run"], (1, 1, 0, 0)),
    ],
)
def test_a_refusal_is_true_only_if_what_could_be_run_missed(
    outcomes: list[str], expected: tuple[int, ...]
) -> None:
    forced = [{"index": 7, "rank": i, "status": s} for i, s in enumerate(outcomes)]
    figures = summarise([], forced)["refusals"]
    names = ("checked", "could_not_be_run", "ran", "missed")
    assert tuple(figures[name] for name in names) == expected


@pytest.mark.parametrize(("part", "whole"), [(0, 10), (7, 10), (57, 60), (60, 60)])
def test_an_interval_is_wilsons(part: int, whole: int) -> None:
    z = 1.959964
    p = part / whole
    middle = (p + z * z / (2 * whole)) / (1 + z * z / whole)
    half = math.sqrt(p * (1 - p) / whole + z * z / (4 * whole * whole))
    half = half * z / (1 + z * z / whole)
    assert interval(part, whole) == pytest.approx(
        (middle - half, middle + half), abs=1e-6
    )


def test_every_row_of_the_table_has_as_many_cells_as_its_head(tmp_path: Path) -> None:
    path = tmp_path / "table.md"
    forced = [{**REFUSED, "rank": 0, "status": "missed"}]
    write_table(path, [REACHED, REFUSED], forced)
    sampled, anyway = path.read_text().split("\nRefused, but run anyway:\n\n")
    for part, count in ((sampled, 4), (anyway, 3)):
        lines = part.splitlines()
        assert len(lines) == count
        assert {line.count("|") for line in lines} == {7}
    assert "choice 1" in table_line(forced[0])


def scripted(monkeypatch: pytest.MonkeyPatch, outcomes: list[str]) -> list[int]:
    """Let samples end as scripted, in this process; return which were run."""
    ran: list[int] = []

    def run(task: Any, options: SweepOptions, index: int) -> Row:
        ran.append(index)
        return {"index": index, "status": outcomes[index], "reason": "scripted"}

    class Here:
        def __enter__(self) -> Here:
            return self

        def __exit__(self, *exception: object) -> None:
            pass

        def submit(self, work: Any, *arguments: Any) -> Any:
            from concurrent.futures import Future

            future: Future[Row] = Future()
            future.set_result(work(*arguments))
            return future

    monkeypatch.setattr(module, "run_sample", run)
    monkeypatch.setattr(
        module,
        "run_forced",
        lambda task, options, index, rank: {
            "index": index,
            "rank": rank,
            "status": "missed",
            "reason": "",
        },
    )
    monkeypatch.setattr(module, "worker_pool", lambda jobs: Here())
    return ran


def test_samples_are_drawn_until_enough_are_attempted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcomes = ["refused", "reached", "refused", "missed", "failed", "reached"]
    ran = scripted(monkeypatch, outcomes)
    options = SweepOptions(attempts=2, engine="planar", jobs=1, check_refusals=1)
    summary = sweep(TASK, options, tmp_path)
    assert ran == [0, 1, 2, 3]
    assert (summary["drawn"], summary["attempted"]) == (4, 2)
    assert summary["refusals"]["checked"] == 1
    more = sweep(TASK, replace(options, attempts=3), tmp_path)
    assert ran == [0, 1, 2, 3, 4]  # it went on where it ended
    assert (more["drawn"], more["attempted"], more["failed"]) == (5, 3, 1)
    rows = [json.loads(x) for x in (tmp_path / "rows.jsonl").read_text().splitlines()]
    assert sum("rank" in row for row in rows) == FORCED


def test_drawing_ends_where_nothing_can_be_attempted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scripted(monkeypatch, ["refused"] * 1000)
    with pytest.raises(PushPressSlideError, match="only 0 of 101 drawn tasks"):
        sweep(TASK, SweepOptions(attempts=5, engine="planar", jobs=1), tmp_path)


@pytest.mark.parametrize(
    "error", [IndexError, AssertionError, ZeroDivisionError, SystemExit]
)
def test_an_error_of_ours_is_a_row(
    error: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*arguments: Any, **others: Any) -> None:
        raise error("no such thing")

    monkeypatch.setattr(sample_module, "simulate", fails)
    row = run_sample(TASK, OPTIONS, 4)
    assert (row["index"], row["status"]) == (4, "failed")
    assert row["reason"] == f"{error.__name__}: no such thing"


def test_a_sample_that_takes_too_long_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def endless(*arguments: Any, **others: Any) -> None:
        while True:
            pass

    monkeypatch.setattr(sample_module, "simulate", endless)
    row = run_sample(TASK, replace(OPTIONS, sample_time=0.05), 0)
    assert row["status"] == "failed"
    assert row["reason"] == "SampleTimeoutError: took longer than 0.05 s"


def test_a_forced_choice_that_cannot_be_run_says_why(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def no_path(*arguments: Any, **others: Any) -> None:
        raise InfeasibleTaskError("no joint path")

    monkeypatch.setattr(sample_module, "run_choice", no_path)
    options = replace(OPTIONS, vary="tasks")
    row = run_forced(TASK, options, 0, 0)
    assert row["status"] == "not run"
    assert "no joint path" in row["reason"]
    assert run_forced(TASK, options, 0, 99)["status"] == "not run"


def test_each_of_the_best_choices_can_be_forced() -> None:
    options = replace(OPTIONS, vary="tasks")
    rows = [run_forced(TASK, options, 0, rank) for rank in range(2)]
    assert all(row["status"] in ("reached", "missed") for row in rows)
    assert rows[0]["choice"] != rows[1]["choice"]


def test_a_row_holds_how_much_of_its_goal_the_object_covers() -> None:
    row = run_forced(TASK, replace(OPTIONS, vary="tasks"), 0, 0)
    width = math.sqrt(TASK.object.shape.placed(Pose2()).area)
    assert row["overlap"] == pytest.approx(
        1.0, abs=4.0 * (row["final_position_error"] / width + row["final_yaw_error"])
    )


def test_a_cube_that_is_a_tenth_of_its_side_aside_covers_nine_tenths() -> None:
    goal = TASK.goal
    side = math.sqrt(TASK.object.shape.placed(Pose2()).area)
    aside = goal.compose(Pose2(0.1 * side, 0.0, 0.0))
    ended = {"bodies": {"object": {"final_pose": [*aside.position, aside.yaw]}}}
    assert sample_module._overlap(TASK, ended) == pytest.approx(0.9)
    assert sample_module._overlap(TASK, {"bodies": {}}) is None
