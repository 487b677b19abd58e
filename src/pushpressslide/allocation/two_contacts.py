"""Allocation to two side contacts anywhere on the object: four force components for the
three components of a wrench (docs/mechanics.md, sections 5 and 6).

The split "least_friction" has the smallest sum of squared friction forces: section 6's
u = -T/2, changed as little as needed. "least_force" has the smallest sum of squared
forces: an even share along the line of contacts, changed as little as needed. It
squeezes less and is nearer to slipping.

The projection "nearest" replaces a wrench by the nearest feasible one in the norm
diag(1, 1, 1/rho^2). "force_priority" changes only the moment; "torque_priority" adds a
force along the sum of the normals. If neither gives a feasible wrench, the nearest one
is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from pushpressslide.allocation.allocator import Allocator, allocator_of
from pushpressslide.allocation.contact_line import Split, check_pair
from pushpressslide.allocation.projections import Projection, WrenchCone
from pushpressslide.core.allocation import STATUSES, Allocation, new
from pushpressslide.core.pose import Point
from pushpressslide.kernels.allocation import Two, Wrench
from pushpressslide.kernels.two_contacts import (
    ELSEWHERE,
    Linear,
    Rest,
    nearest_forces,
    two_contact_figures,
    two_contacts,
)
from pushpressslide.mechanics.checks import check_caps, check_point, check_rho


def two_contact_allocator(
    points: Sequence[Point],
    normals: Sequence[Point],
    friction: float,
    rho: float,
    *,
    caps: Sequence[float] = (inf, inf),
    projection: Projection = "nearest",
    split: Split = "least_friction",
) -> Allocator:
    """``allocate(fx, fy, tau)`` for side contacts at two ``points`` [m] in B.

    ``normals`` are unit vectors into the object, in B; the wrench is about B's origin,
    in B. ``split`` chooses among the forces inside the cones of ``friction`` that
    realise the wrench. A wrench outside the cone is projected by ``projection``, in the
    norm of an ellipsoid of ``rho`` [m]. A wrench that needs more normal force than
    ``caps`` [N] is scaled. The status is "ok" if the wrench is realised unchanged (to
    1e-9 of the wrench), otherwise "projected". It is "infeasible" if the best force is
    zero, or if the wrench is not finite. Raises ValueError for contacts that coincide,
    friction < 0, rho or caps <= 0, and for "least_friction" if both normals lie along
    the line of contacts.
    """
    check_rho(rho)
    check_caps(caps)
    check_pair(points, normals, friction, split)
    for point in points:
        check_point(point, "point")
    least_friction = float(split == "least_friction")
    own = float(projection != "nearest")
    figures = two_contact_figures(
        (points[0], points[1]),
        (normals[0], normals[1]),
        (friction, rho),
        (caps[0], caps[1]),
        (least_friction, own),
    )
    if projection == "nearest":
        return allocator_of(two_contacts, *figures)
    cone = WrenchCone(points, normals, friction, rho)
    moved = cone.moved_by(projection)
    return moving_allocator(two_contacts, figures, figures, moved)


def moving_allocator(
    kernel: Callable[..., Two],
    figures: tuple[Any, Any],
    general: tuple[Linear, Rest],
    projected: Callable[[float, float, float], Wrench],
) -> Allocator:
    """Allocator for a kernel that does not handle wrenches outside the cone.

    Such a wrench is first mapped by the function ``projected``. It is then allocated as
    the nearest wrench that the contacts described by ``general`` can provide.
    """
    first, second = figures

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Allocation of a wrench [N, N m]."""
        answer = kernel(fx, fy, tau, first, second)
        if answer[3] == ELSEWHERE:
            aim = projected(fx, fy, tau)
            answer = nearest_forces((fx, fy, tau), aim, *general)
        forces, normals, margin, status, residual = answer
        words = (forces, normals, margin, STATUSES[status], residual)
        return new(Allocation, words)

    return allocate
