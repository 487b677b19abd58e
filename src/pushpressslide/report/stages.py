"""A run as a list of stages, by default a single one: their plans, their results, and
their records joined into one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import groupby
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.bodies import OBJECT, Stage, obstacle_name, start_state
from pushpressslide.core.plan import Choice, Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.state import WorldState
from pushpressslide.report import series
from pushpressslide.report.outcome import finished, is_within
from pushpressslide.view.timeline import GOAL_ERROR, goal_errors


@dataclass(frozen=True)
class StagePlan:
    """Purpose of a stage, its plan, and all choices considered."""

    stage: Stage
    plan: Plan
    choices: tuple[Choice, ...]  # refused ones too; empty if not kept


@dataclass(frozen=True)
class StageRun(StagePlan):
    """A started stage, with its record."""

    record: Record
    began: float  # [s] since the first stage began
    state: WorldState  # initial state, with the poses of the bodies
    anew: bool = False  # whether it was planned again for where the bodies were seen

    @classmethod
    def alone(cls, record: Record, choices: Sequence[Choice] = ()) -> StageRun:
        """The only stage of a run with a single goal."""
        task = record.plan.task
        stage = Stage(OBJECT, task.goal)
        state = start_state(task).with_body_at(OBJECT, task.true_start)
        return cls(stage, record.plan, tuple(choices), record, 0.0, state)

    @property
    def reached(self) -> bool:
        """Whether the body ended at the stage's goal. A body that is put aside only has
        to be released.
        """
        if self.stage.aside:
            return finished(self.record)
        at_goal = is_within(self.plan.task, self.record)
        return self.record.reason == "goal_reached" and at_goal

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        if not series.ticks(self.record):
            return 0.0
        time = self.record.arrays["time"]
        return float(time[-1] - time[0])


def body_positions(run: StageRun) -> dict[str, Array]:
    """Quaternion and position (N, 7) of every body in Drake's world, by its name in the
    task. Empty for a plant without such data.
    """
    arrays = run.record.arrays
    if "object_pose_3d" not in arrays:
        return {}
    out = {}
    for body in run.state.poses:
        out[body] = arrays[_own_name(body, run.stage.body)]
    return out


def body_poses(run: StageRun) -> dict[str, Array]:
    """Poses X_WG (N, 3) of every body, by its name in the task."""
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
    """Pose X_WG of every body at the last sample, without full turns."""
    return {
        body: Pose2(*map(float, poses[-1])).wrapped
        for body, poses in body_poses(run).items()
    }


def joined_record(runs: Sequence[StageRun], ending: Ending, seed: int) -> Record:
    """Records of the stages joined into one, with continuous time.

    In each stage, data of the object are those of the body that it moves.
    ``pose_<body>`` (N, 3) and, with Drake, ``body_<body>`` (N, 7) are those of each
    body by its name in the task. ``ending`` is the reason for the end of the whole run.
    ``cut_record`` extracts a stage.
    """
    first = _Counts()
    parts = []
    stages = []
    for number, run in enumerate(runs):
        parts.append(_renumbered(run, number, first))
        stages.append(_rest(run.record, first))
        first = first.after(run)
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
        {
            "time_step": records[0].meta.get("time_step"),
            "events": _timed(runs, "events"),
            "breaches": _timed(runs, "breaches"),
            "stages": stages,
        },
    )


def cut_record(
    joined: Record, number: int, began: float, stage_plan: StagePlan
) -> Record:
    """Record of one stage, extracted from that of the whole run.

    The stage ``began`` [s] after the first one.
    """
    stages = joined.meta["stages"]
    rest = stages[number]
    next_stretch = math.inf
    if number + 1 < len(stages):
        next_stretch = stages[number + 1]["first_stretch"]
    numbers = joined.arrays["plan_stretch"]
    planned = (numbers >= rest["first_stretch"]) & (numbers < next_stretch)
    own = joined.arrays["stage"] == number
    arrays = {}
    for name, values in joined.arrays.items():
        if name.startswith("body_"):
            name = _own_name(name.removeprefix("body_"), stage_plan.stage.body)
        if not name.startswith("pose_") and name not in ("stage", GOAL_ERROR):
            arrays[name] = values[planned if name.startswith("plan_") else own]
    arrays["time"] = arrays["time"] - began
    arrays["placement"] = arrays["placement"] - rest["first_placement"]
    for name in ("stretch", "plan_stretch"):
        arrays[name] = arrays[name] - rest["first_stretch"]
    return Record(
        arrays,
        rest["reason"],
        rest["reason_text"],
        joined.engine,
        joined.seed + number,
        rest["wall_time"],
        tuple(rest["modes"]),
        stage_plan.plan,
        rest["meta"],
    )


@dataclass(frozen=True)
class _Counts:
    """Number of placements and segments before a stage."""

    placements: int = 0
    stretches: float = 0.0

    def after(self, run: StageRun) -> _Counts:
        """Counts before the next stage."""
        return _Counts(
            self.placements + len(run.plan.by_placement),
            self.stretches + 1.0 + float(run.record.arrays["plan_stretch"][-1]),
        )


def _rest(record: Record, first: _Counts) -> dict[str, Any]:
    """Data of a stage, other than arrays, that a joined record keeps."""
    return {
        "reason": record.reason,
        "reason_text": record.reason_text,
        "wall_time": record.wall_time,
        "modes": list(record.modes),
        "first_placement": first.placements,
        "first_stretch": first.stretches,
        "meta": dict(record.meta),
    }


def _renumbered(run: StageRun, number: int, first: _Counts) -> dict[str, Array]:
    """Arrays of a stage, renumbered as part of the whole run."""
    arrays = {
        name: values
        for name, values in run.record.arrays.items()
        if not name.startswith("body_") and name != "object_pose_3d"
    }
    arrays["time"] = run.began + arrays["time"] - arrays["time"][0]
    arrays["stage"] = np.full(len(arrays["time"]), float(number))
    arrays["placement"] = arrays["placement"] + first.placements
    arrays["stretch"] = arrays["stretch"] + first.stretches
    arrays["plan_stretch"] = arrays["plan_stretch"] + first.stretches
    goal = run.stage.goal
    arrays[GOAL_ERROR] = goal_errors(arrays["object_pose"], (goal.x, goal.y, goal.yaw))
    for body, poses in body_poses(run).items():
        arrays[f"pose_{body}"] = poses
    for body, positions in body_positions(run).items():
        arrays[f"body_{body}"] = positions
    return arrays


def _own_name(body: str, driven_body: str) -> str:
    """Array of a body's positions in the stage in which ``driven_body`` is the object."""
    name = obstacle_name(body, driven_body)
    return "object_pose_3d" if name == OBJECT else f"body_{name}"


def joined_plan(stages: Sequence[StagePlan]) -> Plan:
    """Plan of the first stage, continued by the plans of the others."""
    plans = [stage.plan for stage in stages]
    return reduce(Plan.followed, plans)


def _timed(runs: Sequence[StageRun], name: str) -> list[dict[str, Any]]:
    """Entries of all stages under ``name``, with their time in the run and their stage."""
    return [
        {**noted, "time": run.began + noted["time"], "stage": number}
        for number, run in enumerate(runs)
        for noted in run.record.meta.get(name, [])
    ]


def replayed_record(runs: Sequence[StageRun], record: Record) -> Record:
    """Record of a run for a replay in the scene of the first stage.

    The object is the first stage's body throughout, whichever body is tracked.
    """
    if "stage" not in record.arrays:
        return record
    first = runs[0]
    arrays = dict(record.arrays)
    own = [arrays["stage"] == number for number in range(len(runs))]
    moved = [
        series.compose(arrays["object_pose"][rows], run.plan.task.X_GB)
        for rows, run in zip(own, runs, strict=True)
    ]
    tracked = series.compose(np.concatenate(moved), arrays["vehicle_frame"])
    shown = arrays[f"pose_{first.stage.body}"]
    arrays["object_pose"] = shown
    body = series.compose(shown, first.plan.task.X_GB)
    arrays["vehicle_frame"] = _relative(body, tracked)
    found = {b: arrays.pop(f"body_{b}", None) for b in first.state.poses}
    for name, positions in found.items():
        if positions is not None:
            arrays[_own_name(name, first.stage.body)] = positions
    return replace(record, arrays=arrays)


def _relative(X_WA: Array, X_WC: Array) -> Array:
    """X_AC (N, 3) from poses X_WA and X_WC (N, 3)."""
    dx = X_WC[:, 0] - X_WA[:, 0]
    dy = X_WC[:, 1] - X_WA[:, 1]
    c = np.cos(X_WA[:, 2])
    s = np.sin(X_WA[:, 2])
    return np.stack([c * dx + s * dy, c * dy - s * dx, X_WC[:, 2] - X_WA[:, 2]], axis=1)
