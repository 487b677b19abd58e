"""Capsules of an arm, from the arm's planning model in Drake.

They are used because Drake's general distance query may not terminate for capsules deep
inside each other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.geometry import Capsule, GeometryId, SceneGraphInspector, Sphere
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.arms.paths.capsules import ArmCapsules
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.robot_models import add_robot


def arm_capsules(robot: Robot, index: int) -> ArmCapsules:
    """Capsules of an arm's planning model.

    Any other shape is replaced by the sphere about its bounding box.
    """
    plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
    instance = add_robot(plant, robot, index, collision=True).model_instance
    plant.Finalize()
    kinematics = arm_kinematics(robot)
    chain = kinematics.link_poses(kinematics.facts.home)
    inspector = scene_graph.model_inspector()
    links = []
    ends = []
    radii = []
    for i in plant.GetBodyIndices(instance):
        body = plant.get_body(i)
        if body.name() not in chain:
            continue
        for shape in plant.GetCollisionGeometriesForBody(body):
            links.append(body.name())
            axis, radius = _capsule(inspector, shape)
            ends.append(axis)
            radii.append(radius)
    return ArmCapsules(kinematics, links, np.array(ends), np.array(radii))


def _capsule(inspector: SceneGraphInspector, shape_id: GeometryId) -> tuple[Any, float]:
    """Ends of a capsule's axis in its body's frame [m], and its radius [m]."""
    shape = inspector.GetShape(shape_id)
    center = np.zeros(3)
    half = np.zeros(3)
    if isinstance(shape, Capsule):
        radius = shape.radius()
        half = np.array([0.0, 0.0, 0.5 * shape.length()])
    elif isinstance(shape, Sphere):
        radius = shape.radius()
    else:
        box = inspector.GetObbInGeometryFrame(shape_id)
        radius = float(np.linalg.norm(box.half_width()))
        center = box.center()
    X_BG = inspector.GetPoseInFrame(shape_id)
    return [X_BG @ (center - half), X_BG @ (center + half)], radius
