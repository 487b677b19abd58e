"""Allocation to two side contacts that keeps a reserve of friction if possible."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.allocation.allocator import Allocator
from pushpressslide.allocation.projections import Projection
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.pose import Point


def reserving_allocator(
    points: Sequence[Point],
    normals: Sequence[Point],
    friction: float,
    rho: float,
    projection: Projection = "nearest",
) -> Allocator:
    """Allocator that realises a wrench with the preferred friction utilisation if
    possible, and with full friction otherwise.

    Both use ``two_contact_allocator``.
    """
    preferred = two_contact_allocator(
        points, normals, margins.PREFERRED_USE * friction, rho
    )
    exact = two_contact_allocator(points, normals, friction, rho, projection=projection)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Contact forces [N] for a wrench [N, N m], in B."""
        allocation = preferred(fx, fy, tau)
        return allocation if allocation.status == "ok" else exact(fx, fy, tau)

    return allocate
