"""Two side contacts that keep a reserve of friction if they can."""

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
    """Allocator that uses ``two_contact_allocator`` with the preferred friction
    utilisation if this gives the wrench, and with full friction otherwise.
    """
    preferred = two_contact_allocator(
        points, normals, margins.PREFERRED_USE * friction, rho
    )
    exact = two_contact_allocator(points, normals, friction, rho, projection=projection)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Forces of a wrench in B."""
        allocation = preferred(fx, fy, tau)
        return allocation if allocation.status == "ok" else exact(fx, fy, tau)

    return allocate
