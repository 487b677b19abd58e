"""Convex parts of a body from a mesh, in its frame with z zero at half height."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point
from pushpressslide.geometry.areas import filled, joined_ring, polygons
from pushpressslide.geometry.mesh_body import Band, MeshBody
from pushpressslide.geometry.pieces import convex_pieces

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

DETAIL = 3e-4
"""Size [m] of details of an outline that do not matter for contact."""
CONVEX = 0.995
"""Smallest area of a cross-section that counts as convex, as a share of its convex
hull's area.
"""
THIN = 0.005
"""Thickness [m] below which a layer is thin. A pressing tip may penetrate by this
depth.
"""
UPRIGHT = 0.5
"""Share of a layer's height above which a single upright band represents the whole
layer.
"""
MOST_RINGS = 9
"""Largest number of cross-sections in a convex part."""
MOST_PARTS = 100
"""Largest number of convex shapes that represent a body in distances to an arm."""
SLACKS = (2e-3, 4e-3, 8e-3, 16e-3)
"""Distances [m] by which the convex shapes may extend beyond the body. Larger ones need
fewer shapes.
"""
SLAB = 3.0
"""Height of a slab of convex shapes, as a multiple of the distance in ``SLACKS``."""
STEP = 4e-3
"""Difference [m] below which two outlines count as one, for a body that is pressed
inside a hollow.
"""


@dataclass(frozen=True)
class ConvexPart:
    """The convex hull of points."""

    corners: tuple[Vector3, ...]  # [m]
    thickness: float  # [m] half the smallest extent


@dataclass(frozen=True)
class UprightPart:
    """A part with the same cross-section, convex or not, from ``low`` to ``high``."""

    polygon: Polygon
    low: float  # [m]
    high: float  # [m]

    @property
    def ring(self) -> tuple[Point, ...]:
        """Corners of the cross-section [m], with bridges to its holes."""
        if self.polygon.area >= CONVEX * self.polygon.convex_hull.area:
            return _ring(self.polygon)
        return joined_ring(self.polygon)


Part = ConvexPart | UprightPart


def convex_of(part: Part) -> Iterator[ConvexPart]:
    """Convex parts that make up one part."""
    if isinstance(part, ConvexPart):
        yield part
        return
    for corners in convex_pieces(part.ring):
        places = [(x, y, z) for z in (part.low, part.high) for x, y in corners]
        x, y = np.ptp(np.array(corners), axis=0)
        thin = min(float(x), float(y), part.high - part.low)
        yield ConvexPart(tuple(places), 0.5 * thin)


@lru_cache(maxsize=8)
def convex_corners(body: MeshBody) -> tuple[tuple[Vector3, ...], ...]:
    """Corners [m] of the convex parts of a body."""
    parts = (own for part in body_parts(body) for own in convex_of(part))
    return tuple(part.corners for part in parts)


@lru_cache(maxsize=8)
def few_convex_corners(body: MeshBody) -> tuple[tuple[Vector3, ...], ...]:
    """Corners [m] of convex parts that cover a body. They are the body itself unless
    that takes too many, or a tip presses inside.
    """
    parts = convex_corners(body)
    for slack in () if body.pressed_inside else SLACKS:
        if len(parts) <= MOST_PARTS:
            break
        covers = _covering_parts(body, slack)
        parts = tuple(own.corners for part in covers for own in convex_of(part))
    return parts


def _covering_parts(body: MeshBody, slack: float) -> Iterator[UprightPart]:
    """Upright parts that cover a body, in slabs, and stand out from it by up to
    ``slack`` [m] along the support.
    """
    import shapely

    middle = 0.5 * body.height
    for slab in _slabs(_solid_bands(body), SLAB * slack):
        area = shapely.union_all([a for band in slab for a in (band.foot, band.head)])
        wider = area.buffer(0.5 * slack, join_style="mitre").simplify(0.5 * slack)
        for polygon in polygons(wider):
            yield UprightPart(polygon, slab[0].low - middle, slab[-1].high - middle)


def _slabs(bands: Sequence[Band], height: float) -> list[list[Band]]:
    """Bands from the base up, in groups with a height of about ``height`` [m]."""
    out: list[list[Band]] = []
    for band in bands:
        if out and band.high - out[-1][0].low <= height:
            out[-1].append(band)
        else:
            out.append([band])
    return out


def body_parts(body: MeshBody, thick: bool = False) -> Iterator[Part]:
    """Parts of a body. With ``thick``, thin ones are merged into their neighbours."""
    middle = 0.5 * body.height
    detail = STEP / 4.0 if body.pressed_inside else DETAIL
    layers = _layers(_solid_bands(body))
    if thick:
        layers = _thick(layers)
    for layer in layers:
        core = max(layer.bands, key=lambda band: band.high - band.low)
        upright = core.high - core.low >= UPRIGHT * (layer.high - layer.low)
        if not upright and _is_convex(core):
            yield _stacked(layer, middle)
            continue
        for polygon in polygons(core.foot.simplify(detail)):
            yield UprightPart(polygon, layer.low - middle, layer.high - middle)


@dataclass(frozen=True)
class _Layer:
    """Consecutive bands that form one part: a convex stack, or a single band."""

    low: float  # [m]
    high: float  # [m]
    bands: tuple[Band, ...]

    @property
    def height(self) -> float:
        return self.high - self.low


def _solid_bands(body: MeshBody) -> list[Band]:
    """Bands of a body with their holes filled. If a tip presses inside a hollow, a few
    bands with open holes.
    """
    if body.pressed_inside:
        return _few(body.bands)
    return [
        replace(band, foot=filled(band.foot), head=filled(band.head))
        for band in body.bands
    ]


def _few(bands: Sequence[Band]) -> list[Band]:
    """The bands, with neighbours merged if their outlines differ by less than ``STEP``."""
    out: list[Band] = []
    for band in bands:
        last = out[-1] if out else None
        if last is None or last.foot.hausdorff_distance(band.head) > STEP:
            out.append(band)
        else:
            out[-1] = Band(last.low, band.high, last.foot, band.head)
    return out


def _is_convex(band: Band) -> bool:
    return all(
        len(list(polygons(area))) == 1 and area.area >= CONVEX * area.convex_hull.area
        for area in (band.foot, band.head)
    )


def _layers(bands: Sequence[Band]) -> list[_Layer]:
    """Bands in as few convex layers as possible."""
    layers: list[_Layer] = []
    for band in bands:
        if layers and _stays_convex(layers[-1].bands, band):
            last = layers[-1]
            layers[-1] = _Layer(last.low, band.high, (*last.bands, band))
        else:
            layers.append(_Layer(band.low, band.high, (band,)))
    return layers


def _thick(layers: Sequence[_Layer]) -> list[_Layer]:
    """Layers without thin ones, such as those at fillets.

    A thin layer is merged with its higher neighbour.
    """
    out = list(layers)
    while len(out) > 1:
        thin = min(range(len(out)), key=lambda i: out[i].height)
        if out[thin].height >= THIN:
            break
        sides = [i for i in (thin - 1, thin + 1) if 0 <= i < len(out)]
        wide = max(sides, key=lambda i: out[i].height)
        low = min(out[thin].low, out[wide].low)
        high = max(out[thin].high, out[wide].high)
        out[wide] = replace(out[wide], low=low, high=high)
        del out[thin]
    return out


def _stays_convex(run: Sequence[Band], band: Band) -> bool:
    """Whether ``run``, a stack of bands that is convex as a whole, stays convex with
    ``band`` on top.
    """
    last = run[-1]
    if not (_is_convex(last) and _is_convex(band)):
        return False
    between = run[len(run) // 2]
    triples = ((last, last, band), (last, band, band), (run[0], between, band))
    return all(_bulges(*triple) for triple in triples)


def _bulges(lower: Band, between: Band, upper: Band) -> bool:
    """Whether straight lines from the foot of one band to the head of another lie
    inside a band between them.
    """
    foot = np.array(_ring(lower.foot))
    head = np.array(_ring(upper.head))
    size = upper.high - lower.low
    ends = ((between.low, between.foot), (between.high, between.head))
    return all(
        area.buffer(2.0 * DETAIL).covers(_blend(foot, head, (z - lower.low) / size))
        for z, area in ends
    )


def _blend(foot: Array, head: Array, share: float) -> Area:
    """Cross-section of a frustum at the fraction ``share`` of its height."""
    import shapely

    points = (1.0 - share) * foot[:, None] + share * head
    return shapely.MultiPoint(points.reshape(-1, 2)).convex_hull


def _ring(area: Area) -> tuple[Point, ...]:
    """Corners [m] of the convex hull of a cross-section."""
    hull = area.convex_hull.simplify(DETAIL)
    return tuple((x, y) for x, y in next(polygons(hull)).exterior.coords[:-1])


def _stacked(layer: _Layer, middle: float) -> ConvexPart:
    """Convex part made from a layer. Its origin is at the height ``middle`` [m] above
    the support.
    """
    bands = layer.bands
    levels = [(layer.low, bands[0].foot), *((band.high, band.head) for band in bands)]
    levels[-1] = (layer.high, bands[-1].head)
    places = {round(k) for k in np.linspace(0, len(levels) - 1, MOST_RINGS)}
    rings = [(levels[k][0], _ring(levels[k][1])) for k in sorted(places)]
    corners = [(x, y, z - middle) for z, ring in rings for x, y in ring]
    sides = np.ptp(np.array(corners), axis=0)
    return ConvexPart(tuple(corners), 0.5 * float(sides.min()))
