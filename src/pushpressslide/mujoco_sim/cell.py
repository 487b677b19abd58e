"""MuJoCo's simulation as a cell: arms, and the quantities that only a simulator knows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import mujoco
import numpy as np

from pushpressslide.arms.arm_cell import arm_cell, lost_object
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.joint_arms import joint_arms
from pushpressslide.arms.paths.joint_path import ArmPath
from pushpressslide.arms.paths.library import ArmLibrary
from pushpressslide.arms.placements import ArmPlacements
from pushpressslide.control.cell import Cell, TrueState
from pushpressslide.control.disturbance import Pushes
from pushpressslide.control.knocker import NAME as BALL
from pushpressslide.control.knocker import Knocker
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.spatial_pose import tilt_of
from pushpressslide.core.state import WorldState
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import Task
from pushpressslide.core.true_task import true_plan
from pushpressslide.core.truth import refuse_truth
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.mechanics.ground import Ground, is_uneven
from pushpressslide.mujoco_sim.arm_model import MujocoArmModel
from pushpressslide.mujoco_sim.free_body import planar_pose, planar_twist
from pushpressslide.mujoco_sim.position_loops import PositionLoops
from pushpressslide.mujoco_sim.scene import MujocoScene, build_scene, time_step
from pushpressslide.mujoco_sim.uneven_ground import UnevenGround

NEVER = -1.0
"""Margin [m] of a pair that makes no contact."""


def mujoco_cell(
    plan: Plan,
    library: ArmLibrary,
    paths: Sequence[tuple[ArmPath, ...]],
    options: RunOptions | None = None,
    *,
    step: float | None = None,
    knocker: Knocker | None = None,
) -> Cell:
    """Cell with the arms at the start of the first of ``paths``, or with arms and
    bodies in the state in which a run with these ``options`` begins.

    There is one set of joint paths for each placement; ``library`` plans those of
    recoveries. ``step`` [s] is the physics step. ``knocker`` disturbs the object.
    Raises TaskError for a ``truth`` that MuJoCo does not have.
    """
    options = options or RunOptions()
    _refuse_grain(plan.task)
    seed = options.true_world_seed
    true = true_plan(plan, seed)
    scene = build_scene(true, step or time_step(true), knocker)
    physics = MujocoPhysics(plan, scene, knocker, seed)
    drives = [MujocoDrives(physics, i) for i in range(len(scene.arms))]
    arms = joint_arms(plan, MujocoArmModel, drives, options)
    placements = ArmPlacements(library, arms, paths)
    return arm_cell("mujoco", physics, arms, placements, paths, plan, options.begin)


def _refuse_grain(task: Task) -> None:
    """Raise TaskError for a support with a grain: pairs of geoms have none."""
    truth = task.truth
    plain = replace(truth, friction_direction=0.0)
    refuse_truth(truth, plain, task.source or task.name, "with engine mujoco")


class _Instant(NamedTuple):
    """True poses and velocities at one time."""

    q: Array  # (nq,) positions
    X_WG: Pose2
    twist: Vector3  # [m/s], [m/s], [rad/s] of the object in the support's frame


class MujocoPhysics:
    """A scene as clock, tracker and source of the true state."""

    simulated = True

    def __init__(
        self,
        plan: Plan,
        scene: MujocoScene,
        knocker: Knocker | None = None,
        seed: int = 0,
    ) -> None:
        """Put the bodies of a scene at the start of a run. ``seed`` draws the patches
        of the support.
        """
        self._knocker = knocker
        task = plan.task
        self._pushes = Pushes(task)
        motion = plan.query.motion
        self.scene = scene
        self.model = scene.model
        self.state = mujoco.MjData(scene.model)
        self.frame: SupportFrame = task.support.frame
        self._ends = (plan.query.start, task.goal)
        self._region = _Region(scene, task.support.region)
        self._ground = None
        if is_uneven(task.truth):
            self._ground = UnevenGround(scene, Ground.of_truth(task.truth, seed))
        self._period = motion.control_period
        step = float(scene.model.opt.timestep)
        self._steps = round(self._period / step)
        self._body = scene.position("object")
        self._velocity = scene.velocity("object")
        self._rows = {
            "object_pose_3d" if name == "object" else f"body_{name}": scene.position(
                name
            )
            for name in scene.bodies
        }
        self.facts: dict[str, Any] = {
            "time_step": step,
            "control_period": self._period,
            "mujoco": mujoco.__version__,
        }
        if self._pushes:
            self.facts["pushed"] = self._pushes.times
        self._ticks = 0
        self._force = np.zeros(6)

    def put(self, arms: Sequence[JointArm], start: WorldState | None) -> None:
        """Put ``arms`` at the start of their joint paths, or arms and bodies as in
        ``start``, and compute the contacts.
        """
        state = self.state
        for i, arm in enumerate(arms):
            state.qpos[self.scene.joints[i]] = arm.start
        if start is not None:
            for i, speed in enumerate(start.speeds):
                state.qvel[self.scene.freedoms[i]] = speed
            for name, pose in start.spatial.items():
                first = self.scene.position(name)
                state.qpos[first : first + 7] = (*pose[4:], *pose[:4])
        self._arms = arms
        self._region.update(state)
        if self._ground is not None:
            self._ground.update(state, self.time)
        mujoco.mj_forward(self.model, state)
        self.now = self._look()
        self._before = self.now

    def _look(self) -> _Instant:
        """Read the present state."""
        q = self.state.qpos.copy()
        first = self._body
        pose = planar_pose(q[first : first + 7].tolist(), self.frame)
        v = self.state.qvel[self._velocity : self._velocity + 6]
        return _Instant(q, pose, planar_twist(v.tolist(), self.frame))

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._ticks * self._period

    def read(self) -> StampedPose:
        """The object's pose."""
        return StampedPose(self.time, self.now.X_WG)

    def advance(self) -> None:
        """Simulate one control period."""
        self._before = self.now
        self._region.update(self.state)
        if self._ground is not None:
            self._ground.update(self.state, self.time)
        if self._knocker is not None:
            self._knock(self._knocker)
        if self._pushes:
            self._push(self._pushes)
        self._ticks += 1
        mujoco.mj_step(self.model, self.state, self._steps)
        self.now = self._look()

    def _knock(self, knocker: Knocker) -> None:
        """Apply the force on the ball, at the start of a tick."""
        first, freedom = self.scene.position(BALL), self.scene.velocity(BALL)
        place = self.state.qpos[first : first + 3].copy()
        speed = self.state.qvel[freedom : freedom + 3].copy()
        force = knocker.force(place, speed, self.now.X_WG, self.time)
        self.state.qfrc_applied[freedom : freedom + 3] = force

    def _push(self, pushes: Pushes) -> None:
        """Apply the pushes at the object's centre of mass, at the start of a tick."""
        fx, fy, moment = pushes.wrench(self.now.X_WG, self.time)
        body = self.model.body("object").id
        about = [moment * axis for axis in self.frame.spin_axis]
        self.state.xfrc_applied[body] = (*self.frame.direction((fx, fy, 0.0)), *about)

    def failure(self) -> str | None:
        """Reason that the simulation cannot continue, or None.

        At the start of the last tick the object was far away, or had fallen or tipped
        over.
        """
        q, pose, _ = self._before
        height = None
        if self._region.limited:
            px, py, pz = q[self._body : self._body + 3].tolist()
            height = self.frame.coordinates((px, py, pz))[2]
        w, x, y, z = q[self._body + 3 : self._body + 7].tolist()
        tilt = tilt_of((w, x, y, z), self.frame)
        return lost_object(float(q.sum()), pose, self._ends, height, tilt)

    def tip_force(self, arm: int) -> Vector3:
        """Force [N] of an arm's tip ON what it touches, world axes."""
        state = self.state
        sphere = self.scene.spheres[arm]
        total = np.zeros(3)
        geoms = state.contact.geom
        for i in np.flatnonzero((geoms == sphere).any(axis=1)).tolist():
            mujoco.mj_contactForce(self.model, state, i, self._force)
            # of the first geom on the second
            force = state.contact.frame[i].reshape(3, 3).T @ self._force[:3]
            total += force if geoms[i, 0] == sphere else -force
        fx, fy, fz = total.tolist()
        return (fx, fy, fz)

    def observe(self) -> TrueState:
        """True state of the last completed tick."""
        before = self._before
        tips = tuple(arm.true_tip for arm in self._arms)
        return TrueState(
            before.X_WG, tips, before.twist, extras=partial(self._poses, before.q)
        )

    def _poses(self, q: Array) -> Mapping[str, Any]:
        """Spatial poses of all bodies: quaternion (w, x, y, z) and position [m]."""
        return {
            name: [*q[first + 3 : first + 7], *q[first : first + 3]]
            for name, first in self._rows.items()
        }


class _Region:
    """The part of a plane that carries feet."""

    def __init__(
        self, scene: MujocoScene, region: tuple[tuple[float, float], ...] | None
    ) -> None:
        self.limited = region is not None
        if region is None:
            return
        import shapely

        self._area = shapely.Polygon(region)
        shapely.prepare(self._area)
        self._model = scene.model
        self._feet = [
            (
                scene.position(name),
                body.points,
                np.array([scene.model.pair(pair).id for pair in body.feet]),
            )
            for name, body in scene.bodies.items()
        ]
        self._frame = scene.frame

    def update(self, state: Any) -> None:
        """Take the support from the feet that are beyond its edge."""
        if not self.limited:
            return
        import shapely

        for first, points, pairs in self._feet:
            pose = planar_pose(state.qpos[first : first + 7].tolist(), self._frame)
            c, s = math.cos(pose.yaw), math.sin(pose.yaw)
            x = pose.x + points @ (c, -s)
            y = pose.y + points @ (s, c)
            carried = shapely.contains_xy(self._area, x, y)
            self._model.pair_margin[pairs] = np.where(carried, 0.0, NEVER)


class MujocoDrives:
    """Encoders, force sensor and motors of one arm."""

    def __init__(self, physics: MujocoPhysics, index: int) -> None:
        """Take the ``index``th arm."""
        self._physics = physics
        self._index = index
        self._joints = physics.scene.joints[index]
        self._freedoms = physics.scene.freedoms[index]
        self._loops: PositionLoops | None = None

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._physics.time

    def joints(self) -> Array:
        """Positions and velocities (2 n,)."""
        state = self._physics.state
        return np.concatenate([state.qpos[self._joints], state.qvel[self._freedoms]])

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        """Force [N] of the tip ON what it touches, world axes."""
        return self._physics.tip_force(self._index)

    def drive(self, torque: Array) -> None:
        """Apply joint torques (n,) [N m] until the next call."""
        self._physics.state.qfrc_applied[self._freedoms] = torque

    def follow(self, arm: ArmDynamics, start: Array, speed: Array) -> Array:
        """Let the joints follow positions, as ``arms.model.PositionDrives.follow``."""
        state = self._physics.state
        if self._loops is None:
            names = self._physics.scene.arms[self._index]
            self._loops = PositionLoops(self._physics.model, names, arm.M)
        before = state.qfrc_applied[self._freedoms] + self._loops.force(state)
        self.drive(self._loops.lead(state, arm.bias, start, speed))
        return before
