"""Friction between bodies and their supports as a smooth function of the twist, on
arrays: the exact limit surface of a pressure, or the ellipsoid.

Source: docs/mechanics.md, section 1; ``planar.support`` for one. Twists are
(v_x, v_y, rho w) of the centre of pressure, so that all three are speeds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_positive
from pushpressslide.batch.elementwise import figures
from pushpressslide.core.arrays import Array
from pushpressslide.mechanics.balance import CREEP
from pushpressslide.mechanics.pressure import PressureSamples

BLOCK = 32_768  # speeds of samples that are worked out at a time, to stay in the cache


@dataclass(frozen=True, eq=False)
class Support:
    """Samples of the load, the same under all bodies, and each body's size and limit.

    One sample of torsional radius rho is the ellipsoid.
    """

    places: Array  # (m, 2) over rho, from the centre of pressure
    radii: Array  # (m,) over rho, of the cells
    shares: Array  # (m,) of the load
    rho: Array  # (...) [m] root mean square distance of the load
    max_force: Array  # (...) [N] mu_s N

    def sums(self, twists: Array) -> Array:
        """Return 14 sums (n, 14) over the samples, of which friction and its slope are
        made, for ``twists`` (n, 3) [m/s].

        With b = (1, x, y, r^2) and the speed |v|: of b_i / |v|, and of b_i b_j / |v|^3
        for i <= j.
        """
        soft = CREEP * CREEP
        basis, pairs = self._basis
        out = np.empty((len(twists), 14))
        rows = max(1, BLOCK // len(basis))
        for start in range(0, len(twists), rows):
            block = slice(start, start + rows)
            vx, vy, w = twists[block].T
            still = vx * vx + vy * vy + soft
            terms = np.stack([still, 2.0 * w * vy, -2.0 * w * vx, w * w])
            squared = np.maximum(basis @ terms, soft)
            per_speed = self.shares[:, None] / np.sqrt(squared)
            out[block, :4] = (basis.T @ per_speed).T
            out[block, 4:] = (pairs @ (per_speed / squared)).T
        return out

    @cached_property
    def _basis(self) -> tuple[Array, Array]:
        """Return b_i (m, 4), and b_i b_j (10, m) for i <= j."""
        x, y = self.places.T
        square = x * x + y * y + self.radii**2
        basis = np.stack([np.ones_like(x), x, y, square], axis=1)
        i, j = np.triu_indices(4)
        return basis, np.ascontiguousarray((basis[:, i] * basis[:, j]).T)


def ellipsoid_support(max_force: ArrayLike, rho: ArrayLike) -> Support:
    """Return bodies on the ellipsoid: ``max_force`` (...) [N] mu_s N, ``rho`` (...) [m].

    Raises ValueError unless both are finite and > 0.
    """
    force, length = figures(max_force, rho)
    check_positive(force, "max_force", "N")
    check_positive(length, "rho", "m")
    one = np.ones(1)
    return Support(np.zeros((1, 2)), one, one, length, force)


def exact_support(samples: PressureSamples, friction: ArrayLike) -> Support:
    """Return bodies on the exact surface of one pressure, for ``friction`` (...) of the
    pair object/support.

    Raises ValueError for friction <= 0, and for a pressure with pins: about one of
    them a body turns with no drag that could be found.
    """
    (mu,) = figures(friction)
    check_positive(mu, "friction", "")
    check_positive(samples.radii[samples.loads > 0.0], "radius of a sample", "m")
    arms = samples.points - np.array(samples.cop)
    shares = samples.loads / samples.total_load
    square = (arms**2).sum(axis=1) + samples.radii**2
    rho = np.sqrt(shares @ square)
    return Support(
        arms / rho, samples.radii / rho, shares, rho, mu * samples.total_load
    )
