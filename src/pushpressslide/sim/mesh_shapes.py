"""A body from a mesh in Drake: the convex and layered pieces that tips touch, and the
surface that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import Convex, InMemoryMesh, Mesh
from pydrake.geometry import Shape as DrakeShape

from pushpressslide.core.control import Vector3
from pushpressslide.core.pose import Point
from pushpressslide.geometry.areas import filled, joined_ring, polygons
from pushpressslide.geometry.mesh_body import Band, MeshBody
from pushpressslide.geometry.pieces import convex_pieces
from pushpressslide.sim.layered_mesh import layered_mesh
from pushpressslide.taskfile.mesh_file import surface_of

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
MOST_DRAWN = 100_000
"""Largest number of triangles of a body that is drawn unchanged."""
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
class SolidPart:
    """A part of a body that is touched by tips."""

    shape: DrakeShape
    thickness: float  # [m] thickness of its compliant layer


@lru_cache(maxsize=8)
def touched_parts(body: MeshBody) -> tuple[SolidPart, ...]:
    """Parts of a body for hydroelastic contact with tips. The origin of z is at half
    height.
    """
    return tuple(_solid_parts(body, layered=True))


@lru_cache(maxsize=8)
def convex_parts(body: MeshBody) -> tuple[DrakeShape, ...]:
    """Convex shapes whose union covers a body. The origin of z is at half height.

    The union equals the body, unless this takes too many shapes or a tip presses inside
    a hollow.
    """
    parts = [part.shape for part in _solid_parts(body, layered=False)]
    for slack in () if body.pressed_inside else SLACKS:
        if len(parts) <= MOST_PARTS:
            break
        parts = [part.shape for part in _covering_parts(body, slack)]
    return tuple(parts)


def _covering_parts(body: MeshBody, slack: float) -> Iterator[SolidPart]:
    """Upright convex parts, in slabs, that cover a body. They extend beyond it by up to
    ``slack`` [m] along the support.
    """
    import shapely

    middle = 0.5 * body.height
    for slab in _slabs(_solid_bands(body), SLAB * slack):
        area = shapely.union_all([a for band in slab for a in (band.foot, band.head)])
        wider = area.buffer(0.5 * slack, join_style="mitre").simplify(0.5 * slack)
        for polygon in polygons(wider):
            ends = (slab[0].low - middle, slab[-1].high - middle)
            yield from _upright(polygon, *ends, layered=False)


def _slabs(bands: Sequence[Band], height: float) -> list[list[Band]]:
    """Bands from the base up, in groups with a height of about ``height`` [m]."""
    out: list[list[Band]] = []
    for band in bands:
        if out and band.high - out[-1][0].low <= height:
            out[-1].append(band)
        else:
            out.append([band])
    return out


def _solid_parts(body: MeshBody, layered: bool) -> Iterator[SolidPart]:
    middle = 0.5 * body.height
    detail = STEP / 4.0 if body.pressed_inside else DETAIL
    layers = _layers(_solid_bands(body))
    if layered:
        layers = _thick(layers)
    for layer in layers:
        core = max(layer.bands, key=lambda band: band.high - band.low)
        upright = core.high - core.low >= UPRIGHT * (layer.high - layer.low)
        if not upright and _is_convex(core):
            yield _stacked(layer, middle)
            continue
        for polygon in polygons(core.foot.simplify(detail)):
            ends = (layer.low - middle, layer.high - middle)
            yield from _upright(polygon, *ends, layered)


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


def _stacked(layer: _Layer, middle: float) -> SolidPart:
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
    return SolidPart(_convex(corners), 0.5 * float(sides.min()))


def _frustum(
    foot: Sequence[Point], head: Sequence[Point], low: float, high: float
) -> SolidPart:
    corners = [(x, y, low) for x, y in foot] + [(x, y, high) for x, y in head]
    return SolidPart(_convex(corners), _thickness(foot, high - low))


def _upright(
    polygon: Polygon, low: float, high: float, layered: bool
) -> Iterator[SolidPart]:
    """Upright part between two heights: one layered mesh, or several convex shapes."""
    height = high - low
    ring = joined_ring(polygon)
    if polygon.area >= CONVEX * polygon.convex_hull.area:
        ring = _ring(polygon)
    if layered and not polygon.interiors:
        try:
            made = layered_mesh(ring, height)
        except ValueError:
            pass  # too thin for a layer
        else:
            middle = 0.5 * (low + high)
            yield SolidPart(made.mesh.raised(middle).drake(), made.depth)
            return
    for corners in convex_pieces(ring):
        yield _frustum(corners, corners, low, high)


def _thickness(ring: Sequence[Point], height: float) -> float:
    x, y = np.ptp(np.array(ring), axis=0)
    return 0.5 * float(min(x, y, height))


def _convex(corners: Sequence[Vector3]) -> Convex:
    return Convex(np.array(corners).T, "piece")


@lru_cache(maxsize=8)
def drawn_mesh(body: MeshBody) -> DrakeShape:
    """The surface in a body's file as it is drawn. The origin of z is at half height."""
    mesh = surface_of(body)
    if len(mesh.faces) > MOST_DRAWN:
        mesh = mesh.convex_hull
    low = float(mesh.bounds[0, 2])
    vertices = mesh.vertices - (0.0, 0.0, low + 0.5 * body.height)
    corners = "\n".join(f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in vertices.tolist())
    faces = "\n".join(f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist())
    file = MemoryFile(f"{corners}\n{faces}\n", ".obj", "body.obj")
    return Mesh(InMemoryMesh(mesh_file=file), 1.0)
