"""Footprints in the scene: overlaps, gaps, and what a ledge or an opening carries."""

from __future__ import annotations

import math

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Opening, Shape


def overlap_area(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Return the area [m^2] that two footprints share."""
    return float(shape_1.placed(X_W1).intersection(shape_2.placed(X_W2)).area)


def gap(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Return the distance [m] between two footprints; zero where they overlap."""
    return float(shape_1.placed(X_W1).distance(shape_2.placed(X_W2)))


def depth_beside(shape: Shape, X_WG: Pose2, opening: Opening, point: Point) -> float:
    """Return the depth [m] of a point in what an opening leaves of a footprint.

    What is left counts with its convex hull. The depth is negative outside, and
    infinite where no part of the footprint is over the opening.
    """
    from shapely import Point as Place
    from shapely import box

    w, h = opening.size
    x, y = opening.center
    whole = shape.placed(X_WG)
    rest = whole.difference(box(x - 0.5 * w, y - 0.5 * h, x + 0.5 * w, y + 0.5 * h))
    if rest.area == whole.area:
        return math.inf
    if rest.is_empty:
        return -math.inf
    hull = rest.convex_hull
    place = Place(point)
    if hull.covers(place):
        return float(hull.boundary.distance(place))
    return -float(hull.distance(place))


def around(
    shape: Shape, X_WG: Pose2, distance: float, count: int
) -> tuple[list[Point], float]:
    """Return ``count`` points even around a footprint, ``distance`` [m] off it, and how
    far apart [m].
    """
    line = shape.placed(X_WG).buffer(distance).exterior
    points = [line.interpolate(i / count, normalized=True) for i in range(count)]
    return [(p.x, p.y) for p in points], float(line.length) / count
