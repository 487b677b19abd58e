"""The line through two contacts, and how their forces along it may be split within
friction (docs/mechanics.md, sections 6 and 7).

Let e be the direction from contact 1 to 2, and m = J e. The forces are f_1 = (s, g_1)
and f_2 = (F.e - s, g_2). The components g_1 and g_2 across the line follow from the
wrench; the component s along it is free.
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
        """Components of e [1], length [m] of the line, and its midpoint [m]."""
        if not 0.0 < self.length < math.inf:
            raise InputError(
                f"contacts at {first} and {second} m; need two distinct, finite points"
            )
        self.e = (ex, ey)
        """Unit vector from contact 1 to 2, in B."""
        self.middle = (middle_x, middle_y)

    def in_axes(self, v: Point) -> Point:
        """Components (v.e, v.m) of a vector in B."""
        return in_axis(self.e, v)

    def in_body(self, v: Point) -> Point:
        """Vector in B with components ``v`` along e and m."""
        return from_axis(self.e, v)

    def components(
        self, fx: float, fy: float, tau: float, about: Point = (0.0, 0.0)
    ) -> tuple[float, float, float]:
        """Components (F.e, g_1, g_2) [N] of a wrench whose moment is about the point
        ``about`` [m].

        g_1 = F.m/2 - tau_mid/l and g_2 = F.m/2 + tau_mid/l, where tau_mid is the moment
        about the midpoint and l the length of the line.
        """
        return line_parts(fx, fy, tau, self.figures, about)


def check_pair(
    points: Sequence[Point], normals: Sequence[Point], friction: float, split: Split
) -> None:
    """Raise InputError unless forces can be split over two side contacts.

    They cannot if ``friction`` is negative, a normal is not of unit length, or the
    contacts coincide. The split "least_friction" also excludes two normals that are
    both parallel to the line of contacts.
    """
    check_friction(friction)
    for normal in normals:
        check_normal(normal)
    line = ContactLine(*points)
    (_, n1m), (_, n2m) = (line.in_axes(n) for n in normals)
    if split == "least_friction" and n1m * n1m + n2m * n2m < FACING * FACING:
        raise InputError(
            "contacts that face each other; allowed there: split 'least_force'"
        )
