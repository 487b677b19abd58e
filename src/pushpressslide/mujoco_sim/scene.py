"""A task as a MuJoCo model: support, object, obstacles and robots."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

from pushpressslide.control.knocker import FRICTION, MASS, RADIUS, Knocker
from pushpressslide.control.knocker import NAME as BALL
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.ridge import LENGTH, Ridge
from pushpressslide.core.ridge import NAME as RIDGE
from pushpressslide.core.slabs import slabs
from pushpressslide.core.spatial_pose import spatial_axes
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import ObjectModel, Obstacle, Support, Task
from pushpressslide.geometry.inertia import solid_center, solid_moments
from pushpressslide.geometry.shape import Shape
from pushpressslide.mechanics.surface_friction import SurfaceFrictions, pair_friction
from pushpressslide.mujoco_sim.arm_bodies import ArmNames, add_arm, quaternion
from pushpressslide.mujoco_sim.contact import STEPS, Contacts, set_solver, sink
from pushpressslide.mujoco_sim.feet import feet_of
from pushpressslide.mujoco_sim.position_loops import add_position_loops
from pushpressslide.mujoco_sim.shapes import FOOT, UNTOUCHED, add_feet, add_solid

PROUD = 1.5e-3
"""Distance [m] by which the feet stand out from a base, on a support with an opening:
the base itself touches nothing but the sides of the opening.
"""
LONGEST_STEP = 1e-3
"""Longest step [s] of the simulation."""
SHORTEST_STEP = 2e-4
"""Shortest step [s]."""
PRESSED_SINK = 5e-4
"""Depth [m] to which a pressed body may sink, which decides the step."""
FITTED_SINK = 5e-5
"""The same on a support with an opening: feet that leave its edge release their energy,
which throws the body.
"""
ROW = 4.0
"""Stiffness of a foot on a ridge over that on the plane: few feet carry the body there.
Much stiffer ones would throw it.
"""
WALL_REACH = 3.0
"""Size [m] of a wall around its opening."""
WALL_DEPTH = 0.5
"""Thickness [m] of a wall behind its opening."""


@dataclass(frozen=True)
class BodyNames:
    """Names of one free body's elements in a model."""

    body: str
    parts: tuple[str, ...]  # convex geoms
    feet: tuple[str, ...]  # pairs of its feet with the support
    points: Array  # (n, 2) [m] of the feet, in the frame of its shape


@dataclass(frozen=True)
class MujocoScene:
    """A compiled model, with the names of its elements."""

    model: Any
    frame: SupportFrame
    bodies: Mapping[str, BodyNames]  # the object, then movable obstacles, by name
    arms: tuple[ArmNames, ...]

    @cached_property
    def joints(self) -> tuple[Array, ...]:
        """Indices of each arm's joints among the positions."""
        return tuple(
            np.array([self.model.joint(name).qposadr[0] for name in arm.joints])
            for arm in self.arms
        )

    @cached_property
    def freedoms(self) -> tuple[Array, ...]:
        """Indices of each arm's joints among the velocities."""
        return tuple(
            np.array([self.model.joint(name).dofadr[0] for name in arm.joints])
            for arm in self.arms
        )

    @cached_property
    def spheres(self) -> tuple[int, ...]:
        """Number of each tip's geom."""
        return tuple(self.model.geom(arm.sphere).id for arm in self.arms)

    def position(self, body: str) -> int:
        """Index of a free body's first position."""
        return int(self.model.jnt_qposadr[self.model.body(body).jntadr[0]])

    def velocity(self, body: str) -> int:
        """Index of a free body's first velocity."""
        return int(self.model.jnt_dofadr[self.model.body(body).jntadr[0]])


def time_step(plan: Plan) -> float:
    """Step [s] of the simulation: a whole share of the control period, so short that
    the lightest body does not sink far when it is pressed.
    """
    task = plan.task
    period = task.motion.control_period
    presses = any(contact.kind == "top" for contact in plan.contacts)
    press = len(task.robots) * task.limits.normal_force if presses else 0.0
    mass = task.object.mass
    depth = PRESSED_SINK if task.support.opening is None else FITTED_SINK
    time = math.sqrt(depth * mass / (mass * GRAVITY + press))
    step = min(LONGEST_STEP, max(SHORTEST_STEP, time / STEPS))
    return period / math.ceil(period / step - 1e-9)


def build_scene(plan: Plan, step: float, knocker: Knocker | None = None) -> MujocoScene:
    """Model of a plan's task with a time step [s]. Its bodies are at their true
    starts. ``knocker`` disturbs the object.
    """
    builder = _Builder(plan.task, step)
    builder.add_support()
    builder.add_body(
        "object", plan.task.object, plan.true_start, plan.task.support.friction
    )
    for obstacle in plan.task.obstacles:
        builder.add_obstacle(obstacle)
    builder.add_arms()
    builder.pair_bodies()
    if knocker is not None:
        builder.add_ball(knocker)
    model = builder.spec.compile()
    builder.soften_tips(model)
    return MujocoScene(
        model, plan.task.support.frame, builder.bodies, tuple(builder.arms)
    )


@dataclass
class _Builder:
    """A model under construction."""

    task: Task
    step: float  # [s]
    bodies: dict[str, BodyNames] = field(default_factory=dict)
    arms: list[ArmNames] = field(default_factory=list)
    fixed: dict[str, tuple[str, ...]] = field(default_factory=dict)
    surface: dict[str, float] = field(default_factory=dict)  # friction by body
    ground: tuple[str, ...] = ()  # geoms of the support

    def __post_init__(self) -> None:
        self.spec = mujoco.MjSpec()
        gravity = self.task.truth.gravity
        set_solver(self.spec, self.step, gravity)
        self.contacts = Contacts(self.spec, self.step)
        self.frictions = SurfaceFrictions.of_task(self.task)
        self.frame = self.task.support.frame
        down = self.frame.components(gravity)
        self.sink = sink(max(0.0, -down[2]), self.step)

    @property
    def proud(self) -> float:
        """Distance [m] by which feet stand out."""
        return 0.0 if self.task.support.opening is None else PROUD

    def add_support(self) -> None:
        """Add the plane of the support, or the slabs around its opening."""
        support = self.task.support
        world = self.spec.worldbody
        kinds = mujoco.mjtGeom
        if support.opening is None:
            axes = quaternion(_right_handed(self.frame))
            world.add_geom(
                name="support",
                type=kinds.mjGEOM_PLANE,
                size=[0.0, 0.0, 1.0],
                pos=list(self.frame.origin),
                quat=axes,
                **UNTOUCHED,
            )
            self.ground = ("support",)
            ridge = Ridge.of_task(self.task)
            if ridge is not None:
                self._add_ridge(ridge)
            return
        for i, slab in enumerate(_wall(support)):
            x, y, z = slab.center
            world.add_geom(
                name=f"support_{i}",
                type=kinds.mjGEOM_BOX,
                size=[0.5 * v for v in slab.size],
                **_place(Pose2(x, y), z, self.frame),
                **UNTOUCHED,
            )
            self.ground = (*self.ground, f"support_{i}")

    def _add_ridge(self, ridge: Ridge) -> None:
        """Add a ridge as a buried capsule."""
        r = ridge.radius
        ends = [
            value
            for x in (-0.5 * LENGTH, 0.5 * LENGTH)
            for value in self.frame.point(
                (*ridge.pose.apply((x, 0.0)), ridge.height - r)
            )
        ]
        self.spec.worldbody.add_geom(
            name=RIDGE,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            size=[r, 0.0, 0.0],
            fromto=ends,
            **UNTOUCHED,
        )
        self.ground = (*self.ground, RIDGE)

    def add_body(
        self, name: str, body: ObjectModel, pose: Pose2, friction: float
    ) -> None:
        """Add a free body on feet, with its ``friction`` on the support."""
        shape = body.shape
        height = 0.5 * shape.height + self.proud - self.sink
        added = self.spec.worldbody.add_body(
            name=name, **_place(pose, height, self.frame)
        )
        added.add_freejoint()
        up = self.frame.handedness
        added.explicitinertial = True
        added.mass = body.mass
        added.ipos = [*body.center_of_mass, up * solid_center(shape)]
        added.fullinertia = [body.mass * v for v in solid_moments(shape)]
        parts = add_solid(self.spec, added, shape, f"{name}_part")
        feet = self._add_feet(added, name, shape, friction)
        self.bodies[name] = BodyNames(name, parts, *feet)
        self.surface[name] = self.frictions.object
        if self.proud > 0.0:
            self.contacts.touch(parts, self.ground, friction)

    def _add_feet(
        self, body: Any, name: str, shape: Shape, friction: float
    ) -> tuple[tuple[str, ...], Array]:
        """Add the feet of a body. Returns the names of their pairs, and their points."""
        feet = feet_of(shape)
        truth = self.task.truth
        if (truth.bow or truth.feet) and name == "object":
            feet = feet.bowed(shape, truth.bow, truth.feet)
        level = -self.frame.handedness * (0.5 * shape.height + self.proud - FOOT)
        names = add_feet(body, f"{name}_foot", feet.points, level)
        pairs = [
            self.contacts.stand(
                ground, foot, share * ROW if ground == RIDGE else share, friction
            )
            for foot, share in zip(names, feet.shares.tolist(), strict=True)
            for ground in self.ground
        ]
        return tuple(pairs), feet.points

    def add_obstacle(self, obstacle: Obstacle) -> None:
        """Add an obstacle, fixed in the world or as a free body."""
        name = obstacle.name
        shape = obstacle.shape
        if obstacle.movable:
            body = ObjectModel(shape, obstacle.mass, shape.centroid)
            self.add_body(name, body, obstacle.pose, obstacle.friction)
        else:
            place = _place(obstacle.pose, 0.5 * shape.height, self.frame)
            world = self.spec.worldbody
            parts = add_solid(self.spec, world, shape, f"{name}_part", **place)
            self.fixed[name] = parts
        self.surface[name] = self.frictions.obstacle(obstacle.friction)

    def add_arms(self) -> None:
        """Add all robots. Only their tips touch."""
        for index, robot in enumerate(self.task.robots):
            arm = add_arm(self.spec, robot, index, self.task.truth)
            if robot.interface == "position":
                add_position_loops(self.spec, arm.joints)
            self.arms.append(arm)
            lever = margins.PATCH * robot.tip_radius
            sphere = (arm.sphere,)
            tip = self.frictions.tip
            on_support = pair_friction(tip, self.frictions.support)
            self.contacts.touch(sphere, self.ground, on_support)
            solids = {name: body.parts for name, body in self.bodies.items()}
            for name, parts in (solids | self.fixed).items():
                friction = pair_friction(tip, self.surface[name])
                self.contacts.touch(sphere, parts, friction, lever)

    def add_ball(self, knocker: Knocker) -> None:
        """Add the ball that disturbs the object, and touches nothing else."""
        ball = self.spec.worldbody.add_body(name=BALL, pos=list(knocker.start))
        ball.add_freejoint()
        ball.add_geom(
            name=BALL,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[RADIUS, 0.0, 0.0],
            **(UNTOUCHED | {"mass": MASS}),
        )
        friction = pair_friction(self.frictions.object, FRICTION)
        self.contacts.touch([BALL], self.bodies["object"].parts, friction)

    def soften_tips(self, model: Any) -> None:
        """Make the tips as soft as rubber where they touch bodies."""
        spheres = [arm.sphere for arm in self.arms]
        solids = [body.parts for body in self.bodies.values()]
        for parts in (*solids, *self.fixed.values()):
            self.contacts.soften(model, spheres, parts)

    def pair_bodies(self) -> None:
        """Let free bodies touch each other and the fixed obstacles."""
        free = list(self.bodies.items())
        for i, (name, body) in enumerate(free):
            others = {other: later.parts for other, later in free[i + 1 :]}
            for other, parts in (others | self.fixed).items():
                friction = pair_friction(self.surface[name], self.surface[other])
                self.contacts.touch(body.parts, parts, friction)


def _wall(support: Support) -> Sequence[Any]:
    return slabs(support, WALL_REACH, -WALL_REACH, WALL_DEPTH, 0.0)


def _right_handed(frame: SupportFrame) -> Array:
    """Rotation (3, 3) whose z axis is a support's normal."""
    x = np.array(frame.direction((1.0, 0.0, 0.0)))
    z = np.array(frame.normal)
    return np.column_stack([x, np.cross(z, x), z])


def _place(pose: Pose2, height: float, frame: SupportFrame) -> dict[str, Any]:
    """Position [m] and quaternion in the world of a planar pose at a height [m]. The z
    axis points up on a table and into a wall.
    """
    R = np.column_stack(spatial_axes(pose.yaw, frame))
    point = (pose.x, pose.y, height)
    return {"pos": list(frame.point(point)), "quat": quaternion(R)}
