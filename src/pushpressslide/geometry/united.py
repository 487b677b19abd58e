"""The union of footprints that touch or overlap, as one border.

Shapely computes it on a grid, so that parts separated only by round-off are joined.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point
from pushpressslide.geometry.border import CHORDS, Arc, Border, BorderSide, Edge
from pushpressslide.geometry.polygon import without_straight_corners

if TYPE_CHECKING:
    from shapely import Polygon

GRID = 1e-7  # [m] to which corners of a union are rounded
DIGITS = 7  # the same, in decimal places
SLIVER = 0.01  # share of an arc's radius: shorter edges next to it come from its chords
ROUND = 0.004  # share of a circle's radius: chords lie inside it by up to half of this


def united(borders: Sequence[Border]) -> Border:
    """Border of the union of the areas within ``borders``.

    The remaining part of a round border is an arc. The first side starts at the corner
    with the smallest y, and among several at the one with the smallest x. Raises
    ValueError if the union is not connected or has a hole.
    """
    import shapely

    whole = shapely.union_all(
        [shapely.Polygon(border.corners) for border in borders], grid_size=GRID
    )
    if not isinstance(whole, shapely.Polygon):
        pieces = len(shapely.get_parts(whole))
        raise ValueError(f"the parts do not touch along a line: {pieces} pieces")
    if whole.interiors:
        area = sum(float(shapely.Polygon(hole).area) for hole in whole.interiors)
        raise ValueError(f"the union has a hole of {area * 1e4:.3g} cm^2")
    arcs = [
        side for border in borders for side in border.sides if isinstance(side, Arc)
    ]
    return bordered(whole, arcs)


def bordered(whole: Polygon, arcs: Sequence[Arc] = ()) -> Border:
    """Border of a polygon without holes, with chords replaced by the ``arcs`` that they
    approximate.

    The first side is chosen as in ``united``.
    """
    import shapely

    ring = shapely.normalize(shapely.orient_polygons(whole)).exterior.coords[:-1]
    rounded = tuple((round(x, DIGITS) + 0.0, round(y, DIGITS) + 0.0) for x, y in ring)
    if shapely.Polygon(rounded).exterior.is_ccw is False:
        rounded = rounded[::-1]
    corners = without_straight_corners(_without_slivers(rounded, arcs))
    edges = _edges(corners)
    circles = [_circle_of(edge, arcs) for edge in edges]
    first = _first(corners, circles)
    edges = edges[first:] + edges[:first]
    circles = circles[first:] + circles[:first]
    return Border(corners[first:] + corners[:first], _sides(edges, circles))


def _edges(corners: tuple[Point, ...]) -> list[Edge]:
    return list(map(Edge, corners, corners[1:] + corners[:1]))


def _without_slivers(
    corners: tuple[Point, ...], arcs: Sequence[Arc]
) -> tuple[Point, ...]:
    """Corners without the tiny edges between a straight edge and the chords of a
    tangent arc. The end of the straight edge is kept.
    """
    if not arcs:
        return corners
    shortest = SLIVER * min(arc.radius for arc in arcs)
    i = 0
    while i < len(corners) and len(corners) > 3:
        edges = _edges(corners)
        if edges[i].length >= shortest:
            i += 1
            continue
        after = edges[(i + 1) % len(edges)]
        at = i
        if _circle_of(after, arcs) is not None:
            at = (i + 1) % len(corners)
        corners = corners[:at] + corners[at + 1 :]
        i = 0
    return corners


def _circle_of(edge: Edge, arcs: Sequence[Arc]) -> Arc | None:
    """Circle on which an edge is nearly a chord or part of a chord, or None."""
    middle = edge.point_at(0.5 * edge.length)
    for arc in arcs:
        depths = [
            1.0 - math.dist(point, arc.center) / arc.radius
            for point in (edge.start, middle, edge.end)
        ]
        chord = 2.0 * arc.radius * math.sin(math.pi / CHORDS)
        near = all(-ROUND < depth < ROUND for depth in depths)
        if near and edge.length < (1.0 + SLIVER) * chord:
            return arc
    return None


def _first(corners: Sequence[Point], circles: Sequence[Arc | None]) -> int:
    """Index of the corner at which the first side starts."""
    begins = [
        i
        for i, circle in enumerate(circles)
        if circle is None or circle is not circles[i - 1]
    ]
    candidates = begins or range(len(corners))
    return min(candidates, key=lambda i: (corners[i][1], corners[i][0]))


def _sides(
    edges: Sequence[Edge], circles: Sequence[Arc | None]
) -> tuple[BorderSide, ...]:
    """The edges, with consecutive edges on one circle joined into an arc."""
    starts = [
        i
        for i, circle in enumerate(circles)
        if i == 0 or circle is None or circle is not circles[i - 1]
    ]
    sides: list[BorderSide] = []
    for first, after in pairwise([*starts, len(edges)]):
        circle = circles[first]
        if circle is None:
            sides.append(edges[first])
        else:
            sides.append(_arc(circle, edges[first:after]))
    return tuple(sides)


def _arc(circle: Arc, chords: Sequence[Edge]) -> Arc:
    """Arc over consecutive chords of a circle."""
    cx, cy = circle.center

    def angle(point: Point) -> float:
        """Direction [rad] of a point from the centre."""
        return math.atan2(point[1] - cy, point[0] - cx)

    start = angle(chords[0].start)
    sweep = (angle(chords[-1].end) - start) % (2.0 * math.pi)
    if chords[0].start == chords[-1].end:
        sweep = 2.0 * math.pi
    return Arc(circle.center, circle.radius, start, sweep)
