"""The outlines of a body in a mesh that is no upright prism: base, side and top."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point
from pushpressslide.geometry.areas import filled, joined_ring, largest, polygons
from pushpressslide.geometry.mesh_body import Band, MeshBody, Patch, SolidMoments
from pushpressslide.geometry.polygon import counter_clockwise
from pushpressslide.taskfile.mesh_face import covered, enclosed

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area
    from trimesh import Trimesh

    from pushpressslide.core.arrays import Array

DETAIL = 1e-3
"""Of the solid's size: corners that stand out by less are left out of an outline."""
BASE_SHARE = 0.01
BASE_HEIGHTS = (5e-4, 1e-3)
"""Height above the lowest point up to which a face is part of the base: this share of the
body's height, between these two [m].
"""
CRUMBS = 0.01
"""Share of a footprint that may lie apart from the rest."""
MOST_CORNERS = 256
"""Of the outline seen from above."""
LEVELS = 40
"""Of a body whose corners are at more heights."""
STEP = 1e-3
"""[m] between the outlines at both ends of a band."""
FINEST = 24
"""Bands between two heights of corners."""
END = 0.02
"""Of a band's height: distance of its outlines from its ends."""
LEVEL = math.radians(2.0)
"""Slope of a patch on top that counts as level."""
WALL_ROOM = 0.015
"""[m] between a patch on top and what stands above it, for a tip and its rod."""
MOST_DEPTH = 0.05
"""[m] below the highest point of a patch that is pressed: the tip's rod is not long."""
SMALLEST_PATCH = 0.004
"""[m] of the radius of the largest disc in a patch."""


def read_outlines(mesh: Trimesh, path: str, scale: float, up: str) -> MeshBody:
    """Body in a closed surface [m] with z up.

    Raises ValueError for bodies side by side, and for one that rests on a point or a
    line.
    """
    low, high = (float(z) for z in mesh.bounds[:, 2])
    grid = DETAIL * 1e-3 * float(max(mesh.extents))
    triangles = mesh.triangles.copy()
    triangles[:, :, 2] -= low
    bands = _bands(triangles, high - low, grid)
    detail = DETAIL * float(max(mesh.extents))
    footprint = _seen_from_above(bands)
    _check_connected(footprint)
    corners = _outline(largest(footprint), detail)
    moments = _moments(bands)
    return MeshBody(
        path,
        scale,
        corners,
        high - low,
        moments.center[:2],
        up,
        bands=bands,
        base=_base(triangles, bands, grid, detail),
        top=_top(triangles, bands, grid, detail),
        solid=moments,
    )


def _check_connected(footprint: Area) -> None:
    """Raise ValueError unless nearly all of a body is in one piece, seen from above."""
    rest = 1.0 - largest(footprint).area / footprint.area
    if rest > CRUMBS:
        count = len(list(polygons(footprint)))
        raise ValueError(f"its footprint is not in one piece: {count} bodies apart")


def _outline(area: Polygon, detail: float) -> tuple[Point, ...]:
    """Corners of an outline without details, counter-clockwise, and not too many."""
    ring = largest(area.simplify(detail)).exterior.coords[:-1]
    if len(ring) > MOST_CORNERS:
        return _outline(area, 2.0 * detail)
    return counter_clockwise(tuple((x, y) for x, y in ring))


def _seen_from_above(bands: Sequence[Band]) -> Area:
    import shapely

    sections = [section for band in bands for section in (band.foot, band.head)]
    return filled(shapely.union_all(sections))


def _bands(triangles: Array, height: float, grid: float) -> tuple[Band, ...]:
    """Bands from the support to the top, as few as the outlines allow."""
    bands: list[Band] = []
    for low, high in pairwise(_levels(triangles, height)):
        bands += _band_pieces(triangles, low, high, grid)
    out: list[Band] = []
    for band in bands:
        if out and _are_one(out[-1], band):
            out[-1] = Band(out[-1].low, band.high, out[-1].foot, out[-1].head)
        else:
            out.append(band)
    return tuple(out)


def _levels(triangles: Array, height: float) -> list[float]:
    """Heights [m] between which the body is cut: those of its corners, or an even
    division if there are too many.
    """
    import numpy as np

    levels = np.unique(np.round(triangles[:, :, 2] / height, 3)) * height
    if len(levels) > LEVELS:
        levels = np.linspace(0.0, height, LEVELS)
    return [float(z) for z in levels]


def _band_pieces(
    triangles: Array, low: float, high: float, grid: float
) -> Iterator[Band]:
    """Bands between two heights, thin where the outline changes with the height."""
    end = END * (high - low)
    foot = _section(triangles, low + end, grid)
    head = _section(triangles, high - end, grid)
    if foot.is_empty or head.is_empty:
        return
    change = max(_off(foot, head), _off(head, foot))
    count = min(max(1, math.ceil(change / STEP)), FINEST)
    heights = [low + (high - low) * i / count for i in range(count + 1)]
    sections = [_section(triangles, z, grid) for z in heights[1:-1]]
    feet = [foot, *sections]
    heads = [*sections, head]
    for (a, b), one, other in zip(pairwise(heights), feet, heads, strict=True):
        if not (one.is_empty or other.is_empty):
            yield Band(a, b, one, other)


def _off(one: Area, other: Area) -> float:
    """Largest distance [m] of a corner of one area's border from the other's."""
    import shapely

    corners = shapely.points(shapely.get_coordinates(one))
    return float(shapely.distance(corners, other.boundary).max())


def _are_one(one: Band, other: Band) -> bool:
    """Whether two bands are parts of one upright band."""
    parts = ((one.foot, one.head), (one.foot, other.foot), (one.foot, other.head))
    limit = 0.5 * STEP
    return all(_off(a, b) < limit and _off(b, a) < limit for a, b in parts)


def _section(triangles: Array, height: float, grid: float) -> Area:
    """Cross-section of a closed surface at a height that is none of its corners'."""
    import numpy as np

    corners = triangles[:, :, 2]
    cut = (corners.min(axis=1) < height) & (corners.max(axis=1) > height)
    kept = triangles[cut]
    above = kept[:, :, 2] > height
    tails = _crossings(kept, above & ~np.roll(above, -1, axis=1), height)
    heads = _crossings(kept, ~above & np.roll(above, -1, axis=1), height)
    return _simple(enclosed(tails, heads, grid), 1e3 * grid)


def _crossings(triangles: Array, edge: Array, height: float) -> Array:
    """Points (m, 2) at which one edge of each triangle crosses a height."""
    import numpy as np

    rows, first = np.nonzero(edge)
    a = triangles[rows, first]
    b = triangles[rows, (first + 1) % 3]
    share = (height - a[:, 2]) / (b[:, 2] - a[:, 2])
    points: Array = a[:, :2] + share[:, None] * (b[:, :2] - a[:, :2])
    return points


def _simple(area: Area, detail: float) -> Area:
    """The area without small parts and details."""
    import shapely

    kept = [
        part.simplify(detail) for part in polygons(area) if part.area > detail * detail
    ]
    return shapely.union_all(kept)


def _base(triangles: Array, bands: Sequence[Band], grid: float, detail: float) -> Area:
    """Area of the faces that rest on the support, in G.

    Raises ValueError if they have none.
    """
    height = max(band.high for band in bands)
    least, most = BASE_HEIGHTS
    limit = min(max(BASE_SHARE * height, least), most)
    resting = triangles[:, :, 2].max(axis=1) < limit
    area = _covered(triangles[resting][:, ::-1, :2], grid, detail)
    if area.is_empty:
        area = _simple(_section(triangles, limit, grid), detail)
    if area.is_empty:
        raise ValueError("it rests on a point or on an edge")
    return area


def _covered(triangles: Array, grid: float, detail: float) -> Area:
    """Area that triangles (m, 3, 2) cover. Empty if it is too rough to tell."""
    from shapely import Polygon

    try:
        return _simple(covered(triangles, grid), detail)
    except ValueError:
        return Polygon()


def _top(
    triangles: Array, bands: Sequence[Band], grid: float, detail: float
) -> Patch | None:
    """Level patch on top with the largest disc in it, or None if there is none."""
    import numpy as np
    import shapely

    normal = np.cross(
        triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    )
    size = np.linalg.norm(normal, axis=1)
    level = (size > 0.0) & (normal[:, 2] > math.cos(LEVEL) * size)
    heights = triangles[:, :, 2].mean(axis=1)
    best: Patch | None = None
    most = SMALLEST_PATCH
    highest = max(band.high for band in bands)
    near = BASE_SHARE * highest
    level &= heights > highest - MOST_DEPTH
    for height in _clusters(heights[level], near):
        chosen = level & (np.abs(heights - height) <= near)
        area = _covered(triangles[chosen][:, :, :2], grid, detail)
        above = [b for b in bands if b.low > height - near and b.high > height + near]
        walls = [
            shapely.union(band.foot, band.head).buffer(WALL_ROOM) for band in above
        ]
        area = _simple(area.difference(shapely.union_all(walls)), detail)
        radius = _inner_radius(area)
        if radius > most:
            most = radius
            best = Patch(area, float(height))
    return best


def _clusters(heights: Array, near: float) -> list[float]:
    """Heights [m] about which others gather, the highest first."""
    out: list[float] = []
    for height in sorted(heights.tolist(), reverse=True):
        if not out or out[-1] - height > near:
            out.append(height)
    return out


def _inner_radius(area: Area) -> float:
    """Radius [m] of the largest disc in an area."""
    import shapely

    radii = [
        float(shapely.maximum_inscribed_circle(part).length) for part in polygons(area)
    ]
    return max(radii, default=0.0)


def _moments(bands: Sequence[Band]) -> SolidMoments:
    """Centre and second moments of the uniform solid in the bands."""
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
    """Lower and upper half of a band, each with its cross-section and heights [m]."""
    middle = 0.5 * (band.low + band.high)
    yield band.foot, band.low, middle
    yield band.head, middle, band.high
