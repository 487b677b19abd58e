"""Friction between object and support as a smooth function of the twist: the exact
limit surface, summed over samples of the load.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.kernels.support_friction import CREEP
from pushpressslide.mechanics.pressure import PressureSamples

Vector = tuple[float, float, float]
Matrix = list[list[float]]


class SupportFriction:
    """Wrench that slides the object, about the centre of pressure: mu N sum of s_k
    (v_k, r_k x v_k) / |v_k|.

    ``samples`` gives the shares s_k of the load and their positions r_k from the CoP;
    |v_k| is softened by ``CREEP`` (docs/mechanics.md, section 1). A single sample with
    a torsional radius rho gives the ellipsoid.
    """

    def __init__(self, samples: PressureSamples) -> None:
        """Prepare the samples. The limiting friction mu_s N [N] is an argument of each
        call.
        """
        x, y = (samples.points - np.array(samples.cop)).T
        # |v_k|^2 is linear in these four: v^2 + 2 w (v_y x - v_x y) + w^2 (x^2 + y^2 +
        # radius^2)
        self._basis = np.column_stack(
            [np.ones_like(x), x, y, x * x + y * y + samples.radii**2]
        )
        self._columns = np.ascontiguousarray(self._basis.T)
        self._shares = samples.loads / samples.total_load
        # [m] root mean square distance
        self.rho = math.sqrt(float(self._shares @ self._basis[:, 3]))

    def wrench(self, twist: Vector, limit: float) -> Vector:
        """Wrench (fx, fy [N], tau [N m]) that slides the object with ``twist`` [m/s,
        rad/s], both at the CoP.

        ``limit`` [N] is mu_s N.
        """
        return self._wrench(twist, limit)[0]

    def wrench_and_slope(self, twist: Vector, limit: float) -> tuple[Vector, Matrix]:
        """Wrench, and its derivative with respect to the twist, which is symmetric and
        positive definite.
        """
        wrench, (k0, kx, ky, ks), per_speed, squared_speed = self._wrench(twist, limit)
        vx, vy, w = twist
        # the samples' friction, (v_x - w y, v_y + w x, r x v_k), in terms of the basis
        motion = np.array(((vx, 0.0, -w, 0.0), (vy, w, 0.0, 0.0), (0.0, vy, -vx, w)))
        spread = (self._columns * (per_speed / squared_speed)) @ self._basis
        (a, b, c), (_, d, e), (_, _, f) = (motion @ spread @ motion.T).tolist()
        return wrench, [
            [k0 - a, -b, -ky - c],
            [-b, k0 - d, kx - e],
            [-ky - c, kx - e, ks - f],
        ]

    def _wrench(
        self, twist: Vector, limit: float
    ) -> tuple[Vector, list[float], Array, Array]:
        vx, vy, w = twist
        soft = CREEP * CREEP
        squared_speed = self._basis @ np.array(
            (vx * vx + vy * vy + soft, 2 * w * vy, -2 * w * vx, w * w)
        )
        np.maximum(squared_speed, soft, out=squared_speed)
        per_speed = limit * self._shares / np.sqrt(squared_speed)
        k = (self._columns @ per_speed).tolist()
        k0, kx, ky, ks = k
        return (
            (k0 * vx - ky * w, k0 * vy + kx * w, kx * vy - ky * vx + ks * w),
            k,
            per_speed,
            squared_speed,
        )
