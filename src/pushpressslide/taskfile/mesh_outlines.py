"""Outlines of a body in a mesh that is not an upright prism: base, side and top."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point
from pushpressslide.geometry.areas import (
    filled,
    inner_radius,
    joined_ring,
    largest,
    polygons,
)
from pushpressslide.geometry.mesh_body import Band, MeshBody, Patch, SolidMoments
from pushpressslide.geometry.polygon import counter_clockwise
from pushpressslide.taskfile.mesh_slices import Slices, slices_of
from pushpressslide.taskfile.mesh_surface import Surface

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

BASE_HEIGHTS = (2e-4, 1e-3)
"""Heights [m] above the lowest point up to which a face belongs to the base. The larger
one is used if the body would not stand on the base given by the smaller one.
"""
NEAR = 0.01
"""Distance below which two levels count as one, as a share of the body's height."""
GAP = 2.0
"""Half of the largest gap that does not separate two bodies, as a multiple of the
smallest detail.
"""
CRUMBS = 0.01
"""Share of a footprint that may be separate from the rest."""
MOST_CORNERS = 256
"""Largest number of corners in the outline seen from above."""
LEVELS = 40
"""Number of levels for a body whose corners have more different heights than this."""
STEP = 1e-3
"""Largest distance [m] between the outlines at the two ends of a band."""
FINEST = 24
"""Largest number of bands between two heights of corners."""
END = 0.02
"""Distance of a band's outlines from its ends, as a share of its height."""
LEVEL = math.radians(2.0)
"""Largest slope [rad] of a patch on top that counts as level."""
ENOUGH = 0.5
"""Smallest size of a patch that a press may use, as a share of the size of the largest
patch. The highest patch of at least this size is pressed. The size of a patch is the
radius of the largest disc in it.
"""
SMALLEST_PATCH = 0.004
"""Smallest radius [m] of the largest disc in a patch."""


def read_outlines(surface: Surface, path: str, scale: float, up: str) -> MeshBody:
    """Body bounded by a surface.

    Raises ValueError for separate bodies side by side, and for a body that rests on a
    point or a line.
    """
    slices = slices_of(surface)
    bands = _bands(slices)
    if not bands:
        raise ValueError("it has no cross-section")
    gap = GAP * slices.detail
    footprint = _seen_from_above(bands).buffer(gap).buffer(-gap)
    _check_connected(footprint)
    moments = _moments(bands)
    center = moments.center[:2]
    return MeshBody(
        path,
        scale,
        _outline(largest(footprint), slices.detail),
        slices.height,
        center,
        up,
        bands=bands,
        base=_base(slices, center),
        top=_top(slices, bands),
        solid=moments,
    )


def _check_connected(footprint: Area) -> None:
    """Raise ValueError unless nearly all of a body is connected, as seen from above."""
    rest = 1.0 - largest(footprint).area / footprint.area
    if rest > CRUMBS:
        count = len(list(polygons(footprint)))
        raise ValueError(f"its footprint is not in one piece: {count} bodies apart")


def _outline(area: Polygon, detail: float) -> tuple[Point, ...]:
    """Corners [m] of an outline, counter-clockwise, without small details and limited
    in number.
    """
    ring = largest(area.simplify(detail)).exterior.coords[:-1]
    if len(ring) > MOST_CORNERS:
        return _outline(area, 2.0 * detail)
    return counter_clockwise(tuple((x, y) for x, y in ring))


def _seen_from_above(bands: Sequence[Band]) -> Area:
    import shapely

    sections = [section for band in bands for section in (band.foot, band.head)]
    return filled(shapely.union_all(sections))


def _bands(slices: Slices) -> tuple[Band, ...]:
    """Bands from the support to the top, as few as the outlines allow."""
    bands: list[Band] = []
    for low, high in pairwise(_levels(slices)):
        bands += _thin_bands(slices, low, high)
    out: list[Band] = []
    for band in bands:
        if out and _are_one(out[-1], band):
            out[-1] = Band(out[-1].low, band.high, out[-1].foot, out[-1].head)
        else:
            out.append(band)
    return tuple(out)


def _levels(slices: Slices) -> list[float]:
    """Heights [m] that divide the body into bands: those of its corners, or an even
    division if there are too many.
    """
    import numpy as np

    height = slices.height
    levels = np.unique(np.round(slices.triangles[:, :, 2] / height, 3)) * height
    if len(levels) > LEVELS:
        levels = np.linspace(0.0, height, LEVELS)
    return [float(z) for z in levels]


def _thin_bands(slices: Slices, low: float, high: float) -> Iterator[Band]:
    """Yield the bands between two heights. They are thin where the outline changes with
    the height.
    """
    end = END * (high - low)
    foot = slices.section(low + end)
    head = slices.section(high - end)
    if foot.is_empty or head.is_empty:
        return
    change = max(_off(foot, head), _off(head, foot))
    count = min(max(1, math.ceil(change / STEP)), FINEST)
    heights = [low + (high - low) * i / count for i in range(count + 1)]
    sections = [slices.section(z) for z in heights[1:-1]]
    feet = [foot, *sections]
    heads = [*sections, head]
    for (a, b), one, other in zip(pairwise(heights), feet, heads, strict=True):
        if not (one.is_empty or other.is_empty):
            yield Band(a, b, one, other)


def _off(one: Area, other: Area) -> float:
    """Largest distance [m] of a corner of one area's border from the border of the
    other.
    """
    import shapely

    corners = shapely.points(shapely.get_coordinates(one))
    return float(shapely.distance(corners, other.boundary).max())


def _are_one(one: Band, other: Band) -> bool:
    """Whether two bands belong to the same upright band."""
    parts = ((one.foot, one.head), (one.foot, other.foot), (one.foot, other.head))
    limit = 0.5 * STEP
    return all(_off(a, b) < limit and _off(b, a) < limit for a, b in parts)


def _base(slices: Slices, center: Point) -> Area:
    """Area of the faces that rest on the support, in G.

    It is the first of the areas within ``BASE_HEIGHTS`` on which the body stands, or
    the largest of these areas. Raises ValueError if there is none.
    """
    from shapely import Point as Place

    areas = [slices.resting(height) for height in BASE_HEIGHTS]
    areas = [area for area in areas if not area.is_empty]
    if not areas:
        raise ValueError("it rests on a point or on an edge")
    place = Place(center)
    firm = [area for area in areas if area.convex_hull.contains(place)]
    return firm[0] if firm else areas[-1]


def _top(slices: Slices, bands: Sequence[Band]) -> Patch | None:
    """Highest level patch on top that is not much smaller than the largest one. None if
    there is none.
    """
    import numpy as np
    import shapely

    triangles = slices.triangles
    normal = np.cross(
        triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    )
    size = np.linalg.norm(normal, axis=1)
    level = (size > 0.0) & (normal[:, 2] > math.cos(LEVEL) * size)
    heights = triangles[:, :, 2].mean(axis=1)
    found: list[tuple[float, Patch]] = []
    near = NEAR * slices.height
    for height in _clusters(heights[level], near):
        chosen = level & (np.abs(heights - height) <= near)
        area = slices.covered(triangles[chosen])
        above = [b for b in bands if b.low > height - near and b.high > height + near]
        walls = shapely.union_all([area for b in above for area in (b.foot, b.head)])
        area = slices.simple(area.difference(walls))
        radius = inner_radius(area)
        found.append((radius, Patch(area, height, walls)))
    most = max((radius for radius, _ in found), default=0.0)
    if most < SMALLEST_PATCH:
        return None
    return next(patch for radius, patch in found if radius >= ENOUGH * most)


def _clusters(heights: Array, near: float) -> list[float]:
    """Heights [m] about which other heights gather, the highest first."""
    out: list[float] = []
    for height in sorted(heights.tolist(), reverse=True):
        if not out or out[-1] - height > near:
            out.append(height)
    return out


def _moments(bands: Sequence[Band]) -> SolidMoments:
    """Centre and second moments of the uniform solid formed by the bands."""
    import numpy as np

    from pushpressslide.geometry.quadrature import moments

    total = 0.0
    first = np.zeros(3)
    second = np.zeros((3, 3))
    for band in bands:
        for section, low, high in _halves(band):
            thick = high - low
            area, at, over = moments(np.array(joined_ring(section)))
            volume = area * thick
            z = 0.5 * (low + high)
            total += volume
            first += thick * np.array([*at, area * z])
            second[:2, :2] += thick * over
            second[:2, 2] += thick * z * at
            second[2, :2] += thick * z * at
            second[2, 2] += volume * (z * z + thick * thick / 12.0)
    center = first / total
    spread = second / total - np.outer(center, center)
    xx, yy, zz = np.trace(spread) - np.diag(spread)
    inertia = (xx, yy, zz, -spread[0, 1], -spread[0, 2], -spread[1, 2])
    x, y, z = (round(float(v), 7) + 0.0 for v in center)
    return SolidMoments((x, y, z), tuple(float(v) for v in inertia))


def _halves(band: Band) -> Iterator[tuple[Area, float, float]]:
    """Lower and upper half of a band, each with its cross-section and the heights [m]
    of its ends.
    """
    middle = 0.5 * (band.low + band.high)
    yield band.foot, band.low, middle
    yield band.head, middle, band.high
