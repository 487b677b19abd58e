"""Accuracy of the object and the tips against the plan: errors, path, durations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.report import series

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


def motion_figures(
    placements: Sequence[tuple[Plan, Record]], record: Record
) -> dict[str, Any]:
    """Figures ``MOTION_FIELDS`` of a run with at least one tick.

    ``placements`` are the plan and the record of each started placement.
    """
    body = placements[0][0].task.scene.body
    time = record.arrays["time"]
    pose = record.arrays["object_pose"]
    tips = [
        _tip_errors(placement.task, contact, part)
        for placement, part in placements
        for contact in placement.contacts
    ]
    motion = series.motion(body, record)
    tracking = zip(("along", "left", "heading"), motion.tracking_error.T, strict=True)
    return {
        "start_pose": pose[0],
        "final_pose": [*pose[-1, :2], wrap_angle(float(pose[-1, 2]))],
        "duration": float(time[-1] - time[0]),
        "motion_duration": sum(_contact_duration(part) for _, part in placements),
        "rms_position_error": _rms(motion.position_error),
        "rms_yaw_error": _rms(motion.yaw_error),
        "rms_end_effector_error": _rms(np.concatenate(tips)) if tips else None,
        "max_position_error": _largest(motion.position_error),
        "max_yaw_error": _largest(motion.yaw_error),
        "path_rms_error": _rms(motion.path_error),
        "path_max_error": _largest(motion.path_error),
        "path_length": motion.path_length,
        "tracking": {
            name: {"rms": _rms(errors), "max": _largest(errors)}
            for name, errors in tracking
        },
    }


def _rms(values: Array) -> float | None:
    if not values.size:
        return None
    return float(np.sqrt(np.mean(values**2)))


def _largest(values: Array) -> float | None:
    if not values.size:
        return None
    return float(np.abs(values).max())


def _contact_duration(record: Record) -> float:
    """Time [s] from the first tick of the move to the last one."""
    time = record.arrays["time"][series.contact_phase(record)]
    if not len(time):
        return 0.0
    return float(np.ptp(time))


def _tip_errors(task: Task, contact: Contact, record: Record) -> Array:
    """Distance [m] of a tip from its reference position, at every tick of the move.

    The reference position is the contact on the object at its reference pose.
    """
    arrays = record.arrays
    move = series.in_phase(record, "move")
    point, _ = contact.tip_place(task.robots[contact.arm].tip_radius)
    reference = series.compose(
        arrays["reference_pose"], task.X_GB.compose(Pose2(*point))
    )
    tip = arrays["tip_position"][move, contact.arm, :2]
    distance: Array = np.linalg.norm(tip - reference[move, :2], axis=1)
    return distance
