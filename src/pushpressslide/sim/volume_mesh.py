"""Volume meshes in memory, for hydroelastic contact."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pydrake.common import MemoryFile
from pydrake.geometry import InMemoryMesh, Mesh

from pushpressslide.core.control import Vector3

Tetrahedron = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class VolumeMesh:
    """Vertices [m] and tetrahedra. The origin of z is at half height.

    The first three vertices of a tetrahedron run counter-clockwise as seen from the
    fourth.
    """

    vertices: tuple[Vector3, ...]
    tetrahedra: tuple[Tetrahedron, ...]

    def raised(self, height: float) -> VolumeMesh:
        """The mesh raised by a height [m]."""
        raised = tuple((x, y, z + height) for x, y, z in self.vertices)
        return replace(self, vertices=raised)

    def vtk(self) -> str:
        """The mesh as the text of a VTK file."""
        points = [f"{x:.12g} {y:.12g} {z:.12g}" for x, y, z in self.vertices]
        cells = ["4 " + " ".join(map(str, cell)) for cell in self.tetrahedra]
        lines = [
            "# vtk DataFile Version 3.0",
            "object",
            "ASCII",
            "DATASET UNSTRUCTURED_GRID",
            f"POINTS {len(points)} double",
            *points,
            f"CELLS {len(cells)} {5 * len(cells)}",
            *cells,
            f"CELL_TYPES {len(cells)}",
            *["10"] * len(cells),
        ]
        return "\n".join(lines) + "\n"

    def drake(self) -> Mesh:
        """The mesh as a Drake mesh."""
        file = MemoryFile(self.vtk(), ".vtk", "object.vtk")
        return Mesh(InMemoryMesh(mesh_file=file), 1.0)
