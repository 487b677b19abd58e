"""A body from a mesh in Drake: the convex and layered pieces that tips touch, and the
surface that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
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
"""[m] of an outline that contact does not see."""
CONVEX = 0.995
"""Share of its convex hull's area that a convex cross-section has at least."""
MOST_DRAWN = 100_000
"""Triangles of a body that is drawn as it is."""
STEP = 4e-3
"""[m] between outlines that count as one, of a body that is pressed inside."""


@dataclass(frozen=True)
class SolidPart:
    """A part of a body that tips touch."""

    shape: DrakeShape
    thickness: float  # [m] of its compliant layer


@lru_cache(maxsize=8)
def touched_parts(body: MeshBody) -> tuple[SolidPart, ...]:
    """Pieces of a body for hydroelastic contact with tips, with z zero at half height."""
    return tuple(_solid_parts(body, layered=True))


@lru_cache(maxsize=8)
def convex_parts(body: MeshBody) -> tuple[DrakeShape, ...]:
    """Convex shapes whose union is a body, with z zero at half height."""
    return tuple(part.shape for part in _solid_parts(body, layered=False))


def _solid_parts(body: MeshBody, layered: bool) -> Iterator[SolidPart]:
    middle = 0.5 * body.height
    for run in _runs(_solid_bands(body)):
        low = run[0].low - middle
        high = run[-1].high - middle
        if _is_convex(run[0]):
            yield _frustum(_ring(run[0].foot), _ring(run[-1].head), low, high)
            continue
        detail = STEP / 4.0 if body.pressed_inside else DETAIL
        for polygon in polygons(run[0].foot.simplify(detail)):
            yield from _upright(polygon, low, high, layered)


def _solid_bands(body: MeshBody) -> list[Band]:
    """Bands of a body with their holes filled, or few bands with open ones if a tip
    presses inside.
    """
    if body.pressed_inside:
        return _few(body.bands)
    return [
        replace(band, foot=filled(band.foot), head=filled(band.head))
        for band in body.bands
    ]


def _few(bands: Sequence[Band]) -> list[Band]:
    """Bands joined where their outlines differ by less than ``STEP``."""
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


def _runs(bands: Sequence[Band]) -> list[list[Band]]:
    """Bands in runs: a run of several is one frustum."""
    runs: list[list[Band]] = []
    for band in bands:
        if runs and _is_frustum([*runs[-1], band]):
            runs[-1].append(band)
        else:
            runs.append([band])
    return runs


def _is_frustum(bands: Sequence[Band]) -> bool:
    """Whether convex bands lie within ``DETAIL`` of one frustum."""
    if not all(_is_convex(band) for band in bands):
        return False
    low = bands[0].low
    high = bands[-1].high
    foot = np.array(_ring(bands[0].foot))
    head = np.array(_ring(bands[-1].head))
    between = bands[len(bands) // 2]
    ends = ((between.low, between.foot), (between.high, between.head))
    return all(
        _blend(foot, head, (z - low) / (high - low)).hausdorff_distance(
            area.convex_hull
        )
        < 2.0 * DETAIL
        for z, area in ends
    )


def _blend(foot: Array, head: Array, share: float) -> Area:
    """Cross-section of a frustum at a share of its height."""
    import shapely

    points = [(1.0 - share) * a + share * b for a, b in product(foot, head)]
    return shapely.MultiPoint(points).convex_hull


def _ring(area: Area) -> tuple[Point, ...]:
    """Corners of the convex hull of a cross-section."""
    hull = area.convex_hull.simplify(DETAIL)
    return tuple((x, y) for x, y in next(polygons(hull)).exterior.coords[:-1])


def _frustum(
    foot: Sequence[Point], head: Sequence[Point], low: float, high: float
) -> SolidPart:
    corners = [(x, y, low) for x, y in foot] + [(x, y, high) for x, y in head]
    return SolidPart(_convex(corners), _thickness(foot, high - low))


def _upright(
    polygon: Polygon, low: float, high: float, layered: bool
) -> Iterator[SolidPart]:
    """A concave part between two heights: one layered piece, or several convex ones."""
    ring = joined_ring(polygon)
    height = high - low
    if polygon.area >= CONVEX * polygon.convex_hull.area:
        ring = _ring(polygon)
        yield _frustum(ring, ring, low, high)
        return
    if layered and not polygon.interiors:
        try:
            made = layered_mesh(ring, height)
        except ValueError:
            pass  # too thin for one
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
    """The surface in a body's file as it is drawn, with z zero at half height."""
    mesh = surface_of(body)
    if len(mesh.faces) > MOST_DRAWN:
        mesh = mesh.convex_hull
    low = float(mesh.bounds[0, 2])
    vertices = mesh.vertices - (0.0, 0.0, low + 0.5 * body.height)
    corners = "\n".join(f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in vertices.tolist())
    faces = "\n".join(f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist())
    file = MemoryFile(f"{corners}\n{faces}\n", ".obj", "body.obj")
    return Mesh(InMemoryMesh(mesh_file=file), 1.0)
