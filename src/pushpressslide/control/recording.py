"""Collects what happens, tick by tick, into a Record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.control import PHASES, ControlLog, TipCommand, Vector3
from pushpressslide.core.plan import Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import ReasonCode, Record

PATH_SAMPLES = 200


class Recorder:
    """Appends rows; ``record`` makes arrays of them. The names and shapes are those of
    core.record.Record.
    """

    def __init__(self, plan: Plan) -> None:
        """Start empty, with the plan's own arrays."""
        self._rows: dict[str, list[Any]] = {}
        self._plan = plan
        self._number = 0  # of the placement that is done now
        self._before = 0  # segments that were begun before it
        self._followed: list[Segment] = []  # each segment that was begun

    def __len__(self) -> int:
        return len(self._rows.get("time", ()))

    def begin(self, number: int) -> None:
        """Note that the placement of that ``number`` begins."""
        self._number = number
        self._before = len(self._followed)

    def add(
        self,
        *,
        time: float,
        log: ControlLog,
        true_pose: Pose2,
        twist: Sequence[float],
        commands: Sequence[TipCommand | None],
        tips: Sequence[Vector3],
        forces: Sequence[Vector3],
        ticks: Sequence[float],
        more: Mapping[str, Any] | None = None,
        followed: Segment | None = None,
    ) -> None:
        """Append one tick; ``ticks`` are track, allocate, execute and total [s];
        ``more`` holds engine-specific rows; ``followed`` is the stretch, as planned
        when it began, None before the first.
        """
        nothing = (np.nan, np.nan, np.nan)
        if followed is not None and (
            not self._followed or followed is not self._followed[-1]
        ):
            self._followed.append(followed)
        planned = self._plan.placements[self._number][0]
        X_BV = (followed or planned).X_BV
        row: dict[str, Any] = {
            "time": time,
            "phase": PHASES.index(log.phase),
            "leg": (followed or planned).leg,
            "stretch": max(self._before, len(self._followed) - 1),
            "vehicle_frame": (X_BV.x, X_BV.y, X_BV.yaw),
            "object_pose": (true_pose.x, true_pose.y, true_pose.yaw),
            "object_twist": tuple(twist),
            "reference_pose": (log.reference.x, log.reference.y, log.reference.yaw),
            "tracking_error": log.tracking_error,
            "progress": log.progress,
            "steering": log.steering,
            "wanted_wrench": log.wanted_wrench,
            "allocated_wrench": log.allocated_wrench,
            "command_force": [c.force if c is not None else nothing for c in commands],
            "tip_reference": [
                c.position if c is not None else nothing for c in commands
            ],
            "tip_position": list(tips),
            "measured_force": list(forces),
            "tick_track": ticks[0],
            "tick_allocate": ticks[1],
            "tick_execute": ticks[2],
            "tick_total": ticks[3],
            **(more or {}),
        }
        for name, value in row.items():
            self._rows.setdefault(name, []).append(value)

    def record(
        self,
        reason: tuple[ReasonCode, str],
        engine: Literal["drake", "planar"],
        seed: int,
        wall_time: float,
        meta: Mapping[str, Any],
    ) -> Record:
        """Return everything so far."""
        arrays: dict[str, NDArray[np.float64]] = {
            name: np.asarray(rows, dtype=np.float64)
            for name, rows in self._rows.items()
        }
        placements = self._plan.placements
        paths = [segment.path for segment in self._followed]
        done = min(len(paths) - self._before, len(placements[self._number]))
        rest = [piece for group in placements[self._number :] for piece in group]
        paths += [segment.path for segment in rest[done:]]
        samples = [
            p.pose(s) for p in paths for s in np.linspace(0.0, p.length, PATH_SAMPLES)
        ]
        arrays["plan_path"] = np.array([(p.x, p.y, p.yaw) for p in samples])
        arrays["plan_stretch"] = np.repeat(
            np.arange(len(paths), dtype=np.float64), PATH_SAMPLES
        )
        modes = tuple(
            mode for mode, _ in groupby(piece.mode for piece in self._plan.segments)
        )
        return Record(
            arrays, reason[0], reason[1], engine, seed, wall_time, modes, meta
        )
