"""Planar poses of bodies in space, and back, on any support."""

from __future__ import annotations

import math

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import Matrix3, SupportFrame

Quaternion = tuple[float, float, float, float]  # w, x, y, z


def planar_pose_of(position: Vector3, x_axis: Vector3, frame: SupportFrame) -> Pose2:
    """Planar pose of a body: x and y of its origin [m], and the yaw of its x axis.
    ``position`` [m] and ``x_axis`` are given in the world.
    """
    x, y, _ = frame.coordinates(position)
    ax, ay, _ = frame.components(x_axis)
    return Pose2(x, y, math.atan2(ay, ax))


def x_axis_of(quaternion: Quaternion) -> Vector3:
    """Direction of a body's x axis in the world."""
    w, x, y, z = quaternion
    return (1.0 - 2.0 * (y * y + z * z), 2.0 * (w * z + x * y), 2.0 * (x * z - w * y))


def tilt_of(quaternion: Quaternion, frame: SupportFrame) -> float:
    """Angle [rad] by which a body's z axis is tilted from its direction at rest on the
    support.
    """
    w, x, y, z = quaternion
    up = (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))
    share = sum(a * b for a, b in zip(up, frame.spin_axis, strict=True))
    return math.acos(min(max(share, -1.0), 1.0))


def spatial_axes(yaw: float, frame: SupportFrame) -> Matrix3:
    """Directions in the world of a body's x, y and z axis at a yaw [rad]. The z axis
    points up on a table, and into the wall on a wall.
    """
    c = math.cos(yaw)
    s = math.sin(yaw)
    x = frame.direction((c, s, 0.0))
    y = frame.direction((-s, c, 0.0))
    return x, y, frame.spin_axis
