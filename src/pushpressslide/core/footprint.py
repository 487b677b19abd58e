"""Footprints of a task's bodies: convexity, centroid, and whether two of them overlap."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point, Pose2, cross
from pushpressslide.core.task import Box, Cylinder, Opening, Shape, Task

if TYPE_CHECKING:
    from shapely import Polygon

MIN_AREA = 1e-6
"""Least area of a footprint [m^2]."""

LEDGE_GAP = 2e-3
"""Gap to a ledge below it at which an object counts as lying on it [m]."""


def signed_area(polygon: tuple[Point, ...]) -> float:
    """Return the area [m^2] of a polygon, positive if its corners run
    counter-clockwise.
    """
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
    """Return why a polygon is not simple, strictly convex and of positive area, or None
    if it is.
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


def depth_inside(shape: Shape, point: Point) -> float:
    """Return how far [m] a point, in G, lies inside the footprint; negative outside."""
    if isinstance(shape, Cylinder):
        return shape.radius - math.hypot(*point)
    corners = shape.footprint
    depths = []
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        edge = (b[0] - a[0], b[1] - a[1])
        depths.append(
            cross(edge, (point[0] - a[0], point[1] - a[1])) / math.hypot(*edge)
        )
    return min(depths)


def distance_outside(shape: Shape, point: Point) -> float:
    """Return the distance [m] from a point, in G, to the footprint; zero inside."""
    if depth_inside(shape, point) >= 0.0:
        return 0.0
    if isinstance(shape, Cylinder):
        return math.hypot(*point) - shape.radius
    corners = shape.footprint
    return min(
        _to_segment(point, a, b)
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    )


def _to_segment(p: Point, a: Point, b: Point) -> float:
    ex = b[0] - a[0]
    ey = b[1] - a[1]
    t = ((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / (ex * ex + ey * ey)
    t = min(max(t, 0.0), 1.0)
    return math.hypot(p[0] - a[0] - t * ex, p[1] - a[1] - t * ey)


def overlap_area(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Return the area [m^2] that two footprints share."""
    return float(_placed(shape_1, X_W1).intersection(_placed(shape_2, X_W2)).area)


def gap(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Return the distance [m] between two footprints; zero where they overlap."""
    return float(_placed(shape_1, X_W1).distance(_placed(shape_2, X_W2)))


def lowered(task: Task, X_WG: Pose2, by: float) -> Pose2:
    """Return a pose on a wall moved ``by`` [m] the way the weight pulls."""
    x, y = task.weight_in_plane
    size = math.hypot(x, y)
    return replace(X_WG, x=X_WG.x + by * x / size, y=X_WG.y + by * y / size)


def on_ledge(task: Task, X_WG: Pose2, within: float) -> bool:
    """Return whether an object at a pose on a wall has a fixed obstacle ``within`` [m]
    below it.
    """
    below = lowered(task, X_WG, within)
    shape = task.object.shape
    fixed = (o for o in task.obstacles if not o.movable)
    return any(overlap_area(shape, below, Box(o.size), o.pose) > 0.0 for o in fixed)


def carried(task: Task, X_WG: Pose2) -> bool:
    """Return whether an object that is let go at a pose stays: on a wall, on a ledge or
    in the opening.
    """
    support = task.support
    shape = task.object.shape
    if support.kind == "table" or on_ledge(task, X_WG, LEDGE_GAP):
        return True
    return support.opening is not None and support.opening.holds(X_WG, shape)


def depth_beside(shape: Shape, X_WG: Pose2, opening: Opening, point: Point) -> float:
    """Return how far [m] a point lies inside the convex hull of what an opening leaves
    of a footprint that is partly over it; negative outside, infinite where nothing is
    over it.
    """
    from shapely import Point as Place
    from shapely import box

    w, h = opening.size
    x, y = opening.center
    whole = _placed(shape, X_WG)
    rest = whole.difference(box(x - 0.5 * w, y - 0.5 * h, x + 0.5 * w, y + 0.5 * h))
    if rest.area == whole.area:
        return math.inf
    if rest.is_empty:
        return -math.inf
    hull = rest.convex_hull
    place = Place(point)
    return (
        float(hull.boundary.distance(place))
        if hull.covers(place)
        else -float(hull.distance(place))
    )


def around(
    shape: Shape, X_WG: Pose2, distance: float, count: int
) -> tuple[list[Point], float]:
    """Return ``count`` points even around a footprint, ``distance`` [m] off it, and how
    far apart [m].
    """
    line = _placed(shape, X_WG).buffer(distance).exterior
    points = [line.interpolate(i / count, normalized=True) for i in range(count)]
    return [(p.x, p.y) for p in points], float(line.length) / count


def _placed(shape: Shape, X_WG: Pose2) -> Polygon:
    from shapely import Point as Centre
    from shapely import Polygon

    if isinstance(shape, Cylinder):
        return Centre(X_WG.x, X_WG.y).buffer(shape.radius, quad_segs=64)
    return Polygon([X_WG.apply(corner) for corner in shape.footprint])
