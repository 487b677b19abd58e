"""Allocation to a press and a push, on arrays: the answers of
``allocation.press_and_push``.

Source: docs/mechanics.md, section 7.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.allocation.press_and_push import LEAST_LEVER
from pushpressslide.batch.allocations import (
    INFEASIBLE,
    OK,
    PROJECTED,
    Allocations,
    allocations,
    is_finite,
    wanted,
    wrench_table,
)
from pushpressslide.batch.checks import (
    check_all,
    check_finite,
    check_frictions,
    check_last,
    check_positive,
    check_units,
)
from pushpressslide.batch.elementwise import columns_of, figures, leading_shape
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.formulas import Column, Columns, greater, least, where

ROUNDING = 1e-12  # of the disc's radius, allowed beyond it


class PressPush(NamedTuple):
    """A press and a push as columns; in B."""

    ex: Column  # unit vector from the press to the push
    ey: Column
    px: Column  # [m] from the centre of pressure to the press
    py: Column
    lever: Column  # [m] of the push about the press
    nx: Column  # unit inward normal of the push
    ny: Column
    load: Column  # [N] of the press
    friction: Column


class PressAndPush:
    """A press and a push; all figures of any leading shape."""

    def __init__(
        self,
        press: ArrayLike,
        load: ArrayLike,
        push: ArrayLike,
        normal: ArrayLike,
        friction: ArrayLike,
        cop: ArrayLike = (0.0, 0.0),
    ) -> None:
        """Prepare the contacts.

        ``press``, ``push`` and ``cop`` (..., 2) [m] and unit inward ``normal`` (..., 2)
        in B, ``load`` (...) [N], ``friction`` (...). Raises ValueError as
        ``press_and_push_allocator``.
        """
        p, n, q, normals, mu, center = figures(press, load, push, normal, friction, cop)
        for array, name in ((p, "press"), (q, "push"), (normals, "normal")):
            check_last(array, (2,), name)
        check_last(center, (2,), "cop")
        check_finite(center, "cop")
        check_positive(n, "load", "N")
        check_frictions(mu)
        check_units(normals)
        dx, dy = (q[..., k] - p[..., k] for k in range(2))
        length = np.hypot(dx, dy)
        apart = (length > 0.0) & np.isfinite(length)
        check_all(apart, length, "distance of the contacts", "finite and > 0", "m")
        nx, ny = (normals[..., k] for k in range(2))
        lever = dx * ny - dy * nx
        check_all(np.abs(lever) > LEAST_LEVER, lever, "lever of the push", "not 0", "m")
        px, py = (p[..., k] - center[..., k] for k in range(2))
        self.contacts = PressPush(
            dx / length, dy / length, px, py, lever, nx, ny, n, mu
        )
        self.shape = leading_shape(self.contacts)
        """The leading shape of the contacts."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about the
        centre of pressure, in B: those of ``press_and_push_allocator``.
        """
        rows = wanted(wrenches)
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (wrench_table(rows, shape), columns_of(self.contacts, shape))
        return allocations(arguments, shape, 2, held_and_pushed, ())


class Interval(NamedTuple):
    """An interval of forces [N]; reversed if empty."""

    low: Column
    high: Column


def held_and_pushed(wrench: WrenchColumns, c: PressPush) -> Columns:
    """Return the allocation: the push turns the object about the press."""
    finite = is_finite(wrench)
    most = c.friction * c.load
    a = (wrench.tau - c.px * wrench.fy + c.py * wrench.fx) / c.lever
    along = c.ex * c.nx + c.ey * c.ny
    left = c.nx * c.ey - c.ny * c.ex
    right_side = side_interval(c.friction * a, c.friction * along - left)
    left_side = side_interval(c.friction * a, c.friction * along + left)
    low = greater(right_side.low, left_side.low)
    high = least(right_side.high, left_side.high)
    # the sides of a cone without friction do not tell a pull from a push
    pulls = (low > high) | ((c.friction == 0.0) & (a < 0.0))
    gx = wrench.fx - a * c.nx
    gy = wrench.fy - a * c.ny
    middle = gx * c.ex + gy * c.ey
    square = middle * middle - gx * gx - gy * gy + most * most
    room = np.sqrt(greater(square, 0.0))
    s = where(pulls, 0.0, least_along(low, high, middle, room))
    a = where(pulls, 0.0, a)
    gx = wrench.fx - a * c.nx - s * c.ex
    gy = wrench.fy - a * c.ny - s * c.ey
    size = np.sqrt(gx * gx + gy * gy)
    some = (gx != 0.0) | (gy != 0.0)  # its square may be too small to be a number
    slips = (size > most * (1.0 + ROUNDING)) | (some & (most == 0.0))
    part = where(size > 0.0, most / size, 0.0)
    scale = where(finite, where(slips, part, 1.0), 0.0)
    pressed_x = where(finite, scale * gx, 0.0)
    pressed_y = where(finite, scale * gy, 0.0)
    pushed_x = where(finite, scale * (a * c.nx + s * c.ex), 0.0)
    pushed_y = where(finite, scale * (a * c.ny + s * c.ey), 0.0)
    f_n = pushed_x * c.nx + pushed_y * c.ny
    f_t = c.nx * pushed_y - c.ny * pushed_x
    margin = least(most - scale * size, c.friction * f_n - np.abs(f_t))
    x = pressed_x + pushed_x
    y = pressed_y + pushed_y
    moment = where(finite, c.px * y - c.py * x + scale * a * c.lever, 0.0)
    changed = pulls | slips
    none = (x == 0.0) & (y == 0.0) & (moment == 0.0)
    lost = where(none, INFEASIBLE, PROJECTED)
    status = where(finite, where(changed, lost, OK), INFEASIBLE)
    counts = changed | (status == INFEASIBLE)
    return (
        pressed_x,
        pressed_y,
        pushed_x,
        pushed_y,
        c.load,
        f_n,
        where(finite, margin, 0.0),
        status,
        where(counts, wrench.fx - x, 0.0),
        where(counts, wrench.fy - y, 0.0),
        where(counts, wrench.tau - moment, 0.0),
    )


def side_interval(slack: Column, slope: Column) -> Interval:
    """Return the interval of s in which ``slack + slope s >= 0``; reversed if none."""
    bound = -slack / slope
    empty = (slope == 0.0) & (slack < 0.0)
    low = where(slope > 0.0, bound, where(empty, math.inf, -math.inf))
    return Interval(low, where(slope < 0.0, bound, math.inf))


def least_along(low: Column, high: Column, middle: Column, room: Column) -> Column:
    """Return the least part of the push along the line, in [low, high], that is within
    ``room`` of ``middle``; the nearest to that where none is.
    """
    bottom = greater(low, middle - room)
    top = least(high, middle + room)
    inside = least(greater(0.0, bottom), top)
    return where(bottom <= top, inside, least(greater(middle, low), high))
