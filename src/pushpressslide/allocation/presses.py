"""Allocation to two top contacts: tangential forces inside the friction discs of two
presses (docs/mechanics.md, section 7).

The force components across the line of contacts follow from the wrench. Those along the
line are free of antagonistic shear if they do not have opposite signs. All formulas are
closed forms in plain floats. The normal loads are in ``press_loads``.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, sqrt
from typing import Protocol

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.core.allocation import STATUSES, Allocation, new
from pushpressslide.core.pose import Point
from pushpressslide.kernels.presses import PressPair as PressPair
from pushpressslide.kernels.presses import largest_scale as largest_scale
from pushpressslide.kernels.presses import least_root, press_pair, two_presses
from pushpressslide.mechanics.checks import check_friction


class PressAllocator(Protocol):
    """An allocator that takes the normal forces and the reference point of the moment
    as arguments.
    """

    def __call__(
        self, fx: float, fy: float, tau: float, normals: Point, cop: Point = (0.0, 0.0)
    ) -> Allocation:
        """Tangential forces for a wrench about ``cop`` [m], in B."""
        ...


def two_press_allocator(points: Sequence[Point], friction: float) -> PressAllocator:
    """``allocate(fx, fy, tau, normals, cop)`` for top contacts at two ``points`` [m] in
    B.

    The wrench is about ``cop`` [m], in B: the centre of pressure of the contacts'
    ``normals`` [N], preferably measured ones. The radius of each disc is ``friction``
    times the normal force. The force along the line of contacts is shared in the ratio
    of the remaining capacities of the discs. The split has no antagonistic shear, and
    is inside both discs whenever any split is.

    A wrench beyond the discs is scaled onto them, with status "projected". Its
    direction is kept, but it is then inside the limit surface and moves nothing: these
    normals cannot drive the twist. The status is "infeasible" if no force is left, the
    wrench is not finite, or a normal is not finite and >= 0. Raises InputError for
    contacts that coincide, or friction < 0.
    """
    check_friction(friction)
    first, second = points
    ContactLine(first, second)
    (pair,) = press_pair(first, second, friction)
    return _allocator(pair)


def _allocator(pair: PressPair) -> PressAllocator:
    """Allocator for the two presses of ``pair``."""

    def allocate(
        fx: float, fy: float, tau: float, normals: Point, cop: Point = (0.0, 0.0)
    ) -> Allocation:
        """Allocation of a wrench [N, N m] about ``cop`` [m]."""
        forces, normals, margin, status, residual = two_presses(
            fx, fy, tau, normals, cop, pair
        )
        words = (forces, normals, margin, STATUSES[status], residual)
        return new(Allocation, words)

    return allocate


def least_press(
    parts: tuple[float, float, float], friction: float, share: float
) -> float:
    """Smallest sum [N] of two normal forces if contact 2 has the fraction ``share``, in
    [0, 1].
    """
    along, g1, g2 = parts
    a1 = friction * (1.0 - share)
    a2 = friction * share
    return sqrt(least_root(a1 * a1, g1 * g1, a2 * a2, g2 * g2, abs(along)))


def least_presses(parts: tuple[float, float, float], friction: float) -> Point:
    """The two normal forces [N] with the smallest sum: |f_i| / mu, with F.e split in
    the ratio |g_1| : |g_2|.
    """
    along, g1, g2 = parts
    across = abs(g1) + abs(g2)
    share = abs(g2) / across if across > 0.0 else 0.5
    return hypot((1.0 - share) * along, g1) / friction, hypot(
        share * along, g2
    ) / friction
