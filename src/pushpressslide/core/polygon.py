"""Polygons in the plane: area, centroid, convexity, and the distance to an edge."""

from __future__ import annotations

import math

from pushpressslide.core.pose import Point, cross

MIN_AREA = 1e-6
"""Least area of a footprint [m^2]."""


def signed_area(polygon: tuple[Point, ...]) -> float:
    """Return the area [m^2]; it is positive if the corners run counter-clockwise."""
    return 0.5 * sum(
        cross(a, b) for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    )


def centroid(polygon: tuple[Point, ...]) -> Point:
    """Return the area centroid [m] of a polygon of non-zero area."""
    x = y = 0.0
    ox, oy = polygon[0]
    moved = tuple((px - ox, py - oy) for px, py in polygon)
    for a, b in zip(moved, moved[1:] + moved[:1], strict=True):
        w = cross(a, b)
        x = x + w * (a[0] + b[0])
        y = y + w * (a[1] + b[1])
    area = signed_area(moved)
    return (ox + x / (6.0 * area), oy + y / (6.0 * area))


def convexity_fault(polygon: tuple[Point, ...]) -> str | None:
    """Return why a polygon is not simple, strictly convex and of positive area.

    None if it is.
    """
    n = len(polygon)
    if len(set(polygon)) < n:
        return "two corners are the same"
    edges = [
        (b[0] - a[0], b[1] - a[1])
        for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    ]
    turns = []
    for u, v in zip(edges, edges[1:] + edges[:1], strict=True):
        turns.append(math.atan2(cross(u, v), u[0] * v[0] + u[1] * v[1]))
    for i, turn in enumerate(turns):
        if abs(turn) < 1e-6 or abs(turn) > math.pi - 1e-6:
            return f"corner {(i + 1) % n} is no corner: its edges lie on one line"
    if any(t > 0 for t in turns) and any(t < 0 for t in turns):
        return "it is not convex"
    if abs(sum(turns)) > 2.0 * math.pi + 1e-3:
        return "it crosses itself"
    if abs(signed_area(polygon)) < MIN_AREA:
        return f"its area {abs(signed_area(polygon)):.3g} m^2 is below {MIN_AREA:g} m^2"
    return None


def distance_to_segment(p: Point, a: Point, b: Point) -> float:
    """Return the distance [m] from ``p`` to the segment from ``a`` to ``b``."""
    ex = b[0] - a[0]
    ey = b[1] - a[1]
    t = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / (ex * ex + ey * ey)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(p[0] - a[0] - t * ex, p[1] - a[1] - t * ey)
