"""The top of an object, on which a tip can press, in B.

The top of an upright shape has the outline of its base.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.task import ObjectModel

# directions from the CoM in which points are offered, starting at G's x axis
DIRECTIONS = 12
# shares of the distance from the CoM to the edge at which points are offered
SHARES = (0.85, 0.65, 0.4)


def inside_top(body: ObjectModel, point: Point, margin: float) -> bool:
    """Whether ``point`` [m] is at least ``margin`` [m] inside the outline."""
    return body.shape.holds(point, margin, body.center_of_mass)


def room_inside(body: ObjectModel, point: Point) -> float:
    """Depth [half widths] of a centre of pressure at ``point`` [m] inside the base's
    convex hull.

    For each edge of the hull, the distance inside the edge is divided by half the
    hull's width across it; the smallest quotient is the depth. If it is negative, the
    object tips.
    """
    return float(rooms_inside(body, np.array([point]))[0])


def rooms_inside(body: ObjectModel, points: Array) -> Array:
    """``room_inside`` (m,) of ``points`` (m, 2)."""
    return body.shape.depths(points, body.center_of_mass)


def top_places(body: ObjectModel, margin: float) -> list[Point]:
    """Places to press [m], at least ``margin`` [m] inside the outline.

    They lie at fixed fractions of all chords through the CoM in a fixed set of
    directions. The first chord of a convex top starts at the CoM.
    """
    out = []
    for i in range(DIRECTIONS):
        angle = 2.0 * math.pi * i / DIRECTIONS
        u = (math.cos(angle), math.sin(angle))
        for near, far in body.shape.chords(u, margin, body.center_of_mass):
            if far > margin:
                places = (near + share * (far - near) for share in SHARES)
                out += [(place * u[0], place * u[1]) for place in places]
    return out
