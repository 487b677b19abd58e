"""Two side contacts as columns: what a wrench leaves open of their forces, and how their
friction cones bound that.

Source: docs/mechanics.md, section 6; ``allocation.contact_line`` for one pair.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from pushpressslide.allocation.contact_line import ALONG, FACING, Split
from pushpressslide.batch.checks import check_all
from pushpressslide.batch.elementwise import figures
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column


class Pair(NamedTuple):
    """Two side contacts as columns; all in B."""

    p1x: Column  # [m]
    p1y: Column
    p2x: Column
    p2y: Column
    n1x: Column  # unit inward normals
    n1y: Column
    n2x: Column
    n2y: Column
    ex: Column  # unit vector from contact 1 to 2
    ey: Column
    # the force of contact 1 that the split asks for, per fx, fy and tau
    x_fx: Column
    x_fy: Column
    x_tau: Column  # [1/m]
    y_fx: Column
    y_fy: Column
    y_tau: Column
    # change of the slacks of the cones' sides for a force along e
    slope_1: Column
    slope_2: Column
    slope_3: Column
    slope_4: Column
    friction: Column
    rho: Column  # [m]
    cap_1: Column  # [N]
    cap_2: Column


def contact_pair(
    points: Array,
    normals: Array,
    friction: Array,
    rho: Array,
    caps: Array,
    split: Split,
) -> Pair:
    """Return the figures of ``allocation.contact_line.ContactPair``.

    ``points`` (..., 2, 2) [m] and unit inward ``normals`` (..., 2, 2) in B, ``friction``
    (...), ``rho`` (...) [m], ``caps`` (..., 2) [N]. Raises ValueError for contacts that
    coincide, and for "least_friction" where both normals lie along their line.
    """
    dx, dy = (points[..., 1, k] - points[..., 0, k] for k in range(2))
    length = np.hypot(dx, dy)
    apart = (length > 0.0) & np.isfinite(length)
    check_all(apart, length, "distance of the contacts", "finite and > 0", "m")
    ex = dx / length
    ey = dy / length
    n1x, n1y = (normals[..., 0, k] for k in range(2))
    n2x, n2y = (normals[..., 1, k] for k in range(2))
    n1e = ex * n1x + ey * n1y
    n1m = ex * n1y - ey * n1x
    n2e = ex * n2x + ey * n2y
    n2m = ex * n2y - ey * n2x
    part: Sequence[Array] = figures(0.5, 0.0, 0.0)
    if split == "least_friction":
        squares = n1m * n1m + n2m * n2m
        check_all(
            squares >= FACING * FACING,
            np.sqrt(squares),
            "sine of the normals to the line of contacts",
            f">= {FACING}, or split 'least_force'",
        )
        part = (n2m * n2m / squares, n1m * n1e / squares, -n2m * n2e / squares)
    ends = [points[..., i, k] for i in range(2) for k in range(2)]
    return Pair._make(
        [
            *ends,
            *(n1x, n1y, n2x, n2y),
            *(ex, ey),
            *_first_force(ends, (ex, ey), length, part),
            *_slopes(friction * n1e + n1m, friction * n1e - n1m),
            *_slopes(-friction * n2e - n2m, -friction * n2e + n2m),
            *(friction, rho),
            *(caps[..., 0], caps[..., 1]),
        ]
    )


def _first_force(
    ends: Sequence[Array], e: tuple[Array, Array], length: Array, part: Sequence[Array]
) -> Iterator[Array]:
    """Yield the components x and y of contact 1's force per fx, fy and tau.

    ``part`` are the parts of F.e, g_1 and g_2 in the force along ``e``.
    """
    ex, ey = e
    mid_x = 0.5 * (ends[0] + ends[2])
    mid_y = 0.5 * (ends[1] + ends[3])
    alongs = (ex, ey, 0.0 * ex)
    halves = (-0.5 * ey, 0.5 * ex, 0.0 * ex)
    turnings = (mid_y / length, -mid_x / length, 1.0 / length)
    across = [half - turning for half, turning in zip(halves, turnings, strict=True)]
    forces = [
        part[0] * along + part[1] * g + part[2] * (half + turning)
        for along, half, turning, g in zip(
            alongs, halves, turnings, across, strict=True
        )
    ]
    yield from (ex * s - ey * g for s, g in zip(forces, across, strict=True))
    yield from (ey * s + ex * g for s, g in zip(forces, across, strict=True))


def _slopes(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the slopes of a cone's sides, none of them zero: ``contact_line._apart``."""
    a_along = np.abs(a) < ALONG
    b_along = np.logical_not(a_along) & (np.abs(b) <= ALONG)
    return (
        np.where(a_along, np.copysign(ALONG, -b), a),
        np.where(b_along, np.copysign(ALONG, -a), b),
    )
