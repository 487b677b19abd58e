"""Allocation to one top contact: a tangential force within the friction disc of its
press (docs/mechanics.md, sections 4 and 8).
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, sqrt

from pushpressslide.core.allocation import Allocation, nothing
from pushpressslide.core.pose import Point
from pushpressslide.mechanics.checks import check_point, check_press, check_rho


def one_press_allocator(
    point: Point, load: float, friction: float, rho: float, cop: Point = (0.0, 0.0)
) -> Callable[[float, float, float], Allocation]:
    """Return ``allocate(fx, fy, tau)`` for a top contact at ``point`` [m] in B, pressed
    with ``load`` [N].

    The wrench is about ``cop`` [m] in B. One contact gives only wrenches with
    tau = (point - cop) x f and |f| <= friction load. Any other is projected: to the
    nearest direction in the norm diag(1, 1, 1/rho^2), in which the error of the object's
    twist is least, then onto the disc. A wrench that is not finite is "infeasible".
    Raises InputError unless ``point`` and ``cop`` are finite, ``rho`` [m] and ``load``
    are > 0 and ``friction`` >= 0.
    """
    check_point(point, "point")
    check_point(cop, "cop")
    check_press(load, friction)
    check_rho(rho)
    rx = point[0] - cop[0]
    ry = point[1] - cop[1]
    most = friction * load
    inv = 1.0 / (rho * rho)
    shrink = 1.0 / (1.0 + (rx * rx + ry * ry) * inv)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench [N, N m]."""
        off = tau - rx * fy + ry * fx
        size = sqrt(fx * fx + fy * fy)
        if size <= most and abs(off) <= 1e-12 * most:
            return Allocation(((fx, fy),), (load,), most - size, "ok", (0.0, 0.0, off))
        if not size + abs(tau) < inf:
            return nothing((load,), (fx, fy, tau))
        # least squares of (f - F, (r x f - tau) / rho) over f
        k = off * inv * shrink
        gx = fx - k * ry
        gy = fy + k * rx
        size = sqrt(gx * gx + gy * gy)
        if size > most:
            gx = gx * most / size
            gy = gy * most / size
            size = most
        residual = (fx - gx, fy - gy, tau - rx * gy + ry * gx)
        return Allocation(((gx, gy),), (load,), most - size, "projected", residual)

    return allocate
