"""Allocation to a press from above and a push from the side. The push turns the object
about the pressed point, and the press provides the remaining force (docs/mechanics.md,
section 7).
"""

from __future__ import annotations

from pushpressslide.allocation.allocator import Allocator, allocator_of
from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, cross
from pushpressslide.kernels.press_and_push import (
    press_and_push,
    press_and_push_figures,
)
from pushpressslide.mechanics.checks import check_normal, check_point, check_press

LEAST_LEVER = 1e-6  # [m]


def press_and_push_allocator(
    press: Point,
    load: float,
    push: Point,
    normal: Point,
    friction: float,
    cop: Point = (0.0, 0.0),
) -> Allocator:
    """``allocate(fx, fy, tau)`` for a top contact at ``press`` [m] with ``load`` [N],
    and a side contact at ``push`` [m] with the unit inward ``normal``.

    Everything is in B; the wrench is about ``cop`` [m]. Of all forces inside cone and
    disc that realise the wrench, those with the push nearest to its normal are taken. A
    wrench beyond the friction of the press is scaled down. If the push would have to
    pull, its moment is left out. The status is "projected" in both cases. It is
    "infeasible" if no force is left, or if the wrench is not finite. Raises InputError
    unless the points are finite, ``load`` is > 0, ``friction`` >= 0, and the push has a
    lever about the pressed point.
    """
    check_point(cop, "cop")
    line = ContactLine(press, push)
    lever = line.length * cross(line.e, normal)
    check_press(load, friction)
    check_normal(normal)
    if not abs(lever) > LEAST_LEVER:
        raise InputError(f"lever {lever} m of the push; must not be 0")
    figures = press_and_push_figures(press, load, push, normal, friction, cop)
    return allocator_of(press_and_push, *figures)
