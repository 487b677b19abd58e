"""A second physics with an arm: a Panda of rigid links and a box that slides, in NumPy.

The arm takes torques as in Drake; its model, its drives and the world are this file's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.placements import ArmPlacements
from pushpressslide.arms.torque_arm import TorqueArm
from pushpressslide.control.cell import Cell
from pushpressslide.control.run_loop import run_loop
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.arrays import Array
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.control import Vector3
from pushpressslide.core.task import Robot, Task
from pushpressslide.core.twist_path import integrate
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.facts import TIP_MASS, load_facts, rotation_from_rpy

pytest.importorskip("pydrake")  # for the search for joint paths

STEPS = 5  # of the world in a control period
SMALL = 1e-6  # [s] over which a rate is a difference
DOWN = np.array([0.0, 0.0, -GRAVITY])


class Links(NamedTuple):
    """Jacobians of the centres of mass, and where the joints are."""

    linear: Array  # (l, 3, n)
    angular: Array  # (l, 3, n)
    inertia: Array  # (l, 3, 3) about the centres of mass, world axes
    tip: Array  # (6, n)


class RigidArm:
    """Rigid links on joints with rotors, as ``arms.model.ArmModel``."""

    def __init__(self, robot: Robot) -> None:
        self.facts = facts = load_facts(robot.model)
        self.size = facts.size
        self.kinematics = arm_kinematics(robot)
        self.children = [joint.child for joint in facts.moving]
        self.axes = np.array([joint.axis for joint in facts.moving])
        self.links = [link for link in facts.links if link.mass > 0.0]
        self.mass = np.array([*(link.mass for link in self.links), TIP_MASS])
        before = {facts.base: 0}
        for joint in facts.joints:
            before[joint.child] = before[joint.parent] + (joint.kind != "fixed")
        counts = [*(before[link.name] for link in self.links), self.size]
        self.carried = np.arange(self.size) < np.array(counts)[:, None]  # (l, n)

    def jacobians(self, q: Array) -> Links:
        poses = self.kinematics.link_poses(q)
        out = np.array([poses[c][0] for c in self.children])
        axes = np.einsum("nij,nj->ni", out, self.axes)
        origins = np.array([poses[c][1] for c in self.children])
        _, tip, J = self.kinematics.tip_and_jacobian(q)
        places = [tip]
        inertias = [np.zeros((3, 3))]
        for link in reversed(self.links):
            R, p = poses[link.name]
            xx, yy, zz, xy, xz, yz = link.inertia
            own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            turn = R @ rotation_from_rpy(link.rpy)
            inertias.insert(0, turn @ own @ turn.T)
            places.insert(0, p + R @ np.array(link.com))
        arms = np.array(places)[:, None] - origins  # (l, n, 3)
        held = self.carried[..., None]
        linear = np.where(held, np.cross(axes, arms), 0.0).transpose(0, 2, 1)
        angular = np.where(held, axes, 0.0).transpose(0, 2, 1)
        return Links(linear, angular, np.array(inertias), J)

    def state_at(self, x: Array) -> ArmDynamics:
        q, v = x[: self.size], x[self.size :]
        now = self.jacobians(q)
        soon = self.jacobians(q + SMALL * v)
        M = np.einsum("l,lin,lim->nm", self.mass, now.linear, now.linear)
        M += np.einsum("lin,lij,ljm->nm", now.angular, now.inertia, now.angular)
        M += np.diag(self.facts.armature)
        falling = (soon.linear - now.linear) @ v / SMALL - DOWN
        turning = (soon.angular - now.angular) @ v / SMALL
        w = now.angular @ v
        torque = np.einsum("lij,lj->li", now.inertia, turning)
        torque += np.cross(w, np.einsum("lij,lj->li", now.inertia, w))
        bias = np.einsum("l,lin,li->n", self.mass, now.linear, falling)
        bias += np.einsum("lin,li->n", now.angular, torque)
        rotation, place = self.kinematics.tip_pose(q)
        wx, wy, wz, vx, vy, vz = (now.tip @ v).tolist()
        px, py, pz = place.tolist()
        drift = (soon.tip - now.tip) @ v / SMALL
        return ArmDynamics(
            q,
            v,
            (px, py, pz),
            rotation,
            (vx, vy, vz),
            (wx, wy, wz),
            now.tip,
            M,
            bias,
            drift,
        )


class World:
    """A box that a tip pushes on one face, and the arm's drives."""

    simulated = True

    def __init__(self, task: Task, plan: pps.Plan, arm: RigidArm) -> None:
        self.time = 0.0
        self.task = task
        self.arm = arm
        self.X = plan.true_start.compose(task.object.X_GB)
        (self.contact,) = plan.contacts
        body = task.object
        rho = rho_fit(support_pressure(body.shape, center_of_mass=body.center_of_mass))
        drag = task.support.friction * body.mass * GRAVITY
        self.surface = EllipsoidLimitSurface(drag, rho)
        self.spin = 0.0  # [rad/s]
        self.force = np.zeros(3)  # [N] ON the box, the mean of the last period
        self.x = np.zeros(0)
        self.torque = np.zeros(0)
        self.at: ArmDynamics

    def read(self) -> StampedPose:
        return StampedPose(self.time, self.X.compose(self.task.object.X_GB.inverse()))

    def joints(self) -> Array:
        return self.x

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        self.at = arm
        fx, fy, fz = self.force.tolist()
        return (fx, fy, fz)

    def drive(self, torque: Array) -> None:
        self.torque = torque

    def failure(self) -> None: ...

    def advance(self) -> None:
        period = self.task.motion.control_period
        n = self.arm.size
        at = self.at  # as the arm was read in this period
        free = np.linalg.solve(at.M, self.torque - at.bias)
        yields = np.linalg.solve(at.M, at.J[3:].T)  # (n, 3) by a force at the tip
        q, v = self.x[:n].copy(), self.x[n:].copy()
        place = np.array(at.position)
        forces = []
        for _ in range(STEPS):
            dt = period / STEPS
            force = self.pushed(place, at.J[3:] @ v, dt)
            v += dt * (free - yields @ force)
            q += dt * v
            place += dt * (at.J[3:] @ v)
            forces.append(force)
        self.x = np.concatenate([q, v])
        self.force = np.mean(forces, axis=0)
        self.time += period

    def pushed(self, place: Array, velocity: Array, dt: float) -> Array:
        """Force of the tip on the box, which gives way to it for ``dt`` [s]."""
        nx, ny = self.contact.normal
        radius = self.task.robots[0].tip_radius
        x, y = self.X.unapply((place[0], place[1]))
        touched = (x + radius * nx, y + radius * ny)
        px, py = self.contact.point
        gap = (px - touched[0]) * nx + (py - touched[1]) * ny
        vx, vy = self.X.unrotate((velocity[0], velocity[1]))
        if vx * nx + vy * ny <= gap / dt:
            return np.zeros(3)
        # the tool turns with the box: its tip does not roll along the face
        turn = radius * self.spin
        mu = self.task.contact_friction
        led = (vx - turn * ny, vy + turn * nx)
        out = push_outcome(self.surface, touched, (nx, ny), mu, led)
        twist = out.twist.moved_to((0.0, 0.0))
        self.spin = twist.w
        self.X = integrate(self.X, (twist.vx, twist.vy, twist.w), dt)
        return np.array([*self.X.rotate(out.force), 0.0])


def cell_of(plan: pps.Plan) -> Cell:
    from pushpressslide.sim.arm_library import DRAKE, joint_paths_of

    model = RigidArm(plan.task.robots[0])
    world = World(plan.task, plan, model)
    arm = TorqueArm(model, world)
    placements = ArmPlacements(DRAKE, [arm], joint_paths_of(plan))
    placements.begin_placement(plan.query)
    start = arm.path.approach[0]
    world.x = np.concatenate([start, np.zeros_like(start)])
    world.torque = model.state_at(world.x).bias
    return Cell("rigid links", world, [arm], world, placements)


def test_its_arm_weighs_what_drakes_does() -> None:
    from pushpressslide.sim.arm_model import DrakeArmModel

    robot = pps.load_task("rear-push-rear").robots[0]
    model = RigidArm(robot)
    x = np.concatenate([model.facts.home + 0.1, np.linspace(-0.5, 0.5, 7)])
    ours = model.state_at(x)
    theirs = DrakeArmModel(robot).state_at(x)
    np.testing.assert_allclose(ours.M, theirs.M, atol=5e-3)
    np.testing.assert_allclose(ours.J, theirs.J, atol=1e-9)
    np.testing.assert_allclose(ours.bias, theirs.bias, atol=0.3)


def test_a_shipped_task_is_done_on_it() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    record = run_loop(cell_of(plan), plan)
    figures = pps.result(record)
    assert figures["success"], record.reason_text
    assert figures["final_position_error"] < 2e-3
    assert abs(figures["final_yaw_error"]) < math.radians(1.0)
    assert record.engine == "rigid links"
    # the arm was driven by torques inside its limits
    torques = record.arrays["joint_torque_0"]
    assert np.abs(torques).max() > 1.0
    assert record.arrays["torque_share_0"].max() <= 1.0
