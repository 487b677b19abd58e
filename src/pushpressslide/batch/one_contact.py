"""Allocation to one side contact, on arrays: the results of ``allocation.one_contact``.

Source: docs/mechanics.md, sections 2, 3 and 8.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from pushpressslide.batch.allocations import Allocations, answered, wanted
from pushpressslide.batch.checks import (
    check_finite,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.rows import figures, halves, prepared, spread
from pushpressslide.kernels.one_contact import one_contact, one_contact_figures


class OneContact:
    """One side contact. Point, normal, friction and rho are arrays of any leading
    shape.
    """

    def __init__(
        self, point: ArrayLike, normal: ArrayLike, friction: ArrayLike, rho: ArrayLike
    ) -> None:
        """Prepare the contact.

        ``point`` (..., 2) [m] and ``normal`` (..., 2), the unit inward normal, are in
        B. ``friction`` (...) and ``rho`` (...) [m] are as in ``one_contact_allocator``,
        and so are the errors.
        """
        p, n, mu, length = figures(point, normal, friction, rho)
        check_last(p, (2,), "point")
        check_last(n, (2,), "normal")
        check_finite(p, "point")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        self._figures = prepared(one_contact_figures, halves(p), halves(n), mu, length)
        self.shape = self._figures.shape
        """The leading shape of the contact."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's origin, in B.

        They are those of ``one_contact_allocator``.
        """
        return answered(one_contact, spread(wanted(wrenches)), self._figures, 1)
