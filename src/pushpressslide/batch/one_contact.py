"""Allocation to one side contact, on arrays: the answers of ``allocation.one_contact``.

Source: docs/mechanics.md, sections 2, 3 and 8.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

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
    check_finite,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import columns_of, figures, leading_shape
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.formulas import Column, Columns, where

EXACT = 1e-12  # of the normal force, for 1 m: a moment that is that of the force
SMALL = 1e-9  # of the wrench: an error that is none


class Push(NamedTuple):
    """One side contact as columns; all in B."""

    px: Column  # [m]
    py: Column
    nx: Column  # unit inward normal
    ny: Column
    friction: Column
    rho: Column  # [m]


class Force(NamedTuple):
    """A force [N]."""

    fx: Column
    fy: Column


class OneContact:
    """One side contact; point, normal, friction and rho of any leading shape."""

    def __init__(
        self, point: ArrayLike, normal: ArrayLike, friction: ArrayLike, rho: ArrayLike
    ) -> None:
        """Prepare the contact.

        ``point`` (..., 2) [m] and unit inward ``normal`` (..., 2) in B, ``friction``
        (...), ``rho`` (...) [m]. Raises ValueError as ``one_contact_allocator``.
        """
        p, n, mu, length = figures(point, normal, friction, rho)
        check_last(p, (2,), "point")
        check_last(n, (2,), "normal")
        check_finite(p, "point")
        check_units(n)
        check_frictions(mu)
        check_positive(length, "rho", "m")
        self.push = Push(p[..., 0], p[..., 1], n[..., 0], n[..., 1], mu, length)
        self.shape = leading_shape(self.push)
        """The leading shape of the contact."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about B's
        origin, in B: those of ``one_contact_allocator``.
        """
        rows = wanted(wrenches)
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (wrench_table(rows, shape), columns_of(self.push, shape))
        return allocations(arguments, shape, 1, exact_push, ((OPEN, nearest_push),))


def exact_push(wrench: WrenchColumns, push: Push) -> Columns:
    """Return the allocation of a wrench that the contact can give; open otherwise."""
    fn = wrench.fx * push.nx + wrench.fy * push.ny
    ft = push.nx * wrench.fy - push.ny * wrench.fx
    margin = push.friction * fn - np.abs(ft)
    off = wrench.tau - push.px * wrench.fy + push.py * wrench.fx
    given = (margin >= 0.0) & (np.abs(off) <= EXACT * fn) & is_finite(wrench)
    status = where(given, OK, OPEN)
    return wrench.fx, wrench.fy, fn, margin, status, 0.0, 0.0, 0.0


def nearest_push(wrench: WrenchColumns, push: Push) -> Columns:
    """Return the allocation of the nearest wrench that the contact can give."""
    per_square = 1.0 / (push.rho * push.rho)
    # the normal equations of min |f - F|^2 + (p x f - tau)^2 / rho^2
    ax = -push.py
    ay = push.px
    bx = wrench.fx + ax * wrench.tau * per_square
    by = wrench.fy + ay * wrench.tau * per_square
    stretch = 1.0 + (ax * ax + ay * ay) * per_square
    shared = (ax * bx + ay * by) * per_square / stretch
    gx = bx - ax * shared
    gy = by - ay * shared
    slides = np.abs(push.nx * gy - push.ny * gx) > push.friction * (
        push.nx * gx + push.ny * gy
    )
    edge = nearest_on_edges(wrench, push)
    finite = is_finite(wrench)
    gx = where(finite, where(slides, edge.fx, gx), 0.0)
    gy = where(finite, where(slides, edge.fy, gy), 0.0)
    fn = gx * push.nx + gy * push.ny
    pushes = fn > 0.0
    rx = wrench.fx - gx
    ry = wrench.fy - gy
    rt = wrench.tau - (push.px * gy - push.py * gx)
    scale = np.abs(wrench.fx) + np.abs(wrench.fy) + np.abs(wrench.tau) / push.rho
    error = np.abs(rx) + np.abs(ry) + np.abs(rt) / push.rho
    margin = push.friction * fn - np.abs(push.nx * gy - push.ny * gx)
    status = where(
        pushes,
        where(error <= SMALL * scale, OK, PROJECTED),
        where(scale == 0.0, OK, INFEASIBLE),
    )
    return (
        where(pushes, gx, 0.0),
        where(pushes, gy, 0.0),
        where(pushes, fn, 0.0),
        where(pushes, margin, 0.0),
        status,
        rx,
        ry,
        rt,
    )


def nearest_on_edges(wrench: WrenchColumns, push: Push) -> Force:
    """Return the nearest force on the edges of the friction cone; none where that is
    nearest.
    """
    per_square = 1.0 / (push.rho * push.rho)
    none = (
        wrench.fx * wrench.fx
        + wrench.fy * wrench.fy
        + wrench.tau * wrench.tau * per_square
    )
    left, left_cost = along_edge(wrench, push, push.friction)
    right, right_cost = along_edge(wrench, push, -push.friction)
    on_left = left_cost < none
    fx = where(on_left, left.fx, 0.0)
    fy = where(on_left, left.fy, 0.0)
    cost = where(on_left, left_cost, none)
    on_right = right_cost < cost
    return Force(where(on_right, right.fx, fx), where(on_right, right.fy, fy))


def along_edge(
    wrench: WrenchColumns, push: Push, friction: Column
) -> tuple[Force, Column]:
    """Return the nearest force along the edge of a cone, and its squared error: no
    force where it would have to pull.
    """
    per_square = 1.0 / (push.rho * push.rho)
    ex = push.nx - friction * push.ny
    ey = push.ny + friction * push.nx
    lever = push.px * ey - push.py * ex
    norm = ex * ex + ey * ey + lever * lever * per_square
    along = ex * wrench.fx + ey * wrench.fy + lever * wrench.tau * per_square
    size = where(along > 0.0, along / norm, 0.0)
    rx = wrench.fx - size * ex
    ry = wrench.fy - size * ey
    rt = wrench.tau - size * lever
    cost = rx * rx + ry * ry + rt * rt * per_square
    return Force(size * ex, size * ey), cost
