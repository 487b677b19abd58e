"""Between this package's planar data and Drake's spatial data; the only place where the two meet."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.math import SpatialForce

from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Wrench


def rigid_transform(pose: Pose2, z: float) -> RigidTransform:
    """Return the spatial pose with origin height ``z`` [m] of a planar pose on the table."""
    return RigidTransform(RollPitchYaw(0.0, 0.0, pose.yaw), [pose.x, pose.y, z])


def planar_pose(X: RigidTransform) -> Pose2:
    """Return the planar pose of a spatial one: its origin's x, y and the yaw of its x axis."""
    R = X.rotation().matrix()
    p = X.translation()
    return Pose2(float(p[0]), float(p[1]), math.atan2(R[1, 0], R[0, 0]))


def planar_pose_from_positions(q: NDArray[np.float64]) -> Pose2:
    """Return the planar pose of a floating body's seven positions: quaternion (w, x, y, z), then x, y, z
    [m].
    """
    w, x, y, z = q[0], q[1], q[2], q[3]
    return Pose2(float(q[4]), float(q[5]), math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))


def transform_from_positions(q: NDArray[np.float64]) -> RigidTransform:
    """Return the spatial pose of a floating body's seven positions: quaternion (w, x, y, z), then x, y, z
    [m].
    """
    return RigidTransform(RotationMatrix(Quaternion(q[:4] / np.linalg.norm(q[:4]))), q[4:7])


def spatial_force(wrench: Wrench) -> SpatialForce:
    """Return a planar wrench, in world axes, as Drake's [moment; force]."""
    return SpatialForce([0.0, 0.0, wrench.tau], [wrench.fx, wrench.fy, 0.0])
