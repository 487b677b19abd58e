"""Allocation to one side contact: two force components for three wrench components
(docs/mechanics.md, sections 2, 3 and 8).
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from pushpressslide.core.allocation import (
    EXACT,
    Allocation,
    AllocationStatus,
    new,
    nothing,
)
from pushpressslide.core.pose import Point, turned_left
from pushpressslide.mechanics.checks import (
    check_friction,
    check_normal,
    check_point,
    check_rho,
)

Allocator = Callable[[float, float, float], Allocation]


def one_contact_allocator(
    point: Point, normal: Point, friction: float, rho: float
) -> Allocator:
    """Return ``allocate(fx, fy, tau)`` for a side contact at ``point`` [m] in B.

    ``normal`` is the unit inward normal in B. The wrench is about B's origin, the CoM,
    in B. One contact gives only wrenches with tau = point x f and f in the cone of
    ``friction``; any other is projected to the nearest in the norm diag(1, 1, 1/rho^2),
    in which the error of the object's twist is least for an ellipsoid of ``rho`` [m].
    Status "ok" if nothing had to be changed (to 1e-9 of the wrench), "projected" else,
    "infeasible" if even the best force is zero, and for a wrench that is not finite.
    Raises ValueError unless ``friction`` is >= 0 and ``rho`` > 0.
    """
    check_point(point, "point")
    check_normal(normal)
    check_friction(friction)
    check_rho(rho)
    px, py = point
    nx, ny = normal
    tx, ty = turned_left(normal)
    projected = _projected(point, normal, friction, rho)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench [N, N m]."""
        fn = fx * nx + fy * ny
        ft = fx * tx + fy * ty
        margin = friction * fn - (ft if ft > 0.0 else -ft)
        if margin >= 0.0 and -1e-12 * fn <= tau - px * fy + py * fx <= 1e-12 * fn:
            return new(Allocation, (((fx, fy),), (fn,), margin, "ok", EXACT))
        return projected(fx, fy, tau)

    return allocate


def _projected(point: Point, normal: Point, friction: float, rho: float) -> Allocator:
    """Return the allocator of wrenches that one contact cannot give."""
    px, py = point
    nx, ny = normal
    tx, ty = turned_left(normal)
    inv_rho2 = 1.0 / (rho * rho)
    # Normal equations of min |f - F|^2 + (p x f - tau)^2 / rho^2: (I + a a^T / rho^2) f
    # = F + a tau / rho^2, a = (-py, px)
    ax = -py
    ay = px
    denominator = 1.0 / (1.0 + (ax * ax + ay * ay) * inv_rho2)
    on_edges = _on_edges(point, normal, friction, inv_rho2)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of the nearest wrench [N, N m]."""
        if not abs(fx) + abs(fy) + abs(tau) < inf:
            return nothing((0.0,), (fx, fy, tau))
        bx = fx + ax * tau * inv_rho2
        by = fy + ay * tau * inv_rho2
        shared = (ax * bx + ay * by) * inv_rho2 * denominator
        gx = bx - ax * shared
        gy = by - ay * shared
        fn = gx * nx + gy * ny
        ft = gx * tx + gy * ty
        if abs(ft) > friction * fn:
            gx, gy = on_edges(fx, fy, tau)
            fn = gx * nx + gy * ny
            ft = gx * tx + gy * ty
        residual = (fx - gx, fy - gy, tau - (px * gy - py * gx))
        scale = abs(fx) + abs(fy) + abs(tau) / rho
        error = abs(residual[0]) + abs(residual[1]) + abs(residual[2]) / rho
        if fn <= 0.0:
            status: AllocationStatus = "ok" if scale == 0.0 else "infeasible"
            return Allocation(((0.0, 0.0),), (0.0,), 0.0, status, residual)
        margin = friction * fn - abs(ft)
        status = "ok" if error <= 1e-9 * scale else "projected"
        return Allocation(((gx, gy),), (fn,), margin, status, residual)

    return allocate


def _on_edges(
    point: Point, normal: Point, friction: float, inv_rho2: float
) -> Callable[[float, float, float], Point]:
    """Return a function of a wrench: the nearest force on the edges of the friction
    cone, the better of the best of each (one unknown each).
    """
    nx, ny = normal
    tx, ty = turned_left(normal)
    ax = -point[1]
    ay = point[0]
    edges = (
        (nx + friction * tx, ny + friction * ty),
        (nx - friction * tx, ny - friction * ty),
    )

    def nearest(fx: float, fy: float, tau: float) -> Point:
        """Return a force [N]; none where that is nearest."""
        best_cost = fx * fx + fy * fy + tau * tau * inv_rho2
        best = (0.0, 0.0)
        for ex, ey in edges:
            lever = ax * ex + ay * ey
            norm = ex * ex + ey * ey + lever * lever * inv_rho2
            size = (ex * fx + ey * fy + lever * tau * inv_rho2) / norm
            if size > 0.0:
                rx = fx - size * ex
                ry = fy - size * ey
                rt = tau - size * lever
                cost = rx * rx + ry * ry + rt * rt * inv_rho2
                if cost < best_cost:
                    best_cost = cost
                    best = (size * ex, size * ey)
        return best

    return nearest
