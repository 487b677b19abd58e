"""The border of a polygon, with arcs restored from their chords.

A mesh has chords in place of arcs. Consecutive corners on one circle, with small turns
between them, are taken as an arc.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core.pose import Point, cross
from pushpressslide.geometry.border import Arc, Border, BorderSide, Edge
from pushpressslide.geometry.polygon import distance_to_segment

MOST_TURN = math.radians(25.0)
"""Largest angle [rad] between neighbouring chords of an arc. A circle with 15 corners
has this angle.
"""
FEWEST = 3
"""Smallest number of corners inside an arc. Fewer may lie on a circle by chance."""
ROUND = 0.02
"""Largest distance of a corner from its arc, as a share of the arc's radius."""
ALIKE = 0.1
"""Largest relative difference between the radii at two corners of one arc."""
FLAT = 5e-6
"""Distance [m] of a corner from the line through its neighbours below which the border
counts as straight.
"""
SHORTEST = 2e-3
"""Length [m] of the shortest arc."""


@dataclass(frozen=True, slots=True)
class _Circle:
    center: Point
    radius: float


def rounded_border(corners: tuple[Point, ...]) -> Border:
    """Border of a polygon, counter-clockwise [m], with its runs of chords as arcs."""
    corners = _without_flat_corners(corners)
    n = len(corners)
    radii = [
        _radius(corners[i - 1], corners[i], corners[(i + 1) % n]) for i in range(n)
    ]
    whole = _fitted(corners)
    if whole is not None and all(_are_equal(radius, whole.radius) for radius in radii):
        start = _direction(whole, corners[0])
        circle = Arc(whole.center, whole.radius, start, 2.0 * math.pi)
        return Border(corners, (circle,))
    first = _first_sharp(radii)
    corners = corners[first:] + corners[:first]
    radii = radii[first:] + radii[:first]
    return Border(corners, tuple(_sides(corners, radii)))


def _without_flat_corners(corners: tuple[Point, ...]) -> tuple[Point, ...]:
    """Corners without those in the middle of a straight line."""
    kept = list(corners)
    i = 0
    while i < len(kept) and len(kept) > 3:
        before = kept[i - 1]
        after = kept[(i + 1) % len(kept)]
        if distance_to_segment(kept[i], before, after) < FLAT:
            del kept[i]
        else:
            i += 1
    return tuple(kept)


def _sides(corners: tuple[Point, ...], radii: Sequence[float]) -> list[BorderSide]:
    """Edges and arcs, from the first corner on."""
    sides: list[BorderSide] = []
    n = len(corners)
    i = 0
    while i < n:
        end = _run_end(radii, i + 1)
        ring = [corners[k % n] for k in range(i, end + 1)]
        circle = _fitted(ring) if end - i > FEWEST else None
        if circle is not None:
            start = _direction(circle, ring[0])
            sweep = (_direction(circle, ring[-1]) - start) % (2.0 * math.pi)
            if sweep * circle.radius >= SHORTEST:
                sides.append(Arc(circle.center, circle.radius, start, sweep))
                i = end
                continue
        sides.append(Edge(corners[i], corners[(i + 1) % n]))
        i += 1
    return sides


def _run_end(radii: Sequence[float], first: int) -> int:
    """Index of the corner at which an arc ends.

    ``first`` is the index of the arc's first inner corner.
    """
    n = len(radii)
    i = first
    while i < n and _are_equal(radii[i], radii[min(first, n - 1)]):
        i += 1
    return i


def _first_sharp(radii: Sequence[float]) -> int:
    """Index of the first corner at which the radius changes, or 0."""
    n = len(radii)
    return next((i for i in range(n) if not _are_equal(radii[i], radii[i - 1])), 0)


def _are_equal(one: float, other: float) -> bool:
    if math.isinf(one) or math.isinf(other):
        return False
    return abs(one - other) <= ALIKE * other


def _radius(a: Point, b: Point, c: Point) -> float:
    """Radius [m] of the circle through three corners, infinite unless the border makes
    a small turn to the left there.
    """
    u = (b[0] - a[0], b[1] - a[1])
    v = (c[0] - b[0], c[1] - b[1])
    turn = math.atan2(cross(u, v), u[0] * v[0] + u[1] * v[1])
    if not 0.0 < turn <= MOST_TURN:
        return math.inf
    return 0.5 * math.dist(a, c) / math.sin(turn)


def _fitted(points: Sequence[Point]) -> _Circle | None:
    """Least-squares circle through points. None if a point is too far off it."""
    import numpy as np

    places = np.array(points)
    middle = places.mean(axis=0)
    x, y = (places - middle).T
    system = np.stack([x, y, np.ones(len(x))], axis=1)
    solution, *_ = np.linalg.lstsq(system, x * x + y * y, rcond=None)
    cx, cy = 0.5 * solution[:2]
    radius = math.sqrt(max(float(solution[2] + cx * cx + cy * cy), 0.0))
    off = np.abs(np.hypot(x - cx, y - cy) - radius).max()
    if not off < ROUND * radius:
        return None
    return _Circle((float(middle[0] + cx), float(middle[1] + cy)), radius)


def _direction(circle: _Circle, point: Point) -> float:
    """Direction [rad] of a point from the centre."""
    return math.atan2(point[1] - circle.center[1], point[0] - circle.center[0])
