"""Allocation to one or two presses, on arrays: the results of ``allocation.one_press``
and ``allocation.presses``.

Source: docs/mechanics.md, sections 4, 7 and 8.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.batch.allocations import Allocations, answered, wanted
from pushpressslide.batch.checks import (
    check_all,
    check_finite,
    check_frictions,
    check_last,
    check_positive,
)
from pushpressslide.batch.rows import figures, grouped, halves, prepared, spread
from pushpressslide.kernels.one_press import one_press, one_press_figures
from pushpressslide.kernels.presses import press_pair, two_presses


class OnePress:
    """One press. Point, load, friction, rho and centre of pressure are arrays of any
    leading shape.
    """

    def __init__(
        self,
        point: ArrayLike,
        load: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        cop: ArrayLike = (0.0, 0.0),
    ) -> None:
        """Prepare the press.

        ``point`` and ``cop`` (..., 2) [m] are in B. ``load`` (...) [N], ``friction``
        (...) and ``rho`` (...) [m] are as in ``one_press_allocator``, and so are the
        errors.
        """
        p, n, mu, length, center = figures(point, load, friction, rho, cop)
        check_last(p, (2,), "point")
        check_last(center, (2,), "cop")
        check_finite(p, "point")
        check_finite(center, "cop")
        check_positive(n, "load", "N")
        check_frictions(mu)
        check_positive(length, "rho", "m")
        self._figures = prepared(
            one_press_figures, halves(p), n, mu, length, halves(center)
        )
        self.shape = self._figures.shape
        """The leading shape of the press."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about the centre of
        pressure, in B.

        They are those of ``one_press_allocator``.
        """
        row = spread(wanted(wrenches))
        return answered(one_press, row, self._figures, 1)


class TwoPresses:
    """Two presses. Points and friction are arrays of any leading shape."""

    def __init__(self, points: ArrayLike, friction: ArrayLike) -> None:
        """Prepare the presses.

        ``points`` (..., 2, 2) [m] are in B. ``friction`` (...) is as in
        ``two_press_allocator``, and so are the errors.
        """
        p, mu = figures(points, friction)
        check_last(p, (2, 2), "points")
        check_frictions(mu)
        dx, dy = (p[..., 1, k] - p[..., 0, k] for k in range(2))
        length = np.hypot(dx, dy)
        distinct = (length > 0.0) & np.isfinite(length)
        check_all(distinct, length, "distance of the contacts", "finite and > 0", "m")
        first, second = (halves(p[..., i, :]) for i in range(2))
        self._figures = prepared(press_pair, first, second, mu)
        self.shape = self._figures.shape
        """The leading shape of the presses."""

    def allocate(
        self, wrenches: ArrayLike, normals: ArrayLike, cops: ArrayLike = (0.0, 0.0)
    ) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about ``cops`` (..., 2)
        [m], in B.

        The contacts press with ``normals`` (..., 2) [N]. The allocations are those of
        ``two_press_allocator``.
        """
        rows = wanted(wrenches)
        loads, places = figures(normals, cops)
        check_last(loads, (2,), "normals")
        check_last(places, (2,), "cops")
        row = (spread(rows), grouped(loads), grouped(places))
        return answered(two_presses, row, self._figures, 2)
