"""The benchmarks: the closed forms beside solvers.

Speeds are ratios of medians over the same wrenches in the same run.
"""

from __future__ import annotations

import importlib.metadata
import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from pushpressslide.core.errors import TaskError
from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.json_text import to_json
from pushpressslide.report.metrics import installed_versions
from pushpressslide.studies.bench.contestants import (
    ABSENT,
    Call,
    Contestants,
    press_contestants,
    push_contestants,
)

Row = dict[str, Any]
Progress = Callable[[float, float], None]
ROUNDS = 9
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
    """Run the benchmarks ``names`` (None: all) and return their rows by name.

    Writes ``out``/result.json. Raises TaskError for an unknown name. Where a solver is
    not installed its row says so.
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
    write_whole(out / "result.json", to_json(result))
    return result


def solver_versions() -> dict[str, str]:
    """Return the versions of the solvers that are installed."""
    versions = {}
    for name in ("daqp", "clarabel", "scipy"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return versions


def median_time(calls: Sequence[Call]) -> float:
    """Return the median time [s] of single calls, each timed by itself."""
    times = []
    for function, arguments in calls:
        started = perf_counter()
        function(*arguments)
        times.append(perf_counter() - started)
    return statistics.median(times)


def compared(contestants: Contestants) -> list[Row]:
    """Return the median time of each contestant, and its ratio to the first one's.

    All in turn, in several rounds; both figures are medians over the rounds, so that
    what else the machine does falls on all alike. A text in place of calls says why
    there are none.
    """
    first, *_ = contestants
    rounds: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(ROUNDS):
        for name, calls in contestants.items():
            if not isinstance(calls, str):
                rounds[name].append(median_time(calls))
    rows: list[Row] = []
    for name, calls in contestants.items():
        if isinstance(calls, str):
            rows.append({"what": name, "median_us": None, "ratio": None, "note": calls})
            continue
        ratios = [
            time / ours for time, ours in zip(rounds[name], rounds[first], strict=True)
        ]
        median = 1e6 * statistics.median(rounds[name])
        rows.append(
            {
                "what": name,
                "median_us": median,
                "ratio": statistics.median(ratios),
                "note": "",
            }
        )
    return rows


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
    """Return one tick of a shipped task's tracking law and allocator.

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
    tracker = mode.tracker(task, segment)
    friction = task.scene.contact_friction
    allocate = mode.allocator(segment.contacts, friction, segment.drive.rho)
    s = 0.3 * path.length
    off_path = path.pose(s).compose(Pose2(0.0, 0.002, 0.02))
    X_WB = off_path.compose(segment.X_BV.inverse())

    def one_tick() -> object:
        """Track and allocate."""
        wrench = tracker.step(path, X_WB, s, 0.05, 1.0).wrench
        return allocate(wrench.fx, wrench.fy, wrench.tau)

    return one_tick


def agreement(seed: int, out: Path) -> list[Row]:
    """Compare the answers of the closed forms with those of DAQP and Clarabel."""
    from pushpressslide.studies.bench import agreement as cases

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
    """Sample what two orthogonal pushes can give, beside the paper's formulas.

    Also writes ``out``/orthogonal-pushes.png.
    """
    from pushpressslide.report import style
    from pushpressslide.studies.bench import coverage as sampled

    write_whole(out / "orthogonal-pushes.png", style.png(sampled.figure(0.5, seed)))
    return [sampled.coverage(mu, SAMPLES, seed) for mu in sampled.FRICTIONS]


def turning(seed: int, out: Path) -> list[Row]:
    """Sample the ICRs of two orthogonal pushes, beside the paper's distances."""
    from pushpressslide.studies.bench import coverage as sampled

    return [sampled.turning_centers(mu, SAMPLES, seed) for mu in sampled.FRICTIONS]


def select(seed: int, out: Path) -> list[Row]:
    """Run every feasible mode on the planar engine, beside selection's ranking."""
    from pushpressslide.studies.bench.selection import study

    return study()


def sticking(seed: int, out: Path) -> list[Row]:
    """Push random boxes with a flat finger, on the planar engine and as predicted."""
    from pushpressslide.studies.bench.sticking import scores

    return scores(PUSHES, seed)


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
    )
}
