"""A run in stages on disk: an ordinary run in stages/1, stages/2 and so on, and beside
them task.yaml, plan.json, record.npz and, last of all, result.json of the whole.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from pushpressslide.core.bodies import Stage
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.state import State
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.files import (
    PLAN,
    RECORD,
    RESULT,
    TASK,
    Run,
    load_run,
    read_json,
    read_with,
    record_from_bytes,
    record_to_bytes,
    save_run,
)
from pushpressslide.report.json_text import to_json
from pushpressslide.report.stages import StageRun, joined_plan

SCHEMA = 1
STAGES = "stages"


@dataclass(frozen=True)
class StagesRun:
    """A finished run in stages, as read back from its folder."""

    folder: Path
    task: Task
    stages: tuple[Stage, ...]  # as planned
    runs: tuple[StageRun, ...]  # those that were begun
    record: Record  # of all, joined
    result: Mapping[str, Any]


def stage_folder(folder: Path, index: int) -> Path:
    """Return the folder of the stage of an ``index`` from 0."""
    return folder / STAGES / str(index + 1)


def is_staged(folder: Path) -> bool:
    """Return whether a folder holds a finished run in stages."""
    return (folder / STAGES).is_dir() and (folder / RESULT).is_file()


def clear_stages(folder: Path) -> None:
    """Take an older run's result, pages and stages away."""
    for name in (RESULT, "replay.html", "report.html", "run.webp"):
        (folder / name).unlink(missing_ok=True)
    for name in (STAGES, "pictures"):
        shutil.rmtree(folder / name, ignore_errors=True)


def save_stage(
    folder: Path, index: int, run: StageRun, result: Mapping[str, Any]
) -> None:
    """Write a stage as an ordinary run into its folder."""
    out = stage_folder(folder, index)
    save_run(out, run.plan, run.record, result, run.choices)


def stages_to_dict(
    task: Task, stages: Sequence[Stage], runs: Sequence[StageRun] = ()
) -> dict[str, Any]:
    """Return the order of the stages as plain data, as in plan.json; of ``runs`` also
    when and from where each began.
    """
    out = []
    for index, stage in enumerate(stages):
        entry: dict[str, Any] = {
            "body": stage.body,
            "goal": asdict(stage.goal),
            "aside": stage.aside,
        }
        if index < len(runs):
            run = runs[index]
            entry["began"] = run.began
            entry["poses"] = {body: asdict(X) for body, X in run.state.poses.items()}
            entry["planned_anew"] = run.anew
        out.append(entry)
    return {"schema": SCHEMA, "task": task.name, "stages": out}


def save_stages(
    folder: Path,
    task: Task,
    stages: Sequence[Stage],
    runs: Sequence[StageRun],
    record: Record,
    result: Mapping[str, Any],
) -> None:
    """Write what a run in stages has beside its stages."""
    from pushpressslide.taskfile.load import dump_task

    write_whole(folder / TASK, dump_task(task))
    write_whole(folder / PLAN, to_json(stages_to_dict(task, stages, runs)))
    write_whole(folder / RECORD, record_to_bytes(record))
    write_whole(folder / RESULT, to_json(result))


def load_stages(folder: Path) -> StagesRun:
    """Return the run in stages in ``folder``.

    Raises PushPressSlideError if a stage is missing, unfinished or damaged.
    """
    from pushpressslide.taskfile.load import load_written_task

    stored = read_json(folder / PLAN)
    stages = read_with(folder / PLAN, lambda _: _stages(stored))
    runs = []
    for index, entry in enumerate(stored["stages"]):
        if "began" not in entry:
            break
        run = load_run(stage_folder(folder, index))
        begun = read_with(folder / PLAN, partial(_run, entry, stages[index], run))
        runs.append(begun)
    plan = joined_plan(runs)
    record = read_with(
        folder / RECORD, lambda path: record_from_bytes(path.read_bytes(), plan)
    )
    result = read_json(folder / RESULT)
    task = load_written_task(folder / TASK)
    return StagesRun(folder, task, stages, tuple(runs), record, result)


def _stages(data: Mapping[str, Any]) -> tuple[Stage, ...]:
    """Return the stages of ``stages_to_dict``."""
    return tuple(
        Stage(entry["body"], Pose2(**entry["goal"]), entry["aside"])
        for entry in data["stages"]
    )


def _run(entry: Mapping[str, Any], stage: Stage, run: Run, _: Path) -> StageRun:
    """Return the run of a stage that was begun, as ``stages_to_dict`` has it."""
    poses = {body: Pose2(**X) for body, X in entry["poses"].items()}
    return StageRun(
        stage,
        run.plan,
        run.record,
        run.choices,
        entry["began"],
        State(poses),
        entry["planned_anew"],
    )
