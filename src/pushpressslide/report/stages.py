"""A run in stages: what each stage left, one record joined in time, one result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.bodies import OBJECT, Stage, obstacle_name
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.state import State
from pushpressslide.report import series
from pushpressslide.report.outcome import goal_error
from pushpressslide.view.course import GOAL_ERROR, goal_errors


@dataclass(frozen=True)
class StageRun:
    """One stage that was begun, and what came of it."""

    stage: Stage
    plan: Plan
    record: Record
    choices: tuple[Choice, ...]
    began: float  # [s] since the first stage began
    state: State  # in which it began, with the bodies where they were
    anew: bool = False  # whether it was planned again for where the bodies were seen

    @property
    def reached(self) -> bool:
        """Whether the body ended where the stage was to bring it; one that is put aside
        need only have been let go.
        """
        if self.record.reason != "goal_reached":
            return False
        error = goal_error(self.plan.task, self.record)
        tolerance = self.plan.task.tolerance
        near = error.position <= tolerance.position and error.yaw <= tolerance.yaw
        return near or self.stage.aside

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        time = self.record.arrays["time"]
        return float(time[-1] - time[0])


def body_positions(run: StageRun) -> dict[str, Array]:
    """Return quaternion and position (N, 7) in Drake's world of every body, by its name
    in the task; empty for a plant that does not have them.
    """
    arrays = run.record.arrays
    if "object_pose_3d" not in arrays:
        return {}
    out = {}
    for body in run.state.poses:
        name = obstacle_name(body, run.stage.body)
        key = "object_pose_3d" if name == OBJECT else f"body_{name}"
        out[body] = arrays[key]
    return out


def body_poses(run: StageRun) -> dict[str, Array]:
    """Return X_WG (N, 3) of every body, by its name in the task."""
    positions = body_positions(run)
    moved = run.record.arrays["object_pose"]
    out = {}
    for body, X in run.state.poses.items():
        if body == run.stage.body:
            out[body] = moved
        elif body in positions:
            out[body] = series.planar_poses(positions[body])
        else:
            out[body] = np.tile((X.x, X.y, X.yaw), (len(moved), 1))
    return out


def final_poses(run: StageRun) -> dict[str, Pose2]:
    """Return where every body is at the last sample, X_WG; whole turns are left out."""
    return {
        body: Pose2(*map(float, poses[-1])).wrapped
        for body, poses in body_poses(run).items()
    }


def joined_record(runs: Sequence[StageRun], ending: Ending, seed: int) -> Record:
    """Return the records of the stages as one, time running on.

    What refers to the object refers to the body of the stage. ``pose_<body>`` (N, 3)
    and, with Drake, ``body_<body>`` (N, 7) are those of each body by its name in the
    task. ``ending`` is why the whole run ended.
    """
    parts = [_renumbered(runs, i) for i in range(len(runs))]
    common = [name for name in parts[0] if all(name in part for part in parts)]
    arrays = {name: np.concatenate([part[name] for part in parts]) for name in common}
    records = [run.record for run in runs]
    used = (mode for record in records for mode in record.modes)
    return Record(
        arrays,
        ending.code,
        ending.text,
        records[0].engine,
        seed,
        sum(record.wall_time for record in records),
        tuple(mode for mode, _ in groupby(used)),
        joined_plan(runs),
        {"time_step": records[0].meta.get("time_step"), "events": _events(runs)},
    )


def _renumbered(runs: Sequence[StageRun], index: int) -> dict[str, Array]:
    """Return the arrays of a stage as part of the whole run's."""
    run = runs[index]
    before = runs[:index]
    arrays = {
        name: values
        for name, values in run.record.arrays.items()
        if not name.startswith("body_") and name != "object_pose_3d"
    }
    arrays["time"] = run.began + arrays["time"] - arrays["time"][0]
    arrays["stage"] = np.full(len(arrays["time"]), float(index))
    placements = sum(len(other.plan.by_placement) for other in before)
    stretches = sum(1.0 + other.record.arrays["plan_stretch"][-1] for other in before)
    arrays["placement"] = arrays["placement"] + placements
    arrays["stretch"] = arrays["stretch"] + stretches
    arrays["plan_stretch"] = arrays["plan_stretch"] + stretches
    for body, poses in body_poses(run).items():
        arrays[f"pose_{body}"] = poses
    for body, positions in body_positions(run).items():
        arrays[f"body_{body}"] = positions
    return arrays


def joined_plan(runs: Sequence[StageRun]) -> Plan:
    """Return the plan of the first stage, gone on with those of the others."""
    plan = runs[-1].plan
    for run in reversed(runs[:-1]):
        plan = _followed(run.plan, plan)
    return plan


def _followed(plan: Plan, by: Plan) -> Plan:
    again = by if plan.again is None else _followed(plan.again, by)
    return replace(plan, again=again)


def _events(runs: Sequence[StageRun]) -> list[dict[str, Any]]:
    return [
        {**event, "time": run.began + event["time"], "stage": number}
        for number, run in enumerate(runs)
        for event in run.record.meta.get("events", [])
    ]


def replayed_record(runs: Sequence[StageRun], record: Record) -> Record:
    """Return a joined record as a replay of the first stage's scene takes it: the object
    is the first stage's body throughout, whatever is tracked.
    """
    first = runs[0].stage.body
    arrays = dict(record.arrays)
    moved = arrays["object_pose"]
    arrays[GOAL_ERROR] = np.concatenate(
        [
            goal_errors(poses, (goal.x, goal.y, goal.yaw))
            for poses, goal in zip(
                _by_stage(moved, arrays), (run.stage.goal for run in runs), strict=True
            )
        ]
    )
    shown = arrays[f"pose_{first}"]
    arrays["object_pose"] = shown
    offsets = [run.plan.task.X_GB for run in runs]
    tracked = np.concatenate(
        [
            series.compose(poses, offset)
            for poses, offset in zip(_by_stage(moved, arrays), offsets, strict=True)
        ]
    )
    tracked = series.compose(tracked, arrays["vehicle_frame"])
    arrays["vehicle_frame"] = _relative(series.compose(shown, offsets[0]), tracked)
    for body in runs[0].state.poses:
        positions = arrays.pop(f"body_{body}", None)
        if positions is None:
            continue
        name = obstacle_name(body, first)
        key = "object_pose_3d" if name == OBJECT else f"body_{name}"
        arrays[key] = positions
    return replace(record, arrays=arrays)


def _by_stage(values: Array, arrays: Mapping[str, Array]) -> list[Array]:
    stage = arrays["stage"]
    return [values[stage == number] for number in np.unique(stage)]


def _relative(X_WA: Array, X_WC: Array) -> Array:
    """Return X_AC (N, 3) of poses X_WA and X_WC (N, 3)."""
    dx = X_WC[:, 0] - X_WA[:, 0]
    dy = X_WC[:, 1] - X_WA[:, 1]
    c = np.cos(X_WA[:, 2])
    s = np.sin(X_WA[:, 2])
    return np.stack([c * dx + s * dy, c * dy - s * dx, X_WC[:, 2] - X_WA[:, 2]], axis=1)
