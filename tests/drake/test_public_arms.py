"""Arm files as public packages ship them, unedited but for a tip in the task."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import RobotFileError
from pushpressslide.core.scene import Robot, Tip
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.sim.arm_model import DrakeArmModel

PublicFile = Callable[[str, str], Path]


class File(NamedTuple):
    package: str  # its name and version on PyPI
    path: str
    link: str  # that carries the tip
    joints: int


DATA = "cmeel.prefix/share/example-robot-data/robots"
ERD = "example-robot-data 6.0.0"
BULLET = "pybullet 3.2.7"
MANI = "mani_skill 3.0.1"
ROBOPLAN = "pyroboplan 1.3.1"
UR5E = File("airo-models 0.0.12", "airo_models/arms/ur5e/ur5e.urdf", "tool0", 6)
XARM7 = File(ERD, f"{DATA}/xarm_description/urdf/xarm7.urdf", "link7", 7)
PANDA = File(ERD, f"{DATA}/panda_description/urdf/panda.urdf", "panda_link8", 7)
UR5 = File(ERD, f"{DATA}/ur_description/urdf/ur5_robot.urdf", "tool0", 6)
IIWA = File(BULLET, "pybullet_data/kuka_iiwa/model.urdf", "lbr_iiwa_link_7", 7)
KINOVA = File(
    ERD, f"{DATA}/kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", 6
)
PUSHING = [UR5E, XARM7, PANDA, UR5, IIWA, KINOVA]
UR = f"{DATA}/ur_description/urdf"
READ = [
    *PUSHING,
    File("airo-models 0.0.12", "airo_models/arms/ur3e/ur3e.urdf", "tool0", 6),
    File(ERD, f"{UR}/ur3_robot.urdf", "tool0", 6),
    File(ERD, f"{UR}/ur3_gripper.urdf", "tool0", 6),
    File(ERD, f"{UR}/ur5_gripper.urdf", "tool0", 6),
    File(ERD, f"{UR}/ur10_robot.urdf", "tool0", 6),
    File(ERD, f"{UR}/ur10_joint_limited_robot.urdf", "tool0", 6),
    File(ERD, f"{DATA}/z1_description/urdf/z1.urdf", "link06", 6),
    File(ERD, f"{DATA}/so_arm_description/urdf/so100.urdf", "gripper", 5),
    File(ERD, f"{DATA}/so_arm_description/urdf/so101.urdf", "gripper_link", 5),
    File(ERD, f"{DATA}/baxter_description/urdf/baxter.urdf", "left_gripper", 7),
    File(ERD, f"{DATA}/tiago_description/robots/tiago.urdf", "arm_tool_link", 8),
    File(ERD, f"{DATA}/pr2_description/urdf/pr2.urdf", "r_gripper_tool_frame", 8),
    File(BULLET, "pybullet_data/kuka_iiwa/model.sdf", "lbr_iiwa_link_7", 7),
    File(BULLET, "pybullet_data/franka_panda/panda.urdf", "panda_link8", 7),
    File(BULLET, "pybullet_data/xarm/xarm6_robot.urdf", "link6", 6),
    File(MANI, "mani_skill/assets/robots/panda/panda_v2.urdf", "panda_link8", 7),
    File(MANI, "mani_skill/assets/robots/panda/panda_stick.urdf", "panda_link8", 7),
    File(MANI, "mani_skill/assets/robots/xarm7/xarm7.urdf", "link7", 7),
    File(
        ROBOPLAN, "pyroboplan/models/ur_description/urdf/ur5_on_base.urdf", "tool0", 9
    ),
    File(
        ROBOPLAN, "pyroboplan/models/ur_description/urdf/ur10_on_base.urdf", "tool0", 9
    ),
]
MASSLESS = File(
    ROBOPLAN, "pyroboplan/models/panda_description/urdf/panda.urdf", "panda_link8", 7
)


def named(file: File) -> str:
    return f"{Path(file.path).stem}-{file.package.split()[0]}"


@pytest.mark.parametrize("file", READ, ids=map(named, READ))
def test_a_public_arm_is_read_with_a_ready_posture(
    public_file: PublicFile, file: File
) -> None:
    kin = arm_kinematics(Robot(str(public_file(*file[:2])), tip=Tip(file.link)))
    assert kin.facts.size == file.joints
    assert kin.joint_margin(kin.facts.home) >= 0.0
    assert (kin.facts.armature > 0.0).all()
    assert all("\n" not in note for note in kin.facts.notes)


@pytest.mark.parametrize("file", READ, ids=map(named, READ))
def test_a_link_that_is_not_there_is_refused_in_one_line(
    public_file: PublicFile, file: File
) -> None:
    robot = Robot(str(public_file(*file[:2])), tip=Tip("no_such_link"))
    with pytest.raises((RobotFileError, pps.PushPressSlideError)) as caught:
        arm_kinematics(robot)
    assert "no_such_link" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_arm_without_masses_is_refused_in_one_line(public_file: PublicFile) -> None:
    robot = Robot(str(public_file(*MASSLESS[:2])), tip=Tip(MASSLESS.link))
    with pytest.raises(RobotFileError, match="'panda_link1', mass: 0 kg") as caught:
        arm_kinematics(robot)
    assert "\n" not in str(caught.value)


def largest_difference(one: Array, other: Array) -> float:
    """Largest difference of two arrays, relative to the largest number in them."""
    return float(np.abs(one - other).max() / np.abs(other).max())


@pytest.mark.long
@pytest.mark.parametrize("file", READ, ids=map(named, READ))
def test_a_public_arm_in_mujoco_is_the_arm_in_drake(
    public_file: PublicFile, file: File
) -> None:
    pytest.importorskip("mujoco")
    from pushpressslide.mujoco_sim.arm_model import MujocoArmModel

    robot = Robot(str(public_file(*file[:2])), (0.1, 0.2, 0.3), 0.4, tip=Tip(file.link))
    models = (MujocoArmModel(robot), DrakeArmModel(robot))
    facts = models[0].facts
    rng = np.random.default_rng(5)
    for _ in range(10):
        q = facts.lower + rng.random(facts.size) * (facts.upper - facts.lower)
        x = np.concatenate([q, rng.normal(size=facts.size)])
        ours, theirs = (model.state_at(x) for model in models)
        for name in ("M", "bias", "J", "rotation"):
            pair = (getattr(ours, name), getattr(theirs, name))
            assert largest_difference(*pair) < 1e-9, name


@pytest.mark.long
@pytest.mark.parametrize("file", [UR5E, XARM7], ids=map(named, [UR5E, XARM7]))
def test_a_public_arm_pushes_in_mujoco(public_file: PublicFile, file: File) -> None:
    pytest.importorskip("mujoco")
    robot = {"model": str(public_file(*file[:2])), "tip": {"link": file.link}}
    record = pps.run("rear-push-rear", engine="mujoco", overrides={"robots": [robot]})
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 2e-3
    assert record.figures["final_yaw_error"] < np.radians(1.0)


@pytest.mark.long
@pytest.mark.parametrize("task", ["rear-push-rear", "press-slide", "book"])
@pytest.mark.parametrize("file", PUSHING, ids=map(named, PUSHING))
def test_a_public_arm_does_what_the_shipped_arms_do(
    public_file: PublicFile, file: File, task: str
) -> None:
    length = pps.load_task(task).robots[0].tip_length
    tip = f"{{link: {file.link}, length: {length}}}"
    robot = f"robots=[{{model: {public_file(*file[:2])}, tip: {tip}}}]"
    record = pps.run(pps.load_task(task, [robot]), engine="drake")
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 2e-3
    assert record.figures["final_yaw_error"] < np.radians(1.0)
