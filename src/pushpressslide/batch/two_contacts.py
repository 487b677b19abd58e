"""Allocation to two side contacts, on arrays: the results of
``allocation.two_contacts``.

Source: docs/mechanics.md, sections 5 and 6.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.allocation.contact_line import FACING, Split
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
from pushpressslide.core.arrays import Array
from pushpressslide.kernels.two_contacts import two_contact_figures, two_contacts


class TwoContacts:
    """Two side contacts. Points, normals, friction, rho and caps are arrays of any
    leading shape.
    """

    def __init__(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        *,
        caps: ArrayLike = (math.inf, math.inf),
        split: Split = "least_friction",
    ) -> None:
        """Prepare the contacts.

        ``points`` (..., 2, 2) [m] and ``normals`` (..., 2, 2), the unit inward normals,
        are in B. ``friction`` (...), ``rho`` (...) [m] and ``caps`` (..., 2) [N] are as
        in ``two_contact_allocator``, and so are the errors.
        """
        p, n, mu, length, most = figures(points, normals, friction, rho, caps)
        check_last(p, (2, 2), "points")
        check_last(n, (2, 2), "normals")
        check_last(most, (2,), "caps")
        check_frictions(mu)
        check_positive(length, "rho", "m")
        check_caps(most)
        check_units(n)
        check_pair(p, n, split)
        choices = figures(float(split == "least_friction"), 0.0)
        self._figures = prepared(
            two_contact_figures,
            *(both(p), both(n), (mu, length), halves(most), choices),
        )
        self.shape = self._figures.shape
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's origin, in B.

        They are those of ``two_contact_allocator`` with projection "nearest".
        """
        return answered(two_contacts, spread(wanted(wrenches)), self._figures, 2)


def both(vectors: Array) -> tuple[Any, Any]:
    """Components of two vectors (..., 2, 2)."""
    return halves(vectors[..., 0, :]), halves(vectors[..., 1, :])


def check_pair(points: Array, normals: Array, split: Split) -> None:
    """Raise InputError unless forces can be split over two side contacts.

    They cannot if the contacts coincide. The split "least_friction" also excludes two
    normals that are both parallel to the line of contacts.
    """
    dx, dy = halves(points[..., 1, :] - points[..., 0, :])
    length = np.hypot(dx, dy)
    distinct = (length > 0.0) & np.isfinite(length)
    check_all(distinct, length, "distance of the contacts", "finite and > 0", "m")
    across = [(dx * n[1] - dy * n[0]) / length for n in both(normals)]
    sine = np.hypot(*across)
    if split == "least_friction":
        check_all(
            sine >= FACING,
            sine,
            "sine of the normals to the line of contacts",
            f">= {FACING}, or split 'least_force'",
        )
