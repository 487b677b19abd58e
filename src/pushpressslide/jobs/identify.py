"""Identification of rho, friction and pressure from recorded pushes.

The models are scored on held-out pushes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.task import Task
from pushpressslide.core.whole_file import write_whole
from pushpressslide.identification.identified_set import (
    IdentifiedSet,
    identified_set,
)
from pushpressslide.identification.intervals import METHOD
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.logs import log_files, read_logs
from pushpressslide.identification.pairs import LENGTH
from pushpressslide.identification.push_sets import PRISM, PushSet, load_sets
from pushpressslide.identification.recorded_sets import (
    RecordedSet,
    pushed_object,
    recorded_set,
)
from pushpressslide.identification.scoring import Identification, identified
from pushpressslide.mechanics.rho import rho_pole
from pushpressslide.report.files import RECORD, TASK
from pushpressslide.report.identification import (
    predicted_rho,
    summary,
    write_identification,
)
from pushpressslide.report.json_text import to_json
from pushpressslide.report.metrics import installed_versions
from pushpressslide.taskfile.load import load_written_task

SCHEMA = 1
Progress = Callable[[float, float], None]


@dataclass(frozen=True)
class IdentifyOptions:
    """Options for scoring the models, and for reading the object and the logs."""

    seed: int = 0
    splits: int = 20
    fit_share: float = 0.5
    # task of the object; None: that of a run, or the prism of the published text logs
    task: Task | None = None
    log: LogOptions = field(default_factory=LogOptions)


def identify(
    data: Sequence[Path],
    out: Path,
    options: IdentifyOptions,
    progress: Progress | None = None,
) -> tuple[dict[str, Any], list[IdentifiedSet]]:
    """Identify every set of pushes in ``data``: logs, or folders with logs.

    All recordings with streams together form one set; each folder of text logs forms
    another. Returns the contents of result.json, and the sets. Writes result.json,
    report.html and a plot of each set to ``out``. Raises PushPressSlideError for logs
    that cannot be read.
    """
    files = log_files(data)
    recorded = None
    passed_over: list[str] = []
    if files:
        recorded = _recorded(data, files, options)
        sets = [recorded.push_set]
    else:
        sets, passed_over = _text_sets(data, options)
    results = []
    for done, push_set in enumerate(sets):
        moved = _overall(progress, done, len(sets))
        found = identified(
            push_set, options.fit_share, options.splits, options.seed, moved
        )
        results.append(identified_set(found, recorded, options.seed))
    models = [each.models for each in results]
    notes = _notes(models, passed_over)
    result = _result(data, options, results, notes)
    # from an older run: a folder with a result is complete
    (out / "result.json").unlink(missing_ok=True)
    shares = f"{100.0 * options.fit_share:g} % of each set's pushes fitted"
    how = f"{options.splits} random splits, {shares}, the rest held out."
    said = [line for each in results for line in summary(each)]
    write_identification(models, out, how, [*said, *notes])
    write_whole(out / "result.json", to_json(result))
    return result, results


def _result(
    data: Sequence[Path],
    options: IdentifyOptions,
    results: Sequence[IdentifiedSet],
    notes: Sequence[str],
) -> dict[str, Any]:
    """Contents of result.json."""
    return {
        "schema": SCHEMA,
        "data": [str(path) for path in data],
        "seed": options.seed,
        "splits": options.splits,
        "fit_share": options.fit_share,
        "length_scale": LENGTH,
        "interval": METHOD,
        "sets": {
            each.models.push_set.name: _figures(each.models) | _more_figures(each)
            for each in results
        },
        "mean_error_reduction": _reductions([each.models for each in results]),
        "notes": list(notes),
        "versions": installed_versions(),
    }


def _recorded(
    data: Sequence[Path], files: Sequence[Path], options: IdentifyOptions
) -> RecordedSet:
    """The set of all recordings in ``files``."""
    task = options.task or _task_of_runs(files)
    recordings = read_logs(files, options.log)
    return recorded_set(data[0].name, recordings, task.scene, options.log)


def _task_of_runs(files: Sequence[Path]) -> Task:
    """Task of the runs that records belong to.

    Raises PushPressSlideError for files that are not records, and for runs with
    different objects.
    """
    tasks = []
    for file in files:
        path = file.parent / TASK
        if file.name != RECORD or not path.is_file():
            raise PushPressSlideError(
                f"{file}: --task is missing; it names the task file with the object's "
                "shape, mass and centre of mass"
            )
        tasks.append(load_written_task(path))
        if tasks[-1].object != tasks[0].object:
            raise PushPressSlideError(
                f"{file}: its object is not that of {files[0]}; allowed: runs of one "
                "object"
            )
    return tasks[0]


def _text_sets(
    data: Sequence[Path], options: IdentifyOptions
) -> tuple[list[PushSet], list[str]]:
    """Sets of text logs, and a line for each skipped file."""
    task = options.task
    body = PRISM if task is None else pushed_object(task.scene)
    sets: list[PushSet] = []
    passed_over: list[str] = []
    for path in data:
        found, skipped = load_sets(path, body=body)
        sets += found
        passed_over += skipped
    return sets, passed_over


def _overall(progress: Progress | None, done: int, sets: int) -> Progress:
    """Progress callback for one set, which reports progress over all ``sets``."""

    def report_progress(part: float, parts: float) -> None:
        """Report progress within the current set."""
        if progress is not None:
            progress(done + part / parts, sets)

    return report_progress


def _figures(one: Identification) -> dict[str, Any]:
    """Figures of one set in result.json; SI units, radians."""
    push_set = one.push_set
    layout, rigid = predicted_rho(one)
    return {
        "logs": list(push_set.logs),
        "pushes": push_set.count,
        "pairs": len(push_set.pairs),
        "refused": list(push_set.refused),
        "pins": [list(pin) for pin in push_set.pins] or None,
        "loads": one.pressure.shares.tolist() if push_set.pins else None,
        "contact_height": float(push_set.pairs.heights.mean()),
        "friction": one.pressure.friction,
        "friction_ellipsoid": one.ellipsoid.max_force / push_set.weight,
        "rho": one.ellipsoid.rho,
        "rho_predicted": layout,
        "rho_predicted_rigid_face": rigid,
        "rho_pressure": rho_pole(one.pressure.at_rest),
        "errors": {
            name: {"mean": s.mean, "spread": s.spread} for name, s in one.scores.items()
        },
    }


def _more_figures(result: IdentifiedSet) -> dict[str, Any]:
    """Intervals, the next push, and results of the streams; SI units."""
    recorded = result.recorded
    clocks = () if recorded is None else recorded.clocks
    return {
        "friction_interval": [
            result.intervals.friction.low,
            result.intervals.friction.high,
        ],
        "rho_interval": [result.intervals.rho.low, result.intervals.rho.high],
        "contact_friction": result.contact_friction,
        "clocks": [
            {
                "log": clock.source,
                "offset": clock.offset.seconds,
                "half_width": clock.offset.half_width,
            }
            for clock in clocks
        ],
        "next_push": asdict(result.next_push),
        "belief": result.belief,
    }


def _reductions(identifications: Sequence[Identification]) -> dict[str, float]:
    """Relative reduction of each model's error compared with the one-parameter
    ellipsoid, averaged over the sets.
    """
    names = [
        name
        for name in identifications[0].scores
        if all(name in each.scores for each in identifications)
    ]
    return {
        name: sum(
            1.0 - each.scores[name].mean / each.scores["ellipsoid"].mean
            for each in identifications
        )
        / len(identifications)
        for name in names
    }


def _notes(
    identifications: Sequence[Identification], passed_over: Sequence[str]
) -> list[str]:
    """Notes on unused data, and on assumptions about each set."""
    notes: list[str] = []
    for each in identifications:
        notes += each.push_set.notes
        notes += [
            f"{each.push_set.name}: {line} (not used)."
            for line in each.push_set.refused
        ]
    return [*notes, *passed_over]
