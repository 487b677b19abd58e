"""Benchmarks of the closed forms against solvers, libraries and other controllers.

Speeds are compared by ratios of medians in the same run.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.json_text import to_json
from pushpressslide.report.metrics import installed_versions
from pushpressslide_studies.bench.compared import Contestants, Row, compared
from pushpressslide_studies.bench.contestants import (
    ABSENT,
    press_contestants,
    push_contestants,
)

Progress = Callable[[float, float], None]
CALLS = 2000  # of a tick in a round
CASES = 10_000  # of each comparison
PUSHES = 1000  # of a flat finger
SAMPLES = 100_000  # of wrenches, for each friction
TICKS = ("rear-push-rear", "rear-push-left")


def bench(
    names: Sequence[str] | None = None,
    *,
    seed: int = 0,
    out: Path,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run the benchmarks ``names``, by default all, and return their rows by name.

    It writes ``out``/result.json and, for compared times, ``out``/ratios.png. Raises
    TaskError for an unknown name. The row of a solver that is not installed says so.
    """
    for name in names or ():
        if name not in BENCHMARKS:
            raise TaskError(
                "pps bench", "NAME", name, f"allowed: {', '.join(BENCHMARKS)}"
            )
    chosen = list(names or BENCHMARKS)
    rows = {}
    for done, name in enumerate(chosen):
        if progress is not None:
            progress(done, len(chosen))
        rows[name] = BENCHMARKS[name](seed, out)
    result = {
        "schema": 1,
        "seed": seed,
        "benchmarks": rows,
        "versions": installed_versions() | solver_versions(),
    }
    # of an older run: a folder that has one is complete
    (out / "result.json").unlink(missing_ok=True)
    _write_ratios(out, rows)
    write_whole(out / "result.json", to_json(result))
    return result


def _write_ratios(out: Path, rows: dict[str, list[Row]]) -> None:
    """Write a plot of all ratios, if there are any."""
    from pushpressslide.report import style
    from pushpressslide_studies.bench.pictures import ratios

    made = ratios(rows)
    if made is not None:
        write_whole(out / "ratios.png", style.png(made))


def solver_versions() -> dict[str, str]:
    """Versions of the installed solvers."""
    versions = {}
    for name in ("daqp", "clarabel", "scipy", "numba", "ompl", "casadi", "mujoco"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return versions


def pushes(seed: int, out: Path) -> list[Row]:
    """Compare the allocation to two side contacts with QP solvers."""
    return compared(push_contestants(seed))


def presses(seed: int, out: Path) -> list[Row]:
    """Compare the allocation to two top contacts with SOCP solvers."""
    return compared(press_contestants(seed))


def tick(seed: int, out: Path) -> list[Row]:
    """Compare tracking plus allocation of a rear push with an empty function call."""

    def empty() -> None:
        """Do nothing."""

    contestants: Contestants = {"empty function call": [(empty, ())] * CALLS}
    return compared(
        contestants | {name: [(track_and_allocate(name), ())] * CALLS for name in TICKS}
    )


def track_and_allocate(name: str) -> Callable[[], object]:
    """One tick of a shipped task's tracking law and allocator.

    The object is off its path by 2 mm and 0.02 rad.
    """
    from pushpressslide.core.pose import Pose2
    from pushpressslide.modes import MODES
    from pushpressslide.selection.select import select as choices_for
    from pushpressslide.selection.solve import plan as make_plan
    from pushpressslide.taskfile.load import load_task

    task = load_task(name)
    plan = make_plan(task, choices_for(task)[0])
    (segment,) = plan.segments
    mode = MODES[segment.mode]
    path = segment.path
    tracker = mode.tracker(task.query, segment)
    friction = task.scene.contact_friction
    allocate = mode.allocator(segment.contacts, friction, segment.drive.rho)
    s = 0.3 * path.length
    off_path = path.pose(s).compose(Pose2(0.0, 0.002, 0.02))
    X_WB = off_path.compose(segment.X_BV.inverse())

    def one_tick() -> object:
        """Track and allocate."""
        wanted = tracker.step(path, X_WB, s, 0.05, 1.0)
        return allocate(wanted.fx, wanted.fy, wanted.tau)

    return one_tick


def agreement(seed: int, out: Path) -> list[Row]:
    """Compare the results of the closed forms with those of DAQP and Clarabel."""
    from pushpressslide_studies.bench import agreement as cases

    try:
        figures = {
            "pushes, least friction": cases.pushes(CASES, seed),
            "pushes, least force": cases.pushes(CASES, seed + 1, "least_force"),
            "presses": cases.presses(CASES, seed + 2),
        }
    except ModuleNotFoundError as error:
        return [{"what": "all", "note": f"{error.name} {ABSENT}"}]
    return [
        {"what": name, "figure": figure, "value": value}
        for name, values in figures.items()
        for figure, value in values.items()
    ]


def coverage(seed: int, out: Path) -> list[Row]:
    """Sample the wrenches of two orthogonal pushes, and compare with the paper's
    formulas.

    Also writes ``out``/orthogonal-pushes.png.
    """
    from pushpressslide.report import style
    from pushpressslide_studies.bench import coverage as sampled

    write_whole(out / "orthogonal-pushes.png", style.png(sampled.figure(0.5, seed)))
    return [sampled.coverage(mu, SAMPLES, seed) for mu in sampled.FRICTIONS]


def turning(seed: int, out: Path) -> list[Row]:
    """Sample the ICRs of two orthogonal pushes, and compare with the paper's distances."""
    from pushpressslide_studies.bench import coverage as sampled

    return [sampled.turning_centers(mu, SAMPLES, seed) for mu in sampled.FRICTIONS]


def select(seed: int, out: Path) -> list[Row]:
    """Run every feasible mode on the planar engine, and compare with the ranking of the
    selection.
    """
    from pushpressslide_studies.bench.selection import study

    return study()


def sticking(seed: int, out: Path) -> list[Row]:
    """Push random boxes with a flat finger on the planar engine, and compare with the
    prediction.
    """
    from pushpressslide_studies.bench.sticking import scores

    return scores(PUSHES, seed)


def batches(seed: int, out: Path) -> list[Row]:
    """Run the laws on arrays, compiled and in Python, and compare with copying the same
    bytes.
    """
    from pushpressslide_studies.bench.batches import batches as rows

    return rows(seed)


def dubins(seed: int, out: Path) -> list[Row]:
    """Compute the lengths of Dubins paths, in batch and singly, and compare with OMPL."""
    from pushpressslide_studies.bench.batches import dubins as rows

    return rows(seed)


def planners(seed: int, out: Path) -> list[Row]:
    """Plan pushes past a post, and compare with OMPL's planners."""
    from pushpressslide_studies.bench.planners import planners as rows

    return rows(seed)


def engines(seed: int, out: Path) -> list[Row]:
    """Push a box in several engines, with one push or many at a time."""
    from pushpressslide_studies.bench.engines import engines as rows

    return rows()


def mpc(seed: int, out: Path) -> list[Row]:
    """Push along a path by the closed forms and by model-predictive control."""
    from pushpressslide_studies.bench.mpc import mpc as rows

    return rows()


def runs(seed: int, out: Path) -> list[Row]:
    """Run shipped tasks in Drake, and compare with the same simulation under
    played-back torques.
    """
    from pushpressslide_studies.bench.whole_run import runs as rows

    return rows()


def memory(seed: int, out: Path) -> list[Row]:
    """Run a shipped task in Drake with other memory allocators."""
    from pushpressslide_studies.bench.memory import memory as rows

    return rows()


def truths(seed: int, out: Path) -> list[Row]:
    """Run samples of one planned push, both on arrays and one by one in the run loop."""
    from pushpressslide_studies.bench.truths import truths as rows

    return rows(seed)


def start(seed: int, out: Path) -> list[Row]:
    """Measure how long programs take to start, compared with ``import numpy``."""
    from pushpressslide_studies.bench.start import start as rows

    return rows()


def scaling(seed: int, out: Path) -> list[Row]:
    """Measure how costs grow with sizes.

    Also writes ``out``/scaling.png.
    """
    from pushpressslide.report import style
    from pushpressslide_studies.bench import scaling as sizes

    rows = sizes.scaling(seed)
    write_whole(out / "scaling.png", style.png(sizes.figure(rows)))
    return rows


BENCHMARKS: dict[str, Callable[[int, Path], list[Row]]] = {
    benchmark.__name__: benchmark
    for benchmark in (
        pushes,
        presses,
        tick,
        agreement,
        coverage,
        turning,
        sticking,
        select,
        batches,
        dubins,
        planners,
        engines,
        mpc,
        runs,
        memory,
        truths,
        start,
        scaling,
    )
}
