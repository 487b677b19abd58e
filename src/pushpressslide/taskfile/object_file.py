"""Objects in URDF, SDF and MJCF files, as one mesh with a mass and a centre of mass."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pushpressslide.core.errors import PushPressSlideError

if TYPE_CHECKING:
    from trimesh import Trimesh

    from pushpressslide.robots.facts import LinkShape
    from pushpressslide.robots.rigid_file import RigidObject

MUJOCO = ".msh"
SUFFIXES = (".urdf", ".sdf", ".xml")
"""Suffixes of files that describe an object and name its meshes."""


def is_object_file(path: Path) -> bool:
    """Whether a file describes an object, and is not itself a mesh."""
    return path.suffix.lower() in SUFFIXES


def read_object(path: Path) -> RigidObject:
    """Object in a file. Raises ValueError, with the cause, if it cannot be read."""
    from pushpressslide.robots.rigid_file import read_rigid_object

    try:
        return read_rigid_object(path)
    except (PushPressSlideError, OSError) as error:
        raise ValueError(str(error)) from error


def object_mesh(content: RigidObject) -> Trimesh:
    """All shapes of an object as one mesh [m]. Raises ValueError if there are none."""
    import trimesh

    if not content.shapes:
        raise ValueError("it holds no shapes")
    parts = []
    for shape, pose in content.shapes:
        part = _mesh_of(shape)
        part.apply_transform(pose)
        parts.append(part)
    whole = trimesh.util.concatenate(parts)
    assert isinstance(whole, trimesh.Trimesh)
    return whole


def _loaded(path: Path) -> Trimesh:
    """Triangles of a mesh file. Raises ValueError if it cannot be read."""
    import trimesh

    if path.suffix.lower() == MUJOCO:
        return _mujoco_mesh(path)
    try:
        mesh = trimesh.load(str(path), force="mesh", process=False)
    except Exception as error:  # whatever a broken file makes the reader raise
        raise ValueError(f"its mesh {path.name} cannot be read: {error}") from error
    if not isinstance(mesh, trimesh.Trimesh):
        raise ValueError(f"its mesh {path.name} holds no triangles")
    return mesh


def _mujoco_mesh(path: Path) -> Trimesh:
    """Triangles of a mesh in MuJoCo's own binary format: four counts, then vertices,
    normals, texture coordinates and faces.
    """
    import numpy as np
    import trimesh

    data = path.read_bytes()
    points, normals, texture, faces = np.frombuffer(data, "<i4", 4).tolist()
    start = 16 + 12 * points + 12 * normals + 8 * texture
    if len(data) != start + 12 * faces:
        raise ValueError(f"its mesh {path.name} cannot be read")
    vertices = np.frombuffer(data, "<f4", 3 * points, 16).reshape(-1, 3)
    corners = np.frombuffer(data, "<i4", 3 * faces, start).reshape(-1, 3)
    return trimesh.Trimesh(vertices, corners, process=False)


def _mesh_of(shape: LinkShape) -> Trimesh:
    """Mesh [m] of one shape in its own frame."""
    import numpy as np
    import trimesh

    if shape.kind == "mesh":
        mesh = _loaded(Path(shape.mesh))
        vertices = np.asarray(mesh.vertices) * np.array(shape.size)
        return trimesh.Trimesh(vertices, mesh.faces, process=False)
    made: dict[str, Any] = {
        "box": lambda sides: trimesh.creation.box(sides),
        "sphere": lambda size: trimesh.creation.icosphere(3, size[0]),
        "cylinder": lambda size: trimesh.creation.cylinder(size[0], size[1]),
        "capsule": lambda size: trimesh.creation.capsule(size[1], size[0]),
    }
    out: Trimesh = made[shape.kind](shape.size)
    return out
