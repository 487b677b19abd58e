"""Allocation to two side contacts, anywhere on the object: four force components for
the three of a wrench (docs/mechanics.md, sections 5 and 6).

Every side of a friction cone bounds the free force along the line of contacts on one
side, so that a wrench is possible exactly if the interval left is not empty.

The split "least_friction" has the least sum of squared friction forces: section 6's
u = -T/2, moved as little as needed. "least_force" has the least sum of squared forces:
an even share along the line of contacts, moved as little as needed; it squeezes less
and is nearer to slipping.

The projection "nearest" moves a wrench to the nearest in diag(1, 1, 1/rho^2);
"force_priority" in its moment alone; "torque_priority" by a force along the sum of the
normals; to the nearest where these two do not help.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, isfinite, nan

from pushpressslide.allocation.allocator import Allocator
from pushpressslide.allocation.contact_line import ContactPair, Split
from pushpressslide.allocation.projections import Projection, WrenchCone
from pushpressslide.core.allocation import (
    EXACT,
    Allocation,
    AllocationStatus,
    new,
    nothing,
)
from pushpressslide.core.pose import Point, cross
from pushpressslide.mechanics.checks import check_caps, check_rho
from pushpressslide.mechanics.friction import cone_margin

Vector = tuple[float, float, float]
Force = tuple[float, float, float, float]
"""A contact's force [N]: x and y in B, normal part, part to the left of the normal."""


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
    """Return ``allocate(fx, fy, tau)`` for side contacts at two ``points`` [m] in B.

    With unit inward ``normals``; the wrench is about B's origin, in B. Of all forces
    inside the cones of ``friction`` that realise it, ``split`` chooses one. A wrench
    outside the cone is moved, in the norm of an ellipsoid of ``rho`` [m], as
    ``projection`` says; one that needs more normal force than ``caps`` [N] is scaled.
    Status "ok" if nothing had to be changed (to 1e-9 of the wrench), "projected" else,
    "infeasible" if the best force is zero, and for a wrench that is not finite. Raises
    ValueError for contacts that coincide, friction < 0, rho or caps <= 0, and for
    "least_friction" where both normals lie along the line of contacts.
    """
    check_rho(rho)
    check_caps(caps)
    pair = ContactPair(points, normals, friction, split)
    elsewhere = _Elsewhere(pair, points, normals, friction, rho, caps, projection)
    if friction == 0.0:
        # a cone without width: every wrench is one that has to be moved onto it
        return elsewhere.outside
    return _linear(pair, normals, friction, caps, elsewhere)


def _linear(
    pair: ContactPair,
    normals: Sequence[Point],
    friction: float,
    caps: Sequence[float],
    elsewhere: _Elsewhere,
) -> Allocator:
    """Return the allocator; the forces are linear in the wrench until a cone is met."""
    x_fx, y_fx = pair.first_force(1.0, 0.0, 0.0)
    x_fy, y_fy = pair.first_force(0.0, 1.0, 0.0)
    x_tau, y_tau = pair.first_force(0.0, 0.0, 1.0)
    (n1x, n1y), (n2x, n2y) = normals
    cap1, cap2 = caps
    uncapped = min(caps) == inf
    moved = _moved(pair, friction, caps, elsewhere)

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench [N, N m]."""
        f1x = x_fx * fx + x_fy * fy + x_tau * tau
        f1y = y_fx * fx + y_fy * fy + y_tau * tau
        f2x = fx - f1x
        f2y = fy - f1y
        f1n = n1x * f1x + n1y * f1y
        f2n = n2x * f2x + n2y * f2y
        f1t = n1x * f1y - n1y * f1x
        f2t = n2x * f2y - n2y * f2x
        margin = friction * f1n - (f1t if f1t > 0.0 else -f1t)
        margin2 = friction * f2n - (f2t if f2t > 0.0 else -f2t)
        if margin2 < margin:
            margin = margin2
        if margin >= 0.0 and (uncapped or (f1n <= cap1 and f2n <= cap2)):
            forces = ((f1x, f1y), (f2x, f2y))
            return new(Allocation, (forces, (f1n, f2n), margin, "ok", EXACT))
        return moved((fx, fy, tau), (f1x, f1y, f1n, f1t), (f2x, f2y, f2n, f2t))

    return allocate


def _moved(
    pair: ContactPair,
    friction: float,
    caps: Sequence[float],
    elsewhere: _Elsewhere,
) -> Callable[[Vector, Force, Force], Allocation]:
    """Return the allocator of wrenches whose forces a cone's edge or a cap stops: they
    are moved along the line of contacts as little as the cones need.
    """
    ex, ey = pair.line.e
    n1e = pair.n1e
    n2e = pair.n2e
    # q + a d >= 0 bounds d by -q / a: from below where a > 0.
    up1, up2, up3, up4 = (a > 0.0 for a in pair.slopes)
    k1, k2, k3, k4 = (-1.0 / a for a in pair.slopes)
    cap1, cap2 = caps

    def allocate(wrench: Vector, first: Force, second: Force) -> Allocation:
        """Return the allocation of a wrench [N, N m] of which the split asks for the
        forces ``first`` and ``second``.
        """
        f1x, f1y, f1n, f1t = first
        f2x, f2y, f2n, f2t = second
        most1 = friction * f1n
        most2 = friction * f2n
        if not isfinite(most1 + most2):
            return elsewhere.outside(*wrench)
        d1 = k1 * (most1 - f1t)
        d2 = k2 * (most1 + f1t)
        d3 = k3 * (most2 - f2t)
        d4 = k4 * (most2 + f2t)
        low, high = (d1, inf) if up1 else (-inf, d1)
        if up2:
            if d2 > low:
                low = d2
        elif d2 < high:
            high = d2
        if up3:
            if d3 > low:
                low = d3
        elif d3 < high:
            high = d3
        if up4:
            if d4 > low:
                low = d4
        elif d4 < high:
            high = d4
        if not low <= high:
            return elsewhere.outside(*wrench)
        d = low
        if low <= 0.0:
            d = high if high < 0.0 else 0.0
        f1n = f1n + d * n1e
        f2n = f2n - d * n2e
        if not (f1n <= cap1 and f2n <= cap2):
            return elsewhere.capped(*wrench)
        dx = d * ex
        dy = d * ey
        forces = ((f1x + dx, f1y + dy), (f2x - dx, f2y - dy))
        return new(Allocation, (forces, (f1n, f2n), 0.0, "ok", EXACT))

    return allocate


class _Elsewhere:
    """The allocation where a cap is in the way, or the wrench is outside of the cone."""

    def __init__(
        self,
        pair: ContactPair,
        points: Sequence[Point],
        normals: Sequence[Point],
        friction: float,
        rho: float,
        caps: Sequence[float],
        projection: Projection,
    ) -> None:
        self._pair = pair
        self._points = points
        self._normals = normals
        self._friction = friction
        self._rho = rho
        self._projection = projection
        self._cap1, self._cap2 = caps
        self._cone = WrenchCone(points, normals, friction, rho)

    def capped(self, fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench of the cone that takes more normal force
        than a cap allows.
        """
        f1 = self._pair.first_force(fx, fy, tau)
        f2 = (fx - f1[0], fy - f1[1])
        slacks = []
        pushes = []
        for f, n in zip((f1, f2), self._normals, strict=True):
            push = f[0] * n[0] + f[1] * n[1]
            left = cross(n, f)
            pushes.append(push)
            slacks += [self._friction * push - left, self._friction * push + left]
        f1n, f2n = pushes
        low, high = _interval(slacks, self._pair.slopes)
        least, most = _interval(
            (self._cap1 - f1n, self._cap2 - f2n), (-self._pair.n1e, self._pair.n2e)
        )
        least = max(least, low)
        most = min(most, high)
        d = min(max(0.0, least), most)
        scale = 1.0
        if not least <= most:
            d, scale = self._largest_scale(low, high, f1n, f2n)
        ex, ey = self._pair.line.e
        f1 = (f1[0] + d * ex, f1[1] + d * ey)
        f2 = (f2[0] - d * ex, f2[1] - d * ey)
        return self._allocation((fx, fy, tau), f1, f2, scale)

    def _largest_scale(
        self, low: float, high: float, f1n: float, f2n: float
    ) -> tuple[float, float]:
        """Return d, and the largest part of the wrench, for which both normal forces
        keep their caps.
        """
        rate = self._cap1 * self._pair.n2e + self._cap2 * self._pair.n1e
        both = (self._cap1 * f2n - self._cap2 * f1n) / rate if rate != 0.0 else nan

        def scale(d: float) -> float:
            """Return the part of the wrench that keeps the caps at ``d``."""
            return self._scale(f1n + d * self._pair.n1e, f2n - d * self._pair.n2e)

        candidates = (d for d in (low, high, min(max(both, low), high)) if isfinite(d))
        best = max(candidates, key=scale, default=0.0)
        return best, scale(best)

    def _scale(self, f1n: float, f2n: float) -> float:
        """Return the part of two normal forces [N], at most 1, that keeps the caps."""
        scale = self._cap1 / f1n if f1n > self._cap1 else 1.0
        return min(scale, self._cap2 / f2n) if f2n > self._cap2 else scale

    def outside(self, fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of the wrench that one from outside the cone is moved
        to.
        """
        if not abs(fx) + abs(fy) + abs(tau) < inf:
            return nothing((0.0, 0.0), (fx, fy, tau))
        moved = (fx, fy, tau)
        if self._projection == "force_priority":
            moved = self._cone.with_force_kept(fx, fy, tau)
        elif self._projection == "torque_priority":
            moved = self._cone.with_torque_kept(fx, fy, tau)
        (f1, f2), (f1n, f2n) = self._cone.nearest(*moved)
        return self._allocation((fx, fy, tau), f1, f2, self._scale(f1n, f2n))

    def _allocation(
        self, wanted: Vector, f1: Point, f2: Point, scale: float
    ) -> Allocation:
        """Return ``scale`` times two forces, beside the wrench that was wanted."""
        forces = (scale * f1[0], scale * f1[1]), (scale * f2[0], scale * f2[1])
        p1, p2 = self._points
        (f1x, f1y), (f2x, f2y) = forces
        fx, fy, tau = wanted
        residual = (
            fx - f1x - f2x,
            fy - f1y - f2y,
            tau - cross(p1, forces[0]) - cross(p2, forces[1]),
        )
        size = abs(fx) + abs(fy) + abs(tau) / self._rho
        error = abs(residual[0]) + abs(residual[1]) + abs(residual[2]) / self._rho
        (n1x, n1y), (n2x, n2y) = self._normals
        pushes = (n1x * f1x + n1y * f1y, n2x * f2x + n2y * f2y)
        margin = min(
            cone_margin(f, n, self._friction)
            for f, n in zip(forces, self._normals, strict=True)
        )
        status: AllocationStatus = "ok" if error <= 1e-9 * size < inf else "projected"
        if status == "projected" and f1x == f1y == f2x == f2y == 0.0:
            status = "infeasible"
        return Allocation(forces, pushes, margin, status, residual)


def _interval(slacks: Sequence[float], slopes: Sequence[float]) -> tuple[float, float]:
    """Return the interval of d in which all q + a d >= 0; reversed if there is none."""
    low = -inf
    high = inf
    for q, a in zip(slacks, slopes, strict=True):
        if a > 0.0:
            low = max(low, -q / a)
        elif a < 0.0:
            high = min(high, -q / a)
        elif q < 0.0:
            return inf, -inf
    return low, high
