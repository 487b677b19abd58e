"""Allocation to two pushes on one face, on arrays: the results of
``allocation.parallel``.

Source: docs/mechanics.md, section 5.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.allocations import Allocations, answered, wanted
from pushpressslide.batch.checks import (
    check_all,
    check_caps,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.rows import figures, halves, prepared, spread
from pushpressslide.batch.two_contacts import both, check_pair
from pushpressslide.kernels.parallel import parallel_figures, parallel_pushes

LEVEL = 1e-9  # cosine of the angle between the line of contacts and the normal


class ParallelPushes:
    """Two side contacts on one face. Points, normal, friction, rho and caps are arrays
    of any leading shape.
    """

    def __init__(
        self,
        points: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        *,
        caps: ArrayLike = (math.inf, math.inf),
    ) -> None:
        """Prepare the contacts.

        ``points`` (..., 2, 2) [m] and ``normal`` (..., 2), the unit inward normal, are
        in B. ``friction`` (...), ``rho`` (...) [m] and ``caps`` (..., 2) [N] are as in
        ``parallel_push_allocator``, and so are the errors.
        """
        p, n, mu, length, most = figures(points, normal, friction, rho, caps)
        check_last(p, (2, 2), "points")
        check_last(n, (2,), "normal")
        check_last(most, (2,), "caps")
        check_frictions(mu)
        check_positive(length, "rho", "m")
        check_caps(most)
        check_units(n)
        check_pair(p, np.stack([n, n], axis=-2), "least_friction")
        dx, dy = halves(p[..., 1, :] - p[..., 0, :])
        cosine = (dx * n[..., 0] + dy * n[..., 1]) / np.hypot(dx, dy)
        level = np.abs(cosine) <= LEVEL
        check_all(
            level, cosine, "cosine of the angle of normal and line of contacts", "0"
        )
        self._figures = prepared(
            parallel_figures,
            *(both(p), halves(n), (mu, length), halves(most), figures(1.0, 0.0)),
        )
        self.shape = self._figures.shape
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's origin, in B.

        They are those of ``parallel_push_allocator`` with projection "nearest".
        """
        return answered(parallel_pushes, spread(wanted(wrenches)), self._figures, 2)
