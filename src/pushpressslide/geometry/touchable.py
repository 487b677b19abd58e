"""The parts of a border that a round tip can touch, from the border offset outwards by
the tip's radius (by shapely).

A place on a side can be touched if a tip at that place is clear of all other sides. The
inside of a notch whose mouth is narrower than the tip cannot be touched, however wide
the notch is farther inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point
from pushpressslide.geometry.border import Arc, Border, BorderSide, Edge

if TYPE_CHECKING:
    from shapely import LineString
    from shapely.geometry.base import BaseGeometry as Area

SLACK = 1e-4  # allowed overlap, in tip radii: round-off, and chords
QUADRANT = 64  # chords of a quarter of an offset corner
DEGREE = math.radians(1.0)  # between the places of an arc that are tried
# distance from its contact at which a retreat starts to be checked, in tip radii
OFF = 0.05
LEAST = 1e-6  # [m] shortest side that can be touched
FAR = 1.0  # [m] distance up to which a retreat from a side is checked


@dataclass(frozen=True, slots=True)
class Touchable:
    """A part of one side of a border."""

    index: int  # of the side
    side: BorderSide


@lru_cache(maxsize=64)
def touchable(
    border: Border, tip_radius: float, around: Area | None = None
) -> tuple[Touchable, ...]:
    """Parts of a border that a tip of ``tip_radius`` [m] can touch. A tip of zero
    radius can touch all of it.

    ``around`` is a further region that the tip's centre cannot enter.
    """
    if tip_radius == 0.0:
        return tuple(Touchable(i, side) for i, side in enumerate(border.sides))
    blocked = _blocked(border, tip_radius, closed=True, around=around)
    out = []
    for index, side in enumerate(border.sides):
        if isinstance(side, Edge):
            parts: list[BorderSide] = [*_edge_parts(side, tip_radius, blocked)]
        else:
            parts = [*_arc_parts(side, tip_radius, blocked)]
        out += [Touchable(index, part) for part in parts]
    return tuple(out)


def total_length(parts: Iterable[Touchable]) -> float:
    """Length [m] of parts of a border."""
    return sum(part.side.length for part in parts)


def free_space(border: Border, point: Point, normal: Point, tip_radius: float) -> float:
    """Largest retreat [m] of a tip from a border at ``point``, against the inward
    ``normal``, before it meets the border again. Infinite if it never does.
    """
    from shapely import LineString
    from shapely import Point as Place

    blocked = _blocked(border, tip_radius, closed=False)
    # a measured point may be a little inside
    out = (1.0 + OFF) * tip_radius
    start = (point[0] - out * normal[0], point[1] - out * normal[1])
    end = (start[0] - FAR * normal[0], start[1] - FAR * normal[1])
    met = LineString([start, end]).intersection(blocked)
    if met.is_empty:
        return math.inf
    return OFF * tip_radius + float(Place(start).distance(met))


@lru_cache(maxsize=64)
def _blocked(
    border: Border, tip_radius: float, closed: bool, around: Area | None = None
) -> Area:
    """Region that the tip's centre cannot enter. With ``closed`` it includes notches
    too narrow for the tip.
    """
    from shapely import Polygon, prepare, union

    swollen = Polygon(border.corners).buffer(
        (1.0 - SLACK) * tip_radius, quad_segs=QUADRANT
    )
    area: Area = Polygon(swollen.exterior) if closed else swollen
    if around is not None:
        area = union(area, around)
    prepare(area)
    return area


def _edge_parts(edge: Edge, tip_radius: float, blocked: Area) -> list[Edge]:
    """Touchable parts of an edge, in order."""
    from shapely import LineString, get_parts

    nx, ny = edge.normal
    ends = [
        (x - tip_radius * nx, y - tip_radius * ny) for x, y in (edge.start, edge.end)
    ]
    line = LineString(ends)
    if not line.intersects(blocked):
        return [edge]
    parts = [
        _between(edge, line, part)
        for part in get_parts(line.difference(blocked))
        if part.length > LEAST
    ]
    return sorted(parts, key=lambda part: math.dist(edge.start, part.start))


def _between(edge: Edge, line: LineString, side: LineString) -> Edge:
    """Part of an edge opposite a part of its offset line."""
    from shapely import Point as Place

    first, last = sorted(line.project(Place(end)) for end in side.coords)
    return Edge(edge.point_at(first), edge.point_at(min(last, edge.length)))


def _arc_parts(arc: Arc, tip_radius: float, blocked: Area) -> list[Arc]:
    """Touchable parts of an arc, in order."""
    from shapely import contains_xy

    steps = max(2, math.ceil(arc.sweep / DEGREE))
    angles = [arc.start + arc.sweep * i / steps for i in range(steps + 1)]
    wide = Arc(arc.center, arc.radius + tip_radius, arc.start, arc.sweep)
    xs, ys = zip(*map(wide.point_at, angles), strict=True)
    free = [not inside for inside in contains_xy(blocked, xs, ys)]
    if all(free):
        return [arc]
    out = []
    start: float | None = None
    for i, is_free in enumerate([*free, False]):
        if is_free and start is None:
            start = angles[i]
        elif not is_free and start is not None:
            end = angles[i - 1]
            if end > start:
                out.append(Arc(arc.center, arc.radius, start, end - start))
            start = None
    return out
