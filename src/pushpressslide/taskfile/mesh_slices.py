"""Cross-sections and level faces of a surface in a mesh file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pushpressslide.geometry.areas import filled, polygons
from pushpressslide.taskfile.mesh_face import covered, enclosed
from pushpressslide.taskfile.mesh_surface import Surface

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

DETAIL = 1e-3
"""Smallest detail of an outline, as a share of the solid's size. Corners that protrude
by less are omitted.
"""
GRID = 1e-3
"""Grid to which corners are rounded, as a share of ``DETAIL``."""
DANGLING = 0.05
"""Share of a cross-section's lines that need not belong to a closed loop."""


@dataclass(frozen=True)
class Slices:
    """A surface that stands on the plane z = 0, for cuts at any height."""

    triangles: Array  # (m, 3, 3) [m]
    height: float  # [m]
    detail: float  # [m]
    closed: bool

    @property
    def grid(self) -> float:
        """Grid length [m] to which corners are rounded."""
        return GRID * self.detail

    def section(self, height: float) -> Area:
        """Cross-section at a height at which there is no corner.

        If the surface is open there, the cross-section has no holes.
        """
        import numpy as np

        corners = self.triangles[:, :, 2]
        cut = (corners.min(axis=1) < height) & (corners.max(axis=1) > height)
        kept = self.triangles[cut]
        above = kept[:, :, 2] > height
        tails = _crossings(kept, above & ~np.roll(above, -1, axis=1), height)
        heads = _crossings(kept, ~above & np.roll(above, -1, axis=1), height)
        if self.closed or _is_balanced(tails, heads, self.grid):
            return self.simple(enclosed(tails, heads, self.grid))
        return self.simple(_looped(tails, heads, self.grid))

    def resting(self, height: float) -> Area:
        """Area of the faces below ``height``. Without such faces, the cross-section at
        that height.
        """
        low = self.triangles[:, :, 2].max(axis=1) < height
        area = self.covered(self.triangles[low][:, ::-1])
        return self.section(height) if area.is_empty else area

    def covered(self, triangles: Array) -> Area:
        """Area covered by triangles (m, 3, 3), counter-clockwise as seen from above.
        Empty if they are too rough.
        """
        from shapely import Polygon

        try:
            return self.simple(covered(triangles[:, :, :2], self.grid))
        except ValueError:
            return Polygon()

    def simple(self, area: Area) -> Area:
        """The area without small parts and details."""
        import shapely

        small = self.detail * self.detail
        kept = [
            part.simplify(self.detail) for part in polygons(area) if part.area > small
        ]
        return shapely.union_all(kept)


def slices_of(surface: Surface) -> Slices:
    """Slices of a surface, which is raised or lowered to stand on the plane z = 0."""
    mesh = surface.mesh
    low, high = (float(z) for z in mesh.bounds[:, 2])
    triangles = mesh.triangles.copy()
    triangles[:, :, 2] -= low
    detail = DETAIL * float(max(mesh.extents))
    return Slices(triangles, high - low, detail, not surface.fault)


def _crossings(triangles: Array, edge: Array, height: float) -> Array:
    """Points (m, 2) at which one edge of each triangle crosses a height."""
    import numpy as np

    rows, first = np.nonzero(edge)
    a = triangles[rows, first]
    b = triangles[rows, (first + 1) % 3]
    share = (height - a[:, 2]) / (b[:, 2] - a[:, 2])
    points: Array = a[:, :2] + share[:, None] * (b[:, :2] - a[:, :2])
    return points


def _is_balanced(tails: Array, heads: Array, grid: float) -> bool:
    """Whether the number of directed lines that end at each point equals the number
    that begin there.

    The lines are then closed loops with the body to their left.
    """
    import numpy as np

    points = np.round(np.concatenate((tails, heads)) / grid)
    _, number = np.unique(points, axis=0, return_inverse=True)
    sense = np.repeat((1.0, -1.0), len(tails))
    return not np.bincount(number.ravel(), weights=sense).any()


def _looped(tails: Array, heads: Array, grid: float) -> Area:
    """Area within the loops of directed lines, or the lines' convex hull if they do not
    close.
    """
    import numpy as np
    import shapely

    lines = shapely.union_all(
        shapely.linestrings(np.stack((tails, heads), axis=1)), grid_size=grid
    )
    cells, cuts, dangles, _ = shapely.polygonize_full([lines])
    loose = shapely.length(cuts) + shapely.length(dangles)
    if loose > DANGLING * shapely.length(lines):
        return lines.convex_hull
    return filled(shapely.union_all(shapely.get_parts(cells), grid_size=grid))
