"""The ellipsoid on arrays: the wrench that drives a twist, and the twist that a wrench
drives.

Source: docs/mechanics.md, sections 1 and 1.2; ``mechanics.limit_surface`` and
``mechanics.height_term`` do the same for one object. Wrenches are about B's origin, and
twists are those of B's origin, in B.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.checks import check_all, check_last, check_positive
from pushpressslide.batch.rows import answers, figures, figures_of, halves, spread
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.limit_surface import driven_twist, driving_wrench


class EllipsoidSurface:
    """An ellipsoidal limit surface with parameters of any leading shape."""

    def __init__(
        self,
        max_force: ArrayLike,
        rho: ArrayLike,
        center: ArrayLike = (0.0, 0.0),
        lift: ArrayLike = 0.0,
    ) -> None:
        """Prepare the surface.

        ``max_force`` (...) [N] and ``rho`` (...) [m] are > 0. ``center`` (..., 2) [m]
        is in B. ``lift`` (...) [m] >= 0 is h mu_s for forces at a height h. Raises
        ValueError otherwise.
        """
        force, length, point, height = figures(max_force, rho, center, lift)
        check_last(point, (2,), "center")
        check_positive(force, "max_force", "N")
        check_positive(length, "rho", "m")
        rises = np.isfinite(height) & (height >= 0.0)
        check_all(rises, height, "lift", "finite and >= 0", "m")
        self._surface = figures_of((force, length, height, *halves(point)))
        self.shape = self._surface.shape
        """The leading shape of the surface."""

    def wrenches(self, twists: ArrayLike) -> Array:
        """Wrenches (..., 3) on the surface that drive ``twists`` (..., 3)."""
        (rows,) = figures(twists)
        check_last(rows, (3,), "twists")
        return answers(driving_wrench, spread(rows), self._surface, columns=3)

    def twist_directions(self, wrenches: ArrayLike) -> Array:
        """Twists (..., 3) that ``wrenches`` (..., 3) drive, with |(v, rho w)| = 1 m/s
        at the displaced centre of pressure. A zero wrench gives zero.
        """
        return self._twists(wrenches)[..., :3]

    def levels(self, wrenches: ArrayLike) -> Array:
        """Levels H(W) (...) of wrenches W: 1 on the limit surface, below 1 for an
        object at rest.
        """
        return self._twists(wrenches)[..., 3]

    def _twists(self, wrenches: ArrayLike) -> Array:
        """Twists and levels (..., 4)."""
        (rows,) = figures(wrenches)
        check_last(rows, (3,), "wrenches")
        return answers(driven_twist, spread(rows), self._surface, columns=4)
