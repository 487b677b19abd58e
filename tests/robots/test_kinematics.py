"""Forward kinematics, Jacobian and tool yaw obey their definitions."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.scene import MODELS
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.facts import TIP, load_facts
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude

SHARES = st.lists(st.floats(0.02, 0.98), min_size=7, max_size=7)


def posture(kin, shares):
    lower = kin.facts.lower
    upper = kin.facts.upper
    return lower + np.array(shares[: kin.facts.size]) * (upper - lower)


@given(st.sampled_from(MODELS), SHARES)
def test_the_jacobian_is_the_derivative_of_the_tip_pose(name, shares):
    kin = ArmKinematics(load_facts(name), (0.1, -0.3, 0.2), 0.6, 0.12)
    q = posture(kin, shares)
    h = 1e-6
    J = kin.jacobian(q)
    R = kin.tip_pose(q)[0]
    for i, step in enumerate(h * np.eye(kin.facts.size)):
        R_plus, p_plus = kin.tip_pose(q + step)
        R_minus, p_minus = kin.tip_pose(q - step)
        spin = (R_plus - R_minus) @ R.T / (2 * h)
        np.testing.assert_allclose(J[3:, i], (p_plus - p_minus) / (2 * h), atol=1e-8)
        np.testing.assert_allclose(
            J[:3, i], [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-8
        )


@given(st.sampled_from(MODELS), SHARES)
def test_rotations_stay_rotations(name, shares):
    kin = ArmKinematics(load_facts(name))
    R, _ = kin.tip_pose(posture(kin, shares))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-13)
    assert np.linalg.det(R) > 0


@pytest.mark.parametrize("name", MODELS)
def test_many_postures_at_once_equal_one_at_a_time(name):
    kin = ArmKinematics(load_facts(name), (0.0, 0.5, 0.3), -0.4)
    rng = np.random.default_rng(3)
    q = kin.facts.lower + rng.random((2, 5, kin.facts.size)) * (
        kin.facts.upper - kin.facts.lower
    )
    R, p, J = kin.tip_and_jacobian(q)
    for i, j in np.ndindex(2, 5):
        R_one, p_one, J_one = kin.tip_and_jacobian(q[i, j])
        np.testing.assert_allclose(R[i, j], R_one, atol=1e-15)
        np.testing.assert_allclose(p[i, j], p_one, atol=1e-15)
        np.testing.assert_allclose(J[i, j], J_one, atol=1e-15)


def test_the_base_pose_moves_everything_rigidly():
    here = ArmKinematics(load_facts("iiwa7"))
    there = ArmKinematics(load_facts("iiwa7"), (0.3, -0.2, 0.4), 0.5 * math.pi)
    R, p = here.tip_pose(here.facts.home)
    R_there, p_there = there.tip_pose(here.facts.home)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(R_there, turn @ R, atol=1e-15)
    np.testing.assert_allclose(p_there, turn @ p + [0.3, -0.2, 0.4], atol=1e-15)


def test_a_longer_rod_moves_the_tip_along_the_tool():
    short, long = (
        ArmKinematics(load_facts("panda"), tip_length=length) for length in (0.1, 0.25)
    )
    R, p = short.tip_pose(short.facts.home)
    _, p_long = long.tip_pose(short.facts.home)
    np.testing.assert_allclose(p_long - p, 0.15 * R[:, 2], atol=1e-15)


def test_link_poses_end_at_the_tip():
    kin = ArmKinematics(load_facts("panda"), (0.1, 0.0, 0.2), 0.3)
    poses = kin.link_poses(kin.facts.home)
    assert set(poses) == {link.name for link in kin.facts.links} | {TIP}
    np.testing.assert_allclose(poses[TIP][1], kin.tip_pose(kin.facts.home)[1])
    np.testing.assert_allclose(poses["panda_link1"][1], [0.1, 0.0, 0.533], atol=1e-15)
    R, p = poses["panda_link8"]
    np.testing.assert_allclose(
        p + R @ [0, 0, kin.tip_length], poses[TIP][1], atol=1e-15
    )


def test_the_hand_turns_its_tool_by_its_yaw_joint():
    kin = ArmKinematics(load_facts("hand"))
    R, p = kin.tip_pose(np.array([0.4, -0.2, 0.6, 1.1]))
    np.testing.assert_allclose(p, [0.4, -0.2, 0.6 - kin.tip_length], atol=1e-15)
    assert kin.tool_yaw(np.array([0.4, -0.2, 0.6, 1.1])) == pytest.approx(1.1)
    assert R[2, 2] == pytest.approx(-1.0)


@given(st.floats(-3.1, 3.1), st.floats(0.0, 1.2), st.floats(-3.1, 3.1))
def test_the_tool_yaw_is_that_of_its_projected_x_axis_at_any_tilt(yaw, tilt, azimuth):
    attitude = ToolAttitude(tilt, azimuth)
    R = attitude.rotation(yaw)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert attitude.yaw(R) == pytest.approx(yaw, abs=1e-12)
    np.testing.assert_allclose(R[:, 2], attitude.axis, atol=1e-15)
    assert math.acos(min(1.0, -R[2, 2])) == pytest.approx(tilt, abs=1e-7)


def test_on_a_wall_the_upright_tool_points_into_the_wall():
    # its normal along -x of the world
    wall = SupportFrame.of_wall((0.9, 0.0, 0.5), math.pi)
    attitude = ToolAttitude(axes=wall.axes)
    np.testing.assert_allclose(attitude.axis, [1.0, 0.0, 0.0], atol=1e-15)
    R = ToolAttitude(0.3, 1.1, wall.axes).rotation(0.7)
    np.testing.assert_allclose(
        R, ToolAttitude(0.3, 1.1, wall.axes).rotation_at(0.7), atol=1e-15
    )
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert attitude.yaw(R) == pytest.approx(0.7)
    # a quarter turn from "left" to "up"
    np.testing.assert_allclose(
        attitude.rotation(0.0)[:, 0], [0.0, 1.0, 0.0], atol=1e-15
    )
    np.testing.assert_allclose(
        attitude.rotation(0.5 * math.pi)[:, 0], [0.0, 0.0, 1.0], atol=1e-15
    )


def test_a_tilt_of_a_quarter_turn_is_refused():
    with pytest.raises(PushPressSlideError, match="tilt"):
        ToolAttitude(0.5 * math.pi)


@pytest.mark.parametrize(
    ("model", "frame", "message"),
    [
        ("spot", None, "panda, iiwa7, .*hand"),
        ("nowhere.urdf", "tip", "no such file"),
    ],
)
def test_a_model_that_cannot_be_read_is_refused(model, frame, message):
    with pytest.raises(PushPressSlideError, match=message):
        arm_kinematics(Robot(model, (0.0, 0.0, 0.0), tip_frame=frame))
