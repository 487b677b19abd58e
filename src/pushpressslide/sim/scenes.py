"""A task as a Drake scene: support, object, obstacles and robots.

The settings of hydroelastic contact (approximation, meshes, modulus) were chosen by
measurement.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometrySet,
    Mesh,
    ProximityProperties,
    SceneGraph,
)
from pydrake.geometry import Shape as DrakeShape
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    MultibodyPlant,
)
from pydrake.multibody.tree import (
    BodyIndex,
    RigidBody,
    SpatialInertia,
    UnitInertia,
    default_model_instance,
)
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.arms.paths.placements import reached_bounds
from pushpressslide.core import task as model
from pushpressslide.core.plan import Plan
from pushpressslide.core.ridge import Ridge
from pushpressslide.core.slabs import slabs
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.geometry.inertia import solid_center, solid_moments
from pushpressslide.geometry.polygon import counter_clockwise
from pushpressslide.mechanics.surface_friction import SurfaceFrictions
from pushpressslide.sim.contact import solve_contacts
from pushpressslide.sim.convert import rigid_transform, slab_pose
from pushpressslide.sim.knock import Disturbances
from pushpressslide.sim.plane import Plane, add_plane, bow_depth
from pushpressslide.sim.robot_models import RobotInstance, add_robot
from pushpressslide.sim.surfaces import (
    HYDROELASTIC_MODULUS,
    Bounds,
    convex_shapes,
    drawn_shape,
    rigid_properties,
    support_grid,
    tip_modulus,
    touched_shapes,
)

# [m] the object starts this deep in the support, so that it is in contact at once
SINK = 2e-6
# [m] of the support around the area planned for the object, with a second value for
# replans
GRID_ROOM = 0.25
ROOM_ANEW = 0.2
TILES_PER_WIDTH = 4.0  # of the support grid under the object's narrow side
# the same under one press, where only a part of the base carries the load
PRESSED_TILES = 6.0
DRAWN_REACH = 0.8  # [m] of a wall that is drawn beside and above its origin
DRAWN_THICKNESS = 0.01  # [m] of it behind its opening's back
TABLE_COLOR = np.array([0.82, 0.80, 0.76, 1.0])
WALL_COLOR = np.array([0.74, 0.78, 0.80, 1.0])
OBJECT_COLOR = np.array([0.85, 0.55, 0.25, 1.0])
OBSTACLE_COLOR = np.array([0.45, 0.50, 0.58, 1.0])


@dataclass(frozen=True)
class DrakeScene:
    """A finalized plant with the handles that a station needs."""

    builder: DiagramBuilder
    plant: MultibodyPlant
    scene_graph: SceneGraph
    object: RigidBody
    bodies: dict[str, RigidBody]  # movable obstacles, by name
    robots: tuple[RobotInstance, ...]
    bounds: Bounds | None  # [m] of the support's surface, where it has any
    disturbances: Disturbances | None = None


def rest_height(body: model.ObjectModel) -> float:
    """Initial height [m] of the shape's centre above the support."""
    return 0.5 * body.shape.height - SINK


def solid_inertia(body: model.ObjectModel) -> SpatialInertia:
    """Inertia of a solid of uniform density about the origin of its frame.

    The frame is that of G in the plane, at half height. The solid is shifted so that
    its centre is the body's CoM, which is at half height unless the body comes from a
    mesh.
    """
    shape = body.shape
    unit = UnitInertia(*solid_moments(shape))
    central = SpatialInertia(body.mass, [0.0, 0.0, 0.0], unit)
    com = body.center_of_mass
    return central.Shift([-com[0], -com[1], -solid_center(shape)])


def grid_bounds(plan: Plan, tile: float) -> Bounds:
    """Bounds of the planned positions of the object, in whole tiles with edges of
    ``tile`` [m].

    They include a margin for errors and a margin for replans.
    """
    x_min, x_max, y_min, y_max = reached_bounds(plan, GRID_ROOM)
    reach = plan.task.object.shape.farthest((0.0, 0.0)) + GRID_ROOM
    movable = [o.pose for o in plan.task.obstacles if o.movable]
    x = [pose.x for pose in movable]
    y = [pose.y for pose in movable]
    more = tile * math.ceil(ROOM_ANEW / tile)
    return (
        min([x_min, *(v - reach for v in x)]) - more,
        max([x_max, *(v + reach for v in x)]) + more,
        min([y_min, *(v - reach for v in y)]) - more,
        max([y_max, *(v + reach for v in y)]) + more,
    )


def tile_size(shape: model.Shape) -> float:
    """Edge length [m] of a support tile."""
    return shape.breadth / TILES_PER_WIDTH


def mesh_size(shape: model.Shape) -> float:
    """Edge length [m] in an object's mesh.

    A cylinder becomes a prism with 26 corners, whose base area is smaller by 1 %.
    """
    if isinstance(shape, model.Cylinder):
        return 0.25 * shape.radius
    return min(0.25 * shape.height, tile_size(shape))


def build_scene(
    plan: Plan,
    *,
    models: str = "generated",
    time_step: float | None = None,
    convex: bool = False,
) -> DrakeScene:
    """Scene of a plan's task.

    ``convex`` selects the solver that always converges.

    The plant is finalized; the builder is not built yet, so that systems can be added.
    """
    task = plan.task
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(
        builder, time_step or task.motion.time_step
    )
    solve_contacts(plant, convex=convex)
    if task.truth.tilt != 0.0:
        plant.mutable_gravity_field().set_gravity_vector(list(task.truth.gravity))
    frictions = SurfaceFrictions.of_task(task)
    modulus = object_modulus(task)
    object_body = add_object(plant, task.object, frictions.object, modulus)
    bodies = _add_obstacles(plant, task, frictions)
    plane = None
    bounds = None
    if task.support.region is None and task.support.opening is None:
        plane = _add_plane(plant, task, frictions, object_body, bodies)
    else:
        bounds = _add_grid(plant, plan, frictions)
    _draw_support(plant, task.support)
    robots = tuple(
        add_robot(
            plant,
            robot,
            index,
            tip_properties=tip_properties(robot, frictions),
            models=models,
            source=task.source or task.name,
            truth=task.truth,
        )
        for index, robot in enumerate(task.robots)
    )
    disturbances = None
    if task.disturbances:
        disturbances = Disturbances(plant, plan, object_body)
    plant.Finalize()
    _let_only_tips_touch(plant, scene_graph, robots)
    if plane is not None:
        plane.let_bases_stand(plant, scene_graph)
    if disturbances is not None:
        disturbances.connect(builder, plant, scene_graph)
    return DrakeScene(
        builder, plant, scene_graph, object_body, bodies, robots, bounds, disturbances
    )


def _add_plane(
    plant: MultibodyPlant,
    task: model.Task,
    frictions: SurfaceFrictions,
    driven_body: RigidBody,
    bodies: Mapping[str, RigidBody],
) -> Plane:
    """Add a support without edges, and the bases of all moving bodies."""
    shape = task.object.shape
    plane = add_plane(plant, task.support.frame, frictions.support)
    *_, down = task.support.frame.components(task.truth.gravity)
    depth = bow_depth(shape, -task.object.mass * down, task.truth.bow)
    plane.stand(plant, driven_body, shape, frictions.object, bow=depth)
    for obstacle in task.obstacles:
        if obstacle.movable:
            friction = frictions.obstacle(obstacle.friction)
            plane.stand(plant, bodies[obstacle.name], obstacle.shape, friction)
    ridge = Ridge.of_task(task)
    if ridge is not None:
        plane.add_ridge(plant, ridge, frictions.support)
    return plane


def _add_grid(plant: MultibodyPlant, plan: Plan, frictions: SurfaceFrictions) -> Bounds:
    """Add a support with edges; return the bounds of its surface."""
    shape = plan.task.object.shape
    pressed = [contact.kind for contact in plan.contacts] == ["top"]
    tile = tile_size(shape) * (TILES_PER_WIDTH / PRESSED_TILES if pressed else 1.0)
    bounds = grid_bounds(plan, tile)
    grid = support_grid(bounds, tile, plan.task.support)
    add_support(plant, grid, frictions.support)
    return bounds


def object_modulus(task: model.Task) -> float:
    """Modulus [Pa] of a task's object, stiff enough for its tips."""
    smallest = min((robot.tip_radius for robot in task.robots), default=math.inf)
    return tip_modulus(task.object.shape, smallest, task.limits.normal_force)


def add_object(
    plant: MultibodyPlant,
    body: model.ObjectModel,
    friction: float,
    modulus: float = HYDROELASTIC_MODULUS,
) -> RigidBody:
    """Add the object as a compliant body of a ``modulus`` [Pa]."""
    shape = body.shape
    added = plant.AddRigidBody("object", default_model_instance(), solid_inertia(body))
    X = RigidTransform()
    touched = touched_shapes(shape, friction, mesh_size(shape), modulus)
    for i, (piece, properties) in enumerate(touched):
        name = f"object_{i}" if i else "object"
        plant.RegisterCollisionGeometry(added, X, piece, name, properties)
    drawn = drawn_shape(shape)
    plant.RegisterVisualGeometry(added, X, drawn, "object_visual", OBJECT_COLOR)
    return added


def add_support(plant: MultibodyPlant, grid: Mesh, friction: float) -> None:
    """Add the support's surface to the world as a rigid mesh."""
    plant.RegisterCollisionGeometry(
        plant.world_body(),
        RigidTransform(),
        grid,
        "support",
        rigid_properties(friction),
    )


def tip_properties(
    robot: model.Robot, frictions: SurfaceFrictions
) -> ProximityProperties:
    """Contact properties of a robot's tip."""
    return rigid_properties(frictions.tip, 0.3 * robot.tip_radius)


def _add_obstacles(
    plant: MultibodyPlant, task: model.Task, frictions: SurfaceFrictions
) -> dict[str, RigidBody]:
    """Add all obstacles; return the bodies of the movable ones by name."""
    bodies = {}
    for obstacle in task.obstacles:
        friction = frictions.obstacle(obstacle.friction)
        body = _add_obstacle(plant, obstacle, task.support.frame, friction)
        if obstacle.movable:
            bodies[obstacle.name] = body
    return bodies


def _add_obstacle(
    plant: MultibodyPlant,
    obstacle: model.Obstacle,
    frame: SupportFrame,
    friction: float,
) -> RigidBody:
    """Add an obstacle, either fixed to the world and rigid, or as a separate compliant
    body. Return the body it belongs to.
    """
    shape = obstacle.shape
    X = rigid_transform(obstacle.pose, 0.5 * shape.height - SINK, frame)
    name = obstacle.name
    smallest = min(shape.height, shape.breadth)
    if obstacle.movable:
        solid = model.ObjectModel(shape, obstacle.mass, shape.centroid)
        instance = plant.AddModelInstance(f"obstacle_{name}")
        body = plant.AddRigidBody(name, instance, solid_inertia(solid))
        plant.SetDefaultFloatingBaseBodyPose(body, X)
        X = RigidTransform()
        touched = touched_shapes(shape, friction, 0.25 * smallest)
    else:
        body = plant.world_body()
        # Drake takes a mesh that tips touch in points as its hull
        properties = rigid_properties(friction, 0.5 * smallest)
        touched = [(piece, properties) for piece in convex_shapes(shape)]
    for i, (piece, properties) in enumerate(touched):
        own = f"{name}_{i}" if i else name
        plant.RegisterCollisionGeometry(body, X, piece, own, properties)
    drawn = drawn_shape(shape)
    plant.RegisterVisualGeometry(body, X, drawn, f"{name}_visual", OBSTACLE_COLOR)
    return body


def _draw_support(plant: MultibodyPlant, support: model.Support) -> None:
    """Draw the table or floor. Any other support plane is drawn from the floor up,
    around its opening.
    """
    table = RigidTransform([0.45, 0.0, -0.0101])
    top: DrakeShape = DrakeBox(1.7, 1.8, 0.02)
    if support.region is not None:
        table = RigidTransform([0.0, 0.0, -0.0101])
        top = drawn_shape(model.Prism(counter_clockwise(support.region), 0.02))
    plant.RegisterVisualGeometry(plant.world_body(), table, top, "table", TABLE_COLOR)
    frame = support.frame
    if frame == TABLE:
        return
    floor = -frame.origin[2]
    drawn = slabs(support, DRAWN_REACH, floor, DRAWN_THICKNESS, -SINK)
    for i, slab in enumerate(drawn):
        plant.RegisterVisualGeometry(
            plant.world_body(),
            slab_pose(slab, frame),
            DrakeBox(*slab.size),
            f"wall_{i}",
            WALL_COLOR,
        )


def _let_only_tips_touch(
    plant: MultibodyPlant, scene_graph: SceneGraph, robots: tuple[RobotInstance, ...]
) -> None:
    """Exclude the links of robots from contact.

    The links of generated models have no contact shapes, but those of a model from a
    file may. Joint paths keep the links clear, and shapes without hydroelastic
    properties would end the run.
    """
    links = GeometrySet()
    everything = GeometrySet()
    tips = {robot.tip_geometry for robot in robots}
    instances = {robot.model_instance for robot in robots}
    for index in range(plant.num_bodies()):
        body = plant.get_body(BodyIndex(index))
        for geometry in plant.GetCollisionGeometriesForBody(body):
            everything.Add(geometry)
            if body.model_instance() in instances and geometry not in tips:
                links.Add(geometry)
    scene_graph.collision_filter_manager().Apply(
        CollisionFilterDeclaration()
        .ExcludeBetween(links, everything)
        .ExcludeWithin(links)
    )
