"""Allocation to one top contact: a tangential force within the friction disc of its
press (docs/mechanics.md, sections 4 and 8).
"""

from __future__ import annotations

from pushpressslide.allocation.allocator import Allocator, allocator_of
from pushpressslide.core.pose import Point
from pushpressslide.kernels.one_press import one_press, one_press_figures
from pushpressslide.mechanics.checks import check_point, check_press, check_rho


def one_press_allocator(
    point: Point, load: float, friction: float, rho: float, cop: Point = (0.0, 0.0)
) -> Allocator:
    """``allocate(fx, fy, tau)`` for a top contact at ``point`` [m] in B, pressed with
    ``load`` [N].

    The wrench is about ``cop`` [m] in B. One contact gives only wrenches with tau =
    (point - cop) x f and |f| <= friction load. Any other wrench is projected: first to
    the nearest direction in the norm diag(1, 1, 1/rho^2), which makes the error of the
    object's twist smallest, then onto the disc. A wrench that is not finite is
    "infeasible". Raises InputError unless ``point`` and ``cop`` are finite, ``rho`` [m]
    and ``load`` are > 0 and ``friction`` >= 0.
    """
    check_point(point, "point")
    check_point(cop, "cop")
    check_press(load, friction)
    check_rho(rho)
    return allocator_of(one_press, *one_press_figures(point, load, friction, rho, cop))
