"""Convex decomposition of a polygon: a triangulation whose triangles are merged while
they stay convex (Hertel and Mehlhorn 1983).
"""

from __future__ import annotations

from functools import lru_cache

from pushpressslide.core.pose import Point
from pushpressslide.geometry.polygon import is_convex, turns

Polygon = tuple[Point, ...]

FLAT = -1e-9  # [rad] turn to the right that counts as none


@lru_cache(maxsize=64)
def convex_pieces(corners: Polygon) -> tuple[Polygon, ...]:
    """Convex polygons that make up a simple polygon, all counter-clockwise. A convex
    polygon is returned unchanged.
    """
    if is_convex(corners):
        return (corners,)
    pieces = _triangles(corners)
    merged = _merged_once(pieces)
    while merged is not None:
        pieces = merged
        merged = _merged_once(pieces)
    return tuple(pieces)


def triangles(corners: Polygon) -> list[tuple[int, int, int]]:
    """Triangulation of a simple polygon by corner indices, each triangle
    counter-clockwise.
    """
    number = {corner: i for i, corner in enumerate(corners)}
    return [(number[a], number[b], number[c]) for a, b, c in _triangles(corners)]


def _triangles(corners: Polygon) -> list[tuple[Point, ...]]:
    """Triangles that make up a polygon, or an area within a ring that touches itself."""
    import shapely

    area = shapely.make_valid(shapely.Polygon(corners), method="structure")
    made = [
        shapely.constrained_delaunay_triangles(part) for part in shapely.get_parts(area)
    ]
    parts = shapely.get_parts(shapely.orient_polygons(made))
    return [tuple((x, y) for x, y in part.exterior.coords[:-1]) for part in parts]


def _merged_once(polygons: list[Polygon]) -> list[Polygon] | None:
    """The polygons with one pair merged over the longest common edge. None if no pair
    forms a convex polygon.
    """
    owner = {
        edge: i
        for i, piece in enumerate(polygons)
        for edge in zip(piece, piece[1:] + piece[:1], strict=True)
    }
    shared = [
        (a, b) for (a, b), i in owner.items() if (b, a) in owner and i < owner[(b, a)]
    ]
    shared.sort(key=lambda edge: -_squared_length(*edge))
    for a, b in shared:
        i = owner[(a, b)]
        j = owner[(b, a)]
        whole = _joined(polygons[i], polygons[j], a, b)
        if min(turns(whole)) > FLAT:
            others = [piece for k, piece in enumerate(polygons) if k not in (i, j)]
            return [*others, whole]
    return None


def _joined(one: Polygon, other: Polygon, a: Point, b: Point) -> Polygon:
    """Union of two polygons that share the edge from a to b of the first."""
    i = one.index(b)
    j = other.index(a)
    return one[i:] + one[:i] + (other[j:] + other[:j])[1:-1]


def _squared_length(a: Point, b: Point) -> float:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2
