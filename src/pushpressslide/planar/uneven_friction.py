"""Friction between object and a support whose friction differs with place, direction,
speed and time: a limit surface summed over samples of the load.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.truth import Truth
from pushpressslide.core.wrench import Twist
from pushpressslide.kernels.support_friction import CREEP
from pushpressslide.mechanics.ground import Ground, is_uneven
from pushpressslide.planar.support import Support
from pushpressslide.planar.support_friction import Matrix, Vector


class UnevenFriction:
    """Wrench that slides the object, about the centre of pressure: mu N times the
    gradient of the sum of s_k |D v_k|, the power of samples with shares s_k.

    The symmetric D scales velocities by the friction along and across a grain.
    """

    def __init__(
        self, points: Array, radii: Array, shares: Array, squared: tuple[float, ...]
    ) -> None:
        """Prepare samples at ``points`` (n, 2) [m] from the CoP, with torsional
        ``radii`` (n,) [m]. The entries xx, xy, yy of D D are ``squared``.
        """
        a, b, c = squared
        x, y = points.T
        turn_x = b * x - a * y
        turn_y = c * x - b * y
        turn = x * turn_y - y * turn_x + radii**2
        rows = np.empty((len(x), 3, 3))
        rows[:, 0, 0] = a
        rows[:, 1, 1] = c
        rows[:, 0, 1] = rows[:, 1, 0] = b
        rows[:, 0, 2] = rows[:, 2, 0] = turn_x
        rows[:, 1, 2] = rows[:, 2, 1] = turn_y
        rows[:, 2, 2] = turn
        # |D v_k|^2 is the quadratic form of these in the twist
        self._forms = rows
        self._shares = shares
        # [m] root mean square distance
        self.rho = math.sqrt(float(shares @ turn / (shares.sum() * 0.5 * (a + c))))

    def wrench(self, twist: Vector, limit: float) -> Vector:
        """Wrench (fx, fy [N], tau [N m]) that slides the object with ``twist`` [m/s,
        rad/s], both at the CoP.

        ``limit`` [N] is mu_s N.
        """
        motions, loads, _ = self._motions(twist, limit)
        fx, fy, tau = (loads @ motions).tolist()
        return (fx, fy, tau)

    def wrench_and_slope(self, twist: Vector, limit: float) -> tuple[Vector, Matrix]:
        """Wrench, and its derivative with respect to the twist, which is symmetric and
        positive definite.
        """
        motions, loads, squared_speed = self._motions(twist, limit)
        fx, fy, tau = (loads @ motions).tolist()
        turned = (motions.T * (loads / squared_speed)) @ motions
        slope = np.tensordot(loads, self._forms, 1) - turned
        return (fx, fy, tau), slope.tolist()

    def _motions(self, twist: Vector, limit: float) -> tuple[Array, Array, Array]:
        """Half the gradients (n, 3) of |D v_k|^2, loads over speeds (n,), and
        |D v_k|^2 (n,), softened by ``CREEP``.
        """
        motions = self._forms @ np.array(twist)
        soft = CREEP * CREEP
        squared_speed = np.maximum(motions @ np.array(twist) + soft, soft)
        return motions, limit * self._shares / np.sqrt(squared_speed), squared_speed


class UnevenGround:
    """Friction of a support by ``truth``, under the object as it lies and moves."""

    def __init__(self, truth: Truth, seed: int) -> None:
        """Draw the patches of the support."""
        self._ground = Ground.of_truth(truth, seed)
        self._truth = truth

    @classmethod
    def if_uneven(cls, truth: Truth, seed: int) -> UnevenGround | None:
        """The ground, or None for Coulomb's friction with one coefficient."""
        if is_uneven(truth) or truth.friction_direction != 0.0:
            return cls(truth, seed)
        return None

    def under(
        self, support: Support, cop: Point, X_WB: Pose2, twist: Twist, time: float
    ) -> UnevenFriction:
        """Friction about ``cop`` [m] in B. Its dependence on the speed is that of the
        last ``twist`` in B.
        """
        samples = support.samples(cop)
        points = samples.points - samples.cop
        own = twist.moved_to((0.0, 0.0))
        moving = (*X_WB.rotate((own.vx, own.vy)), own.w)
        factors = self._ground.under(points + cop, X_WB, moving, time)
        shares = factors * samples.loads / samples.total_load
        squared = self._squared_scale(X_WB.yaw)
        return UnevenFriction(points, samples.radii, shares, squared)

    def _squared_scale(self, yaw: float) -> tuple[float, float, float]:
        """Entries xx, xy, yy of D D in the axes of B, at a ``yaw`` [rad] of B."""
        half = 0.5 * self._truth.friction_direction
        along = (1.0 - half) ** 2
        across = (1.0 + half) ** 2
        c = math.cos(self._truth.grain_yaw - yaw)
        s = math.sin(self._truth.grain_yaw - yaw)
        return (
            along * c * c + across * s * s,
            (along - across) * c * s,
            along * s * s + across * c * c,
        )
