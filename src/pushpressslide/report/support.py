"""The object relative to its support: tilt, gap, fall into an opening, and depth in it."""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.record import Record
from pushpressslide.core.task import Scene, Support, Task
from pushpressslide.report import series

FIELDS = (
    "max_tilt_deg",
    "support_gap_max",
    "fall_height",
    "fall_speed",
    "seated_depth",
)
# [m] depth of the object's middle below the support's face at which it counts as
# entering
ENTERED = 0.003


def support_figures(task: Task, record: Record) -> dict[str, float | None]:
    """Tilt, gap, fall and depth of the object. None for figures that do not apply.

    They are the largest tilt [deg]; the largest gap [m] before the object enters the
    opening; the distance [m] and the speed [m/s] by which the object's middle falls
    after that; and the final depth [m] in the opening.
    """
    out: dict[str, float | None] = dict.fromkeys(FIELDS)
    positions = record.arrays.get("object_pose_3d")
    if positions is None or not len(positions):
        return out
    gap = _gap(task.scene, positions)
    inside = np.flatnonzero(gap < -ENTERED)
    until = len(gap)
    if len(inside):
        until = int(inside[0])
    before = gap[:until][series.contact_phase(record)[:until]]
    out["max_tilt_deg"] = math.degrees(float(np.nanmax(_tilt(task.support, positions))))
    if before.size:
        out["support_gap_max"] = max(0.0, float(before.max()))
    if not task.scene.enters(task.goal):
        return out
    out["seated_depth"] = -float(gap[-1])
    if until + 1 < len(gap):
        height = positions[until:, 6]
        time = record.arrays["time"][until:]
        out["fall_height"] = float(height[0] - height.min())
        out["fall_speed"] = max(0.0, -float((np.diff(height) / np.diff(time)).min()))
    return out


def seat_error(task: Task, record: Record) -> float:
    """Distance [m] of the object's final position from the back of its goal's opening.

    0 without an opening, or if the engine does not record the depth.
    """
    positions = record.arrays.get("object_pose_3d")
    opening = task.support.opening
    if positions is None or opening is None or not task.scene.enters(task.goal):
        return 0.0
    return abs(opening.depth + float(_gap(task.scene, positions)[-1]))


def _gap(scene: Scene, positions: Array) -> Array:
    """Distance (N,) [m] of the object's middle from its rest position on the support.

    ``positions`` (N, 7) are quaternions and positions. Distances away from the support
    are positive.
    """
    frame = scene.support.frame
    out = np.array(frame.direction((0.0, 0.0, 1.0)))
    height = (positions[:, 4:7] - np.array(frame.origin)) @ out
    return np.asarray(height - 0.5 * scene.body.shape.height)


def _tilt(support: Support, positions: Array) -> Array:
    """Angle (N,) [rad] between the object's own z axis and its direction at rest."""
    w, x, y, z = positions[:, :4].T
    axis = np.stack(
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
        axis=1,
    )
    return np.asarray(
        np.arccos(np.clip(axis @ np.array(support.frame.spin_axis), -1.0, 1.0))
    )
