"""A body from a mesh in Drake: the convex and layered pieces that tips touch, and the
surface that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import Convex, InMemoryMesh, Mesh
from pydrake.geometry import Shape as DrakeShape

from pushpressslide.core.control import Vector3
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.mesh_parts import (
    Part,
    UprightPart,
    body_parts,
    convex_of,
    few_convex_corners,
)
from pushpressslide.sim.layered_mesh import layered_mesh
from pushpressslide.taskfile.mesh_file import surface_of

MOST_DRAWN = 100_000
"""Largest number of triangles of a body that is drawn unchanged."""


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
    return tuple(
        solid for part in body_parts(body, thick=True) for solid in _solids(part)
    )


@lru_cache(maxsize=8)
def convex_parts(body: MeshBody) -> tuple[DrakeShape, ...]:
    """Convex shapes whose union covers a body, as ``few_convex_corners``."""
    return tuple(_convex(corners) for corners in few_convex_corners(body))


def _solids(part: Part) -> Iterator[SolidPart]:
    """One layered piece for an upright part, otherwise convex ones."""
    if isinstance(part, UprightPart) and not part.polygon.interiors:
        try:
            made = layered_mesh(part.ring, part.high - part.low)
        except ValueError:
            pass  # too thin for a layer
        else:
            middle = 0.5 * (part.low + part.high)
            yield SolidPart(made.mesh.raised(middle).drake(), made.depth)
            return
    for convex in convex_of(part):
        yield SolidPart(_convex(convex.corners), convex.thickness)


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
