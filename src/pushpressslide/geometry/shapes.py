"""Shapes of objects: boxes, prisms, cylinders, compounds of these, and meshes.

A new kind of shape needs only one new class, which defines its corners or its border,
or overrides the methods.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from pushpressslide.core.checks import check_places, check_pose, check_positive
from pushpressslide.core.errors import InputError
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.border import Border, border_of, round_border
from pushpressslide.geometry.outlined import Outlined
from pushpressslide.geometry.polygon import is_convex, signed_area
from pushpressslide.geometry.shape import ORIGIN, Ends, Shape
from pushpressslide.geometry.sides import ROUND_SIDES, RoundSide, Side, SidePlace
from pushpressslide.geometry.united import united

if TYPE_CHECKING:
    from shapely import Polygon

    from pushpressslide.core.arrays import Array

__all__ = [
    "Box",
    "Compound",
    "ConcavePrism",
    "Cylinder",
    "MeshSolid",
    "Part",
    "Prism",
    "Shape",
]

OUTLINE_POINTS = 48  # per drawn circle


@dataclass(frozen=True, slots=True)
class Box(Shape):
    """A cuboid with its frame G at its centre.

    Raises InputError unless its three lengths are finite and > 0.
    """

    size: tuple[float, float, float]  # [m] full lengths along x, y, z

    def __post_init__(self) -> None:
        if not hasattr(self.size, "__len__") or len(self.size) != 3:
            raise InputError(f"size {self.size!r} m; must be three lengths")
        for length in self.size:
            check_positive(length, "size")

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

    def resized(self, growth: Point) -> Box:
        """Box whose length and width differ by ``growth`` [m]."""
        length, width, height = self.size
        return Box((length + growth[0], width + growth[1], height))

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
    """An upright prism on a simple polygon, with its frame G at the polygon's origin.

    A concave polygon gives a ``ConcavePrism``. Raises InputError for a height that is
    not finite and > 0, and for corners that are not finite or run clockwise.
    """

    polygon: tuple[Point, ...]  # [m] corners in G, counter-clockwise
    height: float  # [m]

    def __new__(cls, polygon: tuple[Point, ...] = (), height: float = 0.0) -> Prism:
        """A ``Prism`` for a convex polygon, a ``ConcavePrism`` for a concave one."""
        has_corners = hasattr(polygon, "__len__") and len(polygon) > 2
        if cls is not Prism or not has_corners:
            return object.__new__(cls)
        check_places(polygon, "polygon", 3)
        return object.__new__(Prism if is_convex(polygon) else ConcavePrism)

    def __post_init__(self) -> None:
        check_places(self.polygon, "polygon", 3)
        check_positive(self.height, "height")
        if not signed_area(self.polygon) > 0.0:
            raise InputError("the corners of a prism must run counter-clockwise")

    @property
    def corners(self) -> tuple[Point, ...]:
        """Corners of the base in G, counter-clockwise [m]."""
        return self.polygon

    def resized(self, growth: Point) -> Prism:
        """Prism on the scaled polygon."""
        return Prism(self._enlarged(self.polygon, growth), self.height)

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        return f"prism on {len(self.polygon)} corners, height {1e3 * self.height:g} mm"


class ConcavePrism(Outlined, Prism):
    """An upright prism on a concave polygon."""

    @cached_property
    def border(self) -> Border:
        """The border of the footprint in G."""
        return border_of(self.polygon)


@dataclass(frozen=True, slots=True)
class Cylinder(Shape):
    """An upright cylinder with its frame G at its centre.

    Raises InputError unless radius and height are finite and > 0.
    """

    radius: float  # [m]
    height: float  # [m]

    def __post_init__(self) -> None:
        check_positive(self.radius, "radius")
        check_positive(self.height, "height")

    @property
    def corners(self) -> tuple[Point, ...]:
        """No corners."""
        return ()

    @property
    def edges(self) -> tuple[Ends | None, ...]:
        """No edges."""
        return ()

    @property
    def border(self) -> Border:
        """The circle."""
        return round_border(self.radius)

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

    def resized(self, growth: Point) -> Cylinder:
        """Cylinder of another diameter. Raises InputError for an oval."""
        across, along = growth
        if across != along:
            raise InputError(f"growth {growth!r} m of a cylinder; must be equal")
        return Cylinder(self.radius + 0.5 * across, self.height)

    def bounds(self, X_WG: Pose2) -> tuple[float, float, float, float]:
        """Bounds x_min, x_max, y_min, y_max [m] of the footprint at a pose."""
        r = self.radius
        return (X_WG.x - r, X_WG.x + r, X_WG.y - r, X_WG.y + r)

    def outline(self) -> tuple[Point, ...]:
        """``OUTLINE_POINTS`` points of the circle [m]."""
        angles = (2.0 * math.pi * i / OUTLINE_POINTS for i in range(OUTLINE_POINTS))
        return tuple(
            (self.radius * math.cos(a), self.radius * math.sin(a)) for a in angles
        )

    def placed(self, X_WG: Pose2) -> Polygon:
        """Circle at a pose for Shapely, as a polygon of 256 sides."""
        from shapely import Point

        return Point(X_WG.x, X_WG.y).buffer(self.radius, quad_segs=64)

    def depth(self, point: Point) -> float:
        """Depth [m] of a point in G inside the circle. Negative outside."""
        return self.radius - math.hypot(*point)

    def distance(self, point: Point) -> float:
        """Distance [m] from a point in G to the disc. 0 inside."""
        return max(math.hypot(*point) - self.radius, 0.0)

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Whether ``point`` [m] in B is at least ``margin`` [m] inside the circle."""
        return (
            math.hypot(point[0] + origin[0], point[1] + origin[1])
            <= self.radius - margin
        )

    def depths(self, points: Array, origin: Point) -> Array:
        """Depths (m,) of points (m, 2), as fractions of the radius."""
        import numpy as np

        x, y = (points + np.array(origin)).T
        room: Array = 1.0 - np.hypot(x, y) / self.radius
        return room

    def chords(
        self, direction: Point, margin: float, origin: Point
    ) -> tuple[tuple[float, float], ...]:
        """The single chord [m] along a ray, up to the circle whose radius is smaller by
        ``margin`` [m].

        The chord has no length if the line of the ray misses that circle.
        """
        cx, cy = origin
        radius = self.radius - margin
        b = cx * direction[0] + cy * direction[1]
        room = b * b - cx * cx - cy * cy + radius * radius
        return ((0.0, -b + math.sqrt(room) if room > 0.0 else 0.0),)

    def extent(self, direction: Point, origin: Point) -> float:
        """Extent [m] of the circle along a unit vector."""
        return self.radius - origin[0] * direction[0] - origin[1] * direction[1]

    def farthest(self, origin: Point) -> float:
        """Distance [m] from B's origin to the circle's far side."""
        return math.hypot(*origin) + self.radius

    def gauge(self) -> Callable[[float, float], float]:
        """Gauge function: the distance from the centre, divided by the radius."""
        radius = self.radius

        def gauge(x: float, y: float) -> float:
            """Gauge value: 0 at the centre, 1 on the circle."""
            return math.hypot(x, y) / radius

        return gauge

    def side_places(
        self, clearance: float, tip_radius: float, origin: Point
    ) -> tuple[SidePlace, ...]:
        """Contact places in ``ROUND_SIDES`` directions."""
        out = []
        for i in range(ROUND_SIDES):
            angle = 2.0 * math.pi * i / ROUND_SIDES
            normal = (math.cos(angle), math.sin(angle))
            foot = (
                -self.radius * normal[0] - origin[0],
                -self.radius * normal[1] - origin[1],
            )
            out.append(SidePlace(i, foot, normal, None))
        return tuple(out)

    def side(self, point: Point, normal: Point, origin: Point) -> Side:
        """The round side, at the contact."""
        return RoundSide((-origin[0], -origin[1]), self.radius, normal)

    @property
    def base_corners(self) -> tuple[Point, ...]:
        """Corners in G [m] of a polygon with the disc's second moment."""
        from pushpressslide.geometry import quadrature

        return quadrature.disc_corners(self.radius)

    def base_rule(self, resolution: int) -> tuple[Array, Array]:
        """Points (m, 2) [m] and areas (m,) [m^2] of a quadrature rule: Gauss points on
        rings.
        """
        from pushpressslide.geometry import quadrature

        return quadrature.disc_rule(self.radius, resolution)

    def pressure(self, cop: Point, resolution: int) -> tuple[Array, Array, Array]:
        """Points, areas and pressures. If ``cop`` is far off centre, the opposite side
        lifts.
        """
        from pushpressslide.geometry import quadrature

        return quadrature.disc_pressure(self.radius, cop, resolution)


@dataclass(frozen=True, slots=True)
class Part:
    """One part of a compound."""

    shape: Box | Prism | Cylinder
    pose: Pose2  # of its own frame in the compound's G

    def __post_init__(self) -> None:
        check_pose(self.pose, "pose of a part")


@dataclass(frozen=True)
class Compound(Outlined):
    """The union of upright parts of the same height, connected and without holes.

    A cylinder's side stays round wherever it is part of the border. Raises InputError
    if there are no parts. Its border raises ValueError if the union has a hole or is
    not connected.
    """

    parts: tuple[Part, ...]

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("parts of a compound: none; must be one or more")
        for part in self.parts:
            if not isinstance(part, Part):
                raise InputError(f"part of a compound {part!r}; must be a Part")

    @property
    def height(self) -> float:
        """Height [m], shared by all parts."""
        return self.parts[0].shape.height

    @cached_property
    def border(self) -> Border:
        """The border of the union in G."""
        return united([part.shape.border.transformed(part.pose) for part in self.parts])

    def resized(self, growth: Point) -> Prism:
        """Prism on the scaled outline."""
        return Prism(self._enlarged(self.outline(), growth), self.height)

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        height = f"height {1e3 * self.height:g} mm"
        return f"compound of {len(self.parts)} parts, {height}"


@dataclass(frozen=True)
class MeshSolid(Outlined):
    """An upright solid with a border read from a mesh.

    G is the frame of the file, rotated so that its axis ``up`` points up.
    """

    path: str  # of the file
    scale: float  # [m] per unit of the file
    polygon: tuple[Point, ...]  # [m] corners in G, counter-clockwise
    height: float  # [m]
    center: Point  # [m] in G, centroid of the solid as seen from above
    up: str = "z"  # axis of the file that points up: x, y, z, -x, -y or -z
    note: str = ""  # how the file's surface was simplified, and why
    file_mass: float | None = None  # [kg] mass in the file

    def __post_init__(self) -> None:
        check_positive(self.scale, "scale")
        check_places(self.polygon, "polygon", 3)
        check_positive(self.height, "height")
        check_places((self.center,), "center")

    @cached_property
    def border(self) -> Border:
        """The border of the footprint in G."""
        return border_of(self.polygon)

    def resized(self, growth: Point) -> MeshSolid:
        """Solid on the scaled outline."""
        corners = self._enlarged(self.polygon, growth)
        (center,) = self._enlarged((self.center,), growth)
        return replace(self, polygon=corners, center=center)

    @property
    def centroid(self) -> Point:
        """Centroid [m] of the solid in G, projected on the support."""
        return self.center

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        height = f"height {1e3 * self.height:g} mm"
        turned = "" if self.up == "z" else f", {self.up} of the file up"
        return f"mesh on {len(self.polygon)} corners, {height}{turned}"
