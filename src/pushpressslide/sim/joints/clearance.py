"""How near an arm comes to table, object, obstacles and itself: signed distances in a
plant made for planning only.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometrySet,
    ProximityProperties,
    SignedDistancePair,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import (
    JacobianWrtVariable,
    SpatialInertia,
    default_model_instance,
)
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.joints.outline import Outline, least_distance
from pushpressslide.sim.robot_models import add_robot
from pushpressslide.sim.surfaces import object_shape

LOOK = 0.08  # [m] distances beyond this are of no interest
# [m] over which the smooth least distance passes from one pair to the next
SMOOTHING = 5e-4
# [m] a hair below, so that a base bolted to the table does not count
TABLE_LEVEL = -0.001


class ClearanceModel:
    """One arm with collision capsules, the object, the table, the obstacles, and arms
    that stand still.
    """

    def __init__(
        self, plan: Plan, arm: int, others: Mapping[int, Array] | None = None
    ) -> None:
        """Build the planning plant; ``others`` are the postures of arms that stand
        still.
        """
        task = plan.task
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        self._instance = add_robot(plant, task.robots[arm], arm, collision=True)
        self._still = [
            (Outline(task.robots[arm], arm), Outline(task.robots[i], i), q[None])
            for i, q in (others or {}).items()
        ]
        self._object = plant.AddRigidBody(
            "object",
            default_model_instance(),
            SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1),
        )
        properties = ProximityProperties()
        shape_id = plant.RegisterCollisionGeometry(
            self._object,
            RigidTransform(),
            object_shape(task.object.shape),
            "object",
            properties,
        )
        frame = task.support.frame
        below = TABLE_LEVEL - 0.5
        slabs = {"table": RigidTransform([0.0, 0.0, below])}
        if task.support.kind == "wall":
            slabs["wall"] = rigid_transform(Pose2(), below, frame)
        for name, X in slabs.items():
            plant.RegisterCollisionGeometry(
                plant.world_body(), X, DrakeBox(6.0, 6.0, 1.0), name, properties
            )
        for obstacle in task.obstacles:
            plant.RegisterCollisionGeometry(
                plant.world_body(),
                rigid_transform(obstacle.pose, 0.5 * obstacle.size[2], frame),
                DrakeBox(*obstacle.size),
                obstacle.name,
                properties,
            )
        plant.Finalize()
        self._object_shape = shape_id
        robot = self._instance
        joints = [
            plant.GetJointByName(fact.name, robot.model_instance)
            for fact in robot.facts.moving
        ]
        # of q in a Jacobian
        self._columns = np.array([joint.velocity_start() for joint in joints])
        self._tip = set(plant.GetCollisionGeometriesForBody(self._instance.tip_body))
        self._plant = plant
        self._height = 0.5 * task.object.shape.height
        self._frame = frame
        base = [
            plant.GetBodyByName(name, self._instance.model_instance)
            for name in self._instance.base_links
        ]
        self._base_shapes = {
            g for body in base for g in plant.GetCollisionGeometriesForBody(body)
        }
        arm_bodies = [
            plant.get_body(i)
            for i in plant.GetBodyIndices(self._instance.model_instance)
        ]
        manager = scene_graph.collision_filter_manager()

        def shapes(bodies: Sequence[object]) -> GeometrySet:
            out = GeometrySet()
            for body in bodies:
                out.Add(plant.GetCollisionGeometriesForBody(body))
            return out

        world = shapes([plant.world_body()])
        # the base stands on the table, object and table belong together, and an arm may
        # fold
        manager.Apply(CollisionFilterDeclaration().ExcludeBetween(shapes(base), world))
        manager.Apply(
            CollisionFilterDeclaration().ExcludeBetween(GeometrySet(shape_id), world)
        )
        manager.Apply(CollisionFilterDeclaration().ExcludeWithin(shapes(arm_bodies)))
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._plant_context = plant.GetMyMutableContextFromRoot(self._context)
        self._query = plant.get_geometry_query_input_port()
        self._inspector = scene_graph.model_inspector()

    def least(
        self, postures: Array, object_poses: Sequence[Pose2], *, touching: bool
    ) -> tuple[float, str]:
        """Return the least distance [m], at most 0.08, and between what, over postures
        (k, n) and object poses X_WG (k).

        ``touching``: the tip touches the object on purpose, so that these two do not
        count.
        """
        least = LOOK
        pair = "nothing within reach"
        for q, pose in zip(postures, object_poses, strict=True):
            for found in self._pairs(q, pose, touching):
                if found.distance < least:
                    least = found.distance
                    pair = " and ".join(
                        self._inspector.GetName(g).split("::")[-1]
                        for g in (found.id_A, found.id_B)
                    )
        for own, outline, q_still in self._still:
            apart = least_distance(own, outline, postures, q_still, LOOK)
            if apart < least:
                least = apart
                pair = "the arms"
        return float(least), pair

    def smooth_least(
        self, q: Array, object_pose: Pose2, *, touching: bool
    ) -> tuple[float, Array]:
        """Return a smooth lower bound of the least distance [m] of what the joints
        move, and its gradient (n,).
        """
        pairs = [
            pair
            for pair in self._pairs(q, object_pose, touching)
            if not {pair.id_A, pair.id_B} & self._base_shapes
        ]
        if not pairs:
            return LOOK, np.zeros(len(q))
        distances = np.array([pair.distance for pair in pairs])
        least = float(distances.min())
        weights = np.exp((least - distances) / SMOOTHING)
        total = float(weights.sum())
        gradient = np.zeros(len(q))
        for pair, weight in zip(pairs, weights / total, strict=True):
            if weight > 1e-6:
                gradient += weight * self._gradient(pair)
        return least - SMOOTHING * math.log(total), gradient

    def _gradient(self, pair: SignedDistancePair) -> Array:
        """Gradient (n,) of one pair's distance."""
        plant = self._plant
        out = np.zeros(len(self._columns))
        for shape, point, sign in (
            (pair.id_A, pair.p_ACa, 1.0),
            (pair.id_B, pair.p_BCb, -1.0),
        ):
            frame = plant.GetBodyFromFrameId(
                self._inspector.GetFrameId(shape)
            ).body_frame()
            if frame.model_instance() == self._instance.model_instance:
                jacobian = plant.CalcJacobianTranslationalVelocity(
                    self._plant_context,
                    JacobianWrtVariable.kV,
                    frame,
                    self._inspector.GetPoseInFrame(shape) @ point,
                    plant.world_frame(),
                    plant.world_frame(),
                )
                out += sign * (pair.nhat_BA_W @ jacobian)[self._columns]
        return out

    def _pairs(
        self, q: Array, object_pose: Pose2, touching: bool
    ) -> Iterator[SignedDistancePair]:
        """Yield what is near each other in one posture."""
        self._plant.SetPositions(self._plant_context, self._instance.model_instance, q)
        self._plant.SetFreeBodyPose(
            self._plant_context,
            self._object,
            rigid_transform(object_pose, self._height, self._frame),
        )
        query = self._query.Eval(self._plant_context)
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(LOOK):
            between = {pair.id_A, pair.id_B}
            if not (touching and between & self._tip and self._object_shape in between):
                yield pair
