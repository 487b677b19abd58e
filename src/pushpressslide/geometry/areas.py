"""Areas made of several polygons with holes, as shapely represents them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area

Ring = tuple[Point, ...]


def polygons(area: Area) -> Iterator[Polygon]:
    """Polygons of an area, without any points and lines in it."""
    import shapely

    for part in shapely.get_parts(area):
        if isinstance(part, shapely.Polygon) and not part.is_empty:
            yield shapely.orient_polygons(part)


def filled(area: Area) -> Area:
    """The area with its holes filled."""
    import shapely

    return shapely.union_all([shapely.Polygon(p.exterior) for p in polygons(area)])


def largest(area: Area) -> Polygon:
    """Largest polygon of an area, without its holes.

    Raises ValueError if the area is empty.
    """
    import shapely

    found = max(polygons(area), key=lambda p: float(p.area))
    return shapely.Polygon(found.exterior)


def inner_radius(area: Area | None) -> float:
    """Radius [m] of the largest disc in an area. 0 without one."""
    import shapely

    if area is None:
        return 0.0
    radii = [
        float(shapely.maximum_inscribed_circle(part).length) for part in polygons(area)
    ]
    return max(radii, default=0.0)


def joined_ring(area: Area) -> Ring:
    """Corners [m] of one ring about an area, counter-clockwise.

    Polygons and holes are joined by pairs of opposite edges, which cancel in every
    integral along the ring.
    """
    rings: list[Ring] = []
    for polygon in polygons(area):
        rings += [
            _corners(line.coords) for line in (polygon.exterior, *polygon.interiors)
        ]
    ring = rings.pop(0)
    while rings:
        near = min(rings, key=lambda other: _bridge(ring, other)[0])
        rings.remove(near)
        _, i, j = _bridge(ring, near)
        ring = ring[: i + 1] + near[j:] + near[: j + 1] + ring[i:]
    return ring


def _corners(coordinates: object) -> Ring:
    return tuple((float(x), float(y)) for x, y in list(coordinates)[:-1])  # type: ignore[call-overload]


def _bridge(ring: Ring, other: Ring) -> tuple[float, int, int]:
    """Length [m] of the shortest bridge between two rings, and the indices of its
    corners.
    """
    return min(
        (math.dist(a, b), i, j) for i, a in enumerate(ring) for j, b in enumerate(other)
    )
