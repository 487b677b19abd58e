"""All conversions between planar data and Drake's spatial data.

Drake's world frame is the world frame of this package. Planar data refer to the
support's frame (core/support_frame.py), which on a table is the world frame.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RotationMatrix

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Pose2
from pushpressslide.core.slabs import Slab
from pushpressslide.core.spatial_pose import planar_pose_of, spatial_axes, x_axis_of
from pushpressslide.core.support_frame import TABLE, SupportFrame


def rigid_transform(
    pose: Pose2, z: float, frame: SupportFrame = TABLE
) -> RigidTransform:
    """Spatial pose, in the world, of a planar pose at height ``z`` [m].

    The x and y axes are those of the planar pose. The z axis points up on a table, and
    into the wall on a wall.
    """
    R = RotationMatrix(np.column_stack(spatial_axes(pose.yaw, frame)))
    return RigidTransform(R, frame.point((pose.x, pose.y, z)))


def planar_pose(X: RigidTransform, frame: SupportFrame = TABLE) -> Pose2:
    """Planar pose of a spatial pose: x and y of the origin, and yaw of the x axis."""
    px, py, pz = X.translation().tolist()
    ax, ay, az = X.rotation().col(0).tolist()
    return planar_pose_of((px, py, pz), (ax, ay, az), frame)


def planar_pose_from_positions(
    q: Sequence[float], frame: SupportFrame = TABLE
) -> Pose2:
    """Planar pose from a floating body's seven positions: quaternion (w, x, y, z), then
    x, y, z [m].
    """
    w, x, y, z, px, py, pz = q
    return planar_pose_of((px, py, pz), x_axis_of((w, x, y, z)), frame)


def planar_twist(V: Sequence[float], frame: SupportFrame = TABLE) -> Vector3:
    """Velocity along x and y [m/s] and yaw rate [rad/s], from a body's spatial velocity
    (angular, then linear).
    """
    wx, wy, wz, x, y, z = V
    vx, vy, _ = frame.components((x, y, z))
    ax, ay, az = frame.spin_axis
    return (vx, vy, ax * wx + ay * wy + az * wz)


def transform_from_positions(q: NDArray[np.float64]) -> RigidTransform:
    """Spatial pose from a floating body's seven positions: quaternion (w, x, y, z),
    then x, y, z [m].
    """
    return RigidTransform(
        RotationMatrix(Quaternion(q[:4] / np.linalg.norm(q[:4]))), q[4:7]
    )


def slab_pose(slab: Slab, frame: SupportFrame) -> RigidTransform:
    """Pose of a slab's centre in the world."""
    x, y, z = slab.center
    return rigid_transform(Pose2(x, y), z, frame)
