"""Simplified arms for the renderer: round shapes as one coarse mesh per link and
colour.

Drake's renderer divides every cylinder and capsule into thousands of triangles, which
without a graphics card take most of the rendering time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import trimesh
from pydrake.common import MemoryFile
from pydrake.geometry import (
    Capsule,
    Cylinder,
    Ellipsoid,
    FrameId,
    GeometryInstance,
    InMemoryMesh,
    Mesh,
    PerceptionProperties,
    Rgba,
    Role,
    Sphere,
)
from pydrake.math import RigidTransform

from pushpressslide.view.drake.playback import Playback

SIDES = 24  # of a circle
SHARP = math.radians(45.0)  # angle of an edge that is shaded as one

Group = tuple[FrameId, tuple[float, float, float]]
"""Frame and colour of a link."""


def lighten_arms(playback: Playback, shown: Collection[int]) -> None:
    """Simplify the arms ``shown`` for renderers, and hide the links of the other arms.
    The bodies that hold the tips stay visible.
    """
    graph = playback.scene.scene_graph
    inspector = graph.model_inspector()
    source = playback.scene.plant.get_source_id()
    owner = _arm_frames(playback)
    groups: dict[Group, list[trimesh.Trimesh]] = {}
    for geometry in inspector.GetAllGeometryIds(Role.kPerception):
        frame = inspector.GetFrameId(geometry)
        if frame not in owner:
            continue
        color = _color(inspector.GetPerceptionProperties(geometry))
        shape = inspector.GetShape(geometry)
        coarse = ROUND.get(type(shape))
        if owner[frame] in shown:
            if coarse is None or color is None:
                continue
            mesh = coarse(shape)
            mesh.apply_transform(inspector.GetPoseInFrame(geometry).GetAsMatrix4())
            groups.setdefault((frame, color), []).append(mesh)
        graph.RemoveRole(source, geometry, Role.kPerception)
    for number, ((frame, color), meshes) in enumerate(groups.items()):
        drawn = Mesh(_obj(meshes))
        made = GeometryInstance(RigidTransform(), drawn, f"light_{number}")
        properties = PerceptionProperties()
        properties.AddProperty("phong", "diffuse", Rgba(*color, 1.0))
        made.set_perception_properties(properties)
        graph.RegisterGeometry(source, frame, made)


def _arm_frames(playback: Playback) -> Mapping[FrameId, int]:
    """Arm to which each link's frame belongs. The tip's body is not included."""
    plant = playback.scene.plant
    out = {}
    for arm, robot in enumerate(playback.scene.robots):
        for index in plant.GetBodyIndices(robot.model_instance)[:-1]:
            out[plant.GetBodyFrameIdOrThrow(index)] = arm
    return out


def _cylinder(shape: Any) -> trimesh.Trimesh:
    made = trimesh.creation.cylinder(shape.radius(), shape.length(), sections=SIDES)
    # corners of its own for each end, whose edge would be shaded as if it were round
    return trimesh.graph.smooth_shade(made, angle=SHARP)


def _capsule(shape: Any) -> trimesh.Trimesh:
    count = [SIDES, SIDES // 2]
    made = trimesh.creation.capsule(shape.length(), shape.radius(), count=count)
    made.apply_translation(-made.bounds.mean(axis=0))
    return made


def _ellipsoid(shape: Any) -> trimesh.Trimesh:
    made = trimesh.creation.uv_sphere(1.0, count=[SIDES // 2, SIDES])
    made.apply_scale([shape.a(), shape.b(), shape.c()])
    return made


def _sphere(shape: Any) -> trimesh.Trimesh:
    return trimesh.creation.uv_sphere(shape.radius(), count=[SIDES // 2, SIDES])


ROUND: Mapping[type, Callable[[Any], trimesh.Trimesh]] = {
    Capsule: _capsule,
    Cylinder: _cylinder,
    Ellipsoid: _ellipsoid,
    Sphere: _sphere,
}
"""Functions that make a coarse surface [m] of each of Drake's round shapes, about its
origin.
"""


def _color(known: PerceptionProperties) -> tuple[float, float, float] | None:
    """Colour of an opaque body. None for any other body."""
    if not known.HasProperty("phong", "diffuse"):
        return None
    color = known.GetProperty("phong", "diffuse")
    return (color.r(), color.g(), color.b()) if color.a() == 1.0 else None


def _obj(meshes: Sequence[trimesh.Trimesh]) -> InMemoryMesh:
    """Several surfaces as one, with a normal at each corner."""
    lines: list[str] = []
    first = 1
    for mesh in meshes:
        lines += ["v {:.6g} {:.6g} {:.6g}".format(*row) for row in mesh.vertices]
        lines += ["vn {:.5g} {:.5g} {:.5g}".format(*row) for row in mesh.vertex_normals]
        faces = mesh.faces + first
        lines += ["f {0}//{0} {1}//{1} {2}//{2}".format(*row) for row in faces]
        first += len(mesh.vertices)
    text = "\n".join(lines) + "\n"
    return InMemoryMesh(mesh_file=MemoryFile(text, ".obj", "light"))
