"""Collects what happens, tick by tick, into a Record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.control.plant import PlantRow
from pushpressslide.core.control import (
    PHASES,
    Commands,
    ControlLog,
    Measurement,
    TipCommand,
)
from pushpressslide.core.plan import Plan, Segment
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


class Recorder:
    """Collects the rows of a run and makes the arrays of its record."""

    def __init__(self, plan: Plan) -> None:
        """Start empty, with the first placement of ``plan``."""
        self._rows: dict[str, list[Any]] = {}
        self._X_BG = plan.task.X_GB.inverse()
        self._plan = plan
        self._number = 0  # of the placement that is done now, over the whole run
        self._earlier = 0  # placements that were done by other plans than this one
        self._before = 0  # segments that were begun before it
        self._followed: list[Segment] = []  # each segment that was begun

    def __len__(self) -> int:
        return len(self._rows.get("time", ()))

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
        segment = followed or self._plan.placements[self._placement][0]
        self._append(self._plan_rows(segment))
        self._append(_log_rows(tick))
        self._append(_arm_rows(tick))
        self._append(_wall_time_rows(tick))
        self._append(tick.row.extras)

    def _append(self, rows: Mapping[str, Any]) -> None:
        for name, value in rows.items():
            if name not in self._rows:
                self._rows[name] = []
            self._rows[name].append(value)

    def _plan_rows(self, followed: Segment) -> dict[str, Any]:
        # about the frame B that the run began with
        X_BV = self._X_BG.compose(self._plan.task.X_GB).compose(followed.X_BV)
        return {
            "leg": followed.leg,
            "placement": self._number,
            "stretch": max(self._before, len(self._followed) - 1),
            "vehicle_frame": (X_BV.x, X_BV.y, X_BV.yaw),
        }

    def record(
        self,
        ending: Ending,
        engine: str,
        seed: int,
        wall_time: float,
        plan: Plan,
        meta: Mapping[str, Any],
    ) -> Record:
        """Return everything so far, of ``plan`` as it was run."""
        arrays: dict[str, NDArray[np.float64]] = {
            name: np.asarray(rows, dtype=np.float64)
            for name, rows in self._rows.items()
        }
        placements = self._plan.placements[self._placement :]
        paths = [segment.path for segment in self._followed]
        done = min(len(paths) - self._before, len(placements[0]))
        rest = [piece for group in placements for piece in group]
        paths += [segment.path for segment in rest[done:]]
        samples = [
            p.pose(s) for p in paths for s in np.linspace(0.0, p.length, PATH_SAMPLES)
        ]
        arrays["plan_path"] = np.array([(p.x, p.y, p.yaw) for p in samples])
        arrays["plan_stretch"] = np.repeat(
            np.arange(len(paths), dtype=np.float64), PATH_SAMPLES
        )
        used = (piece.mode for part in plan.by_placement for piece in part.segments)
        modes = tuple(mode for mode, _ in groupby(used))
        return Record(
            arrays, ending.code, ending.text, engine, seed, wall_time, modes, plan, meta
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
