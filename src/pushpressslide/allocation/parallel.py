"""Two parallel pushes on one face, in closed form (docs/mechanics.md, section 5)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.allocation.allocator import Allocator, allocator_of
from pushpressslide.allocation.contact_line import ContactLine, check_pair
from pushpressslide.allocation.orthogonal import Feasibility
from pushpressslide.allocation.projections import Projection, WrenchCone
from pushpressslide.allocation.two_contacts import moving_allocator
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point
from pushpressslide.kernels.parallel import parallel_figures, parallel_pushes
from pushpressslide.mechanics.checks import check_caps, check_rho


def feasibility(
    fx: float, fy: float, tau: float, d_x: float, half_width: float, friction: float
) -> Feasibility:
    """Tightest condition for a wrench (fx, fy [N], tau [N m]) about the CoM.

    The contacts at (-d_x, +-half_width) [m] push along +x. The conditions are |tau +
    d_x fy| <= half_width fx, |fy| <= mu fx.
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
    """``allocate(fx, fy, tau)`` for two side contacts on one face with unit inward
    ``normal``, in B.

    The normal forces follow from the wrench. The friction force is shared in their
    ratio, so that both contacts are equally far from slipping.
    ``two_contact_allocator`` shares it evenly instead and takes the lighter contact to
    the edge of its cone first. In all other respects they agree. Raises InputError if
    the line of contacts is not at right angles to ``normal``, to 1e-9.
    """
    line = ContactLine(*points)
    along, _ = line.in_axes(normal)
    if abs(along) > 1e-9:
        raise InputError(
            f"points {points[0]}, {points[1]} m; must lie at right angles to normal "
            f"{normal}"
        )
    check_rho(rho)
    check_caps(caps)
    normals = (normal, normal)
    check_pair(points, normals, friction, "least_friction")
    figures = parallel_figures(
        (points[0], points[1]),
        normal,
        (friction, rho),
        (caps[0], caps[1]),
        (1.0, float(projection != "nearest")),
    )
    if projection == "nearest":
        return allocator_of(parallel_pushes, *figures)
    cone = WrenchCone(points, normals, friction, rho)
    moved = cone.moved_by(projection)
    return moving_allocator(parallel_pushes, figures, figures[1], moved)
