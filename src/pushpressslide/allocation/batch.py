"""The allocators on arrays: the same forces as one call at a time, for sampling and
learning. No projection.

Arrays in, arrays out, without branches; ``feasible`` says which rows hold.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pushpressslide.allocation.contact_line import ContactLine, ContactPair, Split
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.mechanics.checks import check_friction

Flags = NDArray[np.bool_]
ROUNDING = 1e-9  # of the forces: by so much a cone without friction may be missed


def push_forces(
    points: Sequence[Point],
    normals: Sequence[Point],
    friction: float,
    wrenches: Array,
    *,
    split: Split = "least_friction",
) -> tuple[Array, Flags]:
    """Return (forces (n, 2, 2) [N], feasible (n,)) of two side contacts for
    ``wrenches`` (n, 3) about B's origin.

    As ``two_contact_allocator`` without caps; forces of rows that are not feasible are
    not meant to be used. Rows that are not finite are not feasible, with zero forces.
    """
    finite: Flags = np.all(np.isfinite(wrenches), axis=1)
    wrenches = np.where(finite[:, None], wrenches, 0.0)
    pair = ContactPair(points, normals, friction, split)
    first = wrenches @ np.array(
        [pair.first_force(*unit) for unit in np.eye(3).tolist()]
    )
    forces = np.stack([first, wrenches[:, :2] - first], axis=1)
    inward = np.array(normals)
    push = np.einsum("nij,ij->ni", forces, inward)
    left = inward[:, 0] * forces[:, :, 1] - inward[:, 1] * forces[:, :, 0]
    slacks = np.stack([friction * push - left, friction * push + left], axis=2).reshape(
        -1, 4
    )
    slopes = np.array(pair.slopes)
    bounds = -slacks / slopes
    low = np.where(slopes > 0.0, bounds, -np.inf).max(axis=1)
    high = np.where(slopes < 0.0, bounds, np.inf).min(axis=1)
    shift = np.where(low <= high, np.clip(0.0, low, high), 0.0)[:, None] * np.array(
        pair.line.e
    )
    forces[:, 0] += shift
    forces[:, 1] -= shift
    rounding = ROUNDING * np.abs(forces).sum(axis=(1, 2))
    push = np.einsum("nij,ij->ni", forces, inward)
    pushing = push.min(axis=1) >= -rounding
    return forces, finite & pushing & (low <= high + rounding)


def press_forces(
    points: Sequence[Point],
    friction: float,
    wrenches: Array,
    normals: Array,
    cops: Array,
) -> tuple[Array, Flags]:
    """Return (forces (n, 2, 2) [N], feasible (n,)) of two top contacts for ``wrenches``
    (n, 3) about ``cops`` (n, 2) [m], pressed with ``normals`` (n, 2) [N].

    As ``two_press_allocator``; forces of rows that are not feasible are not meant to be
    used. Rows that are not finite are not feasible, with zero forces.
    """
    check_friction(friction)
    told = np.hstack([wrenches, normals, cops])
    finite: Flags = np.all(np.isfinite(told), axis=1)
    wrenches = np.where(finite[:, None], wrenches, 0.0)
    cops = np.where(finite[:, None], cops, 0.0)
    line = ContactLine(*points)
    ex, ey = line.e
    fx, fy, tau = wrenches.T
    along = ex * fx + ey * fy
    half = 0.5 * (ex * fy - ey * fx)
    arm = np.array(line.middle) - cops
    turning = (tau - arm[:, 0] * fy + arm[:, 1] * fx) / line.length
    across = np.stack([half - turning, half + turning], axis=1)
    most = friction * normals
    inside = (np.abs(across) <= most).all(axis=1)
    room = np.sqrt(np.maximum(most**2 - across**2, 0.0))
    total = room.sum(axis=1)
    share = np.divide(room[:, 0], total, out=np.zeros_like(total), where=total > 0.0)
    s = along * share
    first = np.stack([s * ex - across[:, 0] * ey, s * ey + across[:, 0] * ex], axis=1)
    return np.stack([first, wrenches[:, :2] - first], axis=1), finite & inside & (
        np.abs(along) <= total
    )
