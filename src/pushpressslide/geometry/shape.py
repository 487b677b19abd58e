"""The interface of a shape: an upright body on a footprint.

A shape is given in its own frame G. A method with an ``origin`` takes and returns
points in B. Frame B has the axes of G, and its origin is at ``origin`` [m] in G, the
projected centre of mass.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, Pose2, cross, turned_left
from pushpressslide.geometry.border import Border, border_of
from pushpressslide.geometry.polygon import centroid, distance_to_segment
from pushpressslide.geometry.sides import ON_FACE, FlatSide, Side, SidePlace
from pushpressslide.geometry.touchable import Touchable, touchable

if TYPE_CHECKING:
    from shapely import Polygon

    from pushpressslide.core.arrays import Array

ORIGIN: Point = (0.0, 0.0)

Ends = tuple[Point, Point]
"""Ends in G [m] of a straight edge of a footprint, counter-clockwise."""


InwardEdge = tuple[float, float, float, float]
"""Inward unit normal (x, y) of an edge, the depth [m] of a point of G inside the edge,
and the width [m] of the footprint perpendicular to it.
"""

KEPT = 256  # footprints of which the edges are remembered


@lru_cache(maxsize=KEPT)
def inward_edges(corners: tuple[Point, ...], origin: Point) -> tuple[InwardEdge, ...]:
    """Edges [m] of a convex, counter-clockwise polygon relative to ``origin`` [m].

    They are cached, since tips on top use them often.
    """
    out = []
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.hypot(bx - ax, by - ay)
        nx = -(by - ay) / length
        ny = (bx - ax) / length
        inside = (origin[0] - ax) * nx + (origin[1] - ay) * ny
        width = max((x - ax) * nx + (y - ay) * ny for x, y in corners)
        out.append((nx, ny, inside, width))
    return tuple(out)


class Shape:
    """Base class of shapes, implemented for the corners of a convex footprint."""

    __slots__ = ()

    if TYPE_CHECKING:  # a property here would be the default of a subclass's field

        @property
        def height(self) -> float:
            """Height [m]."""

        @property
        def description(self) -> str:
            """Kind and size in words, in millimetres."""

        @property
        def note(self) -> str:
            """How the surface in the file was simplified, and why. Empty for most
            shapes.
            """

        @property
        def file_mass(self) -> float | None:
            """Mass [kg] given in the shape's file. None for most shapes."""

    else:
        note = ""
        file_mass = None

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the footprint in G, counter-clockwise [m]. Empty for a round one.

        Edge i, the foot of flat side i, leads from corner i to the next.
        """
        raise NotImplementedError

    @property
    def edges(self) -> tuple[Ends | None, ...]:
        """Ends of each side of the footprint, counter-clockwise. None for a round side."""
        return tuple(self._edges())

    @property
    def border(self) -> Border:
        """The border of the footprint in G."""
        return border_of(self.corners)

    @property
    def convex(self) -> bool:
        """Whether the footprint is convex."""
        return True

    @property
    def hull(self) -> Shape:
        """The upright body on the convex hull of the base, which decides tipping."""
        return self

    @property
    def top_height(self) -> float:
        """Height [m] of the level patch on top that a tip can press."""
        return self.height

    def has_top(self, margin: float) -> bool:
        """Whether the level patch on top has a point at least ``margin`` [m] inside its
        edges.
        """
        return self.inner_radius >= margin

    def section(self, height: float, lean: float = 0.5 * math.pi) -> Shape:
        """The body as met by a tip at ``height`` [m], without sides that lean by more
        than ``lean`` [rad]. Upright bodies are the same at every height.
        """
        return self

    def touchable(self, tip_radius: float) -> tuple[Touchable, ...]:
        """Parts of the border that a tip can touch."""
        return touchable(self.border, tip_radius)

    def least_lean(self, tip_radius: float) -> float:
        """Lean [rad] of the most upright side that a tip can touch. 0 for an upright
        body.
        """
        return 0.0

    def side_height(
        self, wanted: float, bounds: tuple[float, float], tip_radius: float, lean: float
    ) -> float:
        """Height [m] at which a tip can touch much of the side. ``wanted`` for an
        upright body.
        """
        return wanted

    def base_depth(self, point: Point) -> float:
        """Depth [m] of a point in G inside the base. Negative outside."""
        return self.depth(point)

    @property
    def centroid(self) -> Point:
        """Centroid of the footprint in G [m]."""
        return centroid(self.corners)

    @property
    def middle(self) -> Point:
        """Mean of the corners in G [m], or the centre of a round footprint."""
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
    def base_area(self) -> float:
        """Contact area [m^2] of the base on the support."""
        return float(self.placed(Pose2()).area)

    @property
    def half_width(self) -> float:
        """Half of the smallest width of the footprint [m]."""
        return 0.5 * min(width for _, _, _, width in self._inward_edges(ORIGIN))

    @property
    def breadth(self) -> float:
        """Width [m] of the footprint at its narrow part: the width of the bounding
        rectangle.
        """
        x_min, x_max, y_min, y_max = self.bounds(Pose2())
        return min(x_max - x_min, y_max - y_min)

    def bounds(self, X_WG: Pose2) -> tuple[float, float, float, float]:
        """Bounds x_min, x_max, y_min, y_max [m] of the footprint at a pose."""
        xs, ys = zip(*(X_WG.apply(corner) for corner in self.corners), strict=True)
        return (min(xs), max(xs), min(ys), max(ys))

    def outline(self) -> tuple[Point, ...]:
        """Points [m] in G through which to draw the footprint."""
        return self.corners

    def resized(self, growth: Point) -> Shape:
        """The shape scaled about the middle of its bounds, so that these grow by
        ``growth`` [m] along x and y of G.

        Raises InputError for a shape that would vanish, and for a kind of shape that
        cannot have that size.
        """
        raise InputError(f"growth of a {type(self).__name__}; must be (0, 0)")

    def _enlarged(self, points: tuple[Point, ...], growth: Point) -> tuple[Point, ...]:
        """Points [m] in G of the shape, scaled with it by ``growth`` [m].

        Raises InputError if the growth leaves nothing.
        """
        x_min, x_max, y_min, y_max = self.bounds(Pose2())
        length = x_max - x_min
        width = y_max - y_min
        dx, dy = growth
        if dx <= -length or dy <= -width:
            raise InputError(f"growth {growth!r} m; must be more than minus the extent")
        x = 0.5 * (x_min + x_max)
        y = 0.5 * (y_min + y_max)
        kx = 1.0 + dx / length
        ky = 1.0 + dy / width
        return tuple((x + kx * (px - x), y + ky * (py - y)) for px, py in points)

    def placed(self, X_WG: Pose2) -> Polygon:
        """The footprint at a pose as a Shapely polygon. A circle has 256 sides."""
        from shapely import Polygon

        return Polygon([X_WG.apply(corner) for corner in self.corners])

    def depth(self, point: Point) -> float:
        """Depth [m] of a point in G inside the footprint. Negative outside."""
        depths = []
        for a, b in self._edges():
            edge = (b[0] - a[0], b[1] - a[1])
            depths.append(
                cross(edge, (point[0] - a[0], point[1] - a[1])) / math.hypot(*edge)
            )
        return min(depths)

    def distance(self, point: Point) -> float:
        """Distance [m] from a point in G to the footprint. 0 inside."""
        if self.depth(point) >= 0.0:
            return 0.0
        return min(distance_to_segment(point, a, b) for a, b in self._edges())

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Whether ``point`` [m] in B is at least ``margin`` [m] inside the footprint."""
        return all(
            inside + point[0] * nx + point[1] * ny >= margin
            for nx, ny, inside, _ in self._inward_edges(origin)
        )

    def depths(self, points: Array, origin: Point) -> Array:
        """Depths (m,) of points (m, 2) [m] in B inside the outline, as fractions of its
        half width.

        The depth inside each edge is divided by half the width of the outline across
        that edge, and the smallest quotient is taken. The result is negative outside.
        """
        import numpy as np

        nx, ny, inside, width = np.array(self._inward_edges(origin)).T
        room: Array = (2.0 * (inside + points @ np.stack([nx, ny])) / width).min(1)
        return room

    def chords(
        self, direction: Point, margin: float, origin: Point
    ) -> tuple[tuple[float, float], ...]:
        """Intervals [m] of a ray from B's origin along a unit vector that are at least
        ``margin`` [m] inside the outline, the nearest first.
        """
        ux, uy = direction
        far = min(
            (inside - margin) / -(ux * nx + uy * ny)
            for nx, ny, inside, _ in self._inward_edges(origin)
            if ux * nx + uy * ny < -1e-9
        )
        return ((0.0, far),)

    def extent(self, direction: Point, origin: Point) -> float:
        """Extent [m] of the footprint from B's origin along a unit vector."""
        return max(
            (x - origin[0]) * direction[0] + (y - origin[1]) * direction[1]
            for x, y in self.corners
        )

    def farthest(self, origin: Point) -> float:
        """Distance [m] from B's origin to the farthest point of the outline."""
        return max(math.dist(corner, origin) for corner in self.corners)

    def gauge(self) -> Callable[[float, float], float]:
        """Minkowski gauge of (x, y) [m] from the middle: 0 at the middle, 1 on the
        outline.

        It grows linearly along each ray from the middle.
        """
        edges = [(x / depth, y / depth) for (x, y), depth in self._outward_edges()]

        def gauge(x: float, y: float) -> float:
            """Gauge value: 0 at the middle, 1 on the outline."""
            farthest = 0.0
            for a, b in edges:
                out = a * x + b * y
                if out > farthest:
                    farthest = out
            return farthest

        return gauge

    def side_places(
        self, clearance: float, tip_radius: float, origin: Point
    ) -> tuple[SidePlace, ...]:
        """One contact place in B on each side that a tip of ``tip_radius`` [m] can
        touch.

        The place is as near as possible to the foot of the perpendicular from B's
        origin, but at least ``clearance`` [m] from the corners. On a short edge it is
        the middle. A round side counts as ``ROUND_SIDES`` sides.
        """
        corners = [(x - origin[0], y - origin[1]) for x, y in self.corners]
        out = []
        for i, (a, b) in enumerate(
            zip(corners, (*corners[1:], corners[0]), strict=True)
        ):
            length = math.hypot(b[0] - a[0], b[1] - a[1])
            u = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
            along = -(a[0] * u[0] + a[1] * u[1])  # of the origin's foot, from corner a
            clear = min(clearance, 0.5 * length)
            place = min(max(along, clear), length - clear)
            foot = (a[0] + place * u[0], a[1] + place * u[1])
            normal = turned_left(u)
            left = turned_left(normal)
            ends = (b[0] * left[0] + b[1] * left[1], a[0] * left[0] + a[1] * left[1])
            out.append(SidePlace(i, foot, normal, ends))
        return tuple(out)

    def side(self, point: Point, normal: Point, origin: Point) -> Side:
        """Side of a contact at ``point`` [m] in B.

        ``normal`` is the contact's inward unit normal.
        """
        nx, ny = normal
        corners = [(x - origin[0], y - origin[1]) for x, y in self.corners]
        depth = min(nx * x + ny * y for x, y in corners)
        along = [
            nx * y - ny * x for x, y in corners if nx * x + ny * y < depth + ON_FACE
        ]
        return FlatSide(point, normal, depth, (min(along), max(along)))

    def walls(self, point: Point, normal: Point, origin: Point) -> tuple[Side, ...]:
        """Sides that a tip may meet besides that of its contact at ``point`` [m] in B.
        Empty for a convex footprint.
        """
        return ()

    def free_space(
        self, point: Point, normal: Point, tip_radius: float, origin: Point
    ) -> float:
        """Largest retreat [m] of a tip from a contact at ``point`` [m] in B, against
        its inward ``normal``. Infinite if nothing blocks it.
        """
        return math.inf

    @property
    def base_corners(self) -> tuple[Point, ...]:
        """Corners in G [m] of the polygon that carries the pressure. A round footprint
        is replaced by a polygon with many corners.
        """
        return self.corners

    def base_rule(self, resolution: int) -> tuple[Array, Array]:
        """Points (m, 2) [m] in G and areas (m,) [m^2] of a quadrature rule over the
        base.
        """
        from pushpressslide.geometry import quadrature

        return quadrature.base_rule(self.base_corners, resolution)

    def pressure(self, cop: Point, resolution: int) -> tuple[Array, Array, Array]:
        """Points and areas as in ``base_rule``, and pressures (m,) at the points.

        The pressure is linear and unilateral with its centre at ``cop`` [m] in G, not
        normalised. Raises ValueError for a ``cop`` outside the base.
        """
        from pushpressslide.geometry import quadrature

        return quadrature.polygon_pressure(self.base_corners, cop, resolution)

    def _edges(self) -> zip[tuple[Point, Point]]:
        corners = self.corners
        return zip(corners, corners[1:] + corners[:1], strict=True)

    def _inward_edges(self, origin: Point) -> tuple[InwardEdge, ...]:
        """The edges relative to a point of G."""
        return inward_edges(self.corners, origin)

    def _outward_edges(self) -> list[tuple[Point, float]]:
        """Outward unit normals of the edges, and their distances [m] from the middle."""
        mx, my = self.middle
        sides = []
        for (ax, ay), (bx, by) in self._edges():
            length = math.hypot(bx - ax, by - ay)
            out = ((by - ay) / length, (ax - bx) / length)
            sides.append((out, out[0] * (ax - mx) + out[1] * (ay - my)))
        return sides
