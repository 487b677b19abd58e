"""Cartesian impedance of the tip and joint impedance of the posture."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand, Vector3


class Servo(NamedTuple):
    """Springs and dampers of a tip along n, t and height of its contact frame."""

    force: Vector3  # [N] on what the tip touches, in the command's axes
    added: Vector3  # [kg] as of ``execution.torque.Impedance``, along n, t and height

    @property
    def isotropic(self) -> bool:
        """Whether all directions along the support have the same gains."""
        return self.added[0] == self.added[1]


def servo(
    command: TipCommand, position: Vector3, velocity: Vector3, period: float = 0.0
) -> Servo:
    """Springs and dampers about the command's moving reference, over a tick of
    ``period`` [s].

    Their force may leave the friction cone, since it also accelerates the arm's own
    inertia. Along the support and along the height, it is kept below
    ``command.servo_cap``. ``position`` [m] and ``velocity`` [m/s] are those of the tip,
    in the support's frame.
    """
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    dx = command.position[0] - position[0]
    dy = command.position[1] - position[1]
    ux = command.velocity[0] - velocity[0]
    uy = command.velocity[1] - velocity[1]
    uz = command.velocity[2] - velocity[2]
    kn, kt, kz = command.stiffness
    bn, bt, bz = command.damping
    fn = kn * (c * dx + s * dy) + bn * (c * ux + s * uy)
    ft = kt * (-s * dx + c * dy) + bt * (-s * ux + c * uy)
    fz = kz * (command.position[2] - position[2]) + bz * uz
    along = _share_within(math.hypot(fn, ft), command.servo_cap)
    up = _share_within(abs(fz), command.servo_cap)
    return Servo(
        (along * (c * fn - s * ft), along * (s * fn + c * ft), up * fz),
        (
            period * along * (bn + period * kn),
            period * along * (bt + period * kt),
            period * up * (bz + period * kz),
        ),
    )


def tip_force(command: TipCommand, position: Vector3, velocity: Vector3) -> Vector3:
    """Commanded force [N] of the tip on the object, in the support's frame: the
    feed-forward, which is inside the friction cone, plus the force of the servo.
    """
    x, y, z = command.force
    fx, fy, fz = servo(command, position, velocity).force
    return (x + fx, y + fy, z + fz)


def _share_within(size: float, limit: float) -> float:
    """Largest factor, at most 1, that keeps ``size`` within ``limit``."""
    return limit / size if size > limit else 1.0


def rotation_error(R_wanted: Array, R: Array) -> Vector3:
    """Rotation vector [rad], world axes, from ``R`` to ``R_wanted`` (3, 3).

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
    """Moment [N m], world axes, of a rotational spring [N m/rad] and damper [N m
    s/rad].

    The spring's deflection is limited to ``margins.ARM.attitude``. A tool that a joint
    limit has turned far from its wanted attitude therefore returns slowly.
    """
    ex, ey, ez = rotation_error(R_wanted, R)
    size = math.sqrt(ex * ex + ey * ey + ez * ez)
    upper = margins.ARM.attitude
    spring = stiffness * (upper / size if size > upper else 1.0)
    return (
        spring * ex + damping * (w_wanted[0] - w[0]),
        spring * ey + damping * (w_wanted[1] - w[1]),
        spring * ez + damping * (w_wanted[2] - w[2]),
    )
