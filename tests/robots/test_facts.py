"""The published facts are complete and exact."""

import math

import numpy as np
import pytest

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.scene import MODELS
from pushpressslide.robots.facts import (
    exact_angle,
    load_facts,
    rotation_from_rpy,
)
from pushpressslide.robots.kinematics import ArmKinematics


@pytest.mark.parametrize("name", MODELS)
def test_limits_have_one_entry_per_joint_and_hold_the_home_posture(name):
    facts = load_facts(name)
    for limit in (
        facts.lower,
        facts.upper,
        facts.velocity_limit,
        facts.effort_limit,
        facts.torque_rate_limit,
    ):
        assert limit.shape == (facts.size,)
    assert np.all(facts.lower + 0.1 < facts.home)
    assert np.all(facts.home < facts.upper - 0.1)
    assert np.all(facts.effort_limit > 0)


@pytest.mark.parametrize("name", MODELS)
def test_the_joints_form_one_chain_from_base_to_flange(name):
    facts = load_facts(name)
    assert facts.joints[0].parent == facts.base
    assert facts.joints[-1].child == facts.flange
    for before, after in zip(facts.joints, facts.joints[1:], strict=False):
        assert before.child == after.parent
    assert {link.name for link in facts.links} == {
        facts.base,
        *(j.child for j in facts.joints),
    }


@pytest.mark.parametrize("name", MODELS)
def test_the_tool_points_down_in_the_home_posture(name):
    rotation, _ = ArmKinematics(load_facts(name)).tip_pose(load_facts(name).home)
    assert rotation[2, 2] < -0.9999


def test_only_the_franka_arms_limit_the_rate_of_their_torques():
    limits = {name: load_facts(name).torque_rate_limit for name in MODELS}
    assert np.all(limits.pop("panda") == 1000.0)
    assert np.all(limits.pop("fr3") == 1000.0)
    assert all(np.isinf(limit).all() for limit in limits.values())


def test_the_rotors_of_the_first_panda_joints_weigh_as_published():
    np.testing.assert_allclose(
        load_facts("panda").armature[:2], 0.605721456, rtol=1e-12
    )


def test_rounded_quarter_turns_are_made_exact_and_other_angles_left_alone():
    assert exact_angle(1.570796327) == 0.5 * math.pi
    assert exact_angle(-3.141592654) == -math.pi
    assert exact_angle(0.785) == 0.785
    turned = rotation_from_rpy((0.5 * math.pi, 0.0, math.pi))
    assert np.array_equal(turned, np.round(turned))


def test_an_unknown_robot_is_refused_with_the_known_ones():
    with pytest.raises(PushPressSlideError, match=r"panda, iiwa7, .*hand"):
        load_facts("ur5")
