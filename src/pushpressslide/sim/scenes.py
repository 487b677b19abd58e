"""A task as a Drake scene: support, object, obstacles and robots, with the measured
remedies for hydroelastic contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    DiscreteContactApproximation,
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

from pushpressslide.core import task as model
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.sim.convert import rigid_transform
from pushpressslide.sim.robot_models import RobotInstance, add_robot
from pushpressslide.sim.surfaces import (
    OBJECT_FRICTION,
    compliant_properties,
    object_shape,
    partner_friction,
    rigid_properties,
    support_grid,
)

# friction of a pair over that of the smoother surface; 2 is the limit of all
ROUGHEST = 1.99
# [m] that the object starts inside the support, so that contact is there at once
SINK = 2e-6
TILES_PER_WIDTH = 4.0  # of the support grid under the object's narrow side
# the same under one press, which the object stands on a part of its base for
PRESSED_TILES = 6.0
WALL_REACH = 0.8  # [m] of a wall that is drawn beside and above its origin
TABLE_COLOR = np.array([0.82, 0.80, 0.76, 1.0])
WALL_COLOR = np.array([0.74, 0.78, 0.80, 1.0])
OBJECT_COLOR = np.array([0.85, 0.55, 0.25, 1.0])
OBSTACLE_COLOR = np.array([0.45, 0.50, 0.58, 1.0])


@dataclass(frozen=True)
class Scene:
    """A plant that is finalized, with the handles that a station needs."""

    builder: DiagramBuilder
    plant: MultibodyPlant
    scene_graph: SceneGraph
    object: RigidBody
    bodies: dict[str, RigidBody]  # movable obstacles, by name
    robots: tuple[RobotInstance, ...]


def rest_height(body: model.ObjectModel) -> float:
    """Height of the shape's centre above the support at the start [m]."""
    return 0.5 * body.shape.height - SINK


def solid_inertia(body: model.ObjectModel) -> SpatialInertia:
    """Return the inertia of a solid of uniform density about its frame (G in the plane,
    half height), its CoM moved as asked.
    """
    shape = body.shape
    mass = body.mass
    if isinstance(shape, model.Box):
        unit = UnitInertia.SolidBox(*shape.size)
    elif isinstance(shape, model.Cylinder):
        unit = UnitInertia.SolidCylinder(shape.radius, shape.height, [0.0, 0.0, 1.0])
    else:
        corners = np.array(shape.polygon) - np.mean(np.array(shape.polygon), axis=0)
        following = np.roll(corners, -1, axis=0)
        areas = 0.5 * (
            corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
        )
        a = corners
        b = following
        aa = a[:, :, None] * a[:, None, :]
        bb = b[:, :, None] * b[:, None, :]
        ab = a[:, :, None] * b[:, None, :]
        ba = b[:, :, None] * a[:, None, :]
        second = np.einsum("k,kij->ij", areas / 12.0, 2.0 * (aa + bb) + ab + ba)
        centroid = np.einsum("k,ki->i", areas / 3.0, a + b) / areas.sum()
        second = second / areas.sum() - np.outer(centroid, centroid)
        h2 = shape.height**2 / 12.0
        unit = UnitInertia(
            second[1, 1] + h2,
            second[0, 0] + h2,
            second[0, 0] + second[1, 1],
            -second[0, 1],
            0.0,
            0.0,
        )
    central = SpatialInertia(mass, [0.0, 0.0, 0.0], unit)
    com = body.center_of_mass
    return central.Shift([-com[0], -com[1], 0.0])


def grid_bounds(plan: Plan) -> tuple[float, float, float, float]:
    """Return x_min, x_max, y_min, y_max [m] of where the planned object goes, with room
    for errors; anchored to a lattice.
    """
    shape = plan.task.object.shape
    if isinstance(shape, model.Cylinder):
        reach = shape.radius
    else:
        reach = max(math.hypot(x, y) for x, y in shape.footprint)
    poses = [plan.task.true_start]
    for stretch in plan.segments:
        poses += [
            plan.object_pose(stretch, s)
            for s in np.linspace(0.0, stretch.path.length, 60)
        ]
    margin = reach + 0.25
    for obstacle in plan.task.obstacles:
        if obstacle.movable:
            poses.append(obstacle.pose)
    x = [p.x for p in poses]
    y = [p.y for p in poses]
    return min(x) - margin, max(x) + margin, min(y) - margin, max(y) + margin


def tile_size(shape: model.Shape) -> float:
    """Return the edge of a support tile [m]."""
    if isinstance(shape, model.Cylinder):
        width = 2.0 * shape.radius
    else:
        xs, ys = zip(*shape.footprint, strict=True)
        width = min(max(xs) - min(xs), max(ys) - min(ys))
    return width / TILES_PER_WIDTH


def mesh_size(shape: model.Shape) -> float:
    """Return the edge of an object's mesh [m]; a cylinder becomes a prism with 26
    corners, which has 1 % less base.
    """
    if isinstance(shape, model.Cylinder):
        return 0.25 * shape.radius
    return min(0.25 * shape.height, tile_size(shape))


def object_friction(task: model.Task) -> float:
    """Return the friction of the object's own surface, from which those of all its
    partners follow.

    The usual one, unless a movable obstacle is to have more friction on the support
    than the support's surface could then give. Then between the least that lets the
    tips have their pair with the object and the most that leaves the support rough
    enough.
    """
    pairs = [o.friction for o in task.obstacles if o.movable]
    support = task.support.friction
    if not pairs or max(pairs) <= max(support, ROUGHEST * partner_friction(support)):
        return OBJECT_FRICTION
    least = 0.51 * max(task.contact_friction, support)
    rough = 0.5 * max(pairs)
    return math.sqrt(least * max(least, support * rough / (2.0 * rough - support)))


def obstacle_friction(support: float, pair: float) -> float:
    """Return the surface friction of an obstacle whose pair with the support is to be
    ``pair``.

    ``support`` is the friction of the support's own surface. Where no obstacle is rough
    enough, since the pairs of tip, object, support and obstacle cannot all be had, the
    roughest that is sensible is taken.
    """
    return (
        partner_friction(pair, support)
        if pair < ROUGHEST * support
        else 200.0 * support
    )


def build_scene(
    plan: Plan, *, models: str = "generated", time_step: float | None = None
) -> Scene:
    """Return the scene of a plan's task: the plant is finalized, the builder not yet
    built.
    """
    task = plan.task
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(
        builder, time_step or task.motion.time_step
    )
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kLagged)
    # rigid tips and rigid obstacles touch in points, all else hydroelastically
    plant.set_contact_model(ContactModel.kHydroelasticWithFallback)
    body = task.object
    own = object_friction(task)
    ground = partner_friction(task.support.friction, own)
    thing = plant.AddRigidBody("object", default_model_instance(), solid_inertia(body))
    shape = object_shape(body.shape)
    plant.RegisterCollisionGeometry(
        thing,
        RigidTransform(),
        shape,
        "object",
        compliant_properties(own, mesh_size(body.shape)),
    )
    plant.RegisterVisualGeometry(
        thing, RigidTransform(), shape, "object_visual", OBJECT_COLOR
    )
    pressed = [contact.kind for contact in plan.contacts] == ["top"]
    tile = tile_size(body.shape) * (TILES_PER_WIDTH / PRESSED_TILES if pressed else 1.0)
    grid = support_grid(grid_bounds(plan), tile, task.support)
    plant.RegisterCollisionGeometry(
        plant.world_body(),
        RigidTransform(),
        grid,
        "support",
        rigid_properties(ground),
    )
    _draw_support(plant, task.support)
    bodies: dict[str, RigidBody] = {}
    for obstacle in task.obstacles:
        X = rigid_transform(
            obstacle.pose, 0.5 * obstacle.size[2] - SINK, task.support.frame
        )
        box = DrakeBox(*obstacle.size)
        friction = obstacle_friction(ground, obstacle.friction)
        if obstacle.movable:
            instance = plant.AddModelInstance(f"obstacle_{obstacle.name}")
            part = plant.AddRigidBody(
                obstacle.name,
                instance,
                SpatialInertia.SolidBoxWithMass(obstacle.mass, *obstacle.size),
            )
            bodies[obstacle.name] = part
            plant.SetDefaultFloatingBaseBodyPose(part, X)
            plant.RegisterCollisionGeometry(
                part,
                RigidTransform(),
                box,
                obstacle.name,
                compliant_properties(friction, 0.25 * min(obstacle.size)),
            )
            plant.RegisterVisualGeometry(
                part, RigidTransform(), box, obstacle.name + "_visual", OBSTACLE_COLOR
            )
        else:
            plant.RegisterCollisionGeometry(
                plant.world_body(),
                X,
                box,
                obstacle.name,
                rigid_properties(friction, 0.5 * min(obstacle.size)),
            )
            plant.RegisterVisualGeometry(
                plant.world_body(), X, box, obstacle.name + "_visual", OBSTACLE_COLOR
            )
    tip = partner_friction(task.contact_friction, own)
    robots = tuple(
        add_robot(
            plant,
            robot,
            index,
            tip_properties=rigid_properties(tip, 0.3 * robot.tip_radius),
            models=models,
        )
        for index, robot in enumerate(task.robots)
    )
    plant.Finalize()
    _let_only_tips_touch(plant, scene_graph, robots)
    return Scene(builder, plant, scene_graph, thing, bodies, robots)


def _draw_support(plant: MultibodyPlant, support: model.Support) -> None:
    """Draw the table, or the floor, and a wall round its opening."""
    table = RigidTransform([0.45, 0.0, -0.0101])
    plant.RegisterVisualGeometry(
        plant.world_body(), table, DrakeBox(1.7, 1.8, 0.02), "table", TABLE_COLOR
    )
    if support.kind == "table":
        return
    opening = support.opening or model.Opening((0.0, 0.0), (0.0, 0.0), 0.0)
    w, h = opening.size
    cx, cy = opening.center
    depth = opening.depth
    low = cy - 0.5 * h
    high = cy + 0.5 * h
    left = cx - 0.5 * w
    right = cx + 0.5 * w
    reach = WALL_REACH
    floor = -support.frame.origin[2]
    back = -depth - 0.01
    slabs = (  # from, to in x, y and height
        ((-reach, left), (floor, reach), (back, -SINK)),
        ((right, reach), (floor, reach), (back, -SINK)),
        ((left, right), (floor, low), (back, -SINK)),
        ((left, right), (high, reach), (back, -SINK)),
        ((left, right), (low, high), (back, -depth - SINK)),
    )
    for i, spans in enumerate(slabs):
        x, y, z = (0.5 * (a + b) for a, b in spans)
        size = [b - a for a, b in spans]
        if min(size) > 0.0:
            X = rigid_transform(Pose2(x, y), z, support.frame)
            plant.RegisterVisualGeometry(
                plant.world_body(),
                X,
                DrakeBox(size[0], size[1], size[2]),
                f"wall_{i}",
                WALL_COLOR,
            )


def _let_only_tips_touch(
    plant: MultibodyPlant, scene_graph: SceneGraph, robots: tuple[RobotInstance, ...]
) -> None:
    """Take the links of a model given by path out of contact, where the generated
    models have no shapes.

    Their clearance is the joint path's business; shapes without hydroelastic properties
    would end the run.
    """
    links = GeometrySet()
    everything = GeometrySet()
    tips = {robot.tip_geometry for robot in robots}
    own = {robot.model_instance for robot in robots}
    for index in range(plant.num_bodies()):
        body = plant.get_body(BodyIndex(index))
        for geometry in plant.GetCollisionGeometriesForBody(body):
            everything.Add(geometry)
            if body.model_instance() in own and geometry not in tips:
                links.Add(geometry)
    manager = scene_graph.collision_filter_manager()
    manager.Apply(
        CollisionFilterDeclaration()
        .ExcludeBetween(links, everything)
        .ExcludeWithin(links)
    )
