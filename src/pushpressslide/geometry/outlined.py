"""A shape on any simple outline of straight edges and arcs, convex or concave.

Contacts and clearances to other bodies use the true footprint. Tipping uses its convex
hull: the object does not tip as long as the centre of pressure is inside the hull.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from pushpressslide.core import margins
from pushpressslide.core.pose import Point, turned_left
from pushpressslide.geometry.border import Arc, Border, BorderSide, Edge
from pushpressslide.geometry.polygon import (
    centroid,
    convex_hull,
    distance_to_segment,
    is_convex,
)
from pushpressslide.geometry.shape import Ends, Shape
from pushpressslide.geometry.sides import (
    ROUND_SIDES,
    FlatSide,
    RoundSide,
    Side,
    SidePlace,
    on_arc,
)
from pushpressslide.geometry.touchable import free_space

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

FAR = 100.0  # [m] beyond every footprint
TURNED = 1.0  # [m] of distance from a side that equals a normal's error of one radian


@dataclass(frozen=True, slots=True)
class Hull(Shape):
    """The convex hull of a footprint."""

    ring: tuple[Point, ...]  # [m] corners in G, counter-clockwise
    height: float  # [m]

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners in G, counter-clockwise [m]."""
        return self.ring

    @property
    def description(self) -> str:
        """Kind in words."""
        return "hull"


class Outlined(Shape):
    """Geometry of a shape that is defined by its border."""

    @property
    def border(self) -> Border:
        """The border of the footprint in G."""
        raise NotImplementedError

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the footprint in G, counter-clockwise [m]. An arc is represented
        by chords.
        """
        return self.border.corners

    @property
    def edges(self) -> tuple[Ends | None, ...]:
        """Ends in G [m] of each side. None for an arc."""
        return tuple(
            (side.start, side.end) if isinstance(side, Edge) else None
            for side in self.border.sides
        )

    @cached_property
    def area(self) -> Polygon:
        """The footprint in G, as a Shapely polygon."""
        from shapely import Polygon, prepare

        area = Polygon(self.corners)
        prepare(area)
        return area

    @cached_property
    def convex(self) -> bool:
        """Whether the footprint is convex."""
        return is_convex(self.corners)

    @cached_property
    def hull(self) -> Shape:
        """The upright body on the footprint's convex hull."""
        return Hull(convex_hull(self.corners), self.height)

    @cached_property
    def centroid(self) -> Point:
        """Centroid of the footprint in G [m]."""
        return centroid(self.corners)

    @property
    def middle(self) -> Point:
        """Middle of the hull."""
        return self.hull.middle

    @property
    def inner_radius(self) -> float:
        """Inner radius [m] of the hull."""
        return self.hull.inner_radius

    @property
    def circumradius(self) -> float:
        """Distance [m] from the middle to the farthest point of the outline."""
        return self.hull.circumradius

    @property
    def half_width(self) -> float:
        """Half width [m] of the hull."""
        return self.hull.half_width

    @cached_property
    def breadth(self) -> float:
        """Width [m] of the narrow part of the footprint.

        It is the smaller of two values: the width of the bounding rectangle, and four
        times the area divided by the perimeter. For a square both are the length of its
        side.
        """
        whole = self.hull.breadth
        if self.convex:
            return whole
        return min(whole, 4.0 * self.area.area / self.area.length)

    def depth(self, point: Point) -> float:
        """Depth [m] of a point in G inside the footprint. Negative outside."""
        from shapely import Point as Place

        nearest = min(distance_to_segment(point, a, b) for a, b in self._edges())
        return nearest if self.area.covers(Place(point)) else -nearest

    def distance(self, point: Point) -> float:
        """Distance [m] from a point in G to the footprint. 0 inside."""
        return max(0.0, -self.depth(point))

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Whether ``point`` [m] in B is at least ``margin`` [m] inside the footprint."""
        return self.depth((point[0] + origin[0], point[1] + origin[1])) >= margin

    def depths(self, points: Array, origin: Point) -> Array:
        """Depths (m,) of points (m, 2) [m] in B inside the hull, in half widths of the
        hull, as in ``Shape.depths``.
        """
        return self.hull.depths(points, origin)

    def chords(
        self, direction: Point, margin: float, origin: Point
    ) -> tuple[tuple[float, float], ...]:
        """Intervals [m] of a ray from B's origin along a unit vector that are at least
        ``margin`` [m] inside the outline, the nearest first.
        """
        inner = self.area.buffer(-margin, join_style="mitre")
        return chords_in(inner, direction, origin)

    def gauge(self) -> Callable[[float, float], float]:
        """Gauge of the hull."""
        return self.hull.gauge()

    def side_places(
        self, clearance: float, tip_radius: float, origin: Point
    ) -> tuple[SidePlace, ...]:
        """Contact places on the touchable part of each side, several of them on an arc.
        None on an arc too sharp for the tip.
        """
        out: list[SidePlace] = []
        sharp = margins.CREEP * tip_radius / margins.CREPT_TURN
        for found in self.touchable(tip_radius):
            part = found.side
            if isinstance(part, Edge):
                out.append(_edge_place(found.index, part, clearance, origin))
            elif part.whole or part.radius >= sharp:
                out += _arc_places(found.index, part, clearance, origin)
        return tuple(out)

    def side(self, point: Point, normal: Point, origin: Point) -> Side:
        """Side of a contact at ``point`` [m] in B."""
        side = min(
            self.border.sides, key=lambda side: _miss(side, point, normal, origin)
        )
        return _side_in_contact_frame(side, point, normal, origin)

    def walls(self, point: Point, normal: Point, origin: Point) -> tuple[Side, ...]:
        """All sides except that of a contact at ``point`` [m] in B."""
        own = min(
            self.border.sides, key=lambda side: _miss(side, point, normal, origin)
        )
        out = []
        for side in self.border.sides:
            if side is own:
                continue
            if isinstance(side, Edge):
                at = _shifted(side.start, origin)
                out.append(_side_in_contact_frame(side, at, side.normal, origin))
            else:
                out.append(_side_in_contact_frame(side, point, normal, origin))
        return tuple(out)

    def free_space(
        self, point: Point, normal: Point, tip_radius: float, origin: Point
    ) -> float:
        """Largest retreat [m] of a tip from a contact at ``point`` [m] in B, against
        its inward ``normal``. Infinite if nothing blocks it.
        """
        at = (point[0] + origin[0], point[1] + origin[1])
        return free_space(self.border, at, normal, tip_radius)


def chords_in(
    area: Area, direction: Point, origin: Point
) -> tuple[tuple[float, float], ...]:
    """Intervals [m] of a ray from ``origin`` along a unit vector that are inside an
    area, the nearest first.
    """
    from shapely import LineString, get_parts
    from shapely import Point as Place

    end = (origin[0] + FAR * direction[0], origin[1] + FAR * direction[1])
    inside = get_parts(LineString([origin, end]).intersection(area))
    start = Place(origin)
    spans = (sorted(start.distance(Place(p)) for p in part.coords) for part in inside)
    return tuple(sorted((span[0], span[-1]) for span in spans if span))


def _shifted(point: Point, origin: Point) -> Point:
    return (point[0] - origin[0], point[1] - origin[1])


def _edge_place(index: int, edge: Edge, clearance: float, origin: Point) -> SidePlace:
    """Contact place on an edge, as near as possible to the foot of the perpendicular
    from B's origin.

    The place keeps ``clearance`` [m] from both corners.
    """
    a = _shifted(edge.start, origin)
    length = edge.length
    normal = edge.normal
    u = (normal[1], -normal[0])
    along = -(a[0] * u[0] + a[1] * u[1])
    clear = min(clearance, 0.5 * length)
    place = min(max(along, clear), length - clear)
    foot = (a[0] + place * u[0], a[1] + place * u[1])
    left = turned_left(normal)
    b = _shifted(edge.end, origin)
    ends = (b[0] * left[0] + b[1] * left[1], a[0] * left[0] + a[1] * left[1])
    return SidePlace(index, foot, normal, ends)


def _arc_places(
    index: int, arc: Arc, clearance: float, origin: Point
) -> list[SidePlace]:
    """Contact places on an arc, one for each standard direction of a full circle that
    meets the arc. If none does, the middle of the arc.
    """
    step = 2.0 * math.pi / ROUND_SIDES
    if arc.whole:
        angles = [i * step for i in range(ROUND_SIDES)]
    else:
        clear = clearance / arc.radius
        low = math.ceil((arc.start + clear) / step - 1e-9)
        high = math.floor((arc.start + arc.sweep - clear) / step + 1e-9)
        angles = [i * step for i in range(low, high + 1)]
    out = []
    for angle in angles or [arc.start + 0.5 * arc.sweep]:
        normal = (-math.cos(angle), -math.sin(angle))
        out.append(
            SidePlace(index, _shifted(arc.point_at(angle), origin), normal, None)
        )
    return out


def _miss(side: BorderSide, point: Point, normal: Point, origin: Point) -> float:
    """Distance [m] of a contact from a side, plus a penalty for the angle between their
    normals.
    """
    x = point[0] + origin[0]
    y = point[1] + origin[1]
    if isinstance(side, Edge):
        own = side.normal
        away = distance_to_segment((x, y), side.start, side.end)
    else:
        dx = x - side.center[0]
        dy = y - side.center[1]
        distance = math.hypot(dx, dy)
        own = (-dx / distance, -dy / distance) if distance > 0.0 else normal
        away = abs(distance - side.radius)
        if not (side.whole or on_arc((side.start, side.sweep), (dx, dy))):
            away += side.radius
    return away + TURNED * math.dist(own, normal)


def _side_in_contact_frame(
    side: BorderSide, point: Point, normal: Point, origin: Point
) -> Side:
    """Side of a contact at ``point`` [m] in B, in the form that contacts use."""
    if isinstance(side, Arc):
        arc = None if side.whole else (side.start, side.sweep)
        return RoundSide(_shifted(side.center, origin), side.radius, normal, arc)
    nx, ny = side.normal
    ends = [_shifted(end, origin) for end in (side.start, side.end)]
    depth = nx * ends[0][0] + ny * ends[0][1]
    right, left = sorted(nx * y - ny * x for x, y in ends)
    return FlatSide(point, side.normal, depth, (right, left))
