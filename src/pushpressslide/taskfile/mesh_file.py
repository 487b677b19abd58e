"""A mesh file as a body that stands on its base.

The body is an upright solid if, to within ``TOLERANCE``, its base and top are flat, its
sides upright, and its footprint connected and without holes. Any other body has
separate outlines for base, side and top.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shapes import MeshSolid
from pushpressslide.geometry.united import DIGITS, bordered
from pushpressslide.taskfile.mesh_count import SUFFIXES
from pushpressslide.taskfile.mesh_face import covered
from pushpressslide.taskfile.mesh_outlines import read_outlines
from pushpressslide.taskfile.mesh_surface import GRID, Surface, read_surface, turned
from pushpressslide.taskfile.object_file import SUFFIXES as OBJECT_SUFFIXES
from pushpressslide.taskfile.object_file import is_object_file, read_object

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area
    from trimesh import Trimesh

    from pushpressslide.core.arrays import Array

TOLERANCE = 0.003
"""Largest distance of base, top and sides from those of an upright prism, as a share of
the solid's size.
"""
FLATTEST = 0.01
"""Smallest height of a body, as a share of its size."""
DETAIL = 1e-3
"""Smallest detail of the outline, as a share of the solid's size. Corners that protrude
by less are omitted.
"""
MOST_CORNERS = 256
"""Largest number of corners in an outline."""


def read_mesh(path: str, scale: float, up: str = "z") -> MeshSolid:
    """Body in a file with units of ``scale`` [m] and a vertical axis ``up``.

    Raises ValueError, with the cause, for a file that cannot be read, and for a body
    without a base.
    """
    file = Path(path)
    if file.suffix.lower() not in suffixes():
        raise ValueError(f"it ends in none of {', '.join(suffixes())}")
    if not file.is_file():
        raise ValueError("no such file")
    return _read(path, scale, up, _changed(file), file.stat().st_size)


def suffixes() -> tuple[str, ...]:
    """Suffixes of files that may contain a body."""
    return (*SUFFIXES, *OBJECT_SUFFIXES)


def surface_of(solid: MeshSolid) -> Trimesh:
    """Surface [m] of a body from a file, with z pointing up."""
    return read_surface(Path(solid.path), solid.scale, solid.up).mesh


def _changed(file: Path) -> int:
    """Time [ns] of the last change of a file, or of the buffers of a glTF text file."""
    parts = [file]
    if file.suffix.lower() == ".gltf":
        parts += file.parent.glob("*.bin")
    return max(part.stat().st_mtime_ns for part in parts)


@lru_cache(maxsize=16)
def _read(path: str, scale: float, up: str, changed: int, size: int) -> MeshSolid:
    """Body in a file, cached until the file changes."""
    solid = _solid(path, scale, up)
    if not is_object_file(Path(path)):
        return solid
    content = read_object(Path(path))
    note = solid.note
    if content.frictions:
        values = ", ".join(f"{value:g}" for value in content.frictions)
        note = "; ".join(filter(None, (note, f"its file gives frictions {values}")))
    if content.mass <= 0.0:
        return replace(solid, note=note)
    x, y, _ = (scale * turned(content.center, up)).tolist()
    center = (round(x, DIGITS) + 0.0, round(y, DIGITS) + 0.0)
    return replace(solid, note=note, center=center, file_mass=content.mass)


def _solid(path: str, scale: float, up: str) -> MeshSolid:
    """Body in a file, with uniform density."""
    surface = read_surface(Path(path), scale, up)
    mesh = surface.mesh
    extent = float(max(mesh.extents))
    height = float(mesh.extents[2])
    if height < FLATTEST * extent:
        raise ValueError(f"its height {height:.3g} m is below 1 % of its size")
    if surface.fault:
        solid = _outlined(surface, path, scale, up)
        note = f"{surface.fault}; its outline is taken at each height, without holes where it is open"
        return replace(solid, note=note)
    try:
        return _upright(mesh, path, scale, up)
    except _UprightError:
        return _outlined(surface, path, scale, up)


def _outlined(surface: Surface, path: str, scale: float, up: str) -> MeshBody:
    """Body described by its outlines. Raises ValueError if they cannot be found."""
    from shapely.errors import GEOSException

    try:
        return read_outlines(surface, path, scale, up)
    except GEOSException as error:
        raise ValueError(f"its outlines cannot be found: {error}") from error


class _UprightError(Exception):
    """Error which says that a mesh is not an upright solid, with the reason."""


def _upright(mesh: Trimesh, path: str, scale: float, up: str) -> MeshSolid:
    """Upright solid in a mesh. Raises _UprightError if the solid is not upright."""
    from shapely import Polygon

    extent = float(max(mesh.extents))
    height = float(mesh.extents[2])
    faces = _faces(mesh)
    whole = faces.whole
    if not isinstance(whole, Polygon):
        raise _UprightError("its footprint is not in one piece")
    if _holes(whole, extent):
        raise _UprightError("its footprint has a hole")
    _check_flat("base", faces.base, whole, extent)
    _check_flat("top", faces.top, whole, extent)
    simple = Polygon(whole.exterior).simplify(DETAIL * extent)
    assert isinstance(simple, Polygon)
    border = bordered(simple)
    if len(border.corners) > MOST_CORNERS:
        count = len(border.corners)
        raise _UprightError(
            f"its outline has {count} corners, allowed up to {MOST_CORNERS}"
        )
    center = (
        round(whole.centroid.x, DIGITS) + 0.0,
        round(whole.centroid.y, DIGITS) + 0.0,
    )
    return MeshSolid(path, scale, border.corners, height, center, up)


@dataclass(frozen=True)
class _Faces:
    """Faces of a solid as seen from above."""

    base: Area
    top: Area
    whole: Area


def _faces(mesh: Trimesh) -> _Faces:
    """Base, top and whole footprint of a solid.

    Raises _UprightError unless the solid's volume is that of upright prisms.
    """
    import numpy as np
    import shapely

    low, high = mesh.bounds[:, 2]
    grid = GRID * float(max(mesh.extents))
    z = mesh.triangles[:, :, 2]
    near = TOLERANCE * (high - low)
    in_base = (z - low).max(axis=1) < near
    in_top = (high - z).max(axis=1) < near
    flat = mesh.triangles[:, :, :2]
    areas = _signed_areas(flat)
    rising = ~in_base & ~in_top & (areas > grid * grid)
    area = areas[in_top].sum() + np.maximum(areas[~in_base & ~in_top], 0.0).sum()
    # first, since the outlines of a round body take seconds
    _check_upright(float(mesh.volume), float(area) * (high - low))
    try:
        base = covered(flat[in_base][:, ::-1], grid)
        top = covered(flat[in_top], grid)
    except ValueError as error:
        raise _UprightError(str(error)) from error
    between = shapely.union_all(shapely.polygons(flat[rising]), grid_size=grid)
    whole = shapely.union_all([base, top, between], grid_size=grid)
    return _Faces(base, top, whole)


def _signed_areas(triangles: Array) -> Array:
    """Areas [m^2] of triangles (m, 3, 2), negative if they are clockwise."""
    u = triangles[:, 1] - triangles[:, 0]
    v = triangles[:, 2] - triangles[:, 0]
    areas: Array = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return areas


def _holes(area: Polygon, extent: float) -> float:
    """Area [m^2] of holes larger than round-off."""
    from shapely import Polygon

    sizes = [float(Polygon(hole).area) for hole in area.interiors]
    return sum(size for size in sizes if size > (TOLERANCE * extent) ** 2)


def _check_flat(name: str, face: Area, whole: Polygon, extent: float) -> None:
    """Raise _UprightError unless a face covers the whole footprint in one plane."""
    from shapely import Polygon

    if not isinstance(face, Polygon) or face.is_empty or _holes(face, extent):
        raise _UprightError(f"its {name} is not flat: it is no whole face in one plane")
    off = float(whole.exterior.hausdorff_distance(face.exterior))
    if off > TOLERANCE * extent:
        raise _UprightError(
            f"its {name} is not flat, or its sides not upright: in one plane it ends "
            f"{off * 1e3:.3g} mm inside the outline, allowed "
            f"{TOLERANCE * extent * 1e3:.3g} mm"
        )


def _check_upright(volume: float, upright: float) -> None:
    """Raise _UprightError unless ``volume`` [m^3] is that of upright prisms.

    The volume of upright prisms is ``upright`` [m^3], the upward-facing area times the
    full height. A body that is lower in places or leans inwards has a smaller volume.
    """
    if abs(volume - upright) > TOLERANCE * upright:
        raise _UprightError(
            f"its sides are not upright: its volume is {volume / upright:.3f} of that "
            f"of its footprint times its height, allowed within {TOLERANCE:g} of 1"
        )
