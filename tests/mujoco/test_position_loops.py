"""Position loops of joints in MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.arrays import Array
from pushpressslide.mujoco_sim.arm_model import MujocoArmModel
from pushpressslide.mujoco_sim.position_loops import PositionLoops
from pushpressslide.mujoco_sim.scene import MujocoScene, build_scene

STEP = 1e-3  # [s] of the simulation
STEPS = 4  # in a tick


class Loops:
    """A Panda far from its object, whose joints follow positions."""

    def __init__(self) -> None:
        task = pps.load_task("rear-push-rear", {"robots.0.interface": "position"})
        self.scene: MujocoScene = build_scene(pps.plan(task), STEP)
        self.model = self.scene.model
        self.arm = MujocoArmModel(task.robots[0])
        self.facts = self.arm.facts
        self.state = mujoco.MjData(self.model)
        self.state.qpos[self.scene.joints[0]] = self.facts.home
        mujoco.mj_forward(self.model, self.state)
        mass = self.arm.state_at(self.x).M
        self.loops = PositionLoops(self.model, self.scene.arms[0], mass)

    @property
    def x(self) -> Array:
        freedoms = self.scene.freedoms[0]
        q = self.state.qpos[self.scene.joints[0]]
        return np.concatenate([q, self.state.qvel[freedoms]])

    def tick(self, start: Array, speed: Array) -> Array:
        """Let a tick pass. Returns the largest torques (n,) of its steps."""
        freedoms = self.scene.freedoms[0]
        bias = self.arm.state_at(self.x).bias
        added = self.loops.lead(self.state, bias, start, speed)
        self.state.qfrc_applied[freedoms] = added
        largest = np.zeros(len(start))
        for _ in range(STEPS):
            mujoco.mj_step(self.model, self.state)
            largest = np.maximum(largest, np.abs(self.loops.force(self.state) + added))
        return largest


def test_an_arm_at_rest_stays_where_it_is() -> None:
    arm = Loops()
    home = arm.facts.home
    for _ in range(250):
        arm.tick(home, np.zeros(7))
    np.testing.assert_allclose(arm.x[:7], home, atol=1e-6)


def test_joints_follow_a_ramp_without_falling_behind() -> None:
    arm = Loops()
    target = arm.facts.home.copy()
    speed = np.array([0.2, -0.1, 0.2, 0.1, -0.2, 0.1, 0.2])
    for _ in range(250):
        arm.tick(target, speed)
        target = target + STEPS * STEP * speed
    # within what a joint moves in a step
    np.testing.assert_allclose(arm.x[:7], target, atol=5e-4)
    np.testing.assert_allclose(arm.x[7:], speed, atol=5e-3)


def test_torques_stay_within_the_joints_efforts() -> None:
    arm = Loops()
    effort = arm.facts.effort_limit
    largest = np.zeros(7)
    for _ in range(25):
        torque = arm.tick(arm.facts.home + 0.3, np.zeros(7))
        largest = np.maximum(largest, torque)
    assert (largest <= effort + 1e-9).all()
    assert (largest > 0.999 * effort).any()


@pytest.mark.parametrize(
    ("interface", "count"), [("torque", 0), ("velocity", 0), ("position", 7)]
)
def test_only_joints_that_take_positions_have_loops(interface: str, count: int) -> None:
    task = pps.load_task("rear-push-rear", {"robots.0.interface": interface})
    assert build_scene(pps.plan(task), STEP).model.nu == count
