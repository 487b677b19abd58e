"""Shapes of objects: upright bodies on a footprint, and all that is asked of one.

A new kind of shape is one new class: it gives its corners, or answers itself. A shape
is given in its own frame G. A method with an ``origin`` [m] in G takes and gives points
in B, which has G's axes and its origin there: the projected centre of mass.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pushpressslide.core.polygon import centroid, distance_to_segment
from pushpressslide.core.pose import Point, Pose2, cross, turned_left

if TYPE_CHECKING:
    from shapely import Polygon

    from pushpressslide.core.arrays import Array

ORIGIN: Point = (0.0, 0.0)
ROUND_SIDES = 24  # a round side is offered as this many directions
OUTLINE_POINTS = 48  # of a drawn circle
ON_FACE = 1e-6  # [m] from a face's line at which a corner belongs to it


@dataclass(frozen=True, slots=True)
class FlatSide:
    """A face of a shape with corners."""

    point: Point  # [m] in B, of the contact
    normal: Point  # unit, inward
    depth: float  # [m] of the face along the normal
    ends: tuple[float, float]  # [m] along the face, to the left of the normal

    def gap(self, tip: Point, tip_radius: float) -> tuple[float, Point]:
        """Return gap [m] and normal; beside the face the gap is infinite."""
        nx, ny = self.normal
        if not self.ends[0] <= nx * tip[1] - ny * tip[0] <= self.ends[1]:
            return math.inf, self.normal
        return self.depth - tip_radius - (nx * tip[0] + ny * tip[1]), self.normal

    def foot(self, point: Point) -> Point:
        """Return the nearest point of the line through the contact along the face."""
        x, y = self.point
        nx, ny = self.normal
        across = (point[1] - y) * nx - (point[0] - x) * ny
        return (x - across * ny, y + across * nx)

    def normal_at(self, point: Point) -> Point:
        """Return the face's normal, which is the same everywhere."""
        return self.normal

    def coordinates(self, x: Array, y: Array) -> Array:
        """Return the places (N,) along the face [m]."""
        nx, ny = self.normal
        return -ny * x + nx * y


@dataclass(frozen=True, slots=True)
class RoundSide:
    """The side of a cylinder: its normal follows the point that is asked about."""

    center: Point  # [m] in B
    radius: float  # [m]
    normal: Point  # unit, inward, at the contact

    def gap(self, tip: Point, tip_radius: float) -> tuple[float, Point]:
        """Return gap [m] and normal."""
        x = self.center[0] - tip[0]
        y = self.center[1] - tip[1]
        distance = math.hypot(x, y)
        gap = distance - self.radius - tip_radius
        return gap, (x / distance, y / distance) if distance > 0.0 else self.normal

    def foot(self, point: Point) -> Point:
        """Return the point of the circle in the same direction from its centre."""
        x = point[0] - self.center[0]
        y = point[1] - self.center[1]
        k = self.radius / math.hypot(x, y)
        return (k * x + self.center[0], k * y + self.center[1])

    def normal_at(self, point: Point) -> Point:
        """Return the unit vector from ``point`` to the centre."""
        x = self.center[0] - point[0]
        y = self.center[1] - point[1]
        return (x / math.hypot(x, y), y / math.hypot(x, y))

    def coordinates(self, x: Array, y: Array) -> Array:
        """Return the arcs (N,) from the contact [m]."""
        import numpy as np

        nx, ny = self.normal
        arcs: Array = self.radius * np.arctan2(-ny * x + nx * y, -(nx * x + ny * y))
        return arcs


Side = FlatSide | RoundSide
"""A side as a contact sees it."""


class Shape:
    """What every shape answers; here by the corners of a convex footprint."""

    __slots__ = ()

    if TYPE_CHECKING:  # a property here would be the default of a subclass's field

        @property
        def height(self) -> float:
            """Height [m]."""

        @property
        def description(self) -> str:
            """Kind and size in words, in millimetres."""

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the footprint in G, counter-clockwise [m]; none of a round one.

        Edge i, the foot of flat side i, leads from corner i to the next.
        """
        raise NotImplementedError

    @property
    def centroid(self) -> Point:
        """Centroid of the footprint in G [m]."""
        return centroid(self.corners)

    @property
    def middle(self) -> Point:
        """Mean of the corners in G [m]; the centre of a round footprint."""
        xs, ys = zip(*self.corners, strict=True)
        return (sum(xs) / len(xs), sum(ys) / len(ys))

    @property
    def inner_radius(self) -> float:
        """Distance [m] from the middle to the nearest point of the outline."""
        return min(depth for _, depth in self._outward_edges())

    @property
    def circumradius(self) -> float:
        """Distance [m] from the middle to the farthest point of the outline."""
        middle = self.middle
        return max(math.dist(middle, corner) for corner in self.corners)

    @property
    def half_width(self) -> float:
        """Half of the least width of the footprint [m]."""
        return 0.5 * min(width for _, _, _, width in self._inward_edges(ORIGIN))

    def bounds(self, X_WG: Pose2) -> tuple[float, float, float, float]:
        """Return x_min, x_max, y_min, y_max [m] of the footprint at a pose."""
        xs, ys = zip(*(X_WG.apply(corner) for corner in self.corners), strict=True)
        return (min(xs), max(xs), min(ys), max(ys))

    def outline(self) -> tuple[Point, ...]:
        """Return the points [m] in G through which to draw the footprint."""
        return self.corners

    def placed(self, X_WG: Pose2) -> Polygon:
        """Return the footprint at a pose for Shapely; a circle has 256 sides."""
        from shapely import Polygon

        return Polygon([X_WG.apply(corner) for corner in self.corners])

    def depth(self, point: Point) -> float:
        """Return how far [m] a point in G lies inside the footprint; < 0 outside."""
        depths = []
        for a, b in self._edges():
            edge = (b[0] - a[0], b[1] - a[1])
            depths.append(
                cross(edge, (point[0] - a[0], point[1] - a[1])) / math.hypot(*edge)
            )
        return min(depths)

    def distance(self, point: Point) -> float:
        """Return the distance [m] from a point in G to the footprint; 0 inside."""
        if self.depth(point) >= 0.0:
            return 0.0
        return min(distance_to_segment(point, a, b) for a, b in self._edges())

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Return whether ``point`` [m] in B is ``margin`` [m] inside the footprint."""
        return all(
            inside + point[0] * nx + point[1] * ny >= margin
            for nx, ny, inside, _ in self._inward_edges(origin)
        )

    def rooms(self, points: Array, origin: Point) -> Array:
        """Return how far points (m, 2) [m] in B are inside the outline.

        In half widths across the nearest edge; < 0 outside. Of shape (m,).
        """
        import numpy as np

        nx, ny, inside, width = np.array(self._inward_edges(origin)).T
        room: Array = (2.0 * (inside + points @ np.stack([nx, ny])) / width).min(1)
        return room

    def ray(self, direction: Point, margin: float, origin: Point) -> float:
        """Return how far [m] one can go from B's origin along a unit vector.

        Up to ``margin`` [m] inside the outline.
        """
        ux, uy = direction
        return min(
            (inside - margin) / -(ux * nx + uy * ny)
            for nx, ny, inside, _ in self._inward_edges(origin)
            if ux * nx + uy * ny < -1e-9
        )

    def extent(self, direction: Point, origin: Point) -> float:
        """Return how far [m] the footprint extends from B's origin along a unit vector."""
        return max(
            (x - origin[0]) * direction[0] + (y - origin[1]) * direction[1]
            for x, y in self.corners
        )

    def farthest(self, origin: Point) -> float:
        """Return the distance [m] from B's origin to the farthest point of the outline."""
        return max(math.dist(corner, origin) for corner in self.corners)

    def gauge(self) -> Callable[[float, float], float]:
        """Return a function of (x, y) [m] from the middle: 0 there, 1 on the outline.

        It grows in proportion along each ray (the Minkowski gauge).
        """
        edges = self._outward_edges()

        def gauge(x: float, y: float) -> float:
            """Return 0 at the middle, 1 on the outline."""
            return max((x * out[0] + y * out[1]) / depth for out, depth in edges)

        return gauge

    def side_points(
        self, clearance: float, origin: Point
    ) -> tuple[tuple[Point, Point], ...]:
        """Return a point [m] in B on each side, and the inward unit normal there.

        The point nearest to the line through B's origin along the normal that is
        ``clearance`` [m] away from the corners, or the middle of a short edge. A round
        side counts as ``ROUND_SIDES`` sides.
        """
        corners = [(x - origin[0], y - origin[1]) for x, y in self.corners]
        out = []
        for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
            length = math.hypot(b[0] - a[0], b[1] - a[1])
            u = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
            along = -(a[0] * u[0] + a[1] * u[1])  # of the origin's foot, from corner a
            clear = min(clearance, 0.5 * length)
            place = min(max(along, clear), length - clear)
            foot = (a[0] + place * u[0], a[1] + place * u[1])
            out.append((foot, turned_left(u)))
        return tuple(out)

    def side(self, point: Point, normal: Point, origin: Point) -> Side:
        """Return the side on which a contact at ``point`` [m] in B is.

        ``normal`` is the contact's inward unit normal.
        """
        nx, ny = normal
        corners = [(x - origin[0], y - origin[1]) for x, y in self.corners]
        depth = min(nx * x + ny * y for x, y in corners)
        along = [
            nx * y - ny * x for x, y in corners if nx * x + ny * y < depth + ON_FACE
        ]
        return FlatSide(point, normal, depth, (min(along), max(along)))

    def base_rule(self, resolution: int) -> tuple[Array, Array]:
        """Return points (m, 2) [m] in G and areas (m,) [m^2] to integrate over the base."""
        from pushpressslide.core import quadrature

        return quadrature.base_rule(self.corners, resolution)

    def pressure(self, cop: Point, resolution: int) -> tuple[Array, Array, Array]:
        """Return points and areas like ``base_rule``, and pressures (m,) there.

        The pressure is linear and unilateral with its centre at ``cop`` [m] in G, of
        any size. Raises ValueError for a ``cop`` outside the base.
        """
        from pushpressslide.core import quadrature

        return quadrature.polygon_pressure(self.corners, cop, resolution)

    def _edges(self) -> zip[tuple[Point, Point]]:
        corners = self.corners
        return zip(corners, corners[1:] + corners[:1], strict=True)

    def _inward_edges(self, origin: Point) -> list[tuple[float, float, float, float]]:
        """Inward unit normal (x, y), depth of ``origin`` in G [m], width across [m]."""
        corners = self.corners
        out = []
        for (ax, ay), (bx, by) in self._edges():
            length = math.hypot(bx - ax, by - ay)
            nx = -(by - ay) / length
            ny = (bx - ax) / length
            inside = (origin[0] - ax) * nx + (origin[1] - ay) * ny
            width = max((x - ax) * nx + (y - ay) * ny for x, y in corners)
            out.append((nx, ny, inside, width))
        return out

    def _outward_edges(self) -> list[tuple[Point, float]]:
        """Outward unit normals and distances [m] from the middle."""
        mx, my = self.middle
        sides = []
        for (ax, ay), (bx, by) in self._edges():
            length = math.hypot(bx - ax, by - ay)
            out = ((by - ay) / length, (ax - bx) / length)
            sides.append((out, out[0] * (ax - mx) + out[1] * (ay - my)))
        return sides


@dataclass(frozen=True, slots=True)
class Box(Shape):
    """A cuboid; its frame G is at its centre."""

    size: tuple[float, float, float]  # [m] full lengths along x, y, z

    @property
    def height(self) -> float:
        """Height [m]."""
        return self.size[2]

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the base in G, counter-clockwise [m]."""
        a = 0.5 * self.size[0]
        b = 0.5 * self.size[1]
        return ((-a, -b), (a, -b), (a, b), (-a, b))

    @property
    def centroid(self) -> Point:
        """G's origin."""
        return ORIGIN

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        return "box " + " × ".join(f"{1e3 * v:g}" for v in self.size) + " mm"


@dataclass(frozen=True, slots=True)
class Prism(Shape):
    """An upright prism on a convex polygon; its frame G is the polygon's own origin."""

    polygon: tuple[Point, ...]  # [m] corners in G, counter-clockwise, convex
    height: float  # [m]

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the base in G, counter-clockwise [m]."""
        return self.polygon

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        return f"prism on {len(self.polygon)} corners, height {1e3 * self.height:g} mm"


@dataclass(frozen=True, slots=True)
class Cylinder(Shape):
    """An upright cylinder; its frame G is at its centre."""

    radius: float  # [m]
    height: float  # [m]

    @property
    def corners(self) -> tuple[Point, ...]:
        """No corners."""
        return ()

    @property
    def centroid(self) -> Point:
        """G's origin."""
        return ORIGIN

    @property
    def middle(self) -> Point:
        """G's origin."""
        return ORIGIN

    @property
    def inner_radius(self) -> float:
        """The radius [m]."""
        return self.radius

    @property
    def circumradius(self) -> float:
        """The radius [m]."""
        return self.radius

    @property
    def half_width(self) -> float:
        """The radius [m]."""
        return self.radius

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        radius = f"{1e3 * self.radius:g} mm"
        return f"cylinder, radius {radius}, height {1e3 * self.height:g} mm"

    def bounds(self, X_WG: Pose2) -> tuple[float, float, float, float]:
        """Return x_min, x_max, y_min, y_max [m] of the footprint at a pose."""
        r = self.radius
        return (X_WG.x - r, X_WG.x + r, X_WG.y - r, X_WG.y + r)

    def outline(self) -> tuple[Point, ...]:
        """Return ``OUTLINE_POINTS`` points of the circle [m]."""
        angles = (2.0 * math.pi * i / OUTLINE_POINTS for i in range(OUTLINE_POINTS))
        return tuple(
            (self.radius * math.cos(a), self.radius * math.sin(a)) for a in angles
        )

    def placed(self, X_WG: Pose2) -> Polygon:
        """Return the circle at a pose for Shapely, as a polygon of 256 sides."""
        from shapely import Point

        return Point(X_WG.x, X_WG.y).buffer(self.radius, quad_segs=64)

    def depth(self, point: Point) -> float:
        """Return how far [m] a point in G lies inside the circle; < 0 outside."""
        return self.radius - math.hypot(*point)

    def distance(self, point: Point) -> float:
        """Return the distance [m] from a point in G to the disc; 0 inside."""
        return max(math.hypot(*point) - self.radius, 0.0)

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Return whether ``point`` [m] in B is ``margin`` [m] inside the circle."""
        return (
            math.hypot(point[0] + origin[0], point[1] + origin[1])
            <= self.radius - margin
        )

    def rooms(self, points: Array, origin: Point) -> Array:
        """Return the depths (m,) of points (m, 2) over the radius."""
        import numpy as np

        x, y = (points + np.array(origin)).T
        room: Array = 1.0 - np.hypot(x, y) / self.radius
        return room

    def ray(self, direction: Point, margin: float, origin: Point) -> float:
        """Return the distance [m] to the circle that is ``margin`` [m] smaller.

        0 where B's origin is outside that circle and its line misses it.
        """
        cx, cy = origin
        radius = self.radius - margin
        b = cx * direction[0] + cy * direction[1]
        room = b * b - cx * cx - cy * cy + radius * radius
        return -b + math.sqrt(room) if room > 0.0 else 0.0

    def extent(self, direction: Point, origin: Point) -> float:
        """Return how far [m] the circle extends along a unit vector."""
        return self.radius - origin[0] * direction[0] - origin[1] * direction[1]

    def farthest(self, origin: Point) -> float:
        """Return the distance [m] from B's origin to the circle's far side."""
        return math.hypot(*origin) + self.radius

    def gauge(self) -> Callable[[float, float], float]:
        """Return the distance from the centre over the radius."""
        radius = self.radius

        def gauge(x: float, y: float) -> float:
            """Return 0 at the centre, 1 on the circle."""
            return math.hypot(x, y) / radius

        return gauge

    def side_points(
        self, clearance: float, origin: Point
    ) -> tuple[tuple[Point, Point], ...]:
        """Return points [m] in B in ``ROUND_SIDES`` directions, and inward normals."""
        out = []
        for i in range(ROUND_SIDES):
            angle = 2.0 * math.pi * i / ROUND_SIDES
            normal = (math.cos(angle), math.sin(angle))
            foot = (
                -self.radius * normal[0] - origin[0],
                -self.radius * normal[1] - origin[1],
            )
            out.append((foot, normal))
        return tuple(out)

    def side(self, point: Point, normal: Point, origin: Point) -> Side:
        """Return the round side."""
        return RoundSide((-origin[0], -origin[1]), self.radius, normal)

    def base_rule(self, resolution: int) -> tuple[Array, Array]:
        """Return points (m, 2) and areas (m,): Gauss points on rings."""
        from pushpressslide.core import quadrature

        return quadrature.disc_rule(self.radius, resolution)

    def pressure(self, cop: Point, resolution: int) -> tuple[Array, Array, Array]:
        """Return points, areas and pressures; the far side lifts for a far ``cop``."""
        from pushpressslide.core import quadrature

        return quadrature.disc_pressure(self.radius, cop, resolution)
