"""A body of any form that stands on its base, read from a mesh.

It is described by three outlines. The base is the part that touches the support. The
side is the outline that a tip meets at its height. The top is the level patch that a
press can use.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from pushpressslide.core.errors import InputError
from pushpressslide.core.margins import inset, rod_radius
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.geometry.areas import filled, joined_ring, largest
from pushpressslide.geometry.border import Border, BorderSide
from pushpressslide.geometry.outlined import Hull, Outlined, chords_in
from pushpressslide.geometry.polygon import convex_hull, counter_clockwise
from pushpressslide.geometry.rounded import rounded_border
from pushpressslide.geometry.shape import Shape
from pushpressslide.geometry.shapes import MeshSolid
from pushpressslide.geometry.touchable import Touchable, total_length, touchable

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

ENOUGH = 0.5
"""Share of the largest touchable length above which a height is accepted for a tip."""
JOINT = 1e-3
"""Gap [m] below which two sides count as continuous."""
WALL_ROOM = 2.0
"""Distance of a contact point from adjacent walls, as a multiple of its margin to the
edges of its patch.
"""
HEIGHT_DIGITS = 3
"""Decimal places [m] of a section's height."""
HEIGHTS = 24
"""Number of heights that are tried for a tip."""
QUADRANT = 16
"""Number of chords per quarter of an offset corner."""
BESIDE = 0.05
"""Allowed overlap of a tip with other parts of the body, in tip radii. A side that
leans by 18 degrees causes this overlap.
"""
NEAR = 0.2
"""Distance above and below a contact at which the lean of a side is measured, in tip
radii.
"""
PLACES = 9
"""Number of points along a side at which its lean is measured."""


@dataclass(frozen=True, slots=True)
class Band:
    """The body between two heights."""

    low: float  # [m]
    high: float  # [m]
    foot: Area  # [m^2] cross-section just above ``low``, in G
    head: Area  # the same just below ``high``

    def distance(self, height: float) -> float:
        """Distance [m] from a height to the band."""
        return max(self.low - height, height - self.high, 0.0)

    def section(self, height: float) -> Area:
        """Cross-section of the band nearest to a height."""
        return self.foot if height < 0.5 * (self.low + self.high) else self.head

    def depths(self, points: Sequence[Point], height: float) -> Array:
        """Depths (m,) [m] of points in G inside the body at a height of the band.
        Negative outside.
        """
        share = (height - self.low) / (self.high - self.low)
        return (1.0 - share) * _depths(self.foot, points) + share * _depths(
            self.head, points
        )


@dataclass(frozen=True, slots=True)
class Patch:
    """A level part of the top."""

    area: Area  # [m^2] in G
    height: float  # [m]
    walls: Area  # [m^2] in G, of what stands above it

    def inside(self, margin: float) -> Area:
        """Region of the patch at least ``margin`` [m] inside its edges, and
        ``WALL_ROOM`` times that distance from walls.
        """
        free = self.area.buffer(-margin, join_style="mitre")
        return free.difference(self.walls.buffer(WALL_ROOM * margin))


@dataclass(frozen=True, slots=True)
class SolidMoments:
    """Centre and second moments of a uniform solid with a mass of 1 kg."""

    center: tuple[float, float, float]  # [m] in G, above the support
    inertia: tuple[float, ...]  # [m^2] about it: xx, yy, zz, xy, xz, yz


@dataclass(frozen=True, eq=False)
class MeshBody(MeshSolid):
    """A mesh body whose base, side and top have separate outlines.

    ``polygon`` is the outline seen from above. Two bodies are equal if they come from
    the same file with the same content.
    """

    bands: tuple[Band, ...] = field(kw_only=True, repr=False)
    base: Area = field(kw_only=True, repr=False)  # [m^2] in G
    top: Patch | None = field(kw_only=True, repr=False)
    solid: SolidMoments = field(kw_only=True, repr=False)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MeshBody) and self._key == other._key

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> tuple[object, ...]:
        return (self.path, self.scale, self.up, self.polygon, self.height, self.solid)

    @cached_property
    def base_corners(self) -> tuple[Point, ...]:
        """Corners in G [m] of one ring about all parts of the base."""
        return joined_ring(self.base)

    @cached_property
    def hull(self) -> Shape:
        """The upright body on the convex hull of the base, which decides tipping."""
        return Hull(convex_hull(self.base_corners), self.height)

    def resized(self, growth: Point) -> MeshSolid:
        """Raises InputError: there is no body of another size."""
        raise InputError("growth of a body with sides that lean; must be (0, 0)")

    @property
    def circumradius(self) -> float:
        """Distance [m] from the middle of the base to the farthest point of the body."""
        return self.farthest(self.middle)

    @cached_property
    def breadth(self) -> float:
        """Width [m] of the base at its narrow part."""
        return min(self.hull.breadth, 4.0 * self.base.area / self.base.length)

    @property
    def convex(self) -> bool:
        """False: the body is not an upright prism with a convex outline."""
        return False

    @property
    def base_area(self) -> float:
        """Area [m^2] of the base on the support."""
        return float(self.base.area)

    @property
    def top_height(self) -> float:
        """Height [m] of the level patch on top."""
        return self.height if self.top is None else self.top.height

    @cached_property
    def pressed_inside(self) -> bool:
        """Whether the level patch on top is the floor of a hollow."""
        if self.top is None:
            return False
        around = [band.foot for band in self.bands if band.low > self.top.height]
        return any(filled(area).covers(self.top.area) for area in around)

    @property
    def description(self) -> str:
        """Kind and size in words, in millimetres."""
        x_min, x_max, y_min, y_max = self.bounds(Pose2())
        lengths = (x_max - x_min, y_max - y_min, self.height)
        return "mesh " + " × ".join(f"{1e3 * v:.3g}" for v in lengths) + " mm"

    def base_depth(self, point: Point) -> float:
        """Depth [m] of a point in G inside the hull of the base. Negative outside."""
        return self.hull.depth(point)

    def extent(self, direction: Point, origin: Point) -> float:
        """Extent [m] of the base from B's origin along a unit vector."""
        return self.hull.extent(direction, origin)

    def has_top(self, margin: float) -> bool:
        """Whether the level patch on top has a point at least ``margin`` [m] inside its
        edges.
        """
        return not _inside_top(self, margin).is_empty

    def holds(self, point: Point, margin: float, origin: Point) -> bool:
        """Whether ``point`` [m] in B is at least ``margin`` [m] inside the level patch
        on top.
        """
        from shapely import Point as Place

        place = Place(point[0] + origin[0], point[1] + origin[1])
        return self.top is not None and bool(_inside_top(self, margin).covers(place))

    def chords(
        self, direction: Point, margin: float, origin: Point
    ) -> tuple[tuple[float, float], ...]:
        """Intervals [m] of a ray from B's origin along a unit vector that are at least
        ``margin`` [m] inside the level patch on top, the nearest first.
        """
        if self.top is None:
            return ()
        return chords_in(_inside_top(self, margin), direction, origin)

    def section(self, height: float, lean: float = 0.5 * math.pi) -> Shape:
        """The body as met by a tip at a height [m].

        Sides that lean by more than ``lean`` [rad] cannot be touched.
        """
        return _section(self, round(height, HEIGHT_DIGITS), lean)

    def side_height(
        self, wanted: float, bounds: tuple[float, float], tip_radius: float, lean: float
    ) -> float:
        """Height [m] between ``bounds``, near ``wanted``, at which a tip can touch much
        of the side.

        It is the height nearest to ``wanted`` among those at which the touchable length
        is not much below the largest.
        """
        return _side_height(self, wanted, bounds, tip_radius, lean)

    def section_depths(self, points: Sequence[Point], height: float) -> Array:
        """Depths (m,) [m] of points in G inside the body's cross-section at a height,
        or at the nearest height that the body has.

        Depths are negative outside.
        """
        band = min(self.bands, key=lambda band: band.distance(height))
        return band.depths(points, min(max(height, band.low), band.high))

    def obstruction(self, height: float, tip_radius: float) -> Area:
        """Region of G that the centre of a tip at a ``height`` [m] cannot enter.

        The tip's ball and the rod above it must both stay clear of the body.
        """
        import shapely

        rod = rod_radius(tip_radius)
        parts = []
        for level, section in self._slices(height):
            reach = math.sqrt(max(tip_radius**2 - (level - height) ** 2, 0.0))
            if level > height:
                reach = max(reach, rod)
            if reach > 0.0:
                parts.append(section.buffer(reach, quad_segs=QUADRANT))
        return filled(shapely.union_all(parts))

    def _slices(self, height: float) -> Iterator[tuple[float, Area]]:
        """Cross-sections and their heights [m]: one at ``height``, and those at the
        ends of the bands.
        """
        for band in self.bands:
            if band.distance(height) == 0.0:
                yield height, band.foot.intersection(band.head)
            yield band.low, band.foot
            yield band.high, band.head


@dataclass(frozen=True, eq=False)
class Section(Outlined):
    """The body as met by a tip at one height."""

    body: MeshBody
    level: float  # [m] of the tip's centre
    lean: float  # [rad] of the sides that the tip may touch

    @property
    def height(self) -> float:
        """Height [m] of the body."""
        return self.body.height

    @cached_property
    def border(self) -> Border:
        """The border of the cross-section's largest part."""
        band = min(self.body.bands, key=lambda band: band.distance(self.level))
        ring = largest(band.section(self.level)).exterior.coords[:-1]
        return rounded_border(counter_clockwise(tuple((x, y) for x, y in ring)))

    @property
    def description(self) -> str:
        """Kind in words."""
        return f"{self.body.description} at {1e3 * self.level:.0f} mm"

    def touchable(self, tip_radius: float) -> tuple[Touchable, ...]:
        """Parts of the border that a tip can touch."""
        if tip_radius == 0.0:
            return touchable(self.border, tip_radius)
        around = self.body.obstruction(self.level, tip_radius)
        parts = touchable(self.border, tip_radius, around.buffer(-BESIDE * tip_radius))
        upright = [
            part for part in parts if self.side_lean(part.side, tip_radius) <= self.lean
        ]
        shortest = 2.0 * inset(tip_radius)
        runs = [run for run in _runs(upright) if total_length(run) >= shortest]
        return tuple(part for run in runs for part in run)

    def least_lean(self, tip_radius: float) -> float:
        """Lean [rad] of the most upright side that the tip can touch."""
        return min(self.side_lean(side, tip_radius) for side in self.border.sides)

    def side_lean(self, side: BorderSide, tip_radius: float) -> float:
        """Largest lean [rad] from the vertical of a side near the contact of a tip.

        Either the upper or the lower part of the side may be in front.
        """
        points = side.points(PLACES)
        near = NEAR * tip_radius
        here = self.body.section_depths(points, self.level)
        ends = (self.level - near, self.level + near)
        ahead = max(
            float((self.body.section_depths(points, z) - here).max()) for z in ends
        )
        return math.atan(max(ahead, 0.0) / near)


def _runs(parts: Sequence[Touchable]) -> list[list[Touchable]]:
    """Runs of consecutive parts of a border, counter-clockwise."""
    runs: list[list[Touchable]] = []
    for part in parts:
        if runs and _meet(runs[-1][-1], part):
            runs[-1].append(part)
        else:
            runs.append([part])
    if len(runs) > 1 and _meet(runs[-1][-1], runs[0][0]):
        runs[0] = runs.pop() + runs[0]
    return runs


def _meet(one: Touchable, other: Touchable) -> bool:
    gap = math.dist(one.side.points(2)[-1], other.side.points(2)[0])
    return gap < JOINT


def _depths(area: Area, points: Sequence[Point]) -> Array:
    """Depths (m,) [m] of points inside an area. Negative outside."""
    import numpy as np
    import shapely

    places = shapely.points(np.array(points))
    away = shapely.distance(places, area.boundary)
    out: Array = np.where(shapely.covers(area, places), away, -away)
    return out


@lru_cache(maxsize=64)
def _inside_top(body: MeshBody, margin: float) -> Area:
    """Region of the level patch on top in which a tip can press."""
    import shapely

    if body.top is None:
        return shapely.Polygon()
    inside = body.top.inside(margin)
    shapely.prepare(inside)
    return inside


@lru_cache(maxsize=256)
def _section(body: MeshBody, height: float, lean: float) -> Section:
    return Section(body, height, lean)


@lru_cache(maxsize=64)
def _side_height(
    body: MeshBody,
    wanted: float,
    bounds: tuple[float, float],
    tip_radius: float,
    lean: float,
) -> float:
    low, high = bounds
    step = max(high - low, 0.0) / HEIGHTS
    heights = [wanted, *(low + step * i for i in range(HEIGHTS + 1))]
    lengths: Mapping[float, float] = {
        height: total_length(_section(body, height, lean).touchable(tip_radius))
        for height in heights
    }
    enough = ENOUGH * max(lengths.values())
    serving = [height for height in heights if lengths[height] >= enough]
    return min(serving, key=lambda height: abs(height - wanted))
