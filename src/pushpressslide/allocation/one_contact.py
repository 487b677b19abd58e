"""Allocation to one side contact: two force components for three wrench components
(docs/mechanics.md, sections 2, 3 and 8).
"""

from __future__ import annotations

from pushpressslide.allocation.allocator import Allocator, allocator_of
from pushpressslide.core.pose import Point
from pushpressslide.kernels.one_contact import one_contact, one_contact_figures
from pushpressslide.mechanics.checks import (
    check_friction,
    check_normal,
    check_point,
    check_rho,
)


def one_contact_allocator(
    point: Point, normal: Point, friction: float, rho: float
) -> Allocator:
    """``allocate(fx, fy, tau)`` for a side contact at ``point`` [m] in B.

    ``normal`` is the unit inward normal in B. The wrench is about B's origin, the CoM,
    in B. One contact gives only wrenches with tau = point x f and f in the cone of
    ``friction``. Any other is projected to the nearest in the norm diag(1, 1, 1/rho^2),
    in which the error of the object's twist is smallest for an ellipsoid of ``rho``
    [m]. Status "ok" if nothing had to be changed (to 1e-9 of the wrench), otherwise
    "projected". The status is "infeasible" if even the best force is zero, and for a
    wrench that is not finite. Raises ValueError unless ``friction`` is >= 0 and ``rho``
    > 0.
    """
    check_point(point, "point")
    check_normal(normal)
    check_friction(friction)
    check_rho(rho)
    figures = one_contact_figures(point, normal, friction, rho)
    return allocator_of(one_contact, *figures)
