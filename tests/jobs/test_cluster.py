"""Sweeps on a Dask cluster: the same rows, even if a worker is lost."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.jobs import cluster as module
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.taskfile.load import load_task

TASK = load_task("rear-push-rear")
OPTIONS = SweepOptions(6, engine="planar", seed=3)
TIMED = ("wall_time", "realtime_factor", "planning_time")


def rows(folder: Path) -> list[dict[str, Any]]:
    lines = (folder / "rows.jsonl").read_text().splitlines()
    found = [json.loads(line) for line in lines]
    for row in found:
        for name in TIMED:
            row.pop(name, None)
    return sorted(found, key=lambda row: row["index"])


@pytest.mark.long
def test_rows_are_the_same_on_a_cluster_that_loses_a_worker(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    sweep(TASK, replace(OPTIONS, jobs=1), tmp_path / "here")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as local:
        lost: list[int] = []

        def progress(done: int, of: int) -> None:
            """Lose a worker once a sample is done; a nanny begins another one."""
            if done >= 1 and not lost:
                lost.append(done)
                nanny = next(iter(local.workers.values()))
                nanny.process.process.kill()

        options = replace(OPTIONS, cluster=local.scheduler_address)
        sweep(TASK, options, tmp_path / "there", progress)
    assert lost
    assert rows(tmp_path / "there") == rows(tmp_path / "here")


def test_a_cluster_that_is_not_there_is_said_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(module, "PATIENCE", 0.5)
    options = replace(OPTIONS, cluster="tcp://127.0.0.1:9")
    with pytest.raises(PushPressSlideError, match="no scheduler answers at 'tcp://127"):
        sweep(TASK, options, tmp_path)


def test_workers_without_alarms_are_not_asked_for_a_limit_of_time(
    tmp_path: Path,
) -> None:
    options = replace(OPTIONS, cluster="tcp://127.0.0.1:9", sample_time=5.0)
    with pytest.raises(PushPressSlideError, match=r"--sample-time: 5 .*--cluster"):
        sweep(TASK, options, tmp_path)


def test_without_the_extra_its_name_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def absent(name: str) -> None:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(module.importlib, "import_module", absent)
    options = replace(OPTIONS, cluster="tcp://127.0.0.1:9")
    with pytest.raises(PushPressSlideError, match=r"pushpressslide\[cluster\]"):
        sweep(TASK, options, tmp_path)
