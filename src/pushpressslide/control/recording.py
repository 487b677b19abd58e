"""Collects what happens, tick by tick, into a Record."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.control.plant import PlantRow
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    PHASES,
    Commands,
    ControlLog,
    Measurement,
    TipCommand,
)
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.execution.impedance import tip_force

PATH_SAMPLES = 200
NO_VECTOR = (np.nan, np.nan, np.nan)


@dataclass(frozen=True, slots=True)
class Tick:
    """One pass of the run loop: what was true, thought, commanded, and came of it."""

    truth: Measurement  # at the start of the tick
    commands: Commands  # as given, before any disturbance
    log: ControlLog
    # the segment that was followed, as planned when it began; None before the first
    followed: Segment | None
    row: PlantRow
    wall_times: tuple[float, float, float]  # [s] to track, to allocate, in total


class _Noted(NamedTuple):
    """A tick, and what was followed in it."""

    tick: Tick
    segment: Segment
    placement: int  # number over the whole run
    stretch: int  # number of the segment over the whole run
    X_GB: Pose2  # of the plan at that time


class Recorder:
    """Collects the ticks of a run and makes the arrays of its record when it is over:
    what is done between two ticks is paid for with cold caches.
    """

    def __init__(self, plan: Plan) -> None:
        """Start empty, with the first placement of ``plan``."""
        self._noted: list[_Noted] = []
        self._X_BG = plan.task.X_GB.inverse()
        self._plan = plan
        self._number = 0  # of the placement that is done now, over the whole run
        self._earlier = 0  # placements that were done by other plans than this one
        self._before = 0  # segments that were begun before it
        self._followed: list[Segment] = []  # each segment that was begun

    def __len__(self) -> int:
        return len(self._noted)

    def begin(self, plan: Plan, number: int) -> None:
        """Note that the placement of that ``number`` of ``plan`` begins."""
        self._number += 1
        self._earlier = self._number - number
        self._plan = plan
        self._before = len(self._followed)

    @property
    def _placement(self) -> int:
        """Number of the present placement in its plan."""
        return self._number - self._earlier

    def add(self, tick: Tick) -> None:
        """Append one tick."""
        followed = tick.followed
        begun = self._followed
        if followed is not None and (not begun or followed is not begun[-1]):
            begun.append(followed)
        self._noted.append(
            _Noted(
                tick,
                followed or self._plan.placements[self._placement][0],
                self._number,
                max(self._before, len(begun) - 1),
                self._plan.task.X_GB,
            )
        )

    def arrays(self) -> dict[str, Array]:
        """Return the arrays of all ticks so far."""
        columns: dict[str, list[Any]] = defaultdict(list)
        for noted in self._noted:
            rows = {
                **self._plan_rows(noted),
                **_log_rows(noted.tick),
                **_arm_rows(noted.tick),
                **_wall_time_rows(noted.tick),
                **noted.tick.row.extras(),
            }
            for name, value in rows.items():
                columns[name].append(value)
        return {
            name: np.asarray(column, dtype=np.float64)
            for name, column in columns.items()
        }

    def _plan_rows(self, noted: _Noted) -> dict[str, Any]:
        # about the frame B that the run began with
        X_BV = self._X_BG.compose(noted.X_GB).compose(noted.segment.X_BV)
        return {
            "leg": noted.segment.leg,
            "placement": noted.placement,
            "stretch": noted.stretch,
            "vehicle_frame": (X_BV.x, X_BV.y, X_BV.yaw),
        }

    def record(
        self,
        arrays: Mapping[str, Array],
        ending: Ending,
        engine: str,
        seed: int,
        wall_time: float,
        plan: Plan,
        meta: Mapping[str, Any],
    ) -> Record:
        """Return the record of ``plan`` as it was run, with the ``arrays`` of all ticks
        and those of the paths.
        """
        placements = self._plan.placements[self._placement :]
        paths = [segment.path for segment in self._followed]
        done = min(len(paths) - self._before, len(placements[0]))
        rest = [piece for group in placements for piece in group]
        paths += [segment.path for segment in rest[done:]]
        samples = [
            p.pose(s) for p in paths for s in np.linspace(0.0, p.length, PATH_SAMPLES)
        ]
        stretches = np.arange(len(paths), dtype=np.float64)
        planned = {
            "plan_path": np.array([(p.x, p.y, p.yaw) for p in samples]),
            "plan_stretch": np.repeat(stretches, PATH_SAMPLES),
        }
        used = (piece.mode for part in plan.by_placement for piece in part.segments)
        modes = tuple(mode for mode, _ in groupby(used))
        return Record(
            {**arrays, **planned},
            ending.code,
            ending.text,
            engine,
            seed,
            wall_time,
            modes,
            plan,
            meta,
        )


def _log_rows(tick: Tick) -> dict[str, Any]:
    log = tick.log
    pose = tick.truth.object_pose
    return {
        "time": tick.truth.time,
        "phase": PHASES.index(log.phase),
        "object_pose": (pose.x, pose.y, pose.yaw),
        "object_twist": tick.row.object_twist,
        "reference_pose": (log.reference.x, log.reference.y, log.reference.yaw),
        "tracking_error": log.tracking_error,
        "progress": log.progress,
        "steering": log.steering,
        "wanted_wrench": log.wanted_wrench,
        "allocated_wrench": log.allocated_wrench,
    }


def _arm_rows(tick: Tick) -> dict[str, Any]:
    tip_commands = [c if isinstance(c, TipCommand) else None for c in tick.commands]
    tips = tick.truth.tips
    return {
        "command_force": [NO_VECTOR if c is None else c.force for c in tip_commands],
        "demanded_force": [
            NO_VECTOR if c is None else tip_force(c, tip.position, tip.velocity)
            for c, tip in zip(tip_commands, tips, strict=True)
        ],
        "tip_reference": [NO_VECTOR if c is None else c.position for c in tip_commands],
        "tip_position": [tip.position for tip in tips],
        "measured_force": list(tick.row.tip_forces),
    }


def _wall_time_rows(tick: Tick) -> dict[str, float]:
    track, allocate, total = tick.wall_times
    return {
        "tick_track": track,
        "tick_allocate": allocate,
        "tick_execute": tick.row.execution_time,
        "tick_total": total,
    }
