"""The surface in a mesh file: closed, in [m], with z pointing up.

Corners at the same position are merged, even if the file separates them because of
normals, texture or material.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pushpressslide.taskfile.mesh_count import check_count, check_triangles
from pushpressslide.taskfile.object_file import (
    is_object_file,
    object_mesh,
    read_object,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from trimesh import Trimesh

    from pushpressslide.core.arrays import Array

    Indices = NDArray[np.integer[Any]]

GRID = 1e-6
"""Distance below which corners count as one, as a share of the solid's size."""
SMALLEST = 0.005
LARGEST = 10.0
"""Largest length [m] of a body's longest side, the same as for a box."""
FARTHEST = 1000.0
"""Largest distance [m] of a corner from the origin of the file's frame."""
MOST_GAP_EDGES = 4
"""Largest number of edges of a gap that is filled. The shape of such a gap is
unambiguous.
"""
UNITS = (("millimetres", 0.001), ("metres", 1.0))
"""Units that a message suggests, with their scales."""

TURNS: Mapping[str, tuple[tuple[int, int, int], ...]] = {
    "x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
}
"""Shortest rotation that makes an axis of the file point up. A half turn is about x."""


@dataclass(frozen=True)
class Surface:
    """A surface with z pointing up. If it is closed, its triangles are
    counter-clockwise as seen from outside.
    """

    mesh: Trimesh  # [m]
    fault: str = ""  # why it is not closed


def read_surface(file: Path, scale: float, up: str) -> Surface:
    """Surface in a file, closed if possible.

    Raises ValueError for a file that cannot be read or contains no solid.
    """
    import numpy as np

    raw = _loaded(file)
    check_triangles(len(raw.faces))
    _check_size(raw, scale)
    vertices = scale * turned(np.asarray(raw.vertices), up)
    merged = _merged(vertices, np.asarray(raw.faces))
    try:
        mesh = _filled(merged)
        _check_winding(mesh)
    except ValueError as error:
        return Surface(merged, str(error))
    return Surface(_outward(mesh))


def turned(points: Array, up: str) -> Array:
    """Points (..., 3), rotated so that the axis ``up`` of the file becomes z."""
    import numpy as np

    out: Array = points @ np.array(TURNS[up], dtype=float).T
    return out


def _loaded(file: Path) -> Trimesh:
    """Triangles of all meshes in a file, each in its place in the scene."""
    import trimesh

    if is_object_file(file):
        return object_mesh(read_object(file))
    check_count(file)
    try:
        mesh = trimesh.load_mesh(str(file), process=False, skip_materials=True)
    except Exception as error:  # whatever a broken file makes the reader raise
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"it cannot be read: {reason[:120]}") from error
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        raise ValueError("it holds no triangles")
    return mesh


def _check_size(mesh: Trimesh, scale: float) -> None:
    """Raise ValueError for positions that are not finite or too far away, and for a
    solid that is larger or smaller than a task allows.
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
            f"{FARTHEST:g} m: {_unit_question(far, scale)}"
        )
    sizes = np.ptp(used, axis=0)
    longest = float(sizes.max())
    if not SMALLEST <= scale * longest <= LARGEST:
        lengths = " x ".join(f"{scale * length:.4g}" for length in sizes)
        raise ValueError(
            f"it is {lengths} m, allowed {SMALLEST:g} to {LARGEST:g} m on its longest "
            f"side: {_unit_question(longest, scale)}"
        )


def _unit_question(length: float, scale: float) -> str:
    """Question about the unit of a file, for a ``length`` that is implausible at this
    ``scale``.
    """
    for unit, other in UNITS:
        if other != scale and SMALLEST <= other * length <= LARGEST:
            return f"in {unit}? give scale: {other:g}"
    return f"is scale: {scale:g} right?"


def _merged(vertices: Array, faces: Indices) -> Trimesh:
    """Mesh with one vertex per position, without degenerate triangles."""
    import numpy as np
    from trimesh import Trimesh

    extent = float(np.ptp(vertices[np.unique(faces)], axis=0).max())
    digits = math.ceil(-math.log10(GRID * extent))
    mesh = Trimesh(vertices, faces, process=False)
    mesh.merge_vertices(digits_vertex=digits)
    a, b, c = mesh.faces.T
    mesh.update_faces((a != b) & (b != c) & (c != a))
    return mesh


def _filled(mesh: Trimesh) -> Trimesh:
    """Mesh with its small gaps filled. Raises ValueError if it is still open."""
    import numpy as np
    from trimesh import Trimesh

    edges = _open_edges(mesh)
    if not len(edges):
        return mesh
    loops = [lp for lp in _loops(edges) if len(lp) <= MOST_GAP_EDGES]
    fans = [(lp[0], lp[i + 1], lp[i]) for lp in loops for i in range(1, len(lp) - 1)]
    if fans:
        faces = np.vstack((mesh.faces, fans))
        mesh = Trimesh(mesh.vertices, faces, process=False)
    count = len(_open_edges(mesh))
    if count:
        raise ValueError(f"its surface is not closed: {count} edges are open")
    return mesh


def _open_edges(mesh: Trimesh) -> Indices:
    """Edges (m, 2) that belong to an odd number of triangles, each with the direction
    it has in one of them.
    """
    import numpy as np

    low, high = mesh.edges_sorted.T
    keys = low * len(mesh.vertices) + high
    _, place, counts = np.unique(keys, return_inverse=True, return_counts=True)
    return np.asarray(mesh.edges[counts[place] % 2 == 1])


def _loops(edges: Indices) -> list[list[int]]:
    """Closed loops of directed edges. Empty if loops meet at a corner, or if a loop
    does not close.
    """
    follow = dict(edges.tolist())
    if len(follow) < len(edges):
        return []
    loops = []
    while follow:
        start, end = follow.popitem()
        loop = [start]
        while end != start:
            if end not in follow:
                return []
            loop.append(end)
            end = follow.pop(end)
        loops.append(loop)
    return loops


def _check_winding(mesh: Trimesh) -> None:
    """Raise ValueError unless the triangles use each edge equally often in both
    directions.
    """
    import numpy as np

    low, high = mesh.edges_sorted.T
    _, place = np.unique(low * len(mesh.vertices) + high, return_inverse=True)
    sense = np.where(mesh.edges[:, 0] == low, 1.0, -1.0)
    count = int(np.count_nonzero(np.bincount(place, weights=sense)))
    if count:
        raise ValueError(
            f"its triangles do not all face outwards: at {count} edges two neighbours "
            "face opposite ways"
        )


def _outward(mesh: Trimesh) -> Trimesh:
    """Mesh whose bodies all face outwards, without the cavities inside them."""
    import numpy as np
    from trimesh import Trimesh
    from trimesh.graph import connected_component_labels

    bodies = np.zeros(len(mesh.faces), dtype=int)
    if mesh.is_watertight:
        pairs = mesh.face_adjacency
        count = len(bodies)
        bodies = connected_component_labels(  # type: ignore[no-untyped-call]
            pairs, node_count=count
        )
    a, b, c = (mesh.triangles - mesh.vertices.mean(axis=0)).swapaxes(0, 1)
    sixfold = np.einsum("ij,ij->i", a, np.cross(b, c))
    volumes = np.bincount(bodies, weights=sixfold) / 6.0
    if volumes.sum() < 0.0:
        mesh.invert()
        volumes = -volumes
    inward = volumes < -GRID * volumes.sum()
    if not inward.any():
        return mesh
    cavities = [
        body for body in np.flatnonzero(inward) if _is_inside(mesh, bodies, int(body))
    ]
    turned = mesh.faces.copy()
    turned[inward[bodies]] = turned[inward[bodies]][:, ::-1]
    kept = ~np.isin(bodies, cavities)
    return Trimesh(mesh.vertices, turned[kept], process=False)


def _is_inside(mesh: Trimesh, bodies: Indices, body: int) -> bool:
    """Whether a body lies within the bounds of any other body."""
    import numpy as np

    corners = mesh.triangles
    own = corners[bodies == body].reshape(-1, 3)
    for other in np.unique(bodies):
        about = corners[bodies == other].reshape(-1, 3)
        inside = (own.min(axis=0) >= about.min(axis=0)).all()
        if other != body and inside and (own.max(axis=0) <= about.max(axis=0)).all():
            return True
    return False
