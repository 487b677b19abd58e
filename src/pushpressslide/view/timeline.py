"""Timeline of a run for its replay: phases, legs, forces, errors to the goal."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.record import Record
from pushpressslide.core.scene import arm_title

FRAMES_PER_SECOND = 30.0
# largest number of frames in a replay, so that a long run is a page of a few megabytes
MOST_FRAMES = 750
GOAL_ERROR = "goal_error"
"""Name of an array (N, 2) [m, rad] in a joined record: the moved body's errors to its
goal.
"""
ENDED_WELL = ("goal_reached", "goal_missed", "interrupted")
"""Reasons for the end of a run that are not failures."""
PARTS = ("stage", "leg", "placement")
"""Arrays whose changes are marked, the one for the largest part first."""


@dataclass(frozen=True, slots=True)
class Span:
    """A phase from ``start`` to ``end`` [s] of the replay."""

    name: str
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Mark:
    """Start of a part of the run, or a failure, at ``time`` [s] of the replay."""

    name: str
    time: float
    text: str = ""  # of a failure, with its number; empty for a part


@dataclass(frozen=True, slots=True)
class RunTimeline:
    """Data that a replay shows next to its pictures, in F frames."""

    time: tuple[float, ...]  # (F,) [s] since the first tick
    phases: tuple[Span, ...]
    marks: tuple[Mark, ...]  # of legs, placements, stages and failures
    arms: tuple[str, ...]  # their names
    force: tuple[tuple[float, ...], ...]  # (A, F) [N] of each arm, its size
    distance: tuple[float, ...]  # (F,) [mm] of the object to its goal
    turn: tuple[float, ...]  # (F,) [deg] to the goal's yaw, >= 0
    ending: str  # why the run ended

    def plain(self) -> dict[str, Any]:
        """The timeline as data for JSON."""
        return asdict(self)


def frames(time: Array, rate: float = FRAMES_PER_SECOND) -> NDArray[np.intp]:
    """Ticks (F,) nearest to a uniform grid of ``rate`` [1/s].

    They include the first and the last tick, and are at most ``MOST_FRAMES``. ``time``
    (N,) [s] is that of each tick.
    """
    if len(time) < 2:
        return np.arange(len(time))
    span = float(time[-1] - time[0])
    count = min(MOST_FRAMES, max(2, math.ceil(span * rate)))
    grid = np.linspace(time[0], time[-1], count)
    return np.unique(np.clip(np.searchsorted(time, grid), 0, len(time) - 1))


def still_ticks(phase: Array) -> dict[str, int]:
    """Ticks of a run's still pictures, by name: start, contact, end. ``phase`` (N,) is
    that of each tick.
    """
    if not len(phase):
        return {}
    (moves,) = np.nonzero(phase == PHASES.index("move"))
    named = {"start": 0, "contact": len(phase) - 1, "end": len(phase) - 1}
    if len(moves):
        named["contact"] = int(moves[len(moves) // 2])
    return named


def run_timeline(plan: Plan, record: Record, ticks: NDArray[np.intp]) -> RunTimeline:
    """Timeline of a run at ``ticks`` (F,) of its record."""
    arrays = record.arrays
    time = arrays["time"] - arrays["time"][:1].sum()
    errors = _goal_errors(plan, record)[ticks]
    forces = np.nan_to_num(arrays["measured_force"][ticks])
    sizes = np.round(np.linalg.norm(forces, axis=2), 2)
    count = len(plan.task.robots)
    return RunTimeline(
        time=_row(time[ticks], 3),
        phases=_phases(time, arrays["phase"]),
        marks=_marks(record, time),
        arms=tuple(arm_title(i, count) for i in range(count)),
        force=tuple(_row(sizes[:, i], 2) for i in range(sizes.shape[1])),
        distance=_row(1e3 * errors[:, 0], 1),
        turn=_row(np.degrees(np.abs(errors[:, 1])), 1),
        ending=_words(record.reason),
    )


def _row(values: Array, decimals: int) -> tuple[float, ...]:
    return tuple(float(v) for v in np.round(values, decimals))


def _goal_errors(plan: Plan, record: Record) -> Array:
    """Distance [m] and rotation [rad] (N, 2) of the object from its goal, at each tick."""
    known = record.arrays.get(GOAL_ERROR)
    if known is not None:
        return known
    goal = plan.task.goal
    return goal_errors(record.arrays["object_pose"], (goal.x, goal.y, goal.yaw))


def goal_errors(poses: Array, goal: tuple[float, float, float]) -> Array:
    """Distance [m] and rotation [rad] (N, 2) of ``poses`` (N, 3) from ``goal``."""
    x, y, yaw = goal
    away = np.hypot(poses[:, 0] - x, poses[:, 1] - y)
    turns = [wrap_angle(float(angle) - yaw) for angle in poses[:, 2]]
    return np.column_stack([away, turns])


def _phases(time: Array, phase: Array) -> tuple[Span, ...]:
    """Phases in order. ``time`` and ``phase`` (N,) are those of each tick."""
    if not len(time):
        return ()
    edges = [0, *(np.flatnonzero(np.diff(phase)) + 1).tolist(), len(time) - 1]
    return tuple(
        Span(
            PHASES[int(phase[first])],
            round(float(time[first]), 3),
            round(float(time[last]), 3),
        )
        for first, last in pairwise(edges)
        if last > first
    )


def _marks(record: Record, time: Array) -> tuple[Mark, ...]:
    """Starts of stages, legs and placements, and failures. Simultaneous starts are
    named after the largest part.
    """
    marks: dict[int, str] = {}
    for part in PARTS:
        number = record.arrays.get(part)
        if number is None:
            continue
        for tick in (np.flatnonzero(np.diff(number)) + 1).tolist():
            marks.setdefault(tick, f"{part} {int(number[tick]) + 1}")
    parts = [
        Mark(name, round(float(time[tick]), 3)) for tick, name in sorted(marks.items())
    ]
    failures = _failures(record, time)
    return tuple(sorted([*parts, *failures], key=lambda mark: mark.time))


def _failures(record: Record, time: Array) -> list[Mark]:
    """Marks of failures: the time at which a limit was broken, or for other failures
    the time at which the arms began to let go.
    """
    if not len(time):
        return []
    first = float(record.arrays["time"][0])
    marks = [
        Mark(_words(breach["code"]), round(breach["time"] - first, 3), breach["text"])
        for breach in record.meta.get("breaches", ())
    ]
    released = record.arrays["phase"] == PHASES.index("release")
    starts = time[np.diff(released.astype(int), prepend=0) > 0]
    ended = [
        (_words(event["code"]), event["time"] - first, event["text"])
        for event in record.meta.get("events", ())
    ]
    if record.reason not in ENDED_WELL:
        ended.append((_words(record.reason), float(time[-1]), record.reason_text))
    earlier = -math.inf
    broken = list(marks)
    for name, end, text in ended:
        if not any(mark.name == name and earlier < mark.time <= end for mark in broken):
            before = starts[starts <= end + 1e-9]
            failed = float(before[-1]) if len(before) else end
            marks.append(Mark(name, round(failed, 3), text))
        earlier = end
    return marks


def _words(code: str) -> str:
    return code.replace("_", " ")
