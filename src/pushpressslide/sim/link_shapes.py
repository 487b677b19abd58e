"""Shapes of a robot's links, from its file, in a MultibodyPlant.

Meshes may have any format. Clearances use their convex hulls, pictures the meshes
themselves.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    Box,
    Capsule,
    Convex,
    Cylinder,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
    Sphere,
)
from pydrake.geometry import Shape as DrakeShape
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from pushpressslide.core.arrays import Array
from pushpressslide.robots.facts import LinkShape
from pushpressslide.robots.file_shapes import read_mesh

ALUMINIUM = (0.78, 0.79, 0.81)
MOST_TRIANGLES = 100_000
"""Largest number of triangles in a drawn mesh."""


def add_shapes(
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    shapes: Iterable[LinkShape],
    collision: bool,
) -> None:
    """Register the shapes of one robot's links: those for pictures and, with
    ``collision``, those for clearances.

    A link without a shape for pictures is drawn with its shapes for clearances. Meshes
    that cannot be read are omitted.
    """
    shapes = tuple(shapes)
    drawn = {s.link for s in shapes if not s.solid and _picture(s) is not None}
    for number, shape in enumerate(shapes):
        body = plant.GetBodyByName(shape.link, instance)
        X = RigidTransform(RollPitchYaw(shape.rpy), shape.xyz)
        name = f"{shape.link}_{number}"
        if shape.solid and collision:
            hull = solid(shape)
            if hull is not None:
                properties = ProximityProperties()
                plant.RegisterCollisionGeometry(body, X, hull, name, properties)
        picture = None
        if not shape.solid or shape.link not in drawn:
            picture = _picture(shape)
        if picture is not None:
            color = np.array([*(shape.color or ALUMINIUM), 1.0])
            plant.RegisterVisualGeometry(body, X, picture, f"{name}_visual", color)


def solid(shape: LinkShape) -> DrakeShape | None:
    """Convex shape of a link for clearances. None for a mesh that cannot be read."""
    if shape.kind != "mesh":
        return _primitive(shape)
    corners = hull_corners(shape.mesh)
    if corners is None:
        return None
    return Convex((corners * np.array(shape.size)).T, Path(shape.mesh).name)


def _primitive(shape: LinkShape) -> DrakeShape:
    kinds: dict[str, Any] = {
        "box": Box,
        "sphere": Sphere,
        "cylinder": Cylinder,
        "capsule": Capsule,
    }
    return kinds[shape.kind](*shape.size)


def _picture(shape: LinkShape) -> DrakeShape | None:
    """Shape that is drawn. None for a mesh that cannot be read or is too large."""
    if shape.kind != "mesh":
        return _primitive(shape)
    text = _wavefront(shape.mesh)
    if text is None:
        return None
    file = MemoryFile(text, ".obj", Path(shape.mesh).name)
    return Mesh(InMemoryMesh(mesh_file=file), np.array(shape.size))


@lru_cache(maxsize=128)
def hull_corners(path: str) -> Array | None:
    """Corners (n, 3) of the convex hull of a mesh, in its own units. None for a mesh
    that cannot be read.
    """
    mesh = read_mesh(path)
    if mesh is None:
        return None
    try:
        hull = mesh.convex_hull
    except Exception:
        return np.array(mesh.bounding_box.vertices)
    out: Array = np.array(hull.vertices)
    return out


@lru_cache(maxsize=128)
def _wavefront(path: str) -> str | None:
    """A mesh as the text of an OBJ file. None if it cannot be read or has too many
    triangles.
    """
    mesh = read_mesh(path)
    if mesh is None or len(mesh.faces) > MOST_TRIANGLES:
        return None
    corners = "\n".join(
        f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in mesh.vertices.tolist()
    )
    faces = "\n".join(f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist())
    return f"{corners}\n{faces}\n"
