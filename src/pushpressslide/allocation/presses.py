"""Allocation to two top contacts: tangential forces inside the friction discs of two
presses (docs/mechanics.md, section 7).

Across the line of contacts both forces follow from the wrench; along it, every split
without opposite signs is free of antagonistic shear. Closed forms in plain floats. The
normal loads are in ``press_loads``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, sqrt
from typing import Protocol

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core.allocation import (
    EXACT,
    Allocation,
    AllocationStatus,
    new,
    nothing,
)
from pushpressslide.core.pose import Point
from pushpressslide.mechanics.checks import check_friction

# of the discs' radii, allowed beyond them: what one contact alone can give may be asked
# of it
ROUNDING = 1e-12
NOTHING = 1e-9  # part of a wrench that counts as none of it


class PressAllocator(Protocol):
    """An allocator that is told the normal forces and the centre of pressure of the
    moment.
    """

    def __call__(
        self, fx: float, fy: float, tau: float, normals: Point, cop: Point = (0.0, 0.0)
    ) -> Allocation:
        """Return the tangential forces for a wrench about ``cop`` [m], in B."""
        ...


def two_press_allocator(points: Sequence[Point], friction: float) -> PressAllocator:
    """Return ``allocate(fx, fy, tau, normals, cop)`` for top contacts at two ``points``
    [m] in B.

    The wrench is about ``cop`` [m], in B: the centre of pressure of the ``normals`` [N]
    that the contacts press with, best as measured. The force along the line of contacts
    is shared in the ratio of what each disc, of radius ``friction`` times normal, has
    left for it: without antagonistic shear, and inside both discs whenever any split
    is.

    A wrench beyond the discs is scaled onto them, status "projected": its direction is
    kept, but below the limit surface nothing moves, so that this twist cannot be driven
    at these normals. "infeasible" if nothing is left of it, it is not finite, or a
    normal is not finite and >= 0. Raises InputError for contacts that coincide, or
    friction < 0.
    """
    check_friction(friction)
    return _sharing(ContactLine(*points), friction)


def _sharing(line: ContactLine, friction: float) -> PressAllocator:
    """Return the allocator; it shares the force along ``line``."""
    ex, ey = line.e
    half_x = -0.5 * ey
    half_y = 0.5 * ex
    mid_x, mid_y = line.middle
    per_length = 1.0 / line.length
    scaled = _Discs(line.e).scaled

    def allocate(
        fx: float, fy: float, tau: float, normals: Point, cop: Point = (0.0, 0.0)
    ) -> Allocation:
        """Return the allocation of a wrench [N, N m] about ``cop`` [m]."""
        n1, n2 = normals
        cop_x, cop_y = cop
        along = ex * fx + ey * fy
        half = half_x * fx + half_y * fy
        turning = (tau - (mid_x - cop_x) * fy + (mid_y - cop_y) * fx) * per_length
        g1 = half - turning
        g2 = half + turning
        most1 = friction * n1
        most2 = friction * n2
        across1 = g1 * g1
        across2 = g2 * g2
        free1 = most1 * most1 - across1
        free2 = most2 * most2 - across2
        if free1 >= 0.0 and free2 >= 0.0:
            room1 = sqrt(free1)
            room = room1 + sqrt(free2)
            if room > 0.0 and room < inf and n1 >= 0.0 and n2 >= 0.0:
                s1 = along * room1 / room
                s2 = along - s1
                margin = most1 - sqrt(s1 * s1 + across1)
                margin2 = most2 - sqrt(s2 * s2 + across2)
                if margin2 < margin:
                    margin = margin2
                # below zero by rounding alone, at the edges of both discs
                if margin >= 0.0 or margin >= -ROUNDING * (most1 + most2):
                    f1x = s1 * ex - g1 * ey
                    f1y = s1 * ey + g1 * ex
                    forces = ((f1x, f1y), (fx - f1x, fy - f1y))
                    return new(Allocation, (forces, normals, margin, "ok", EXACT))
        return scaled(fx, fy, tau, (along, g1, g2), most1, most2, normals)

    return allocate


@dataclass(frozen=True, slots=True)
class _Discs:
    """Two discs onto which wrenches are scaled."""

    e: Point  # unit vector from the first contact to the second

    def scaled(
        self,
        fx: float,
        fy: float,
        tau: float,
        parts: tuple[float, float, float],
        most1: float,
        most2: float,
        normals: Point,
    ) -> Allocation:
        """Return the allocation of a wrench of which ``ContactLine.parts`` are given.

        The discs have the radii ``most1`` and ``most2`` [N].
        """
        ex, ey = self.e
        along, g1, g2 = parts
        most1 = max(most1, 0.0)
        most2 = max(most2, 0.0)
        rounding = ROUNDING * (most1 + most2)
        most1 = most1 + rounding
        most2 = most2 + rounding
        size = abs(along) + abs(g1) + abs(g2)
        n1, n2 = normals
        if not (size + n1 + n2 < inf and n1 >= 0.0 and n2 >= 0.0):
            return nothing(normals, (fx, fy, tau))
        scale = min(largest_scale(parts, (most1, most2)), 1.0)
        if not scale > NOTHING:
            return nothing(normals, (fx, fy, tau))
        g1 *= scale
        room1 = sqrt(max(most1 * most1 - g1 * g1, 0.0))
        room = room1 + sqrt(max(most2 * most2 - scale * g2 * scale * g2, 0.0))
        s = scale * along * room1 / room if room > 0.0 else 0.0
        f1x = s * ex - g1 * ey
        f1y = s * ey + g1 * ex
        f2x = scale * fx - f1x
        f2y = scale * fy - f1y
        margin = min(most1 - hypot(f1x, f1y), most2 - hypot(f2x, f2y))
        status: AllocationStatus = "ok" if 1.0 - scale <= 1e-9 else "projected"
        lost = 1.0 - scale
        residual = (lost * fx, lost * fy, lost * tau)
        return Allocation(((f1x, f1y), (f2x, f2y)), normals, margin, status, residual)


def largest_scale(parts: tuple[float, float, float], most: Point) -> float:
    """Return the factor [0, inf] by which a wrench can be scaled inside two discs.

    ``parts`` (F.e, g_1, g_2) [N] of ``ContactLine.parts``, ``most`` [N] the radii.
    Below 1 the wrench is impossible.
    """
    along, g1, g2 = parts
    x = _least_root(most[0] * most[0], g1 * g1, most[1] * most[1], g2 * g2, abs(along))
    return inf if x == 0.0 else 1.0 / sqrt(x)


def least_press(
    parts: tuple[float, float, float], friction: float, share: float
) -> float:
    """Return the least sum [N] of two normal forces of which contact 2 has the part
    ``share`` in [0, 1].
    """
    along, g1, g2 = parts
    a1 = friction * (1.0 - share)
    a2 = friction * share
    return sqrt(_least_root(a1 * a1, g1 * g1, a2 * a2, g2 * g2, abs(along)))


def least_presses(parts: tuple[float, float, float], friction: float) -> Point:
    """Return the two normal forces [N] of least sum: |f_i| / mu, with F.e shared as
    |g_1| to |g_2|.
    """
    along, g1, g2 = parts
    across = abs(g1) + abs(g2)
    share = abs(g2) / across if across > 0.0 else 0.5
    return hypot((1.0 - share) * along, g1) / friction, hypot(
        share * along, g2
    ) / friction


def _least_root(a1: float, b1: float, a2: float, b2: float, e: float) -> float:
    """Return the least x >= 0 with sqrt(a1 x - b1) + sqrt(a2 x - b2) >= e.

    All arguments are >= 0.
    """
    if (
        (a1 == 0.0 and b1 > 0.0)
        or (a2 == 0.0 and b2 > 0.0)
        or (a1 == a2 == 0.0 and e > 0.0)
    ):
        return inf
    x = max(b1 / a1 if a1 > 0.0 else 0.0, b2 / a2 if a2 > 0.0 else 0.0)
    square = e * e
    if (
        square <= 1e-30 * (b1 + b2)
        or sqrt(max(a1 * x - b1, 0.0)) + sqrt(max(a2 * x - b2, 0.0)) >= e
    ):
        return x
    # The smaller root of the quadratic that squaring twice leads to, without
    # cancellation
    root = sqrt(max(a1 * a2 * square + (a1 - a2) * (a2 * b1 - a1 * b2), 0.0))
    numerator = square * (square + 2.0 * (b1 + b2)) + (b1 - b2) * (b1 - b2)
    denominator = square * (a1 + a2) + (a1 - a2) * (b1 - b2) + 2.0 * e * root
    return x if denominator == 0.0 else numerator / denominator
