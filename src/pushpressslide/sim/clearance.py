"""Smallest distance of an arm to support, object and obstacles: signed distances in a
plant used only for planning.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    ProximityProperties,
    SceneGraph,
    SignedDistancePair,
)
from pydrake.geometry import Shape as DrakeShape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import (
    JacobianWrtVariable,
    RigidBody,
    SpatialInertia,
    default_model_instance,
)
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.arms.paths.capsules import least_distance
from pushpressslide.arms.paths.clearance import CLEARANCE, LOOK, NOTHING, Gap
from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.slabs import slabs
from pushpressslide.core.support_frame import TABLE
from pushpressslide.core.task import Shape, Task
from pushpressslide.sim.convert import rigid_transform, slab_pose
from pushpressslide.sim.outline import arm_capsules
from pushpressslide.sim.robot_models import add_robot
from pushpressslide.sim.surfaces import convex_shapes

# of what a tip's sphere leaves between the rod that holds it and what it touches, less
# than which the rod may not keep: the rest is for a tool that leans
ROD_ROOM = 0.7
TOUCHING = 12  # number of points around the sphere that are checked
PIECE = "#"  # before the number of a shape that is one of several of a body
SMOOTHING = 5e-4  # [m] of the smooth minimum over pairs
# [m] slightly below the surface, so that a base bolted to the table does not touch it
SURFACE_LEVEL = -0.001
SLAB = 6.0  # [m] edge of a plane's slab
SLAB_DEPTH = 1.0  # [m]


class DrakeClearance:
    """Distances between one arm, represented by capsules, and the object, the support,
    the obstacles, and arms at rest.
    """

    def __init__(
        self, plan: Plan, arm: int, others: Mapping[int, Array] | None = None
    ) -> None:
        """Build the planning plant.

        ``others`` are postures (n,) of resting arms.
        """
        task = plan.task
        robots = task.robots
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        self._plant = plant
        self._robot = add_robot(plant, robots[arm], arm, collision=True)
        self._still = [
            (arm_capsules(robots[arm], arm), arm_capsules(robots[i], i), q[None])
            for i, q in (others or {}).items()
        ]
        self._add_object(task.object.shape)
        self._frame = task.support.frame
        _add_surroundings(plant, task)
        self._bodies = _add_movable(plant, task)
        self._heights = {o.name: 0.5 * o.shape.height for o in task.obstacles}  # [m]
        plant.Finalize()
        joints = self._robot.joints(plant)
        # of q in a Jacobian
        self._columns = np.array([joint.velocity_start() for joint in joints])
        sphere = self._robot.tip_geometry
        # the shapes that touch in a run; the rod that holds them may not
        self.sphere = {sphere}
        tip = self._robot.tip_body
        self._own = set(plant.GetCollisionGeometriesForBody(tip))
        if sphere is None:
            self.sphere = self._own
        # the shapes whose distance from the object is that of the contact: of the tip's
        # body, and of a whole tool that presses
        presses = any(c.arm == arm and c.kind == "top" for c in plan.contacts)
        held = plant.GetBodiesWeldedTo(tip) if presses else [tip]
        self._with_contact = set(_shapes(plant, held))
        instance = self._robot.model_instance
        base = [plant.GetBodyByName(name, instance) for name in self._robot.base_links]
        self._base_shapes = set(_shapes(plant, base))
        self._filter(scene_graph, base)
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._plant_context = plant.GetMyMutableContextFromRoot(self._context)
        self._query = plant.get_geometry_query_input_port()
        self._inspector = scene_graph.model_inspector()
        self._allowed = self._allowed_at_contact(robots[arm].tip_radius)

    def _add_object(self, shape: Shape) -> None:
        """Add the object as a free body."""
        plant = self._plant
        # any mass: the plant is not simulated
        inertia = SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1)
        self._object = plant.AddRigidBody("object", default_model_instance(), inertia)
        self._height = 0.5 * shape.height
        self._object_shapes = [
            plant.RegisterCollisionGeometry(
                self._object,
                RigidTransform(),
                piece,
                f"object_{i}",
                ProximityProperties(),
            )
            for i, piece in enumerate(convex_shapes(shape))
        ]

    def _filter(self, graph: SceneGraph, base: Sequence[RigidBody]) -> None:
        """Exclude pairs that may touch: the base and the table, the object and the
        table, and the links of the arm with each other.
        """
        plant = self._plant
        indices = plant.GetBodyIndices(self._robot.model_instance)
        arm = GeometrySet(_shapes(plant, [plant.get_body(i) for i in indices]))
        world = GeometrySet(_shapes(plant, [plant.world_body()]))
        movable = _shapes(plant, self._bodies.values())
        graph.collision_filter_manager().Apply(
            CollisionFilterDeclaration()
            .ExcludeBetween(GeometrySet(_shapes(plant, base)), world)
            .ExcludeBetween(GeometrySet([*self._object_shapes, *movable]), world)
            .ExcludeWithin(GeometrySet([*self._object_shapes, *movable]))
            .ExcludeWithin(arm)
        )

    def _allowed_at_contact(self, radius: float) -> dict[GeometryId, float]:
        """Allowed distances [m] from the touched body for the rod's shapes near the
        contact.

        The contact is on the half of the tip's sphere, of ``radius`` [m], that faces
        away from the rod. The allowed distance of a shape is the fraction ``ROD_ROOM``
        of its smallest distance from this half.
        """
        tip = self._robot.tip_body
        holding = set(_shapes(self._plant, self._plant.GetBodiesWeldedTo(tip)))
        holding -= self.sphere
        query = self._query.Eval(self._plant_context)
        X_WT = self._robot.tip_frame.CalcPoseInWorld(self._plant_context)
        left: dict[GeometryId, float] = {}
        for direction in _half_of_sphere():
            place = X_WT @ (radius * direction)
            for near in query.ComputeSignedDistanceToPoint(place, CLEARANCE / ROD_ROOM):
                if near.id_G in holding:
                    least = min(near.distance, left.get(near.id_G, math.inf))
                    left[near.id_G] = least
        allowed = {shape: ROD_ROOM * least for shape, least in left.items()}
        return {shape: a for shape, a in allowed.items() if 0.0 < a < CLEARANCE}

    def min_distance(
        self,
        postures: Array,
        object_poses: Sequence[Pose2],
        *,
        touching: bool,
        bodies: Mapping[str, Sequence[Pose2]] | None = None,
    ) -> Gap:
        """Gap with the smallest margin over postures (k, n) and object poses X_WG (k),
        searched up to 0.08 m.

        With ``touching``, the tip's sphere touches the object on purpose, so this pair
        is excluded. ``bodies`` are poses (k each) of movable obstacles by name, by
        default those of the task.
        """
        transforms = [
            rigid_transform(pose, self._height, self._frame) for pose in object_poses
        ]
        shapes = self.sphere if touching else set()
        moved = {
            name: [rigid_transform(X, self._heights[name], self._frame) for X in poses]
            for name, poses in (bodies or {}).items()
        }
        gaps = [self._nearest(postures, transforms, shapes, moved, _lack)]
        for own, outline, q_still in self._still:
            distances = least_distance(own, outline, postures, q_still, LOOK)
            gaps.append(Gap(float(distances), "the arms"))
        tightest = max(gaps, key=_lack)
        return replace(tightest, to_object=gaps[0].to_object)

    def least_in_space(
        self,
        postures: Array,
        object_poses: Sequence[RigidTransform],
        touching: Collection[GeometryId],
        bodies: Mapping[str, Sequence[RigidTransform]] | None = None,
    ) -> tuple[float, str]:
        """Smallest distance [m], at most 0.08, over postures (k, n) and spatial poses
        of the object (k), and the names of the nearest pair.

        Other arms are excluded. The arm's ``touching`` shapes may touch the object.
        ``bodies`` are poses (k each) of movable obstacles by name, by default those of
        the task.
        """
        nearest = self._nearest(
            postures, object_poses, touching, bodies or {}, lambda gap: -gap.distance
        )
        return nearest.distance, nearest.pair

    def _nearest(
        self,
        postures: Array,
        object_poses: Sequence[RigidTransform],
        touching: Collection[GeometryId],
        bodies: Mapping[str, Sequence[RigidTransform]],
        order: Callable[[Gap], float],
    ) -> Gap:
        """Gap with the largest value of ``order`` over all postures and poses of
        ``least_in_space``.
        """
        out = NOTHING
        to_object = LOOK
        before = {name: self._pose(name) for name in bodies}
        for i, (q, X) in enumerate(zip(postures, object_poses, strict=True)):
            for name, poses in bodies.items():
                self._put(name, poses[i])
            for near in self._pairs(q, X, touching):
                if self._link_and_object(near, touching):
                    to_object = min(to_object, near.distance)
                gap = Gap(near.distance, "", self._allowance(near, touching))
                if order(gap) > order(out):
                    pair = " and ".join(map(self._name, (near.id_A, near.id_B)))
                    out = replace(gap, pair=pair)
        for name, pose in before.items():
            self._put(name, pose)
        return replace(out, to_object=to_object)

    def _link_and_object(
        self, near: SignedDistancePair, touching: Collection[GeometryId]
    ) -> bool:
        """Whether a pair is the object and a link whose distance from it may change.

        That of the tip is planned. While shapes are ``touching``, so is that of all
        that moves with the contact.
        """
        between = {near.id_A, near.id_B}
        planned = self._with_contact if touching else self._own
        return between.isdisjoint(planned) and not between.isdisjoint(
            self._object_shapes
        )

    def _allowance(
        self, near: SignedDistancePair, touching: Collection[GeometryId]
    ) -> float:
        """Smallest allowed distance [m] between two shapes. The ``touching`` shapes may
        touch the object.
        """
        between = {near.id_A, near.id_B}
        if not touching or between.isdisjoint(self._object_shapes):
            return CLEARANCE
        return min(self._allowed.get(shape, CLEARANCE) for shape in between)

    def _name(self, shape: GeometryId) -> str:
        """Name of the body to which a shape belongs."""
        if shape in self._object_shapes:
            return "object"
        name = str(self._inspector.GetName(shape)).split("::")[-1]
        return name.split(PIECE)[0]

    def _pose(self, name: str) -> RigidTransform:
        """Current pose of a movable obstacle."""
        return self._plant.GetFreeBodyPose(self._plant_context, self._bodies[name])

    def _put(self, name: str, pose: RigidTransform) -> None:
        """Set the pose of a movable obstacle."""
        self._plant.SetFreeBodyPose(self._plant_context, self._bodies[name], pose)

    def smooth_least(
        self, q: Array, object_pose: Pose2, *, touching: bool
    ) -> tuple[float, Array]:
        """A smooth lower bound of the smallest distance [m] of the moving links, and
        its gradient (n,).

        If a pair may be nearer than ``CLEARANCE``, its distance is increased by the
        difference.
        """
        X_WO = rigid_transform(object_pose, self._height, self._frame)
        shapes = self.sphere if touching else set()
        pairs = [
            pair
            for pair in self._pairs(q, X_WO, shapes)
            if not {pair.id_A, pair.id_B} & self._base_shapes
        ]
        if not pairs:
            return LOOK, np.zeros(len(q))
        spare = [CLEARANCE - self._allowance(pair, shapes) for pair in pairs]
        distances = np.array([pair.distance for pair in pairs]) + spare
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
            if frame.model_instance() == self._robot.model_instance:
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
        self, q: Array, X_WO: RigidTransform, touching: Collection[GeometryId]
    ) -> Iterator[SignedDistancePair]:
        """Yield the pairs nearer than LOOK in one posture, with the object at ``X_WO``."""
        self._plant.SetPositions(self._plant_context, self._robot.model_instance, q)
        self._plant.SetFreeBodyPose(self._plant_context, self._object, X_WO)
        query = self._query.Eval(self._plant_context)
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(LOOK):
            between = {pair.id_A, pair.id_B}
            of_object = not between.isdisjoint(self._object_shapes)
            if of_object and not between.isdisjoint(touching):
                continue
            yield pair


def _lack(gap: Gap) -> float:
    return gap.lack


def _half_of_sphere() -> Iterator[Array]:
    """Yield unit vectors (3,), in T, over the half of a tip's sphere that faces away
    from the rod, around the z axis.
    """
    for turn in np.linspace(0.0, 2.0 * math.pi, TOUCHING, endpoint=False):
        for up in (0.0, 0.5, 1.0):
            across = math.sqrt(1.0 - up * up)
            yield np.array([across * math.cos(turn), across * math.sin(turn), up])


def _add_surroundings(plant: MultibodyPlant, task: Task) -> None:
    """Add the floor or table at height zero of the world, the support if it is another
    plane, and the fixed obstacles.
    """
    frame = task.support.frame
    below = SURFACE_LEVEL - 0.5 * SLAB_DEPTH
    table = DrakeBox(SLAB, SLAB, SLAB_DEPTH)
    shapes = [("table", table, RigidTransform([0.0, 0.0, below]))]
    if frame != TABLE:
        half = 0.5 * SLAB
        behind = slabs(task.support, half, -half, SLAB_DEPTH, SURFACE_LEVEL)
        for i, slab in enumerate(behind):
            name = f"{task.support.kind}_{i}"
            shapes.append((name, DrakeBox(*slab.size), slab_pose(slab, frame)))
    for obstacle in task.obstacles:
        if not obstacle.movable:
            X = rigid_transform(obstacle.pose, 0.5 * obstacle.shape.height, frame)
            pieces = convex_shapes(obstacle.shape)
            shapes += [(obstacle.name, piece, X) for piece in pieces]
    _add_shapes(plant, plant.world_body(), shapes)


def _add_movable(plant: MultibodyPlant, task: Task) -> dict[str, RigidBody]:
    """Add the movable obstacles, by name, as free bodies at the task's poses."""
    # any mass: the plant is not simulated
    inertia = SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1)
    bodies = {}
    for obstacle in task.obstacles:
        if not obstacle.movable:
            continue
        instance = plant.AddModelInstance(f"obstacle_{obstacle.name}")
        body = plant.AddRigidBody(obstacle.name, instance, inertia)
        half = 0.5 * obstacle.shape.height
        X = rigid_transform(obstacle.pose, half, task.support.frame)
        plant.SetDefaultFloatingBaseBodyPose(body, X)
        pieces = convex_shapes(obstacle.shape)
        own = RigidTransform()
        _add_shapes(plant, body, [(obstacle.name, piece, own) for piece in pieces])
        bodies[obstacle.name] = body
    return bodies


def _add_shapes(
    plant: MultibodyPlant,
    body: RigidBody,
    shapes: Sequence[tuple[str, DrakeShape, RigidTransform]],
) -> None:
    """Add shapes at poses in ``body`` by their names, which need not be unique."""
    for i, (name, shape, X) in enumerate(shapes):
        own = f"{name}{PIECE}{i}"
        plant.RegisterCollisionGeometry(body, X, shape, own, ProximityProperties())


def _shapes(plant: MultibodyPlant, bodies: Iterable[RigidBody]) -> list[GeometryId]:
    """Collision shapes of bodies."""
    return [g for body in bodies for g in plant.GetCollisionGeometriesForBody(body)]
