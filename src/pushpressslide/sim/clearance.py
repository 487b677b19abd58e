"""How near an arm comes to table, object, obstacles and itself: signed distances in a plant made for planning
only.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import SpatialInertia, default_model_instance
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.robot_models import add_robot
from pushpressslide.sim.surfaces import object_shape

Array = NDArray[np.float64]

LOOK = 0.08  # [m] distances beyond this are of no interest
TABLE_LEVEL = -0.001  # [m] a hair below, so that a base bolted to the table does not count


class ClearanceModel:
    """One arm with collision capsules, the object, the table and the obstacles; no dynamics."""

    def __init__(self, plan: Plan, arm: int) -> None:
        """Build the planning plant."""
        task = plan.task
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        self._instance = add_robot(plant, task.robots[arm], arm, collision=True)
        self._object = plant.AddRigidBody(
            "object", default_model_instance(), SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1)
        )
        properties = ProximityProperties()
        shape_id = plant.RegisterCollisionGeometry(
            self._object, RigidTransform(), object_shape(task.object.shape), "object", properties
        )
        frame, below = task.support.frame, TABLE_LEVEL - 0.5
        slabs = {"table": RigidTransform([0.0, 0.0, below])}
        if task.support.kind == "wall":
            slabs["wall"] = rigid_transform(Pose2(), below, frame)
        for name, X in slabs.items():
            plant.RegisterCollisionGeometry(
                plant.world_body(), X, DrakeBox(6.0, 6.0, 1.0), name, properties
            )
        for obstacle in task.obstacles:
            plant.RegisterCollisionGeometry(
                plant.world_body(), rigid_transform(obstacle.pose, 0.5 * obstacle.size[2], frame),
                DrakeBox(*obstacle.size), obstacle.name, properties,
            )  # fmt: skip
        plant.Finalize()
        self._object_shape = shape_id
        self._tip = set(plant.GetCollisionGeometriesForBody(self._instance.tip_body))
        self._plant, self._height, self._frame = plant, 0.5 * task.object.shape.height, frame
        base = [
            plant.GetBodyByName(name, self._instance.model_instance) for name in self._instance.base_links
        ]
        arm_bodies = [plant.get_body(i) for i in plant.GetBodyIndices(self._instance.model_instance)]
        manager = scene_graph.collision_filter_manager()

        def shapes(bodies: Sequence[object]) -> GeometrySet:
            out = GeometrySet()
            for body in bodies:
                out.Add(plant.GetCollisionGeometriesForBody(body))
            return out

        world = shapes([plant.world_body()])
        # the base stands on the table, object and table belong together, and an arm may fold
        manager.Apply(CollisionFilterDeclaration().ExcludeBetween(shapes(base), world))
        manager.Apply(CollisionFilterDeclaration().ExcludeBetween(GeometrySet(shape_id), world))
        manager.Apply(CollisionFilterDeclaration().ExcludeWithin(shapes(arm_bodies)))
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._plant_context = plant.GetMyMutableContextFromRoot(self._context)
        self._query = plant.get_geometry_query_input_port()
        self._inspector = scene_graph.model_inspector()

    def least(self, postures: Array, object_poses: Sequence[Pose2], *, touching: bool) -> tuple[float, str]:
        """Return the least distance [m], at most 0.08, and between what, over postures (k, n) and object
        poses X_WG (k).

        ``touching``: the tip touches the object on purpose, so that these two do not count.
        """
        least, pair = LOOK, "nothing within reach"
        for q, pose in zip(postures, object_poses, strict=True):
            self._plant.SetPositions(self._plant_context, self._instance.model_instance, q)
            self._plant.SetFreeBodyPose(
                self._plant_context, self._object, rigid_transform(pose, self._height, self._frame)
            )
            query = self._query.Eval(self._plant_context)
            for found in query.ComputeSignedDistancePairwiseClosestPoints(LOOK):
                if (
                    touching
                    and {found.id_A, found.id_B} & self._tip
                    and self._object_shape in (found.id_A, found.id_B)
                ):
                    continue
                if found.distance < least:
                    least = found.distance
                    pair = " and ".join(
                        self._inspector.GetName(g).split("::")[-1] for g in (found.id_A, found.id_B)
                    )
        return float(least), pair
