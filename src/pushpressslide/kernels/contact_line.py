"""The line through two contacts, and the components of a wrench along and across it
(docs/mechanics.md, sections 6 and 7).
"""

from __future__ import annotations

from math import hypot

from pushpressslide.kernels.allocation import Vector, Wrench
from pushpressslide.kernels.kernel import kernel

Line = tuple[float, float, float, float, float]
"""Line through two contacts: unit vector x, y in B from contact 1 to 2, distance [m],
and midpoint x, y [m] in B.
"""


@kernel
def contact_line(first: Vector, second: Vector) -> Line:
    """Line from one contact to the other. The direction is zero if the contacts
    coincide.
    """
    dx = second[0] - first[0]
    dy = second[1] - first[1]
    length = hypot(dx, dy)
    middle_x = 0.5 * (first[0] + second[0])
    middle_y = 0.5 * (first[1] + second[1])
    if length == 0.0:
        return 0.0, 0.0, length, middle_x, middle_y
    return dx / length, dy / length, length, middle_x, middle_y


@kernel
def line_parts(fx: float, fy: float, tau: float, line: Line, about: Vector) -> Wrench:
    """Components (F.e, g_1, g_2) [N] of a wrench whose moment is about the point
    ``about`` [m].

    g_1 = F.m/2 - tau_mid/l and g_2 = F.m/2 + tau_mid/l, where tau_mid is the moment
    about the midpoint and l the length of the line.
    """
    ex, ey, length, middle_x, middle_y = line
    along = ex * fx + ey * fy
    across = ex * fy - ey * fx
    moment = tau - (middle_x - about[0]) * fy + (middle_y - about[1]) * fx
    turning = moment / length
    return along, 0.5 * across - turning, 0.5 * across + turning
