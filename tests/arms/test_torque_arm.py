"""An arm that is driven by torques, on dynamics that are a few lines of NumPy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.model import at_rest
from pushpressslide.arms.torque_arm import TorqueArm
from pushpressslide.control.recording import NO_VECTOR, contact_point
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    JointCommand,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.facts import RobotFacts, load_facts
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude

TASK = pps.load_task("rear-push-rear")
PERIOD = TASK.motion.control_period
RADIUS = TASK.robots[0].tip_radius
NOTHING = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Rotors:
    """An arm whose joints weigh what their rotors and a kilogram square metre do."""

    facts: RobotFacts
    kinematics: ArmKinematics

    @property
    def size(self) -> int:
        return self.facts.size

    @cached_property
    def mass(self) -> Array:
        return np.diag(self.facts.armature + 1.0)

    def state_at(self, x: Array) -> ArmDynamics:
        q, v = x[: self.size], x[self.size :]
        rotation, place, J = self.kinematics.tip_and_jacobian(q)
        wx, wy, wz, vx, vy, vz = (J @ v).tolist()
        px, py, pz = place.tolist()
        rest = np.zeros(self.size)
        return ArmDynamics(
            q,
            v,
            (px, py, pz),
            rotation,
            (vx, vy, vz),
            (wx, wy, wz),
            J,
            self.mass,
            rest,
            np.zeros(6),
        )


class Joints:
    """Joints that turn as their torques have them."""

    def __init__(self, model: Rotors) -> None:
        self.model = model
        self.time = 0.0
        self.x = at_rest(model.facts.home)
        self.torque = np.zeros(model.size)

    def joints(self) -> Array:
        return self.x

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        return NOTHING

    def drive(self, torque: Array) -> None:
        self.torque = torque

    def advance(self) -> None:
        size = self.model.size
        v = self.x[size:] + PERIOD * np.linalg.solve(self.model.mass, self.torque)
        self.x = np.concatenate([self.x[:size] + PERIOD * v, v])
        self.time += PERIOD


@pytest.fixture
def joints() -> Joints:
    robot = TASK.robots[0]
    return Joints(Rotors(load_facts(robot.model), arm_kinematics(robot)))


@pytest.fixture
def arm(joints: Joints) -> TorqueArm:
    """Return a Panda in its ready posture, with a joint path that stays there."""
    model = joints.model
    made = TorqueArm(model, joints)
    home = model.facts.home[None]
    path = JointPath(
        np.zeros(1), home, np.zeros(1), home, 0.0, 0.1, 10.0, 0.1, gap=0.01
    )
    made.follow(path, ToolAttitude(), PERIOD)
    made.read()
    return made


def drive(arm: TorqueArm, joints: Joints, command: ArmCommand, ticks: int) -> None:
    """Pass ticks under a command."""
    for _ in range(ticks):
        arm.read()
        arm.send(command)
        joints.advance()
    arm.read()


def test_joints_are_led_to_where_they_are_wanted(
    arm: TorqueArm, joints: Joints
) -> None:
    wanted = arm.state.q + 0.1
    drive(arm, joints, JointCommand(wanted, np.zeros_like(wanted)), 500)
    assert arm.state.q == pytest.approx(wanted, abs=2e-3)
    assert arm.state.v == pytest.approx(0.0, abs=1e-2)
    assert (np.abs(joints.torque) <= arm.limits.effort).all()
    asked = arm.read().joints
    assert asked is not None
    assert 0.0 <= asked.torque_share <= 1.0


def test_without_a_command_it_rests_where_its_path_begins(
    arm: TorqueArm, joints: Joints
) -> None:
    begin = arm.path.move[0]
    joints.x = at_rest(begin + 0.02)
    drive(arm, joints, None, 500)
    assert arm.state.q == pytest.approx(begin, abs=2e-3)


def test_an_arm_that_brakes_comes_to_rest(arm: TorqueArm, joints: Joints) -> None:
    size = arm.model.size
    joints.x = np.concatenate([arm.state.q, np.full(size, 0.5)])
    drive(arm, joints, BrakeCommand(), 250)
    assert arm.state.v == pytest.approx(0.0, abs=1e-6)


def test_a_posture_that_jumps_is_led_to_at_a_bounded_rate(arm: TorqueArm) -> None:
    still = TipCommand(
        force=NOTHING,
        position=arm.state.position,
        velocity=NOTHING,
        stiffness=NOTHING,
        damping=NOTHING,
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=0.0,
        progress=0.0,
    )
    before = arm.send(still).reference
    command = replace(still, posture=arm.state.q + 1.0)
    after = arm.send(command).reference
    assert before is not None
    assert after is not None
    step = after - before
    assert (step > 0.0).all()
    assert (step <= PERIOD * arm.limits.velocity).all()


def test_a_tip_is_touched_where_the_force_points_through_it() -> None:
    place = (0.4, 0.1, 0.02)
    touched = contact_point(TipState(place, NOTHING, (0.0, -3.0, 4.0)), RADIUS)
    assert touched == pytest.approx(
        (0.4, 0.1 - 0.6 * RADIUS, 0.02 + 0.8 * RADIUS), abs=1e-12
    )
    light = TipState(place, NOTHING, (0.0, 0.0, 0.01))
    assert contact_point(light, RADIUS) is NO_VECTOR
