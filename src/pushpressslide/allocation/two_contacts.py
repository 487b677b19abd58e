"""Allocation to two side contacts, anywhere on the object: four force components for the three of a wrench
(docs/mechanics.md, sections 5 and 6).

Every side of a friction cone bounds the free force along the line of contacts on one side, so that a wrench
is possible exactly if the interval left is not empty.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.one_contact import Allocator
from pushpressslide.allocation.projections import Projection, WrenchCone
from pushpressslide.core.allocation import Allocation, AllocationStatus
from pushpressslide.core.pose import Point, cross
from pushpressslide.mechanics.friction import cone_margin

Split = Literal["least_friction", "least_force"]
Vector = tuple[float, float, float]
ALONG = 1e-9  # sine below which the side of a cone counts as along the line of contacts
FACING = 0.03  # sine of the angle to the line of contacts within which friction leaves the split open
NONE = (0.0, 0.0, 0.0)


def two_contact_allocator(
    points: Sequence[Point],
    normals: Sequence[Point],
    friction: float,
    rho: float,
    *,
    caps: Sequence[float] = (math.inf, math.inf),
    projection: Projection = "nearest",
    split: Split = "least_friction",
) -> Allocator:
    """Return ``allocate(fx, fy, tau)`` for side contacts at two ``points`` [m] with unit inward ``normals``,
    in B.

    The wrench is about B's origin, in B. Of all forces inside the cones of ``friction`` that realise it, the
    answer has the least sum of squared friction forces ("least_friction": section 6's u = -T/2, moved as
    little as needed) or the least sum of squared forces ("least_force": an even share along the line of
    contacts, moved as little as needed; it squeezes less and is nearer to slipping).

    A wrench that the contacts cannot give is moved: to the nearest in diag(1, 1, 1/rho^2) for an ellipsoid of
    ``rho`` [m]; or ("force_priority") in its moment alone; or ("torque_priority") by a force along the sum of
    the normals; to the nearest where these two do not help. One that needs more normal force than ``caps``
    [N] is scaled. Status "ok" if nothing had to be changed (to 1e-9 of the wrench), "projected" else,
    "infeasible" if the best force is zero. Raises ValueError for contacts that coincide, friction <= 0, and
    for "least_friction" where both normals lie along the line of contacts.
    """
    pair = _TwoContacts(points, normals, friction, rho, caps, projection, split)
    # As long as no cone is in the way the forces are linear in the wrench.
    x_fx, y_fx = pair.first_force(1.0, 0.0, 0.0)
    x_fy, y_fy = pair.first_force(0.0, 1.0, 0.0)
    x_tau, y_tau = pair.first_force(0.0, 0.0, 1.0)
    ex, ey = pair.line.e
    (n1x, n1y), (n2x, n2y) = normals
    (n1e, _), (n2e, _) = pair.axes
    # More force d of contact 1 along e, and less of contact 2, changes the slack q of a cone's side to q + a d,
    # so that -q / a bounds d: from below where a > 0.
    slopes = [a for a, _ in pair.sides1] + [-a for a, _ in pair.sides2]
    up1, up2, up3, up4 = (a > 0.0 for a in slopes)
    k1, k2, k3, k4 = (-1.0 / (a if abs(a) > ALONG else math.copysign(ALONG, a)) for a in slopes)
    cap1, cap2 = caps
    capped, outside, none, inf = pair.capped, pair.outside, NONE, math.inf

    def allocate(fx: float, fy: float, tau: float) -> Allocation:
        f1x = x_fx * fx + x_fy * fy + x_tau * tau
        f1y = y_fx * fx + y_fy * fy + y_tau * tau
        f2x, f2y = fx - f1x, fy - f1y
        f1n, f2n = n1x * f1x + n1y * f1y, n2x * f2x + n2y * f2y
        f1t, f2t = n1x * f1y - n1y * f1x, n2x * f2y - n2y * f2x
        margin = friction * f1n - (f1t if f1t > 0.0 else -f1t)
        margin2 = friction * f2n - (f2t if f2t > 0.0 else -f2t)
        if margin2 < margin:
            margin = margin2
        if not margin >= 0.0:
            d1, d2 = k1 * (friction * f1n + f1t), k2 * (friction * f1n - f1t)
            d3, d4 = k3 * (friction * f2n + f2t), k4 * (friction * f2n - f2t)
            low = max(d1 if up1 else -inf, d2 if up2 else -inf, d3 if up3 else -inf, d4 if up4 else -inf)
            high = min(inf if up1 else d1, inf if up2 else d2, inf if up3 else d3, inf if up4 else d4)
            if not low <= high:
                return outside(fx, fy, tau)
            more = low if low > 0.0 else high
            f1x, f1y, f2x, f2y = f1x + more * ex, f1y + more * ey, f2x - more * ex, f2y - more * ey
            f1n, f2n, margin = f1n + more * n1e, f2n - more * n2e, 0.0
        if f1n <= cap1 and f2n <= cap2:
            return Allocation(((f1x, f1y), (f2x, f2y)), (f1n, f2n), margin, "ok", none)
        return capped(fx, fy, tau)

    return allocate


class _TwoContacts:
    """Two side contacts: the split that is wanted, and what comes of it where a cone or a cap is in the
    way.
    """

    def __init__(
        self,
        points: Sequence[Point],
        normals: Sequence[Point],
        friction: float,
        rho: float,
        caps: Sequence[float],
        projection: Projection,
        split: Split,
    ) -> None:
        if not friction > 0.0:
            raise ValueError(f"friction {friction}; must be > 0")
        self.line = ContactLine(*points)
        self._points, self._normals, self._friction, self._rho = points, normals, friction, rho
        self._cap1, self._cap2 = caps
        self._projection = projection
        self._cone = WrenchCone(points, normals, friction, rho)
        self.axes = [self.line.in_axes(n) for n in normals]
        (self._n1e, self._n1m), (self._n2e, self._n2m) = self.axes
        # Sides of the cones, q.f >= 0 for q = mu n -+ J n, in the axes of the line
        self.sides1, self.sides2 = (
            ((friction * ne + nm, friction * nm - ne), (friction * ne - nm, friction * nm + ne))
            for ne, nm in self.axes
        )
        self._weights = (0.5, 0.0, 0.0)
        if split == "least_friction":
            squares = self._n1m**2 + self._n2m**2
            if squares < FACING**2:
                raise ValueError("contacts that face each other; 'least_friction' needs 'least_force' there")
            self._weights = (
                self._n2m**2 / squares,
                self._n1m * self._n1e / squares,
                -self._n2m * self._n2e / squares,
            )

    def _wanted(self, along: float, g1: float, g2: float) -> float:
        """Return the force s [N] of contact 1 along the line that the split asks for."""
        a, b, c = self._weights
        return a * along + b * g1 + c * g2

    def first_force(self, fx: float, fy: float, tau: float) -> Point:
        """Return the wanted force [N] of contact 1, in B."""
        along, g1, g2 = self.line.parts(fx, fy, tau)
        return self.line.in_body((self._wanted(along, g1, g2), g1))

    def capped(self, fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of a wrench of the cone where a cap is in the way."""
        along, g1, g2 = self.line.parts(fx, fy, tau)
        low, high = -math.inf, math.inf
        for a, b in self.sides1:
            low, high = _narrowed(low, high, a, b * g1)
        for a, b in self.sides2:
            low, high = _narrowed(low, high, -a, a * along + b * g2)
        # Normal forces n1e s + h1 and h2 - n2e s
        h1, h2 = self._n1m * g1, self._n2e * along + self._n2m * g2
        least, most = _narrowed(low, high, -self._n1e, self._cap1 - h1)
        least, most = _narrowed(least, most, self._n2e, self._cap2 - h2)
        s, scale = min(max(self._wanted(along, g1, g2), least), most), 1.0
        if not least <= most:
            s, scale = self._largest_scale(low, high, h1, h2)
        f1 = self.line.in_body((s, g1))
        return self._allocation((fx, fy, tau), f1, (fx - f1[0], fy - f1[1]), scale)

    def _largest_scale(self, low: float, high: float, h1: float, h2: float) -> tuple[float, float]:
        """Return s, and the largest part of the wrench, for which both normal forces keep their caps."""
        even = self._cap1 * self._n2e + self._cap2 * self._n1e
        crossing = (self._cap1 * h2 - self._cap2 * h1) / even if even != 0.0 else math.nan
        candidates = [s for s in (low, high, min(max(crossing, low), high)) if math.isfinite(s)]

        def scale(s: float) -> float:
            return self._scale(self._n1e * s + h1, h2 - self._n2e * s)

        best = max(candidates, key=scale, default=0.0)
        return best, scale(best)

    def _scale(self, f1n: float, f2n: float) -> float:
        """Return the part of these normal forces [N] that keeps the caps, at most 1."""
        scale = self._cap1 / f1n if f1n > self._cap1 else 1.0
        return min(scale, self._cap2 / f2n) if f2n > self._cap2 else scale

    def outside(self, fx: float, fy: float, tau: float) -> Allocation:
        """Return the allocation of the wrench that one from outside the cone is moved to."""
        moved = (fx, fy, tau)
        if self._projection == "force_priority":
            moved = self._cone.with_force_kept(fx, fy, tau)
        elif self._projection == "torque_priority":
            moved = self._cone.with_torque_kept(fx, fy, tau)
        (f1, f2), (f1n, f2n) = self._cone.nearest(*moved)
        return self._allocation((fx, fy, tau), f1, f2, self._scale(f1n, f2n))

    def _allocation(self, wanted: Vector, f1: Point, f2: Point, scale: float) -> Allocation:
        """Return ``scale`` times two forces, beside the wrench that was wanted."""
        forces = (scale * f1[0], scale * f1[1]), (scale * f2[0], scale * f2[1])
        p1, p2 = self._points
        (f1x, f1y), (f2x, f2y) = forces
        fx, fy, tau = wanted
        residual = (fx - f1x - f2x, fy - f1y - f2y, tau - cross(p1, forces[0]) - cross(p2, forces[1]))
        size = abs(fx) + abs(fy) + abs(tau) / self._rho
        error = abs(residual[0]) + abs(residual[1]) + abs(residual[2]) / self._rho
        (n1x, n1y), (n2x, n2y) = self._normals
        pushes = (n1x * f1x + n1y * f1y, n2x * f2x + n2y * f2y)
        margin = min(
            cone_margin(f, n, self._friction) for f, n in zip(forces, self._normals, strict=True)
        )
        status: AllocationStatus = "ok" if error <= 1e-9 * size else "projected"
        if status == "projected" and f1x == f1y == f2x == f2y == 0.0:
            status = "infeasible"
        return Allocation(forces, pushes, margin, status, residual)


def _narrowed(low: float, high: float, a: float, r: float) -> tuple[float, float]:
    """Return what a s + r >= 0 leaves of the interval [low, high] of s; (inf, -inf) if nothing."""
    if a > 0.0:
        return max(low, -r / a), high
    if a < 0.0:
        return low, min(high, -r / a)
    return (low, high) if r >= 0.0 else (math.inf, -math.inf)
