"""Recorder that collects a run, tick by tick, into a Record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.control.cell import Applied, TrueState
from pushpressslide.control.limits import ArmReading
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    PHASES,
    Commands,
    ControlLog,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Ending, Record
from pushpressslide.execution.impedance import tip_force

Column = Sequence[Any]  # what is recorded under one name, a row for each tick

PATH_SAMPLES = 200
FELT_FORCE = 0.3  # [N] force above which it determines the contact point
NO_VECTOR = (np.nan, np.nan, np.nan)


class Tick(NamedTuple):
    """One pass of the run loop: true state, belief, commands and applied values."""

    time: float  # [s] at its start
    truth: TrueState
    commands: Commands  # as given, before any disturbance
    log: ControlLog
    # the segment that was followed, as planned when it began; None before the first
    followed: Segment | None
    # joints of each arm as measured, and what was applied to them
    joints: tuple[tuple[ArmReading, Applied], ...]
    # [s] to track, to allocate, to read and drive the arms, in total
    wall_times: tuple[float, float, float, float]


class _Noted(NamedTuple):
    """A tick, with the segment followed in it."""

    tick: Tick
    segment: Segment
    placement: int  # number over the whole run
    stretch: int  # number of the segment over the whole run
    X_GB: Pose2  # of the plan at that time


class Recorder:
    """Collects the ticks of a run, and makes the arrays of its record at the end.

    Arrays are made only at the end: making them between ticks would evict the caches
    that the next tick needs.
    """

    def __init__(self, plan: Plan) -> None:
        """Start without ticks, at the first placement of ``plan``."""
        self._noted: list[_Noted] = []
        self._X_GB = plan.task.X_GB
        self._X_BG = self._X_GB.inverse()
        self._plan = plan
        self._number = 0  # of the placement that is done now, over the whole run
        self._earlier = 0  # placements that were done by other plans than this one
        self._before = 0  # segments that were begun before it
        self._followed: list[Segment] = []  # each segment that was begun

    def __len__(self) -> int:
        return len(self._noted)

    def begin_placement(self, plan: Plan, number: int) -> None:
        """Record the start of placement ``number`` of ``plan``."""
        self._number += 1
        self._earlier = self._number - number
        self._plan = plan
        self._X_GB = plan.task.X_GB
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
                self._X_GB,
            )
        )

    def arrays(self) -> dict[str, Array]:
        """Arrays of all ticks so far."""
        ticks = [noted.tick for noted in self._noted]
        columns = {
            **self._plan_columns(),
            **_log_columns(ticks),
            **_arm_columns(ticks),
            **_wall_time_columns(ticks),
            **_joint_columns(ticks),
            **self._contact_columns(ticks),
            **_extra_columns(ticks),
        }
        return {name: _array(column) for name, column in columns.items()}

    def _plan_columns(self) -> dict[str, Column]:
        # about the frame B that the run began with
        frames = []
        for _, alike in groupby(self._noted, _place):
            at_one_place = list(alike)
            first = at_one_place[0]
            X_BV = self._X_BG.compose(first.X_GB).compose(first.segment.X_BV)
            frames += [(X_BV.x, X_BV.y, X_BV.yaw)] * len(at_one_place)
        return {
            "leg": [noted.segment.leg for noted in self._noted],
            "placement": [noted.placement for noted in self._noted],
            "stretch": [noted.stretch for noted in self._noted],
            "vehicle_frame": frames,
        }

    def _contact_columns(self, ticks: Sequence[Tick]) -> dict[str, Column]:
        """Columns of the contact points of the arms' tips."""
        if not ticks or not ticks[0].joints:
            return {}
        radii = [robot.tip_radius for robot in self._plan.task.robots]
        points = [
            [contact_point(*each) for each in zip(tick.truth.tips, radii, strict=True)]
            for tick in ticks
        ]
        return {"contact_point": points}

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
        """Record of the executed ``plan``, with the ``arrays`` of all ticks and those
        of the paths.
        """
        placements = self._plan.placements[self._placement :]
        paths = [segment.path for segment in self._followed]
        done = min(len(paths) - self._before, len(placements[0]))
        rest = [one_segment for group in placements for one_segment in group]
        paths += [segment.path for segment in rest[done:]]
        samples = [
            p.pose(s) for p in paths for s in np.linspace(0.0, p.length, PATH_SAMPLES)
        ]
        stretches = np.arange(len(paths), dtype=np.float64)
        planned = {
            "plan_path": np.array([(p.x, p.y, p.yaw) for p in samples]),
            "plan_stretch": np.repeat(stretches, PATH_SAMPLES),
        }
        used = (
            one_segment.mode
            for part in plan.by_placement
            for one_segment in part.segments
        )
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


def _place(noted: _Noted) -> tuple[int, Pose2]:
    """Key of a vehicle frame: the segment's identity, and X_GB."""
    return id(noted.segment), noted.X_GB


def _log_columns(ticks: Sequence[Tick]) -> dict[str, Column]:
    logs = [tick.log for tick in ticks]
    thoughts = [log.thought() for log in logs]
    return {
        "time": [tick.time for tick in ticks],
        "phase": [PHASES.index(log.phase) for log in logs],
        "object_pose": [_flat(tick.truth.X_WG) for tick in ticks],
        "object_twist": _twists(ticks),
        "reference_pose": [_flat(one.reference) for one in thoughts],
        "tracking_error": [one.tracking_error for one in thoughts],
        "progress": [log.progress for log in logs],
        "steering": [one.steering for one in thoughts],
        "wanted_wrench": [one.wanted_wrench for one in thoughts],
        "allocated_wrench": [one.allocated_wrench for one in thoughts],
    }


def _twists(ticks: Sequence[Tick]) -> Column:
    """Twists of the object. Unknown twists are difference quotients of the poses."""
    twists: list[Vector3] = []
    for before, tick in zip([*ticks[:1], *ticks[:-1]], ticks, strict=True):
        twist = tick.truth.twist
        if twist is None:
            dt = tick.time - before.time or math.inf
            old = before.truth.X_WG
            new = tick.truth.X_WG
            turned = wrap_angle(new.yaw - old.yaw)
            twist = ((new.x - old.x) / dt, (new.y - old.y) / dt, turned / dt)
        twists.append(twist)
    return twists


def _forces(truth: TrueState) -> tuple[Vector3, ...]:
    """Mean force of each tip during a tick."""
    if truth.forces is not None:
        return truth.forces
    return tuple(tip.force for tip in truth.tips)


def contact_point(tip: TipState, radius: float) -> Vector3:
    """Contact point [m] on the sphere of a ``tip``, by the direction of its force. NaN
    if the force is too small.
    """
    size = math.hypot(*tip.force)
    if size <= FELT_FORCE:
        return NO_VECTOR
    (x, y, z), (fx, fy, fz) = tip.position, tip.force
    return (x + radius * fx / size, y + radius * fy / size, z + radius * fz / size)


def _joint_columns(ticks: Sequence[Tick]) -> dict[str, Column]:
    """Joint states of the arms, and the commands applied to them."""
    columns: dict[str, Column] = {}
    for i in range(len(ticks[0].joints) if ticks else 0):
        joints = [tick.joints[i] for tick in ticks]
        applied = [one for _, one in joints]
        columns[f"joint_position_{i}"] = [reading.q for reading, _ in joints]
        columns[f"joint_velocity_{i}"] = [reading.v for reading, _ in joints]
        if applied[0].reference is not None:
            columns[f"joint_reference_{i}"] = [one.reference for one in applied]
        if applied[0].torque is not None:
            columns[f"joint_torque_{i}"] = [one.torque for one in applied]
            columns[f"torque_share_{i}"] = [one.torque_share for one in applied]
            columns[f"torque_rate_share_{i}"] = [one.rate_share for one in applied]
    return columns


def _flat(pose: Pose2) -> Vector3:
    return (pose.x, pose.y, pose.yaw)


def _arm_columns(ticks: Sequence[Tick]) -> dict[str, Column]:
    return {
        "command_force": [
            [NO_VECTOR if c is None else c.force for c in _tip_commands(tick)]
            for tick in ticks
        ],
        "demanded_force": [
            [
                NO_VECTOR if c is None else tip_force(c, tip.position, tip.velocity)
                for c, tip in zip(_tip_commands(tick), tick.truth.tips, strict=True)
            ]
            for tick in ticks
        ],
        "tip_reference": [
            [NO_VECTOR if c is None else c.position for c in _tip_commands(tick)]
            for tick in ticks
        ],
        "tip_position": [[tip.position for tip in tick.truth.tips] for tick in ticks],
        "measured_force": [_forces(tick.truth) for tick in ticks],
    }


def _tip_commands(tick: Tick) -> list[TipCommand | None]:
    return [c if isinstance(c, TipCommand) else None for c in tick.commands]


def _wall_time_columns(ticks: Sequence[Tick]) -> dict[str, Column]:
    return {
        "tick_track": [tick.wall_times[0] for tick in ticks],
        "tick_allocate": [tick.wall_times[1] for tick in ticks],
        "tick_execute": [tick.wall_times[2] for tick in ticks],
        "tick_total": [tick.wall_times[3] for tick in ticks],
    }


def _extra_columns(ticks: Sequence[Tick]) -> dict[str, Column]:
    rows = [tick.truth.extras() for tick in ticks]
    return {name: [row[name] for row in rows] for name in rows[0]} if rows else {}


def _array(column: Column) -> Array:
    """Rows of a column as one array.

    For many short rows this takes a fifth of the time of ``np.array``.
    """
    if len(column) > 0 and isinstance(column[0], np.ndarray):
        return np.concatenate(column).reshape(len(column), *column[0].shape)
    return np.asarray(column, dtype=np.float64)
