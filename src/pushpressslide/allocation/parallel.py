"""Two parallel pushes on one face, in closed form (docs/mechanics.md, section 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.allocation.allocator import Allocator
from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.orthogonal import Feasibility
from pushpressslide.allocation.projections import Projection
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.allocation import EXACT, Allocation, new
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point


def feasibility(
    fx: float, fy: float, tau: float, d_x: float, half_width: float, friction: float
) -> Feasibility:
    """Return the condition that holds least for a wrench (fx, fy [N], tau [N m]) about
    the CoM.

    Contacts at (-d_x, +-half_width) [m] that push along +x: |tau + d_x fy| <=
    half_width fx, |fy| <= mu fx.
    """
    return min(
        Feasibility(
            fx - abs(tau + d_x * fy) / half_width, "a contact would have to pull"
        ),
        Feasibility(friction * fx - abs(fy), "the force is outside the friction cone"),
    )


def parallel_push_allocator(
    points: Sequence[Point],
    normal: Point,
    friction: float,
    rho: float,
    *,
    caps: Sequence[float] = (math.inf, math.inf),
    projection: Projection = "nearest",
) -> Allocator:
    """Return ``allocate(fx, fy, tau)`` for two side contacts on one face with unit
    inward ``normal``, in B.

    The normal forces follow from the wrench. The friction force is shared in their
    ratio, so that both contacts are equally far from slipping, where
    ``two_contact_allocator`` shares it evenly and takes the lighter contact to the edge
    of its cone first. All else is as there. Raises InputError where the line of
    contacts is not at right angles to ``normal``, to 1e-9.
    """
    line = ContactLine(*points)
    along, _ = line.in_axes(normal)
    if abs(along) > 1e-9:
        raise InputError(
            f"points {points[0]}, {points[1]} m; must lie at right angles to normal "
            f"{normal}"
        )
    general = two_contact_allocator(
        points, (normal, normal), friction, rho, caps=caps, projection=projection
    )
    return _linear(line, normal, friction, caps, general)


def _linear(
    line: ContactLine,
    normal: Point,
    friction: float,
    caps: Sequence[float],
    general: Allocator,
) -> Allocator:
    """Return the allocator; the normal force of contact 1 is linear in the wrench. What
    the contacts cannot give is left to ``general``.
    """
    sign = math.copysign(1.0, line.in_axes(normal)[1])
    x, y, t = (
        sign * line.parts(*unit)[1]
        for unit in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    nx, ny = normal
    cap1, cap2 = caps

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench [N, N m]."""
        push = nx * fx + ny * fy
        slide = nx * fy - ny * fx
        f1n = x * fx + y * fy + t * tau
        f2n = push - f1n
        margin = friction * push - (slide if slide > 0.0 else -slide)
        if push > 0.0 and margin >= 0.0 and 0.0 <= f1n <= cap1 and 0.0 <= f2n <= cap2:
            share = f1n / push
            f1x = share * fx
            f1y = share * fy
            least = share if share < 0.5 else 1.0 - share
            forces = ((f1x, f1y), (fx - f1x, fy - f1y))
            return new(Allocation, (forces, (f1n, f2n), least * margin, "ok", EXACT))
        return general(fx, fy, tau)

    return allocate
