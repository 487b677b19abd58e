"""The figures of one run: result.json, field by field; docs/result.md says what each
means.
"""

from __future__ import annotations

import math
import platform
from collections.abc import Mapping, Sequence
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Record
from pushpressslide.core.task import Robot, Task
from pushpressslide.report import series
from pushpressslide.report.contact_metrics import contact_figures, pivots
from pushpressslide.report.support import seat_error, support_figures
from pushpressslide.robots.facts import MODELS, RobotFacts, load_facts

Array = NDArray[np.float64]

SCHEMA = 1
MOTION_FIELDS = (
    "start_pose",
    "final_pose",
    "duration",
    "motion_duration",
    "rms_position_error",
    "rms_yaw_error",
    "rms_end_effector_error",
    "max_position_error",
    "max_yaw_error",
    "path_rms_error",
    "path_max_error",
    "path_length",
    "tracking",
)
CONTACT_FIELDS = (
    "max_normal_force",
    "contact_loss_time",
    "cone_violation_fraction",
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
    """Return the contents of result.json: SI units, radians, null where a figure does
    not apply, never NaN.

    Computed from ``task``, ``plan`` and ``record`` alone; ``versions`` defaults to
    those of this process.
    """
    out: dict[str, Any] = {
        "schema": SCHEMA,
        "task": task.name,
        "engine": record.engine,
        "seed": record.seed,
        "modes": list(record.modes),
    }
    known = series.ticks(record) > 0
    final = (
        _goal_errors(task, record)
        if known
        else (math.nan, math.nan, math.nan, math.nan)
    )
    success, reason = _verdict(task, record, final[0], final[1])
    out |= {
        "success": success,
        "reason": reason,
        "final_position_error": final[0],
        "final_yaw_error": final[1],
        "final_error_xy": [final[2], final[3]],
        "tolerance": {"position": task.tolerance.position, "yaw": task.tolerance.yaw},
    }
    out |= dict.fromkeys(MOTION_FIELDS + CONTACT_FIELDS)
    if known:
        grasps = series.by_grasp(plan, record)
        out |= _motion_figures(task, grasps, record) | contact_figures(task, grasps)
        out["pivots"] = pivots(task, grasps)
    duration = (
        float(record.arrays["time"][-1] - record.arrays["time"][0]) if known else 0.0
    )
    out |= {
        **_torques(task, record),
        "joint_limit_margin": _joint_margin(task, record) if known else None,
        "realtime_factor": duration / record.wall_time
        if record.wall_time > 0.0
        else None,
        "wall_time": record.wall_time,
        "time_step": record.meta.get("time_step"),
        "tick_us": _tick_times(record) if known else None,
        "bodies": _bodies(task, record) if known else {},
        **support_figures(task, record),
        "planned": _planned(plan, record),
        "versions": dict(versions) if versions is not None else installed_versions(),
    }
    cleaned: dict[str, Any] = plain(out)
    return cleaned


def plain(value: Any) -> Any:
    """Return ``value`` made of what JSON knows: NumPy becomes plain, NaN and infinity
    become None.
    """
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def installed_versions() -> dict[str, str | None]:
    """Return the versions that bear on a result; None for what is not installed as a
    package.
    """
    out: dict[str, str | None] = {"python": platform.python_version()}
    for name in ("pushpressslide", "drake", "numpy"):
        try:
            out[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            out[name] = None
    return out


def _verdict(
    task: Task, record: Record, position: float, yaw: float
) -> tuple[bool, dict[str, str]]:
    allowed = task.tolerance
    seat = seat_error(task, record)
    # False for NaN
    within = max(position, seat) <= allowed.position and yaw <= allowed.yaw
    place = (
        f"ended {1e3 * position:.1f} mm and {math.degrees(yaw):.2f} deg from the goal, "
        "tolerance "
        f"{1e3 * allowed.position:g} mm and {math.degrees(allowed.yaw):g} deg"
    )
    if seat > allowed.position:
        place += f", {1e3 * seat:.0f} mm short of the opening's back"
    if task.tool is not None and f"body_{task.tool.body}" not in record.arrays:
        place = f"engine {record.engine} does not move {task.tool.body!r}: where it ends is not known"
    code = record.reason
    text = record.reason_text
    if code == "goal_reached":
        return within, {
            "code": "goal_reached" if within else "goal_missed",
            "text": "; ".join(filter(None, (text, place))),
        }
    return False, {"code": code, "text": text or place}


def _goal_errors(task: Task, record: Record) -> tuple[float, float, float, float]:
    """Position [m] and yaw error [rad], >= 0, of the body that the goal names; then the
    position error along the goal's axes [m], signed.
    """
    poses = record.arrays["object_pose"]
    goal = task.goal
    if task.tool is not None:
        body = record.arrays.get(f"body_{task.tool.body}")
        goal = task.tool.goal
        poses = (
            series.planar_poses(body) if body is not None else np.full((1, 3), math.nan)
        )
    x, y, yaw = (float(v) for v in poses[-1])
    if not all(math.isfinite(v) for v in (x, y, yaw)):
        return math.nan, math.nan, math.nan, math.nan
    ahead, left = goal.unapply((x, y))
    return math.hypot(ahead, left), abs(wrap_angle(yaw - goal.yaw)), ahead, left


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else math.nan


def _motion_figures(
    task: Task, grasps: Sequence[tuple[Plan, Record]], record: Record
) -> dict[str, Any]:
    arrays = record.arrays
    time = arrays["time"]
    pose = arrays["object_pose"]
    move = series.in_phase(record, "move")
    offset = pose - arrays["reference_pose"]
    position_error = np.hypot(offset[:, 0], offset[:, 1])[move]
    yaw_error = series.wrap_angles(offset[:, 2])[move]
    tips = [
        _tip_errors(task, c, part) for grasp, part in grasps for c in grasp.contacts
    ]
    cross_track = series.path_errors(task, record)[move]
    tracked = series.tracked_poses(task, record)[move, :2]
    stretch = arrays["stretch"][move]
    errors = arrays["tracking_error"][move]
    return {
        "start_pose": pose[0],
        "final_pose": [*pose[-1, :2], wrap_angle(float(pose[-1, 2]))],
        "duration": float(time[-1] - time[0]),
        "motion_duration": sum(_in_contact(part) for _, part in grasps),
        "rms_position_error": _rms(position_error),
        "rms_yaw_error": _rms(yaw_error),
        "rms_end_effector_error": _rms(np.concatenate(tips)) if tips else math.nan,
        "max_position_error": float(position_error.max())
        if position_error.size
        else None,
        "max_yaw_error": float(np.abs(yaw_error).max()) if yaw_error.size else None,
        "path_rms_error": _rms(cross_track),
        "path_max_error": float(cross_track.max()) if cross_track.size else None,
        "path_length": sum(
            float(series.travel(tracked[stretch == i])[-1]) for i in np.unique(stretch)
        ),
        "tracking": {
            name: {
                "rms": _rms(errors[:, i]),
                "max": float(np.abs(errors[:, i]).max()) if len(errors) else None,
            }
            for i, name in enumerate(("along", "left", "heading"))
        },
    }


def _in_contact(record: Record) -> float:
    """Time [s] from the first tick of the move to the last."""
    time = record.arrays["time"][series.contact_phase(record)]
    return float(np.ptp(time)) if len(time) else 0.0


def _tip_errors(task: Task, contact: Contact, record: Record) -> Array:
    """Distance [m] of a tip from its place on the object where the reference has it, at
    every tick of the move.
    """
    arrays = record.arrays
    move = series.in_phase(record, "move")
    point, _ = contact.tip_place(task.robots[contact.arm].tip_radius)
    wanted = series.compose(
        arrays["reference_pose"], task.object.X_GB.compose(Pose2(*point))
    )
    off: Array = np.linalg.norm(
        arrays["tip_position"][move, contact.arm, :2] - wanted[move, :2], axis=1
    )
    return off


def _torques(task: Task, record: Record) -> dict[str, float | None]:
    """How often a joint is asked for more than its torque limit, and the most that one
    is asked for.
    """
    names = [f"torque_share_{i}" for i in range(len(task.robots))]
    shares = np.array([record.arrays[name] for name in names if name in record.arrays])
    return {
        "torque_limit_violation_fraction": float((shares > 1.0).any(axis=0).mean())
        if shares.size
        else None,
        "max_torque_share": float(shares.max()) if shares.size else None,
    }


def robot_facts(robot: Robot) -> RobotFacts | None:
    """Return the facts of a task's robot; None where its description can no longer be
    read.
    """
    if robot.model in MODELS:
        return load_facts(robot.model)
    from pushpressslide.robots.description import read_description

    try:
        return read_description(robot.model, robot.tip_frame)
    except (PushPressSlideError, OSError):
        return None


def _joint_margin(task: Task, record: Record) -> float | None:
    margins = []
    for i, robot in enumerate(task.robots):
        q = record.arrays.get(f"joint_position_{i}")
        facts = robot_facts(robot) if q is not None else None
        if q is not None and facts is not None and q.shape[1] == facts.size and len(q):
            margins.append(float(np.minimum(q - facts.lower, facts.upper - q).min()))
    return min(margins) if margins else None


def _tick_times(record: Record) -> dict[str, dict[str, float] | None]:
    """Median and 99th percentile [us] over phase "move"; None for a part that this
    engine does not have.
    """
    move = series.in_phase(record, "move")
    out = {}
    for part in ("track", "allocate", "execute", "total"):
        values = 1e6 * record.arrays.get(f"tick_{part}", np.zeros(len(move)))[move]
        median, high = (
            (float(v) for v in np.percentile(values, (50, 99)))
            if values.size
            else (0.0, 0.0)
        )
        out[part] = {"median": median, "p99": high} if high > 0.0 else None
    return out


def _bodies(task: Task, record: Record) -> dict[str, Any]:
    poses = {"object": record.arrays["object_pose"]}
    for name, values in record.arrays.items():
        if name.startswith("body_"):
            poses[name.removeprefix("body_")] = series.planar_poses(values)
    return {
        name: {
            "final_pose": [*p[-1, :2], wrap_angle(float(p[-1, 2]))]
            if np.isfinite(p[-1, 2])
            else None,
            "displacement": float(np.hypot(*(p[-1, :2] - p[0, :2]))),
        }
        for name, p in poses.items()
    }


def _planned(plan: Plan, record: Record) -> dict[str, Any]:
    """What was foreseen, of all stretches together, to set beside what happened."""
    margins = [
        segment.cone_margin
        for segment in plan.segments
        if segment.cone_margin is not None
    ]
    return {
        "path_length": sum(
            series.path_length(stretch.path) for stretch in plan.segments
        ),
        "motion_duration": sum(stretch.profile.duration for stretch in plan.segments),
        "friction_margin": min(margins, default=None),
        "joint_limit_margin": record.meta.get("joint_margin_planned"),
        "condition": record.meta.get("condition_planned"),
        "clearance": record.meta.get("clearance_planned"),
    }
