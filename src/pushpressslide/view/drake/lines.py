"""Lines drawn flat on a support: paths and a grid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from pydrake.common import MemoryFile
from pydrake.geometry import InMemoryMesh, Mesh

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Support
from pushpressslide.sim.surfaces import Bounds

RIBBON_WIDTH = 0.006  # [m] of paths
PATH_HEIGHT = 0.0010  # [m] above the support
LEAST_PATH = 0.01  # [m] shorter paths are hardly longer than wide, and not drawn
GRID_STEP = 0.1  # [m] between the lines of the grid
GRID_ROOM = 0.3  # [m] of the grid beyond what the object covers
GRID_HEIGHT = 0.0004  # [m] above the support
GRID_WIDTH = 0.0014  # [m] of its lines
FAR = 10.0  # [m] to the edges of a support that has none
TABLE = (-0.4, -0.9, 1.3, 0.9)  # [m] low and high corner of a table without edges


def leads_somewhere(points: Array) -> bool:
    """Whether a path (K, 2) [m] has a length, so that it can be drawn as a line."""
    return bool(np.ptp(points, axis=0).max() > LEAST_PATH)


def ribbon(points: Array, width: float) -> Mesh:
    """A flat strip of ``width`` [m] along ``points`` (K, 2), K >= 2.

    It lies in the plane z = 0 and faces up.
    """
    return ribbons([points], width)


def ribbons(lines: Sequence[Array], width: float) -> Mesh:
    """Flat strips of ``width`` [m] along ``lines`` (K, 2), K >= 2 each, as one mesh.

    The mesh lies in the plane z = 0 and faces up.
    """
    rows = ["vn 0 0 1"]
    faces: list[str] = []
    first = 1
    for points in lines:
        left, right = _sides(points, width)
        for (x, y), (u, v) in zip(left, right, strict=True):
            rows += [f"v {x:.6f} {y:.6f} 0", f"v {u:.6f} {v:.6f} 0"]
        for i in range(len(points) - 1):
            a = first + 2 * i  # left; then right, left ahead, right ahead
            faces += [
                f"f {a + 1}//1 {a + 3}//1 {a + 2}//1",
                f"f {a + 1}//1 {a + 2}//1 {a}//1",
            ]
        first += 2 * len(points)
    text = "\n".join([*rows, *faces]) + "\n"
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(text, ".obj", "ribbon.obj")))


def _sides(points: Array, width: float) -> tuple[Array, Array]:
    """Left and right edge (K, 2) of a strip along ``points``."""
    along = np.gradient(points, axis=0)
    size = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    left = 0.5 * width * np.column_stack([-along[:, 1], along[:, 0]]) / size
    return points + left, points - left


def grid_lines(support: Support, reached: Bounds) -> list[Array]:
    """Lines (2, 2) [m] every 0.1 m on the support around the area ``reached`` by the
    object.
    """
    x_min, x_max, y_min, y_max = reached
    low = np.array([x_min, y_min]) - GRID_ROOM
    high = np.array([x_max, y_max]) + GRID_ROOM
    surface = _surface(support)
    out = []
    for axis in (0, 1):
        first = int(np.ceil(low[axis] / GRID_STEP))
        last = int(np.floor(high[axis] / GRID_STEP))
        for number in range(first, last + 1):
            start = low.copy()
            end = high.copy()
            start[axis] = end[axis] = number * GRID_STEP
            out += _within(surface, start, end)
    return out


def _surface(support: Support) -> Any:
    """Outline of a support in its plane, without its opening."""
    surface: Any = shapely.box(-FAR, -FAR, FAR, FAR)
    if support.region is not None:
        surface = shapely.Polygon(support.region)
    elif support.kind == "table":
        surface = shapely.box(*TABLE)
    if support.opening is not None:
        left, right, low, high = support.opening.edges
        surface = surface.difference(shapely.box(left, low, right, high))
    return surface


def _within(surface: Any, start: Array, end: Array) -> list[Array]:
    """Parts of a line that lie on a surface."""
    line = shapely.LineString([start, end]).intersection(surface)
    pieces = shapely.get_parts(line)
    return [np.array(p.coords) for p in pieces if p.length > 0.0]
