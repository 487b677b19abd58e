"""The end of a run: success, the reason in words, and the errors at the goal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pushpressslide.control.limits import MEAN_TIME
from pushpressslide.core.arrays import Array
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.pose import Point, wrap_angle
from pushpressslide.core.record import Ending, Record
from pushpressslide.core.task import Task
from pushpressslide.report import series
from pushpressslide.report.support import seat_error

OUTCOME_FIELDS = (
    "success",
    "verified",
    "reason",
    "final_position_error",
    "final_yaw_error",
    "final_error_xy",
    "error_beside_bias",
    "tolerance",
)


@dataclass(frozen=True, slots=True)
class GoalError:
    """Final pose, relative to the goal, of the body that has the goal. NaN if unknown."""

    ahead: float = math.nan  # [m] along the goal's x axis
    left: float = math.nan  # [m] along the goal's y axis
    yaw: float = math.nan  # [rad], >= 0

    @property
    def position(self) -> float:
        """Distance [m] from the goal."""
        return math.hypot(self.ahead, self.left)

    def within(self, tolerance: Tolerance) -> bool:
        """Whether the errors are within a tolerance. False if they are unknown."""
        return self.position <= tolerance.position and self.yaw <= tolerance.yaw


def outcome_figures(
    task: Task, record: Record, figures: Mapping[str, Any]
) -> dict[str, Any]:
    """Success, whether it is verified, reason, errors at the goal and tolerance, as in
    result.json. ``figures`` are the other figures of result.json.
    """
    error = goal_error(task, record)
    beside = error_beside_bias(task, record)
    judged = None
    if beside != error:
        judged = {"position": beside.position, "yaw": beside.yaw}
    fault = _fault(task, record, figures)
    return {
        "success": None if measured_only(record) else finished(record) and not fault,
        "verified": is_verified(task, record),
        "reason": _reason(task, record, error, fault),
        "error_beside_bias": judged,
        "final_position_error": error.position,
        "final_yaw_error": error.yaw,
        "final_error_xy": [error.ahead, error.left],
        "tolerance": tolerance_figures(task.tolerance),
    }


def tolerance_figures(tolerance: Tolerance) -> dict[str, float]:
    """A tolerance, as in result.json."""
    return {
        "position": tolerance.position,
        "yaw": tolerance.yaw,
        "bodies": tolerance.bodies,
    }


def _fault(task: Task, record: Record, figures: Mapping[str, Any]) -> Ending | None:
    """First condition of success that a run violates, or None.

    The conditions are the pose at the goal, the force limit, clearances, and bodies
    that must not move.
    """
    seen = measured_only(record) and "last_look" in record.meta
    if not seen and not is_within(task, record):
        return Ending("goal_missed")
    return (
        _force_fault(task, figures)
        or _clearance_fault(figures)
        or _moved_fault(task, figures)
    )


def _force_fault(task: Task, figures: Mapping[str, Any]) -> Ending | None:
    force = figures.get("max_force_without_stop")
    limit = task.limits.normal_force
    if force is None or force <= limit:
        return None
    text = (
        f"{force:.1f} N over {MEAN_TIME * 1e3:.0f} ms without a stop, "
        f"limits.normal_force is {limit:g} N"
    )
    return Ending("force_limit", text)


def _clearance_fault(figures: Mapping[str, Any]) -> Ending | None:
    clearance = figures.get("clearance_driven")
    if clearance is None or clearance >= 0.0:
        return None
    pair = figures.get("clearance_pair")
    return Ending("collision", f"{pair} intersect by {-clearance * 1e3:.1f} mm")


def _moved_fault(task: Task, figures: Mapping[str, Any]) -> Ending | None:
    """Fault of a run that moved a body against the task, or None."""
    allowed = task.tolerance.bodies
    aimed = {"object", task.tool.body if task.tool is not None else "object"}
    aimed |= {obstacle.name for obstacle in task.obstacles if obstacle.may_move}
    for name, body in figures["bodies"].items():
        if name not in aimed and body["displacement"] > allowed:
            text = (
                f"{name!r} was moved by {body['displacement'] * 1e3:.1f} mm, "
                f"tolerance.bodies is {allowed * 1e3:g} mm"
            )
            return Ending("body_moved", text)
    return None


def goal_error(
    task: Task,
    record: Record,
    position_bias: Point = (0.0, 0.0),
    yaw_bias: float = 0.0,
) -> GoalError:
    """Final pose, relative to the goal, of the body that has the goal, as a camera with
    a bias [m], [rad] sees it.
    """
    poses: Array | None = record.arrays.get("object_pose")
    goal = task.goal
    if task.tool is not None:
        body = record.arrays.get(f"body_{task.tool.body}")
        poses = None if body is None else series.planar_poses(body)
        goal = task.tool.goal
    if poses is None or not len(poses):
        return GoalError()
    x, y, yaw = (float(v) for v in poses[-1])
    if not all(math.isfinite(v) for v in (x, y, yaw)):
        return GoalError()
    ahead, left = goal.unapply((x + position_bias[0], y + position_bias[1]))
    return GoalError(ahead, left, abs(wrap_angle(yaw + yaw_bias - goal.yaw)))


def error_beside_bias(task: Task, record: Record) -> GoalError:
    """The final errors without the constant bias of the camera, which no robot sees.

    The task states the bias. Poses that were measured already contain it.
    """
    sensing = task.sensing
    biased = any((*sensing.position_bias, sensing.yaw_bias))
    if not biased or measured_only(record):
        return goal_error(task, record)
    return goal_error(task, record, sensing.position_bias, sensing.yaw_bias)


def is_within(task: Task, record: Record) -> bool:
    """Whether the body ends within the tolerance, beside a bias of the camera. False if
    its pose is unknown.
    """
    seated = seat_error(task, record) <= task.tolerance.position
    return seated and error_beside_bias(task, record).within(task.tolerance)


def finished(record: Record) -> bool:
    """Whether the controller came to its end, wherever the object is then."""
    return record.reason == "goal_reached" or "last_look" in record.meta


def measured_only(record: Record) -> bool:
    """Whether the record has no true poses, as that of a real robot."""
    return bool(record.meta.get("measured_only"))


def is_verified(task: Task, record: Record) -> bool:
    """Whether the controller finished and knows that the object is at its goal: by the
    last look, or by poses that are exact.
    """
    if record.reason != "goal_reached":
        return False
    return "last_look" in record.meta or is_within(task, record)


def _reason(
    task: Task, record: Record, error: GoalError, fault: Ending | None
) -> dict[str, str]:
    """Code and text of the reason for the end of a run."""
    text = record.reason_text
    place = _final_place(task, record, error)
    code = record.reason
    if not finished(record):
        return {"code": code, "text": text or place}
    if code != "goal_reached" and (fault is None or fault.code == "goal_missed"):
        return {"code": code, "text": f"{text}; {place}"}
    if fault is not None:
        code = fault.code
        text = fault.text or text
    return {"code": code, "text": "; ".join(filter(None, (text, place)))}


def _final_place(task: Task, record: Record, error: GoalError) -> str:
    """Text on the final position of the body that has the goal."""
    if task.tool is not None and f"body_{task.tool.body}" not in record.arrays:
        return (
            f"engine {record.engine} does not move {task.tool.body!r}: where it ends "
            "is not known"
        )
    if math.isnan(error.position):
        return "where it ends is not known: the last pose is not a number"
    allowed = task.tolerance
    place = f"ended {_errors(error)} from the goal"
    beside = error_beside_bias(task, record)
    if beside != error:
        place += f" ({_errors(beside)} without the camera's bias)"
    place += (
        f", tolerance {1e3 * allowed.position:g} mm and "
        f"{math.degrees(allowed.yaw):g} deg"
    )
    seat = seat_error(task, record)
    if seat > allowed.position:
        place += f", {1e3 * seat:.0f} mm short of the opening's back"
    return place


def _errors(error: GoalError) -> str:
    return f"{1e3 * error.position:.1f} mm and {math.degrees(error.yaw):.2f} deg"
