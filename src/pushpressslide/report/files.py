"""A run on disk: task.yaml, plan.json, record.npz and, last of all, result.json.

Each file is there whole or not at all.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.json_text import plain, to_json
from pushpressslide.report.plan_files import (
    choices_from_dict,
    plan_from_dict,
    plan_to_dict,
)

TASK = "task.yaml"
PLAN = "plan.json"
RECORD = "record.npz"
RESULT = "result.json"
META = "meta_json"
"""Name of the array of record.npz that holds, as JSON text, all of a Record that is not
a time series.
"""


T = TypeVar("T")


@dataclass(frozen=True)
class Run:
    """One finished run, as read back from its folder."""

    folder: Path
    task: Task
    plan: Plan
    record: Record
    result: Mapping[str, Any]
    # all that were weighed, refused ones too; empty if not kept
    choices: tuple[Choice, ...] = ()

    def __repr__(self) -> str:
        """Return one line."""
        return f"Run({str(self.folder)!r}: {self.record!r})"


def save_run(
    out: Path,
    plan: Plan,
    record: Record,
    result: Mapping[str, Any],
    choices: Sequence[Choice] = (),
) -> None:
    """Write a run to folder ``out``.

    result.json comes last: a folder that has one is complete. An older result.json is
    taken away first, so that a folder is never half of one run and half of another.
    """
    from pushpressslide.taskfile.load import dump_task

    out.mkdir(parents=True, exist_ok=True)
    (out / RESULT).unlink(missing_ok=True)
    write_whole(out / TASK, dump_task(plan.task))
    write_whole(out / PLAN, to_json(plan_to_dict(plan, choices)))
    write_whole(out / RECORD, record_to_bytes(record))
    write_whole(out / RESULT, to_json(result))


def load_run(folder: str | Path) -> Run:
    """Return the run in ``folder``.

    Raises PushPressSlideError if it is missing, unfinished or damaged.
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
    if "stages" in stored:
        raise PushPressSlideError(
            f"{folder}: holds a run in stages; give one of {folder / 'stages'}, or load "
            "it by report.stage_files.load_stages"
        )
    task = load_written_task(folder / TASK)
    plan = read_with(folder / PLAN, lambda _: plan_from_dict(stored, task))
    choices = read_with(folder / PLAN, lambda _: choices_from_dict(stored))
    record = read_with(
        folder / RECORD, lambda path: record_from_bytes(path.read_bytes(), plan)
    )
    return Run(
        folder, plan.task, plan, replace(record, figures=result), result, choices
    )


def read_json(path: Path) -> Any:
    """Return the JSON data of a file.

    Raises PushPressSlideError if it is damaged.
    """
    return read_with(path, lambda path: json.loads(path.read_text("utf-8")))


def read_with(path: Path, reader: Callable[[Path], T]) -> T:
    """Return what ``reader`` makes of a file.

    Raises PushPressSlideError, with the file's name, if it is damaged.
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
    """Return a record as the bytes of an .npz file.

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
    """Return the record of ``record_to_bytes``, of a run of ``plan``; tuples in ``meta``
    come back as lists.
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
