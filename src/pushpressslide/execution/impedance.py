"""Cartesian impedance of the tip and joint impedance of the posture."""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand, Vector3


def tip_force(command: TipCommand, position: Vector3, velocity: Vector3) -> Vector3:
    """Return the force [N] that the tip is to exert on what it touches, in the
    command's axes as all else.

    Feed-forward plus stiffness and damping about the moving reference along n, t, z of
    the contact frame. The feed-forward is inside the friction cone already; the
    impedance part may leave it, since it also accelerates the arm's own inertia, but is
    held below ``command.servo_cap``: along the support, and along the height.
    """
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    dx = command.position[0] - position[0]
    dy = command.position[1] - position[1]
    ux = command.velocity[0] - velocity[0]
    uy = command.velocity[1] - velocity[1]
    kn, kt, kz = command.stiffness
    bn, bt, bz = command.damping
    fn = kn * (c * dx + s * dy) + bn * (c * ux + s * uy)
    ft = kt * (-s * dx + c * dy) + bt * (-s * ux + c * uy)
    size = math.hypot(fn, ft)
    if size > command.servo_cap:
        fn = fn * command.servo_cap / size
        ft = ft * command.servo_cap / size
    fz = kz * (command.position[2] - position[2]) + bz * (
        command.velocity[2] - velocity[2]
    )
    fz = min(max(fz, -command.servo_cap), command.servo_cap)
    return (
        command.force[0] + c * fn - s * ft,
        command.force[1] + s * fn + c * ft,
        command.force[2] + fz,
    )


def rotation_error(R_wanted: Array, R: Array) -> Array:
    """Return the rotation vector (3,) [rad], world axes, from ``R`` to ``R_wanted`` (3,
    3).

    It is exact up to 90 degrees.
    """
    E = R_wanted @ R.T
    return np.array(
        [
            0.5 * (E[2, 1] - E[1, 2]),
            0.5 * (E[0, 2] - E[2, 0]),
            0.5 * (E[1, 0] - E[0, 1]),
        ]
    )


def tip_moment(
    R_wanted: Array,
    R: Array,
    w_wanted: Array,
    w: Array,
    stiffness: float,
    damping: float,
) -> Array:
    """Return the moment (3,) [N m], world axes, of a rotational spring [N m/rad] and
    damper [N m s/rad].

    The spring is stretched by ``margins.ARM.attitude`` at most: a tool that a joint's
    limit holds back is far off, and turns back slowly.
    """
    error = rotation_error(R_wanted, R)
    size = float(np.linalg.norm(error))
    most = margins.ARM.attitude
    if size > most:
        error = error * (most / size)
    return stiffness * error + damping * (w_wanted - w)
