"""Shipped tasks in every engine: errors, times, and wall time."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pushpressslide.core.task import Task
from pushpressslide.jobs.run import run_task

ENGINES = ("planar", "drake", "mujoco")


@dataclass(frozen=True)
class EngineRun:
    """One task in one engine."""

    task: str
    engine: str
    reached: bool
    error: float | None  # [m] at the end; None: not known
    yaw_error: float | None  # [rad]
    duration: float  # [s] simulated
    wall_time: float  # [s] of the loop

    @property
    def pace(self) -> float:
        """Wall time of a simulated second [s]."""
        return self.wall_time / self.duration


def run_of(task: Task, engine: str) -> EngineRun:
    """Run of a task in an engine."""
    result = run_task(task, engine=engine)
    return EngineRun(
        task.name,
        engine,
        bool(result["success"]),
        result["final_position_error"],
        result["final_yaw_error"],
        result["duration"],
        result["wall_time"],
    )


def table(runs: Sequence[EngineRun]) -> str:
    """Table of all runs as Markdown, one row per task."""
    names = dict.fromkeys(run.task for run in runs)
    by = {(run.task, run.engine): run for run in runs}
    lines = [
        "| task | " + " | ".join(ENGINES) + " |",
        "|---|" + "---|" * len(ENGINES),
    ]
    for name in names:
        cells = (_cell(by[name, engine]) for engine in ENGINES)
        lines.append(f"| `{name}` | {' | '.join(cells)} |")
    lines.append(f"| reached | {' | '.join(_reached(runs))} |")
    lines.append(f"| wall time of a simulated second | {' | '.join(_paces(runs))} |")
    return "\n".join(lines)


def _cell(run: EngineRun) -> str:
    """Errors and duration of one run."""
    if run.error is None or run.yaw_error is None:
        return "not known"
    error = f"{1e3 * run.error:.2f} mm, {math.degrees(abs(run.yaw_error)):.2f}°"
    text = f"{error}, {run.duration:.1f} s"
    return text if run.reached else f"missed: {text}"


def _runs_in(runs: Iterable[EngineRun], engine: str) -> list[EngineRun]:
    return [run for run in runs if run.engine == engine]


def _reached(runs: Sequence[EngineRun]) -> Iterator[str]:
    """Number of reached goals of each engine."""
    for engine in ENGINES:
        own = _runs_in(runs, engine)
        yield f"{sum(run.reached for run in own)} of {len(own)}"


def _paces(runs: Sequence[EngineRun]) -> Iterator[str]:
    """Median pace of each engine."""
    for engine in ENGINES:
        paces = sorted(run.pace for run in _runs_in(runs, engine))
        yield f"{paces[len(paces) // 2]:.2f} s"
