"""Figures of one run: the fields of result.json.

docs/results.md explains each field.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import replace
from importlib import metadata
from typing import Any

import numpy as np

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import wrap_angle
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.report import series
from pushpressslide.report.arm_metrics import joint_margin, speed_share, torque_figures
from pushpressslide.report.contact_metrics import contact_figures, pivots
from pushpressslide.report.json_text import plain
from pushpressslide.report.motion_metrics import MOTION_FIELDS, motion_figures
from pushpressslide.report.outcome import OUTCOME_FIELDS, outcome_figures
from pushpressslide.report.stage_figures import stage_figures
from pushpressslide.report.stages import StageRun
from pushpressslide.report.support import support_figures

SCHEMA = 5
CONTACT_FIELDS = (
    "max_normal_force",
    "max_mean_normal_force",
    "max_force_without_stop",
    "contact_loss_time",
    "cone_violation_fraction",
    "cone_use_commanded",
    "slip_distance",
    "contacts",
    "pivots",
)


def result(
    task: Task,
    plan: Plan,
    record: Record,
    versions: Mapping[str, str | None] | None = None,
) -> dict[str, Any]:
    """Contents of result.json.

    Figures are in SI units and radians, and null if they do not apply, never NaN. They
    are computed only from ``task``, ``plan`` and ``record``. ``versions`` defaults to
    those of this process.
    """
    out: dict[str, Any] = {
        "schema": SCHEMA,
        "task": task.name,
        "engine": record.engine,
        "seed": record.seed,
        "modes": list(record.modes),
        **dict.fromkeys(OUTCOME_FIELDS + MOTION_FIELDS + CONTACT_FIELDS),
    }
    if series.ticks(record) > 0 and plan.segments:
        placements = series.by_placement(plan, record)
        out |= motion_figures(placements, record)
        out |= contact_figures(placements)
        out["pivots"] = pivots(placements)
    out |= {
        **torque_figures(task.robots, record),
        "max_joint_speed_share": speed_share(task.robots, record),
        "joint_limit_margin": joint_margin(task.robots, record),
        "clearance_driven": record.meta.get("clearance_driven"),
        "clearance_pair": record.meta.get("clearance_pair"),
        **_time_figures(record),
        "planning_time": record.meta.get("planning_time"),
        "search": record.meta.get("search"),
        "events": record.meta.get("events", []),
        "parameters": record.meta.get("parameters"),
        "bodies": _bodies(record),
        **support_figures(task, record),
        "planned": _planned(plan, record),
        "versions": installed_versions() if versions is None else versions,
    }
    out |= outcome_figures(task, record, out)
    out["stages"] = [stage_figures(StageRun.alone(replace(record, plan=plan)))]
    cleaned: dict[str, Any] = plain(out)
    return cleaned


def installed_versions() -> dict[str, str | None]:
    """Versions of the packages that affect a result. None for a package that is not
    installed.
    """
    out: dict[str, str | None] = {"python": platform.python_version()}
    for name in ("pushpressslide", "drake", "mujoco", "numpy"):
        try:
            out[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            out[name] = None
    return out


def _time_figures(record: Record) -> dict[str, Any]:
    """Execution speed of the run, and its number of ticks."""
    return {
        "realtime_factor": _realtime_factor(record),
        "wall_time": record.wall_time,
        "time_step": record.meta.get("time_step"),
        "control_period": record.plan.task.motion.control_period,
        "tick_us": _tick_times(record),
        "late_ticks": _late_ticks(record),
    }


def _realtime_factor(record: Record) -> float | None:
    if record.wall_time <= 0.0:
        return None
    time = record.arrays.get("time", np.empty(0))
    duration = float(time[-1] - time[0]) if len(time) else 0.0
    return duration / record.wall_time


def _tick_times(record: Record) -> dict[str, dict[str, float] | None] | None:
    """Median, 99th and 99.9th percentile [us] of the time of each part of a tick, over
    the phase "move".

    None for a part that the engine lacks, or that never ran.
    """
    if series.ticks(record) == 0:
        return None
    move = series.in_phase(record, "move")
    out: dict[str, dict[str, float] | None] = {}
    for part in ("track", "allocate", "execute", "total"):
        out[part] = None
        values = 1e6 * record.arrays.get(f"tick_{part}", np.zeros(len(move)))[move]
        if not values.size:
            continue
        median, high, highest = map(float, np.percentile(values, (50, 99, 99.9)))
        if high > 0.0:
            out[part] = {"median": median, "p99": high, "p999": highest}
    return out


def _late_ticks(record: Record) -> int | None:
    """Number of ticks whose decision took longer than the control period, including
    replans. None if it was not recorded.
    """
    times = record.arrays.get("tick_total")
    if times is None:
        return None
    return int((times > record.plan.task.motion.control_period).sum())


def _bodies(record: Record) -> dict[str, Any]:
    """Final pose and displacement [m] of every movable body.

    ``final_pose`` is None if the yaw was not recorded.
    """
    if series.ticks(record) == 0:
        return {}
    poses = {"object": record.arrays["object_pose"]}
    for name, values in record.arrays.items():
        if name.startswith("body_"):
            poses[name.removeprefix("body_")] = series.planar_poses(values)
    out = {}
    for name, pose in poses.items():
        first = pose[0]
        last = pose[-1]
        final = None
        if np.isfinite(last[2]):
            final = [*last[:2], wrap_angle(float(last[2]))]
        displacement = float(np.hypot(*(last[:2] - first[:2])))
        out[name] = {"final_pose": final, "displacement": displacement}
    return out


def _planned(plan: Plan, record: Record) -> dict[str, Any]:
    """Predictions of the plan over all its segments."""
    margins = [
        segment.cone_margin
        for segment in plan.segments
        if segment.cone_margin is not None
    ]
    return {
        "path_length": sum(segment.path.distance for segment in plan.segments),
        "motion_duration": sum(segment.profile.duration for segment in plan.segments),
        "friction_margin": min(margins, default=None),
        "joint_limit_margin": record.meta.get("joint_margin_planned"),
        "condition": record.meta.get("condition_planned"),
        "clearance": record.meta.get("clearance_planned"),
    }
