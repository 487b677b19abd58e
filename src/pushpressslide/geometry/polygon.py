"""Polygons in the plane: area, centroid, validity, distance to an edge."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.pose import Point, cross, turned_left

MIN_AREA = 1e-6
"""Smallest area of a footprint [m^2]."""

STRAIGHT = 1e-6
"""Turn [rad] of the border below which a corner is ignored."""


def signed_area(polygon: tuple[Point, ...]) -> float:
    """Area [m^2], positive if the corners run counter-clockwise."""
    return 0.5 * sum(
        cross(a, b) for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    )


def counter_clockwise(polygon: tuple[Point, ...]) -> tuple[Point, ...]:
    """Corners [m] in counter-clockwise order. The first corner stays first."""
    return polygon if signed_area(polygon) > 0.0 else polygon[:1] + polygon[:0:-1]


def centroid(polygon: tuple[Point, ...]) -> Point:
    """Area centroid [m] of a polygon of non-zero area."""
    x = y = 0.0
    ox, oy = polygon[0]
    moved = tuple((px - ox, py - oy) for px, py in polygon)
    for a, b in zip(moved, moved[1:] + moved[:1], strict=True):
        w = cross(a, b)
        x = x + w * (a[0] + b[0])
        y = y + w * (a[1] + b[1])
    area = signed_area(moved)
    return (ox + x / (6.0 * area), oy + y / (6.0 * area))


def turns(polygon: tuple[Point, ...]) -> list[float]:
    """Exterior angle [rad] of the border at each corner, positive to the left."""
    edges = [
        (b[0] - a[0], b[1] - a[1])
        for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    ]
    return [
        math.atan2(cross(u, v), u[0] * v[0] + u[1] * v[1])
        for u, v in zip(edges[-1:] + edges[:-1], edges, strict=True)
    ]


def without_straight_corners(polygon: tuple[Point, ...]) -> tuple[Point, ...]:
    """Polygon without the corners at which its border does not turn.

    A corner at which the border reverses its direction is kept.
    """
    while len(polygon) > 3:
        straight = [abs(turn) < STRAIGHT for turn in turns(polygon)]
        if not any(straight):
            break
        first = straight.index(True)
        polygon = polygon[:first] + polygon[first + 1 :]
    return polygon


def is_convex(polygon: tuple[Point, ...]) -> bool:
    """Whether a simple polygon with counter-clockwise corners is convex."""
    return all(turn > -STRAIGHT for turn in turns(polygon))


def convex_hull(polygon: tuple[Point, ...]) -> tuple[Point, ...]:
    """Corners [m] of the convex hull, counter-clockwise, without corners on straight
    lines.
    """
    from shapely import Polygon

    hull = Polygon(polygon).convex_hull
    assert isinstance(hull, Polygon)
    ring = tuple((x, y) for x, y in hull.exterior.coords[:-1])
    if signed_area(ring) < 0.0:
        ring = ring[::-1]
    return without_straight_corners(ring)


def border_fault(polygon: tuple[Point, ...]) -> str | None:
    """Reason why corners do not form a simple polygon with a positive area, or None.

    Corners on a straight line are allowed.
    """
    from shapely import Polygon

    if len(set(polygon)) < len(polygon):
        return "two corners are the same"
    area = abs(signed_area(polygon))
    kept = without_straight_corners(polygon)
    for i, turn in enumerate(turns(polygon)):
        if abs(turn) > math.pi - STRAIGHT:
            return f"at corner {i} its edges lie on one line, and it turns back"
    if not Polygon(kept).is_valid:
        return "it crosses itself, or touches itself"
    if area < MIN_AREA:
        return f"its area {area:.3g} m^2 is below {MIN_AREA:g} m^2"
    return None


def distance_to_segment(p: Point, a: Point, b: Point) -> float:
    """Distance [m] from ``p`` to the segment from ``a`` to ``b``."""
    ex = b[0] - a[0]
    ey = b[1] - a[1]
    t = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / (ex * ex + ey * ey)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(p[0] - a[0] - t * ex, p[1] - a[1] - t * ey)


def turn_near(
    corners: Sequence[Point], point: Point, normal: Point, distance: float
) -> float:
    """Largest angle [rad] between ``normal`` and the inward normals of the sides within
    ``distance`` [m] of ``point``.

    ``corners`` are counter-clockwise, ``normal`` is a unit vector into the polygon.
    """
    out = 0.0
    for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
        if distance_to_segment(point, a, b) > distance:
            continue
        own = turned_left((b[0] - a[0], b[1] - a[1]))
        dot = own[0] * normal[0] + own[1] * normal[1]
        out = max(out, abs(math.atan2(cross(own, normal), dot)))
    return out
