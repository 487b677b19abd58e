"""An arm that is driven by torques, on dynamics that are a few lines of NumPy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.arms.model import at_rest
from pushpressslide.arms.torque_arm import NO_POINT, TorqueArm
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import BrakeCommand, JointCommand, TipCommand, TipState
from pushpressslide.core.plan import JointPath
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.robots.facts import RobotFacts, load_facts
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
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


@pytest.fixture
def arm() -> TorqueArm:
    """Return a Panda in its ready posture, with a joint path that stays there."""
    robot = TASK.robots[0]
    model = Rotors(load_facts(robot.model), arm_kinematics(robot))
    made = TorqueArm(model, RADIUS)
    home = model.facts.home[None]
    path = JointPath(
        np.zeros(1), home, np.zeros(1), home, 0.0, 0.1, 10.0, 0.1, gap=0.01
    )
    made.follow(TASK, path, ToolAttitude())
    made.sense(at_rest(home[0]))
    return made


def driven(arm: TorqueArm, command: object, ticks: int) -> list[Array]:
    """Return the joints' positions after each tick under a command."""
    state = arm.state
    x = np.concatenate([state.q, state.v])
    size = arm.model.size
    out = []
    for _ in range(ticks):
        arm.execute(command)  # type: ignore[arg-type]
        v = x[size:] + PERIOD * np.linalg.solve(state.M, arm.torque - state.bias)
        x = np.concatenate([x[:size] + PERIOD * v, v])
        arm.sense(x)
        out.append(x[:size])
    return out


def test_joints_are_led_to_where_they_are_wanted(arm: TorqueArm) -> None:
    wanted = arm.state.q + 0.1
    driven(arm, JointCommand(wanted, np.zeros_like(wanted)), 500)
    assert arm.state.q == pytest.approx(wanted, abs=2e-3)
    assert arm.state.v == pytest.approx(0.0, abs=1e-2)
    assert (np.abs(arm.torque) <= arm.limits.effort).all()
    assert 0.0 <= arm.reading.torque_share <= 1.0


def test_without_a_command_it_rests_where_its_path_begins(arm: TorqueArm) -> None:
    begin = arm.path.move[0]
    arm.sense(at_rest(begin + 0.02))
    driven(arm, None, 500)
    assert arm.state.q == pytest.approx(begin, abs=2e-3)


def test_an_arm_that_brakes_comes_to_rest(arm: TorqueArm) -> None:
    size = arm.model.size
    arm.sense(np.concatenate([arm.state.q, np.full(size, 0.5)]))
    driven(arm, BrakeCommand(), 250)
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
    arm.execute(still)
    before = arm.row().reference
    command = replace(still, posture=arm.state.q + 1.0)
    arm.execute(command)
    step = arm.row().reference - before
    assert (step > 0.0).all()
    assert (step <= PERIOD * arm.limits.velocity).all()


def test_a_tip_is_touched_where_the_force_points_through_it(arm: TorqueArm) -> None:
    place = (0.4, 0.1, 0.02)
    touched = arm.contact_point(TipState(place, NOTHING, (0.0, -3.0, 4.0)))
    assert touched == pytest.approx(
        (0.4, 0.1 - 0.6 * RADIUS, 0.02 + 0.8 * RADIUS), abs=1e-12
    )
    assert arm.contact_point(TipState(place, NOTHING, (0.0, 0.0, 0.01))) is NO_POINT
