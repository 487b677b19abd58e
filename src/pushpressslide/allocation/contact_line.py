"""The line through two contacts, and what a wrench leaves open of their forces (docs/mechanics.md, sections
6 and 7).

In the axes e, from contact 1 to 2, and m = J e the forces are f_1 = (s, g_1) and f_2 = (F.e - s, g_2): the
parts across the line follow from the wrench, how the part along it is split is free.
"""

from __future__ import annotations

import math

from pushpressslide.core.pose import Point


class ContactLine:
    """The line from contact ``first`` to ``second`` [m], both in B; raises ValueError if they coincide."""

    __slots__ = ("e", "length", "middle")

    def __init__(self, first: Point, second: Point) -> None:
        self.length = math.dist(first, second)
        """[m]"""
        if not self.length > 0.0:
            raise ValueError(f"contacts at {first} and {second} m; need two distinct points")
        self.e = ((second[0] - first[0]) / self.length, (second[1] - first[1]) / self.length)
        """Unit vector from contact 1 to 2, in B."""
        self.middle = (0.5 * (first[0] + second[0]), 0.5 * (first[1] + second[1]))

    def in_axes(self, v: Point) -> Point:
        """Return (v.e, v.m) of a vector in B."""
        ex, ey = self.e
        return (ex * v[0] + ey * v[1], ex * v[1] - ey * v[0])

    def in_body(self, v: Point) -> Point:
        """Return in B the vector with components ``v`` in the axes e and m."""
        ex, ey = self.e
        return (ex * v[0] - ey * v[1], ey * v[0] + ex * v[1])

    def parts(self, fx: float, fy: float, tau: float, about: Point = (0.0, 0.0)) -> tuple[float, float, float]:
        """Return (F.e, g_1, g_2) [N] of a wrench with its moment about ``about`` [m].

        g_1 = F.m/2 - tau_mid/l and g_2 = F.m/2 + tau_mid/l, tau_mid the moment about the middle.
        """
        along, across = self.in_axes((fx, fy))
        moment = tau - (self.middle[0] - about[0]) * fy + (self.middle[1] - about[1]) * fx
        turning = moment / self.length
        return along, 0.5 * across - turning, 0.5 * across + turning
