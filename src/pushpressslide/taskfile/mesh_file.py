"""A mesh file as an upright solid: its footprint, its height, its centre of mass.

The base and the top must be flat, the sides upright, and the footprint connected and
without a hole, all to within ``TOLERANCE``.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from pushpressslide.geometry.shapes import MeshSolid
from pushpressslide.geometry.united import bordered

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry as Area
    from trimesh import Trimesh

    from pushpressslide.core.arrays import Array

SUFFIXES = (".obj", ".stl")
TOLERANCE = 0.01
"""Of the solid's size: how far base, top and sides may be from an upright prism's."""
DETAIL = 1e-3
"""Of the solid's size: corners that stand out by less are left out of the outline."""
MOST_CORNERS = 256
"""Of an outline."""
MOST_TRIANGLES = 200_000
"""Of a mesh."""
MOST_BYTES = 64_000_000
"""Of a file of text: the most triangles that are allowed, with room."""
STL_HEAD = 84
STL_TRIANGLE = 50
"""Bytes of a binary STL file: head, which ends with the count, and triangle."""
LARGEST = 10.0
"""[m] of a side, as of a box."""
FARTHEST = 1000.0
"""[m] of a corner from the origin of the file's frame."""
GRID = 1e-6
"""Of the solid's size, to which triangles are rounded before they are united."""


def read_mesh(path: str, scale: float) -> MeshSolid:
    """Solid in a file, one unit of which is ``scale`` [m].

    Raises ValueError, with the cause, for a file that cannot be read and for a solid
    that does not stand upright on a flat base without a hole.
    """
    file = Path(path)
    if file.suffix.lower() not in SUFFIXES:
        raise ValueError(f"it ends neither in {' nor in '.join(SUFFIXES)}")
    if not file.is_file():
        raise ValueError("no such file")
    stat = file.stat()
    return _read(path, scale, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=16)
def _read(path: str, scale: float, changed: int, size: int) -> MeshSolid:
    """Solid in a file, cached until the file changes."""
    from shapely import Polygon

    mesh = _loaded(path, scale)
    low, high = (float(z) for z in mesh.bounds[:, 2])
    extent = float(max(mesh.extents))
    height = high - low
    if height < TOLERANCE * extent:
        raise ValueError(f"its height {height:.3g} m is below 1 % of its size")
    whole = _top_view(mesh.triangles, mesh.face_normals[:, 2] > 0.0, extent)
    if not isinstance(whole, Polygon):
        raise ValueError("its footprint is not one piece")
    if _holes(whole, extent):
        raise ValueError("its footprint has a hole")
    for name, level in (("base", low), ("top", high)):
        near = abs(mesh.triangles[:, :, 2] - level).max(axis=1) < TOLERANCE * height
        _check_flat(name, _top_view(mesh.triangles, near, extent), whole, extent)
    _check_upright(float(mesh.volume), whole.area * height)
    simple = Polygon(whole.exterior).simplify(DETAIL * extent)
    assert isinstance(simple, Polygon)
    border = bordered(simple)
    if len(border.corners) > MOST_CORNERS:
        count = len(border.corners)
        raise ValueError(
            f"its outline has {count} corners, allowed up to {MOST_CORNERS}"
        )
    x, y, _ = mesh.center_mass
    return MeshSolid(path, scale, border.corners, height, (float(x), float(y)))


def _loaded(path: str, scale: float) -> Trimesh:
    """Triangles of a file [m]. Raises ValueError unless they are closed."""
    import trimesh

    _check_count(Path(path))
    try:
        mesh = trimesh.load_mesh(path, process=False)
    except Exception as error:  # whatever a broken file makes the reader raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"it cannot be read: {reason[:120]}") from error
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        raise ValueError("it holds no triangles")
    _check_triangles(len(mesh.faces))
    _check_size(mesh, scale)
    mesh.process()
    mesh.apply_scale(scale)  # type: ignore[no-untyped-call]
    if not mesh.is_watertight:
        raise ValueError("its surface is not closed")
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh


def _check_count(file: Path) -> None:
    """Raise ValueError for a file of too many triangles, before it is read."""
    size = file.stat().st_size
    with file.open("rb") as content:
        head = content.read(STL_HEAD)
        if file.suffix.lower() == ".stl" and len(head) == STL_HEAD:
            count = int.from_bytes(head[-4:], "little")
            if size == STL_HEAD + STL_TRIANGLE * count:
                _check_triangles(count)
                return
        if size > MOST_BYTES:
            found = f"it is of {size / 1e6:.0f} MB"
            raise ValueError(f"{found}, allowed up to {MOST_BYTES / 1e6:g} MB of text")
        text = head + content.read()
    word = b"endfacet" if file.suffix.lower() == ".stl" else b"\nf "
    _check_triangles(text.count(word))


def _check_triangles(count: int) -> None:
    if count > MOST_TRIANGLES:
        raise ValueError(f"it has {count} triangles, allowed up to {MOST_TRIANGLES}")


def _check_size(mesh: Trimesh, scale: float) -> None:
    """Raise ValueError for positions that are not finite or far away, and for a solid
    larger than a task may hold.
    """
    import numpy as np

    used = mesh.vertices[np.unique(mesh.faces)]
    if not np.isfinite(used).all():
        raise ValueError("a corner of it is no finite number")
    far = float(np.abs(used).max())
    # the largest places first: a difference of others may not be a number
    if far > FARTHEST / scale:
        raise ValueError(
            f"a corner of it is {far * scale:.3g} m from its origin, allowed up to "
            f"{FARTHEST:g} m (scale is {scale:g}; 0.001 is for a file in mm)"
        )
    sizes = scale * np.ptp(used, axis=0)
    if sizes.max() > LARGEST:
        lengths = " x ".join(f"{length:.4g}" for length in sizes)
        raise ValueError(
            f"it is {lengths} m large, allowed up to {LARGEST:g} m (scale is "
            f"{scale:g}; 0.001 is for a file in mm)"
        )


def _top_view(triangles: Array, mask: NDArray[np.bool_], extent: float) -> Area:
    """Union of some triangles (m, 3, 3) in the view from above."""
    import numpy as np
    import shapely

    flat = triangles[mask][:, :, :2]
    u = flat[:, 1] - flat[:, 0]
    v = flat[:, 2] - flat[:, 0]
    area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    seen = flat[area > (GRID * extent) ** 2]
    return shapely.union_all(shapely.polygons(seen), grid_size=GRID * extent)


def _holes(area: Polygon, extent: float) -> float:
    """Area [m^2] of holes larger than round-off."""
    from shapely import Polygon

    sizes = [float(Polygon(hole).area) for hole in area.interiors]
    return sum(size for size in sizes if size > (TOLERANCE * extent) ** 2)


def _check_flat(name: str, face: Area, whole: Polygon, extent: float) -> None:
    """Raise ValueError unless a face covers the whole footprint in one plane."""
    from shapely import Polygon

    if not isinstance(face, Polygon) or face.is_empty or _holes(face, extent):
        raise ValueError(f"its {name} is not flat: it is no whole face in one plane")
    off = float(whole.exterior.hausdorff_distance(face.exterior))
    if off > TOLERANCE * extent:
        raise ValueError(
            f"its {name} is not flat, or its sides not upright: in one plane it ends "
            f"{off * 1e3:.3g} mm inside the outline, allowed "
            f"{TOLERANCE * extent * 1e3:.3g} mm"
        )


def _check_upright(volume: float, upright: float) -> None:
    """Raise ValueError unless a volume [m^3] is that of an upright prism."""
    if abs(volume - upright) > TOLERANCE * upright:
        raise ValueError(
            f"its sides are not upright: its volume is {volume / upright:.3f} of that "
            f"of its footprint times its height, allowed within {TOLERANCE:g} of 1"
        )
