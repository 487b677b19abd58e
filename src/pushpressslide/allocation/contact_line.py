"""The line through two contacts: what a wrench leaves open of their forces, and how
friction bounds that (docs/mechanics.md, sections 6 and 7).

In the axes e, from contact 1 to 2, and m = J e the forces are f_1 = (s, g_1) and f_2 =
(F.e - s, g_2): the parts across the line follow from the wrench, how the part along it
is split is free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, from_axis, in_axis
from pushpressslide.kernels.contact_line import contact_line, line_parts
from pushpressslide.mechanics.checks import check_friction, check_normal

Split = Literal["least_friction", "least_force"]
ALONG = 1e-9  # sine below which the side of a cone counts as along the line of contacts
# sine of the angle to the line of contacts within which friction leaves the split open
FACING = 0.03


class ContactLine:
    """The line from contact ``first`` to ``second`` [m], both in B.

    Raises InputError if they coincide.
    """

    __slots__ = ("e", "figures", "length", "middle")

    def __init__(self, first: Point, second: Point) -> None:
        self.figures = contact_line(first, second)
        ex, ey, self.length, middle_x, middle_y = self.figures
        """[m]"""
        if not 0.0 < self.length < math.inf:
            raise InputError(
                f"contacts at {first} and {second} m; need two distinct, finite points"
            )
        self.e = (ex, ey)
        """Unit vector from contact 1 to 2, in B."""
        self.middle = (middle_x, middle_y)

    def in_axes(self, v: Point) -> Point:
        """Return (v.e, v.m) of a vector in B."""
        return in_axis(self.e, v)

    def in_body(self, v: Point) -> Point:
        """Return in B the vector with components ``v`` in the axes e and m."""
        return from_axis(self.e, v)

    def parts(
        self, fx: float, fy: float, tau: float, about: Point = (0.0, 0.0)
    ) -> tuple[float, float, float]:
        """Return (F.e, g_1, g_2) [N] of a wrench with its moment about ``about`` [m].

        g_1 = F.m/2 - tau_mid/l and g_2 = F.m/2 + tau_mid/l, tau_mid the moment about
        the middle.
        """
        return line_parts(fx, fy, tau, self.figures, about)


class ContactPair:
    """Two side contacts: how a wrench is split over them, and how their friction cones
    bound the split.

    A force d [N] more of contact 1 along e, and of contact 2 against it, leaves the
    wrench as it is. It changes the slack q of each side of the cones to q + a d. Raises
    ValueError as ``two_contact_allocator``.
    """

    __slots__ = ("_weights", "line", "n1e", "n2e", "slopes")

    def __init__(
        self,
        points: Sequence[Point],
        normals: Sequence[Point],
        friction: float,
        split: Split,
    ) -> None:
        check_friction(friction)
        for normal in normals:
            check_normal(normal)
        self.line = ContactLine(*points)
        (n1e, n1m), (n2e, n2m) = (self.line.in_axes(n) for n in normals)
        self.n1e = n1e
        self.n2e = n2e
        self.slopes = (
            *_apart(friction * n1e + n1m, friction * n1e - n1m),
            *_apart(-friction * n2e - n2m, -friction * n2e + n2m),
        )
        """a of the slacks mu f_n - f_t, mu f_n + f_t of contact 1, then of contact 2;
        none of them zero.
        """
        self._weights = (0.5, 0.0, 0.0)
        if split == "least_friction":
            squares = n1m * n1m + n2m * n2m
            if squares < FACING * FACING:
                raise InputError(
                    "contacts that face each other; allowed there: split 'least_force'"
                )
            self._weights = (
                n2m * n2m / squares,
                n1m * n1e / squares,
                -n2m * n2e / squares,
            )

    def first_force(self, fx: float, fy: float, tau: float) -> Point:
        """Return the force [N] of contact 1, in B, that the split asks for."""
        along, g1, g2 = self.line.parts(fx, fy, tau)
        a, b, c = self._weights
        return self.line.in_body((a * along + b * g1 + c * g2, g1))


def _apart(a: float, b: float) -> tuple[float, float]:
    """Return the slopes of a cone's sides, none of them zero.

    A side along the line of contacts bounds nothing if its slack is >= 0, and else
    leaves nothing: as a bound far off, opposite to that of the other side.
    """
    if abs(a) < ALONG:
        return math.copysign(ALONG, -b), b
    return a, b if abs(b) > ALONG else math.copysign(ALONG, -a)
