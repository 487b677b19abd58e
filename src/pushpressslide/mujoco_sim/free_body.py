"""Pose and velocity of a free body of MuJoCo along its support."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.spatial_pose import planar_pose_of, x_axis_of
from pushpressslide.core.support_frame import SupportFrame


def planar_pose(q: Sequence[float], frame: SupportFrame) -> Pose2:
    """Planar pose of a free body's positions: x, y, z [m], and its quaternion."""
    px, py, pz, w, x, y, z = q
    return planar_pose_of((px, py, pz), x_axis_of((w, x, y, z)), frame)


def planar_twist(v: Sequence[float], frame: SupportFrame) -> Vector3:
    """Velocity along x and y [m/s] and yaw rate [rad/s], from a free body's six
    velocities: linear in the world, then angular in the body's axes.
    """
    x, y, z, _, _, yaw_rate = v
    vx, vy, _ = frame.components((x, y, z))
    return (vx, vy, yaw_rate)
