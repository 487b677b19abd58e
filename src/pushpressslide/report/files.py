"""A run on disk: task.yaml, plan.json, record.npz and, written last, result.json.

Each file is either complete or absent.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from pushpressslide.core.bodies import OBJECT, Stage, start_state
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.state import WorldState
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.json_text import plain, to_json
from pushpressslide.report.plan_files import (
    SCHEMA,
    purpose_from_dict,
    stage_from_dict,
    stages_to_dict,
)
from pushpressslide.report.stage_figures import stage_figures
from pushpressslide.report.stages import (
    StagePlan,
    StageRun,
    cut_record,
    joined_plan,
    joined_record,
)

TASK = "task.yaml"
PLAN = "plan.json"
RECORD = "record.npz"
RESULT = "result.json"
OLDER_STAGES = "stages"  # a folder of older runs of several stages
META = "meta_json"
"""Name of the array in record.npz that contains the rest of a Record, other than the
time series, as JSON text.
"""


T = TypeVar("T")


@dataclass(frozen=True)
class Run:
    """One finished run, as read from its folder."""

    folder: Path
    task: Task
    stages: tuple[StagePlan, ...]  # in order, those that were not begun last
    record: Record  # of all stages
    result: Mapping[str, Any]

    @property
    def begun(self) -> tuple[StageRun, ...]:
        """The stages that were started. At least the first one was."""
        return _begun(self.stages)

    @property
    def plan(self) -> Plan:
        """The executed plan with its replans. The plans of several stages follow one
        another.
        """
        return self.record.plan

    @property
    def choices(self) -> tuple[Choice, ...]:
        """All choices considered, including refused ones. Empty if they were not
        stored.
        """
        return tuple(choice for stage in self.stages for choice in stage.choices)

    def __repr__(self) -> str:
        """Summary in one line."""
        return f"Run({str(self.folder)!r}: {self.record!r})"


def save_run(
    out: Path,
    task: Task,
    stages: Sequence[StagePlan],
    record: Record,
    result: Mapping[str, Any],
) -> None:
    """Write a run to the folder ``out``. With an empty result, it is the part of the
    run available so far.

    result.json is written last, so a folder that has one is complete. An older
    result.json is removed first, so that a folder never mixes two runs.
    """
    from pushpressslide.taskfile.load import dump_task

    out.mkdir(parents=True, exist_ok=True)
    (out / RESULT).unlink(missing_ok=True)
    write_whole(out / TASK, dump_task(task))
    write_whole(out / PLAN, to_json(stages_to_dict(task, stages)))
    write_whole(out / RECORD, record_to_bytes(record))
    if result:
        write_whole(out / RESULT, to_json(result))


def load_run(folder: str | Path) -> Run:
    """Run in ``folder``, which may have been written by the previous version.

    Raises PushPressSlideError if the run is missing, unfinished or damaged.
    """
    from pushpressslide.taskfile.load import load_written_task

    folder = Path(folder)
    if not folder.is_dir():
        raise PushPressSlideError(
            f"{folder}: there is no such folder; give one that `pps run` has written"
        )
    for name in (RESULT, TASK, PLAN, RECORD):
        if not (folder / name).is_file():
            raise PushPressSlideError(
                f"{folder}: has no {name}; give a folder that a finished `pps run` has "
                "written"
            )
    result = read_json(folder / RESULT)
    stored = read_json(folder / PLAN)
    task = load_written_task(folder / TASK)
    if (folder / OLDER_STAGES).is_dir():
        return _older_run(folder, task, stored, result)
    plans = read_with(folder / PLAN, partial(_plans, stored, task))
    begun = [part for item, part in plans if "began" in item]
    record = read_with(folder / RECORD, partial(_record, joined_plan(begun)))
    stages = read_with(folder / RECORD, lambda _: _stages(plans, record))
    if not task.goals:
        task = record.plan.task
        result.setdefault("stages", [stage_figures(run) for run in _begun(stages)])
    return Run(folder, task, stages, replace(record, figures=result), result)


def _plans(
    stored: Mapping[str, Any], task: Task, path: Path
) -> list[tuple[Mapping[str, Any], StagePlan]]:
    """Data of each stage in plan.json, with the stage's plan."""
    from pushpressslide.taskfile.load import written_task

    if stored["schema"] == SCHEMA - 1:  # a single stage, written without a list
        alone = {"body": OBJECT, "goal": asdict(task.goal), "aside": False}
        poses = {body: asdict(X) for body, X in start_state(task).poses.items()}
        begun = {"began": 0.0, "poses": poses, "planned_anew": False}
        named = {name: value for name, value in stored.items() if name != "task"}
        entries = [{**named, "later": _later(stored), **alone, **begun}]
    elif stored["schema"] == SCHEMA:
        entries = stored["stages"]
    else:
        raise ValueError(
            f"schema {stored['schema']}, this version reads {SCHEMA - 1} and {SCHEMA}; "
            "run the task again"
        )
    out: list[tuple[Mapping[str, Any], StagePlan]] = []
    for item in entries:
        own = written_task(item["task"], str(path)) if "task" in item else task
        out.append((item, stage_from_dict(item, own)))
    return out


def _later(stored: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Superseding plans, each stored under "again" in the previous plan."""
    out: list[Mapping[str, Any]] = []
    while stored["again"] is not None:
        stored = stored["again"]
        out.append({**stored, "later": []})
    return out


def _begun(stages: Sequence[StagePlan]) -> tuple[StageRun, ...]:
    return tuple(stage for stage in stages if isinstance(stage, StageRun))


def _record(plan: Plan, path: Path) -> Record:
    return record_from_bytes(path.read_bytes(), plan)


def _stages(
    plans: Sequence[tuple[Mapping[str, Any], StagePlan]], joined: Record
) -> tuple[StagePlan, ...]:
    """All stages. Those that were started have their records."""
    out: list[StagePlan] = []
    for number, (item, part) in enumerate(plans):
        if "began" in item:
            record = joined
            if "stage" in joined.arrays:
                record = cut_record(joined, number, item["began"], part)
            part = _run(item, part.stage, record, part.choices)
        out.append(part)
    return tuple(out)


def _run(
    figures: Mapping[str, Any],
    stage: Stage,
    record: Record,
    choices: tuple[Choice, ...],
) -> StageRun:
    """A started stage, from its data in plan.json."""
    state = WorldState({body: Pose2(**X) for body, X in figures["poses"].items()})
    anew = figures["planned_anew"]
    return StageRun(stage, record.plan, choices, record, figures["began"], state, anew)


def _older_run(
    folder: Path, task: Task, stored: Mapping[str, Any], result: dict[str, Any]
) -> Run:
    """A run of the previous version, whose stages are stored as separate runs in
    stages/1, stages/2 and so on.
    """
    runs = []
    for number, item in enumerate(stored["stages"], start=1):
        if "began" in item:
            own = load_run(folder / OLDER_STAGES / str(number))
            runs.append(_run(item, purpose_from_dict(item), own.record, own.choices))
            result["stages"][number - 1]["figures"] = own.result
    ending = Ending(result["reason"]["code"], result["reason"]["text"])
    record = joined_record(runs, ending, result["seed"])
    record = replace(record, figures=result)
    return Run(folder, task, tuple(runs), record, result)


def read_json(path: Path) -> Any:
    """JSON data of a file.

    Raises PushPressSlideError if it is damaged.
    """
    return read_with(path, lambda path: json.loads(path.read_text("utf-8")))


def read_with(path: Path, reader: Callable[[Path], T]) -> T:
    """Result of applying ``reader`` to a file.

    Raises PushPressSlideError, with the file's name, if the file is damaged.
    """
    try:
        return reader(path)
    except (
        KeyError,
        TypeError,
        ValueError,
        OSError,
        EOFError,
        zipfile.BadZipFile,
    ) as error:
        raise PushPressSlideError(
            f"{path}: is damaged or of another version ({type(error).__name__}: "
            f"{error})"
        ) from error


def record_to_bytes(record: Record) -> bytes:
    """A record as the bytes of an .npz file.

    The file holds the arrays, and the rest as JSON text under ``META``.
    """
    rest = {
        "reason": record.reason,
        "reason_text": record.reason_text,
        "engine": record.engine,
        "seed": record.seed,
        "wall_time": record.wall_time,
        "modes": list(record.modes),
        "meta": dict(record.meta),
    }
    arrays: dict[str, Any] = {**record.arrays, META: np.array(json.dumps(plain(rest)))}
    buffer = BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def record_from_bytes(data: bytes, plan: Plan) -> Record:
    """Record from the bytes of ``record_to_bytes``, of a run of ``plan``. Tuples in
    ``meta`` come back as lists.
    """
    with np.load(BytesIO(data), allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files if name != META}
        rest = json.loads(str(stored[META]))
    return Record(
        arrays=arrays,
        reason=rest["reason"],
        reason_text=rest["reason_text"],
        engine=rest["engine"],
        seed=rest["seed"],
        wall_time=rest["wall_time"],
        modes=tuple(rest["modes"]),
        plan=plan,
        meta=rest["meta"],
    )
