"""Allocation to two side contacts, on arrays: the answers of ``allocation.two_contacts``.

Source: docs/mechanics.md, sections 5 and 6. Four formulas, each for the rows that those
before have not settled: forces as wanted, forces moved to the edges of the cones, beyond
a cap, and outside of the cones.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.allocation.contact_line import Split
from pushpressslide.batch.allocations import (
    INFEASIBLE,
    OK,
    OPEN,
    PROJECTED,
    Allocations,
    allocations,
    is_finite,
    wanted,
    wrench_table,
)
from pushpressslide.batch.checks import (
    check_caps,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.contact_pair import Pair, contact_pair
from pushpressslide.batch.elementwise import columns_of, figures, leading_shape
from pushpressslide.batch.nearest_wrench import edge_of, edge_parts
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.formulas import Column, Columns, greater, least, where

BEYOND = OPEN + 1  # within the cones, but beyond a cap
OUTSIDE = OPEN + 2  # of the cones, however the forces are split
EXACT = 1e-9  # of the wrench: an error that is none


class PairForces(NamedTuple):
    """The forces of two contacts [N]."""

    f1x: Column
    f1y: Column
    f2x: Column
    f2y: Column


class TwoContacts:
    """Two side contacts; points, normals, friction, rho and caps of any leading shape."""

    def __init__(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        *,
        caps: ArrayLike = (math.inf, math.inf),
        split: Split = "least_friction",
    ) -> None:
        """Prepare the contacts.

        ``points`` (..., 2, 2) [m] and unit inward ``normals`` (..., 2, 2) in B,
        ``friction`` (...), ``rho`` (...) [m], ``caps`` (..., 2) [N]. Raises ValueError
        as ``two_contact_allocator``.
        """
        p, n, mu, length, most = figures(points, normals, friction, rho, caps)
        check_last(p, (2, 2), "points")
        check_last(n, (2, 2), "normals")
        check_last(most, (2,), "caps")
        check_frictions(mu)
        check_positive(length, "rho", "m")
        check_caps(most)
        check_units(n)
        self.pair = contact_pair(p, n, mu, length, most, split)
        self.shape = leading_shape(self.pair)
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's
        origin, in B: those of ``two_contact_allocator`` with projection "nearest".
        """
        rows = wanted(wrenches)
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (wrench_table(rows, shape), columns_of(self.pair, shape))
        return allocations(arguments, shape, 2, inside_cones, STAGES)


def wanted_forces(wrench: WrenchColumns, pair: Pair) -> PairForces:
    """Return the forces that the split asks for, wherever the cones are."""
    f1x = pair.x_fx * wrench.fx + pair.x_fy * wrench.fy + pair.x_tau * wrench.tau
    f1y = pair.y_fx * wrench.fx + pair.y_fy * wrench.fy + pair.y_tau * wrench.tau
    return PairForces(f1x, f1y, wrench.fx - f1x, wrench.fy - f1y)


def cone_interval(
    slack_1: Column, slack_2: Column, slack_3: Column, slack_4: Column, pair: Pair
) -> tuple[Column, Column]:
    """Return the interval of the force along e [N] that all sides of the cones leave.

    A side bounds it from below where its slope is positive, else from above; reversed
    where nothing is left.
    """
    low = -math.inf
    high = math.inf
    d = -slack_1 / pair.slope_1
    low = where(pair.slope_1 > 0.0, d, low)
    high = where(pair.slope_1 > 0.0, high, d)
    d = -slack_2 / pair.slope_2
    low = where(pair.slope_2 > 0.0, greater(low, d), low)
    high = where(pair.slope_2 > 0.0, high, least(high, d))
    d = -slack_3 / pair.slope_3
    low = where(pair.slope_3 > 0.0, greater(low, d), low)
    high = where(pair.slope_3 > 0.0, high, least(high, d))
    d = -slack_4 / pair.slope_4
    low = where(pair.slope_4 > 0.0, greater(low, d), low)
    high = where(pair.slope_4 > 0.0, high, least(high, d))
    return low, high


def inside_cones(wrench: WrenchColumns, pair: Pair) -> Columns:
    """Return the allocation of a wrench whose wanted forces are inside the cones; open
    otherwise.
    """
    f = wanted_forces(wrench, pair)
    f1n = pair.n1x * f.f1x + pair.n1y * f.f1y
    f2n = pair.n2x * f.f2x + pair.n2y * f.f2y
    f1t = pair.n1x * f.f1y - pair.n1y * f.f1x
    f2t = pair.n2x * f.f2y - pair.n2y * f.f2x
    mu = pair.friction
    margin = least(mu * f1n - np.abs(f1t), mu * f2n - np.abs(f2t))
    held = (margin >= 0.0) & is_finite(wrench) & (mu > 0.0)
    kept = (f1n <= pair.cap_1) & (f2n <= pair.cap_2)
    status = where(held, where(kept, OK, BEYOND), OPEN)
    return f.f1x, f.f1y, f.f2x, f.f2y, f1n, f2n, margin, status, 0.0, 0.0, 0.0


def at_edges(wrench: WrenchColumns, pair: Pair) -> Columns:
    """Return the allocation with the wanted forces moved along e to the edges of the
    cones; outside where no such move is enough.
    """
    f = wanted_forces(wrench, pair)
    f1n = pair.n1x * f.f1x + pair.n1y * f.f1y
    f2n = pair.n2x * f.f2x + pair.n2y * f.f2y
    f1t = pair.n1x * f.f1y - pair.n1y * f.f1x
    f2t = pair.n2x * f.f2y - pair.n2y * f.f2x
    mu = pair.friction
    low, high = cone_interval(
        mu * f1n - f1t, mu * f1n + f1t, mu * f2n - f2t, mu * f2n + f2t, pair
    )
    d = where(low > 0.0, low, where(high < 0.0, high, 0.0))
    n1e = pair.ex * pair.n1x + pair.ey * pair.n1y
    n2e = pair.ex * pair.n2x + pair.ey * pair.n2y
    f1n = f1n + d * n1e
    f2n = f2n - d * n2e
    f1x = f.f1x + d * pair.ex
    f1y = f.f1y + d * pair.ey
    f2x = f.f2x - d * pair.ex
    f2y = f.f2y - d * pair.ey
    held = (low <= high) & is_finite(wrench) & (mu > 0.0)
    kept = (f1n <= pair.cap_1) & (f2n <= pair.cap_2)
    status = where(held, where(kept, OK, BEYOND), OUTSIDE)
    return f1x, f1y, f2x, f2y, f1n, f2n, 0.0, status, 0.0, 0.0, 0.0


def cap_scale(f1n: Column, f2n: Column, pair: Pair) -> Column:
    """Return the part of two normal forces [N], at most 1, that keeps the caps."""
    scale = where(f1n > pair.cap_1, pair.cap_1 / f1n, 1.0)
    return where(f2n > pair.cap_2, least(scale, pair.cap_2 / f2n), scale)


def beyond_caps(wrench: WrenchColumns, pair: Pair) -> Columns:
    """Return the allocation of a wrench of the cone that takes more than a cap allows:
    split in another way, and scaled where no split keeps the caps.
    """
    f = wanted_forces(wrench, pair)
    f1n = pair.n1x * f.f1x + pair.n1y * f.f1y
    f2n = pair.n2x * f.f2x + pair.n2y * f.f2y
    f1t = pair.n1x * f.f1y - pair.n1y * f.f1x
    f2t = pair.n2x * f.f2y - pair.n2y * f.f2x
    mu = pair.friction
    low, high = cone_interval(
        mu * f1n - f1t, mu * f1n + f1t, mu * f2n - f2t, mu * f2n + f2t, pair
    )
    n1e = pair.ex * pair.n1x + pair.ey * pair.n1y
    n2e = pair.ex * pair.n2x + pair.ey * pair.n2y
    first_low, first_high = cap_interval(pair.cap_1 - f1n, -n1e)
    second_low, second_high = cap_interval(pair.cap_2 - f2n, n2e)
    bottom = greater(greater(first_low, second_low), low)
    top = least(least(first_high, second_high), high)
    rate = pair.cap_1 * n2e + pair.cap_2 * n1e
    both = (pair.cap_1 * f2n - pair.cap_2 * f1n) / rate
    between = where(rate != 0.0, least(greater(both, low), high), math.inf)
    scaled, scale = best_scaled(f1n, f2n, (low, high, between), pair)
    fits = bottom <= top
    d = where(fits, least(greater(0.0, bottom), top), scaled)
    moved = PairForces(
        f.f1x + d * pair.ex,
        f.f1y + d * pair.ey,
        f.f2x - d * pair.ex,
        f.f2y - d * pair.ey,
    )
    return judged(wrench, moved, where(fits, 1.0, scale), pair)


def cap_interval(room: Column, slope: Column) -> tuple[Column, Column]:
    """Return the interval of d in which ``room + slope d >= 0``; reversed if none."""
    d = -room / slope
    never = (slope == 0.0) & (room < 0.0)
    low = where(slope > 0.0, d, where(never, math.inf, -math.inf))
    high = where(slope < 0.0, d, where(never, -math.inf, math.inf))
    return low, high


def best_scaled(
    f1n: Column, f2n: Column, places: tuple[Column, Column, Column], pair: Pair
) -> tuple[Column, Column]:
    """Return the place d along e with the largest part of the wrench that keeps the
    caps, and this part; places that are not finite do not count.
    """
    n1e = pair.ex * pair.n1x + pair.ey * pair.n1y
    n2e = pair.ex * pair.n2x + pair.ey * pair.n2y
    best = 0.0
    scale = -math.inf
    for d in places:
        part = cap_scale(f1n + d * n1e, f2n - d * n2e, pair)
        better = np.isfinite(d) & (part > scale)
        best = where(better, d, best)
        scale = where(better, part, scale)
    return best, where(scale > -math.inf, scale, cap_scale(f1n, f2n, pair))


def outside_cones(wrench: WrenchColumns, pair: Pair) -> Columns:
    """Return the allocation of the nearest wrench of the cone."""
    mu = pair.friction
    edges = (
        edge_of(pair.p1x, pair.p1y, pair.n1x, pair.n1y, -mu, pair.rho),
        edge_of(pair.p1x, pair.p1y, pair.n1x, pair.n1y, mu, pair.rho),
        edge_of(pair.p2x, pair.p2y, pair.n2x, pair.n2y, -mu, pair.rho),
        edge_of(pair.p2x, pair.p2y, pair.n2x, pair.n2y, mu, pair.rho),
    )
    z = wrench.tau / pair.rho
    k0, k1, k2, k3 = edge_parts(wrench.fx, wrench.fy, z, edges)
    nearest = PairForces(
        k0 * edges[0].fx + k1 * edges[1].fx,
        k0 * edges[0].fy + k1 * edges[1].fy,
        k2 * edges[2].fx + k3 * edges[3].fx,
        k2 * edges[2].fy + k3 * edges[3].fy,
    )
    return judged(wrench, nearest, cap_scale(k0 + k1, k2 + k3, pair), pair)


def judged(wrench: WrenchColumns, f: PairForces, scale: Column, pair: Pair) -> Columns:
    """Return ``scale`` times the forces ``f``, and how far that is from the wrench;
    no forces for one that is not finite.
    """
    finite = is_finite(wrench)
    f1x = where(finite, scale * f.f1x, 0.0)
    f1y = where(finite, scale * f.f1y, 0.0)
    f2x = where(finite, scale * f.f2x, 0.0)
    f2y = where(finite, scale * f.f2y, 0.0)
    moment = pair.p1x * f1y - pair.p1y * f1x + pair.p2x * f2y - pair.p2y * f2x
    rx = wrench.fx - f1x - f2x
    ry = wrench.fy - f1y - f2y
    rt = wrench.tau - moment
    size = np.abs(wrench.fx) + np.abs(wrench.fy) + np.abs(wrench.tau) / pair.rho
    error = np.abs(rx) + np.abs(ry) + np.abs(rt) / pair.rho
    f1n = pair.n1x * f1x + pair.n1y * f1y
    f2n = pair.n2x * f2x + pair.n2y * f2y
    f1t = pair.n1x * f1y - pair.n1y * f1x
    f2t = pair.n2x * f2y - pair.n2y * f2x
    margin = least(pair.friction * f1n - np.abs(f1t), pair.friction * f2n - np.abs(f2t))
    exact = (error <= EXACT * size) & finite
    some = (f1x != 0.0) | (f1y != 0.0) | (f2x != 0.0) | (f2y != 0.0)
    status = where(exact, OK, where(some, PROJECTED, INFEASIBLE))
    return f1x, f1y, f2x, f2y, f1n, f2n, margin, status, rx, ry, rt


STAGES = ((OPEN, at_edges), (BEYOND, beyond_caps), (OUTSIDE, outside_cones))
"""What settles the rows that ``inside_cones`` has not, in this order."""
