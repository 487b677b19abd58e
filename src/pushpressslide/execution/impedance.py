"""Cartesian impedance of the tip and joint impedance of the posture."""

from __future__ import annotations

import math

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


def rotation_error(R_wanted: Array, R: Array) -> Vector3:
    """Return the rotation vector [rad], world axes, from ``R`` to ``R_wanted`` (3, 3).

    It is exact up to 90 degrees.
    """
    (_, b, c), (d, _, f), (g, h, _) = (R_wanted @ R.T).tolist()
    return (0.5 * (h - f), 0.5 * (c - g), 0.5 * (d - b))


def tip_moment(
    R_wanted: Array,
    R: Array,
    w_wanted: Vector3,
    w: Vector3,
    stiffness: float,
    damping: float,
) -> Vector3:
    """Return the moment [N m], world axes, of a rotational spring [N m/rad] and damper
    [N m s/rad].

    The spring is stretched by ``margins.ARM.attitude`` at most: a tool that a joint's
    limit holds back is far off, and turns back slowly.
    """
    ex, ey, ez = rotation_error(R_wanted, R)
    size = math.sqrt(ex * ex + ey * ey + ez * ez)
    most = margins.ARM.attitude
    spring = stiffness * (most / size if size > most else 1.0)
    return (
        spring * ex + damping * (w_wanted[0] - w[0]),
        spring * ey + damping * (w_wanted[1] - w[1]),
        spring * ez + damping * (w_wanted[2] - w[2]),
    )
