"""Allocation to one or two presses, on arrays: the answers of ``allocation.one_press``
and ``allocation.presses``.

Source: docs/mechanics.md, sections 4, 7 and 8.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.allocation.presses import NOTHING, ROUNDING
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
    check_all,
    check_finite,
    check_frictions,
    check_last,
    check_positive,
)
from pushpressslide.batch.elementwise import columns_of, figures, leading_shape, table
from pushpressslide.batch.wrench_twist import WrenchColumns
from pushpressslide.core.formulas import Column, Columns, greater, least, where

EXACT = 1e-12  # of the friction: a moment, for 1 m, that is that of the force
KEPT = 1e-9  # of a wrench: what it may lose and count as given
LITTLE = 1e-30  # square of a force along the line, over those across it, that is none


class Press(NamedTuple):
    """One press as columns; in B."""

    rx: Column  # [m] from the centre of pressure to the contact
    ry: Column
    load: Column  # [N]
    friction: Column
    rho: Column  # [m]


class OnePress:
    """One press; point, load, friction, rho and centre of pressure of any leading
    shape.
    """

    def __init__(
        self,
        point: ArrayLike,
        load: ArrayLike,
        friction: ArrayLike,
        rho: ArrayLike,
        cop: ArrayLike = (0.0, 0.0),
    ) -> None:
        """Prepare the press.

        ``point`` (..., 2) [m] in B, ``load`` (...) [N], ``friction`` (...), ``rho``
        (...) [m], ``cop`` (..., 2) [m] in B. Raises ValueError as
        ``one_press_allocator``.
        """
        p, n, mu, length, center = figures(point, load, friction, rho, cop)
        check_last(p, (2,), "point")
        check_last(center, (2,), "cop")
        check_finite(p, "point")
        check_finite(center, "cop")
        check_positive(n, "load", "N")
        check_frictions(mu)
        check_positive(length, "rho", "m")
        arm = p - center
        self.press = Press(arm[..., 0], arm[..., 1], n, mu, length)
        self.shape = leading_shape(self.press)
        """The leading shape of the press."""

    def allocate(self, wrenches: ArrayLike) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about the
        centre of pressure, in B: those of ``one_press_allocator``.
        """
        rows = wanted(wrenches)
        shape = np.broadcast_shapes(rows.shape[:-1], self.shape)
        arguments = (wrench_table(rows, shape), columns_of(self.press, shape))
        return allocations(arguments, shape, 1, pressed, ())


def pressed(wrench: WrenchColumns, press: Press) -> Columns:
    """Return the allocation of the nearest direction, then on the disc."""
    most = press.friction * press.load
    off = wrench.tau - press.rx * wrench.fy + press.ry * wrench.fx
    size = np.sqrt(wrench.fx * wrench.fx + wrench.fy * wrench.fy)
    given = (size <= most) & (np.abs(off) <= EXACT * most)
    per_square = 1.0 / (press.rho * press.rho)
    # least squares of (f - F, (r x f - tau) / rho) over f
    stretch = 1.0 + (press.rx * press.rx + press.ry * press.ry) * per_square
    k = where(given, 0.0, off * per_square / stretch)
    gx = wrench.fx - k * press.ry
    gy = wrench.fy + k * press.rx
    size = np.sqrt(gx * gx + gy * gy)
    scale = where(size > most, most / size, 1.0)
    finite = is_finite(wrench)
    fx = where(finite, gx * scale, 0.0)
    fy = where(finite, gy * scale, 0.0)
    margin = where(finite, most - least(size, most), 0.0)
    status = where(finite, where(given, OK, PROJECTED), INFEASIBLE)
    rt = wrench.tau - (press.rx * fy - press.ry * fx)
    return fx, fy, press.load, margin, status, wrench.fx - fx, wrench.fy - fy, rt


class PressPair(NamedTuple):
    """Two presses as columns; in B."""

    ex: Column  # unit vector from contact 1 to 2
    ey: Column
    length: Column  # [m] between the contacts
    mid_x: Column  # [m] the middle
    mid_y: Column
    friction: Column


class Loads(NamedTuple):
    """Two normal forces [N]."""

    first: Column
    second: Column


class Place(NamedTuple):
    """A centre of pressure [m], in B."""

    x: Column
    y: Column


class Parts(NamedTuple):
    """Parts of a wrench along and across the line of contacts [N], and the discs."""

    along: Column
    g1: Column
    g2: Column
    most1: Column  # radii of the discs
    most2: Column


class TwoPresses:
    """Two presses; points and friction of any leading shape."""

    def __init__(self, points: ArrayLike, friction: ArrayLike) -> None:
        """Prepare the presses.

        ``points`` (..., 2, 2) [m] in B, ``friction`` (...). Raises ValueError as
        ``two_press_allocator``.
        """
        p, mu = figures(points, friction)
        check_last(p, (2, 2), "points")
        check_frictions(mu)
        dx, dy = (p[..., 1, k] - p[..., 0, k] for k in range(2))
        length = np.hypot(dx, dy)
        apart = (length > 0.0) & np.isfinite(length)
        check_all(apart, length, "distance of the contacts", "finite and > 0", "m")
        middle = 0.5 * (p[..., 0, :] + p[..., 1, :])
        self.pair = PressPair(
            dx / length, dy / length, length, middle[..., 0], middle[..., 1], mu
        )
        self.shape = leading_shape(self.pair)
        """The leading shape of the presses."""

    def allocate(
        self, wrenches: ArrayLike, normals: ArrayLike, cops: ArrayLike = (0.0, 0.0)
    ) -> Allocations:
        """Return the allocations (...) of ``wrenches`` (..., 3) [N, N m] about ``cops``
        (..., 2) [m], in B, pressed with ``normals`` (..., 2) [N]: those of
        ``two_press_allocator``.
        """
        rows = wanted(wrenches)
        loads, places = figures(normals, cops)
        check_last(loads, (2,), "normals")
        check_last(places, (2,), "cops")
        shape = np.broadcast_shapes(
            rows.shape[:-1], loads.shape[:-1], places.shape[:-1], self.shape
        )
        arguments = (
            wrench_table(rows, shape),
            table(Loads, loads, shape),
            columns_of(Place(places[..., 0], places[..., 1]), shape),
            columns_of(self.pair, shape),
        )
        return allocations(arguments, shape, 2, inside_discs, ((OPEN, onto_discs),))


def disc_parts(
    wrench: WrenchColumns, loads: Loads, cop: Place, pair: PressPair
) -> Parts:
    """Return what a wrench asks of two discs."""
    along = pair.ex * wrench.fx + pair.ey * wrench.fy
    half = 0.5 * (pair.ex * wrench.fy - pair.ey * wrench.fx)
    arm_x = pair.mid_x - cop.x
    arm_y = pair.mid_y - cop.y
    turning = (wrench.tau - arm_x * wrench.fy + arm_y * wrench.fx) / pair.length
    most1 = pair.friction * loads.first
    most2 = pair.friction * loads.second
    return Parts(along, half - turning, half + turning, most1, most2)


def inside_discs(
    wrench: WrenchColumns, loads: Loads, cop: Place, pair: PressPair
) -> Columns:
    """Return the allocation of a wrench that the discs can give; open otherwise."""
    p = disc_parts(wrench, loads, cop, pair)
    room1 = np.sqrt(greater(p.most1 * p.most1 - p.g1 * p.g1, 0.0))
    room2 = np.sqrt(greater(p.most2 * p.most2 - p.g2 * p.g2, 0.0))
    room = room1 + room2
    held = (np.abs(p.g1) <= p.most1) & (np.abs(p.g2) <= p.most2)
    pressed = (loads.first >= 0.0) & (loads.second >= 0.0)
    given = held & (np.abs(p.along) <= room) & (room < math.inf) & is_finite(wrench)
    given = given & pressed
    s = where(room > 0.0, p.along * room1 / room, 0.0)
    f1x = s * pair.ex - p.g1 * pair.ey
    f1y = s * pair.ey + p.g1 * pair.ex
    f2x = wrench.fx - f1x
    f2y = wrench.fy - f1y
    margin = least(
        p.most1 - np.sqrt(f1x * f1x + f1y * f1y),
        p.most2 - np.sqrt(f2x * f2x + f2y * f2y),
    )
    status = where(given, OK, OPEN)
    n1 = loads.first
    n2 = loads.second
    return f1x, f1y, f2x, f2y, n1, n2, margin, status, 0.0, 0.0, 0.0


def onto_discs(
    wrench: WrenchColumns, loads: Loads, cop: Place, pair: PressPair
) -> Columns:
    """Return the allocation of a wrench scaled onto the discs."""
    p = disc_parts(wrench, loads, cop, pair)
    most1 = greater(p.most1, 0.0)
    most2 = greater(p.most2, 0.0)
    rounding = ROUNDING * (most1 + most2)
    most1 = most1 + rounding
    most2 = most2 + rounding
    square = least_square(p.along, p.g1, p.g2, most1, most2)
    scale = where(square > 1.0, 1.0 / np.sqrt(square), 1.0)
    size = np.abs(p.along) + np.abs(p.g1) + np.abs(p.g2)
    finite = (size + loads.first + loads.second < math.inf) & is_finite(wrench)
    finite = finite & (loads.first >= 0.0) & (loads.second >= 0.0)
    some = finite & (scale > NOTHING)
    g1 = scale * p.g1
    g2 = scale * p.g2
    room1 = np.sqrt(greater(most1 * most1 - g1 * g1, 0.0))
    room = room1 + np.sqrt(greater(most2 * most2 - g2 * g2, 0.0))
    s = where(room > 0.0, scale * p.along * room1 / room, 0.0)
    f1x = s * pair.ex - g1 * pair.ey
    f1y = s * pair.ey + g1 * pair.ex
    f2x = scale * wrench.fx - f1x
    f2y = scale * wrench.fy - f1y
    margin = least(
        most1 - np.sqrt(f1x * f1x + f1y * f1y), most2 - np.sqrt(f2x * f2x + f2y * f2y)
    )
    lost = 1.0 - scale
    status = where(some, where(lost <= KEPT, OK, PROJECTED), INFEASIBLE)
    return (
        where(some, f1x, 0.0),
        where(some, f1y, 0.0),
        where(some, f2x, 0.0),
        where(some, f2y, 0.0),
        loads.first,
        loads.second,
        where(some, margin, 0.0),
        status,
        where(some, lost * wrench.fx, wrench.fx),
        where(some, lost * wrench.fy, wrench.fy),
        where(some, lost * wrench.tau, wrench.tau),
    )


def least_square(
    along: Column, g1: Column, g2: Column, most1: Column, most2: Column
) -> Column:
    """Return the least square x by which two discs have to grow to hold a wrench: the
    least with sqrt(a1 x - b1) + sqrt(a2 x - b2) >= e, as ``presses.largest_scale``.
    """
    a1 = most1 * most1
    a2 = most2 * most2
    b1 = g1 * g1
    b2 = g2 * g2
    e = np.abs(along)
    square = e * e
    x = greater(where(a1 > 0.0, b1 / a1, 0.0), where(a2 > 0.0, b2 / a2, 0.0))
    first = np.sqrt(greater(a1 * x - b1, 0.0))
    held = (square <= LITTLE * (b1 + b2)) | (
        first + np.sqrt(greater(a2 * x - b2, 0.0)) >= e
    )
    inner = a1 * a2 * square + (a1 - a2) * (a2 * b1 - a1 * b2)
    root = np.sqrt(greater(inner, 0.0))
    numerator = square * (square + 2.0 * (b1 + b2)) + (b1 - b2) * (b1 - b2)
    denominator = square * (a1 + a2) + (a1 - a2) * (b1 - b2) + 2.0 * e * root
    grown = where(held | (denominator == 0.0), x, numerator / denominator)
    never = (
        ((a1 == 0.0) & (b1 > 0.0))
        | ((a2 == 0.0) & (b2 > 0.0))
        | ((a1 == 0.0) & (a2 == 0.0) & (e > 0.0))
    )
    return where(never, math.inf, grown)
