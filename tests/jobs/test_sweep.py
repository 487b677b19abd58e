"""The table and figures of a sweep, and which finished samples stand for new ones."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pushpressslide.core.task import Task
from pushpressslide.jobs import sweep as module
from pushpressslide.jobs.sweep import SweepOptions, summarise, sweep, table
from pushpressslide.taskfile.load import load_task

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


@pytest.mark.parametrize(
    "change", [{"samples": 4}, {"vary": "tasks"}, {"seed": 1}, {"engine": "drake"}]
)
def test_what_changes_the_samples_is_in_the_settings(change: dict[str, Any]) -> None:
    task = load_task("rear-push-rear")
    assert replace(OPTIONS, **change).settings(task) != OPTIONS.settings(task)


def test_how_the_samples_are_run_is_not_in_the_settings() -> None:
    task = load_task("rear-push-rear")
    other = replace(OPTIONS, jobs=2, force=True, check_refusals=5)
    assert other.settings(task) == OPTIONS.settings(task)


def test_settings_are_the_same_after_a_file() -> None:
    settings = OPTIONS.settings(load_task("rear-push-rear"))
    assert json.loads(json.dumps(settings)) == settings


def test_a_share_of_nothing_is_none() -> None:
    assert summarise([], [])["accepted_share"] is None
    figures = summarise([REFUSED], [])
    assert figures["accepted_share"] == 0.0
    assert figures["reached_share_of_accepted"] is None
    assert figures["duration"] is None


def test_a_forced_run_that_misses_makes_its_refusal_true() -> None:
    forced = [{"status": "missed"}, {"status": "reached"}]
    figures = summarise([REACHED, REFUSED], forced)
    assert figures["accepted"] == figures["reached"] == figures["refused"] == 1
    assert figures["refusals_run_anyway"] == 2
    assert figures["refusals_that_failed"] == 1


def test_every_row_of_the_table_has_as_many_cells_as_its_head() -> None:
    lines = table([REACHED, REFUSED], []).splitlines()
    assert len(lines) == 4
    assert {line.count("|") for line in lines} == {lines[0].count("|")}


def test_forced_runs_are_a_table_of_their_own() -> None:
    text = table([REACHED, REFUSED], [{**REFUSED, "status": "missed"}])
    sampled, forced = text.split("\nRefused, but run anyway:\n\n")
    assert sampled == table([REACHED, REFUSED], [])
    assert len(forced.splitlines()) == 3


def test_the_rows_of_forced_runs_are_in_the_order_of_the_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_samples(
        pool: Any,
        task: Task,
        options: SweepOptions,
        indices: list[int],
        *,
        anyway: bool,
    ) -> Iterator[dict[str, Any]]:
        for index in reversed(indices):
            status = "missed" if anyway else "refused"
            yield {"index": index, "status": status, "reason": ""}

    monkeypatch.setattr(module, "_run_samples", run_samples)
    options = replace(OPTIONS, jobs=1, check_refusals=3)
    sweep(load_task("rear-push-rear"), options, tmp_path)
    lines = (tmp_path / "table.md").read_text().splitlines()
    cells = [line.split(" | ")[:2] for line in lines if line.endswith("|  |")]
    outcomes = [f"| {i}" for i in range(3)]
    assert cells == [
        *([index, "refused"] for index in outcomes),
        *([index, "missed"] for index in outcomes),
    ]
