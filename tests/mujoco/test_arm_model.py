"""Arms in MuJoCo are the arms in Drake."""

import numpy as np
import pytest

from pushpressslide.core.arrays import Array
from pushpressslide.core.scene import MODELS
from pushpressslide.core.task import Robot
from pushpressslide.core.truth import Truth
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.mujoco_sim.arm_model import MujocoArmModel
from pushpressslide.sim.arm_model import DrakeArmModel

POSTURES = 20
ARMS = [model for model in MODELS if model != "hand"]


def states(model: MujocoArmModel) -> list[Array]:
    rng = np.random.default_rng(0)
    facts = model.facts
    spans = facts.upper - facts.lower
    return [
        np.concatenate(
            [facts.lower + spans * rng.random(model.size), rng.normal(size=model.size)]
        )
        for _ in range(POSTURES)
    ]


def assert_same(ours: ArmDynamics, theirs: ArmDynamics) -> None:
    for name in ArmDynamics.__dataclass_fields__:
        np.testing.assert_allclose(
            getattr(ours, name), getattr(theirs, name), atol=1e-9, err_msg=name
        )


@pytest.mark.parametrize("name", ARMS)
def test_mass_matrix_bias_and_kinematics_are_those_of_drake(name: str) -> None:
    robot = Robot(name, (0.1, 0.2, 0.3), 0.4, tip_radius=0.015, tip_length=0.12)
    model = MujocoArmModel(robot)
    drake = DrakeArmModel(robot)
    for x in states(model):
        assert_same(model.state_at(x), drake.state_at(x))


def test_an_arm_that_differs_from_its_robot_is_the_same_in_both() -> None:
    truth = Truth((0.01, -0.02), 0.03, (1e-3, 2e-3, 3e-3), 0.0, 1.2, 0.0, 0.1)
    robot = Robot("panda", (0.1, 0.2, 0.3), 0.4)
    model = MujocoArmModel(robot, truth)
    drake = DrakeArmModel(robot, truth)
    for x in states(model):
        assert_same(model.state_at(x), drake.state_at(x))


def test_joints_are_in_the_order_of_the_facts() -> None:
    model = MujocoArmModel(Robot("ur5e"))
    names = [model.compiled.joint(i).name for i in range(model.size)]
    assert names == [f"robot_0_{joint.name}" for joint in model.facts.moving]
    np.testing.assert_allclose(model.compiled.jnt_range[:, 0], model.facts.lower)
    np.testing.assert_allclose(model.compiled.dof_armature, model.facts.armature)
