"""Arms from MJCF files: defaults, orientations, inertias, limits, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from pushpressslide.core.errors import RobotFileError
from pushpressslide.robots.description import last_link, read_description
from pushpressslide.robots.facts import RobotFacts, rotation_from_rpy
from pushpressslide.robots.kinematics import ArmKinematics

LINK = '<joint name="{name}"/><geom type="box" size=".1 .02 .02" mass="1"/>'


def arm(
    folder: Path,
    inner: str,
    head: str = "",
    tail: str = "",
    link: str = "tool",
) -> RobotFacts:
    """Facts of an arm of one hinge with more on it, read from its file."""
    path = folder / "arm.xml"
    path.write_text(
        f'<mujoco model="arm">{head}<worldbody><body name="base">'
        f'<body name="first" pos="0 0 0.3">{LINK.format(name="j1")}{inner}</body>'
        f"</body></worldbody>{tail}</mujoco>"
    )
    return read_description(str(path), link)


def tool(attributes: str = "", inner: str = LINK.format(name="j2")) -> str:
    return f'<body name="tool" pos="0.2 0 0" {attributes}>{inner}</body>'


@pytest.mark.parametrize(
    "orientation",
    [
        f'quat="{math.cos(0.3)} 0 0 {math.sin(0.3)}"',
        f'quat="{2 * math.cos(0.3)} 0 0 {2 * math.sin(0.3)}"',
        'axisangle="0 0 2 0.6"',
        'euler="0 0 0.6"',
        f'xyaxes="{math.cos(0.6)} {math.sin(0.6)} 0 0 1 0"',
    ],
)
def test_all_forms_of_an_orientation_mean_the_same(tmp_path, orientation) -> None:
    facts = arm(tmp_path, tool(orientation), '<compiler angle="radian"/>')
    R = rotation_from_rpy(facts.moving[1].rpy)
    expected = rotation_from_rpy((0.0, 0.0, 0.6))
    np.testing.assert_allclose(R, expected, atol=1e-12)


def test_a_z_axis_is_where_it_is_said(tmp_path) -> None:
    facts = arm(tmp_path, tool('zaxis="1 2 2"'))
    R = rotation_from_rpy(facts.moving[1].rpy)
    np.testing.assert_allclose(R[:, 2], np.array([1.0, 2.0, 2.0]) / 3.0, atol=1e-12)


def test_capitals_of_an_euler_sequence_turn_about_fixed_axes(tmp_path) -> None:
    turned = []
    for order, angles in (("xyz", "10 20 30"), ("ZYX", "30 20 10")):
        head = f'<compiler eulerseq="{order}"/>'
        facts = arm(tmp_path, tool(f'euler="{angles}"'), head)
        turned.append(facts.moving[1].rpy)
    np.testing.assert_allclose(*turned, atol=1e-12)


def test_a_class_gives_what_an_element_lacks(tmp_path) -> None:
    head = (
        '<default><joint damping="0.1" armature="0.02"/><default class="outer">'
        '<joint armature="0.05" range="-90 45"/><default class="inner">'
        '<joint damping="0.4"/></default></default></default>'
    )
    joint = '<joint name="j2" class="inner" armature="0.5"/>'
    third = f'<body name="third">{LINK.format(name="j3")}</body>'
    box = '<geom type="box" size=".1 .1 .1"/>'
    facts = arm(tmp_path, tool('childclass="outer"', joint + box + third), head)
    first, second = facts.moving
    assert (first.damping, first.rotor_inertia) == (0.1, 0.02)
    assert (second.damping, second.rotor_inertia) == (0.4, 0.5)
    np.testing.assert_allclose((second.lower, second.upper), np.radians((-90, 45)))
    held = next(joint for joint in facts.branches if joint.child == "third")
    assert held.kind == "fixed"


@pytest.mark.parametrize(
    ("tail", "torque"),
    [
        ("", math.inf),
        ('<motor joint="j2" ctrlrange="-2 2" gear="5"/>', 10.0),
        ('<motor joint="j2" ctrlrange="-2 2" ctrllimited="false"/>', math.inf),
        ('<position joint="j2" ctrlrange="-3 3" forcerange="-7 8"/>', 7.0),
        ('<general joint="j2" forcerange="-7 7" gear="2 0 0 0 0 0"/>', 14.0),
        ('<motor joint="j2" ctrlrange="-20 20" forcerange="-7 7"/>', 7.0),
    ],
)
def test_the_torque_limit_is_that_of_the_actuator(tmp_path, tail, torque) -> None:
    facts = arm(tmp_path, tool(), tail=f"<actuator>{tail}</actuator>")
    assert facts.effort_limit[1] == torque


def test_a_joint_off_its_bodys_frame_turns_about_its_place(tmp_path) -> None:
    joint = '<joint name="j2" pos="0.1 0.05 0" axis="0 0 1"/>'
    facts = arm(tmp_path, tool("", joint + '<geom size="0.1"/>'))
    kin = ArmKinematics(facts, tip_length=0.0)
    q = np.array([[0.0, angle] for angle in np.linspace(-3.0, 3.0, 7)])
    _, p = kin.tip_pose(q)
    anchor = np.array([0.3, 0.05, 0.3])
    distance = np.linalg.norm(p - anchor, axis=1)
    np.testing.assert_allclose(distance, math.hypot(0.1, 0.05), atol=1e-12)


def test_masses_come_from_geoms_where_no_inertial_is(tmp_path) -> None:
    geoms = (
        '<geom type="box" size="0.1 0.2 0.3" density="500"/>'
        '<geom type="cylinder" size="0.1 0.2" mass="3" pos="1 0 0"/>'
        '<geom size="0.1" mass="2" group="7"/>'
    )
    head = '<compiler inertiagrouprange="0 4"/>'
    facts = arm(tmp_path, tool("", '<joint name="j2"/>' + geoms), head)
    link = next(link for link in facts.links if link.name == "tool")
    box = 500.0 * 0.2 * 0.4 * 0.6
    assert link.mass == pytest.approx(box + 3.0)
    assert link.com[0] == pytest.approx(3.0 / (box + 3.0))
    around_x = box * (0.4**2 + 0.6**2) / 12.0 + 3.0 * (3.0 * 0.1**2 + 0.4**2) / 12.0
    assert link.inertia[0] == pytest.approx(around_x)


def test_an_included_file_is_read_from_beside_the_file(tmp_path) -> None:
    (tmp_path / "tool.xml").write_text(f"<mujocoinclude>{tool()}</mujocoinclude>")
    facts = arm(tmp_path, '<include file="tool.xml"/>')
    assert [joint.name for joint in facts.moving] == ["j1", "j2"]
    assert last_link(str(tmp_path / "arm.xml")) == "tool"


def test_a_site_carries_a_tip(tmp_path) -> None:
    site = '<site name="end" pos="0 0 0.1"/>'
    facts = arm(tmp_path, tool("", LINK.format(name="j2") + site), link="end")
    _, p = ArmKinematics(facts, tip_length=0.0).tip_pose(np.zeros(2))
    np.testing.assert_allclose(p, [0.2, 0.0, 0.4], atol=1e-12)


@pytest.mark.parametrize(
    ("inner", "message"),
    [
        (tool('childclass="none"'), "class: 'none'.*one of main"),
        (tool('quat="1 0 0"'), "quat: '1 0 0'.*4 finite numbers"),
        (tool("", "<freejoint/>"), "type: 'free'.*only on the base"),
        (tool("", '<joint name="j2" type="ball"/><geom size=".1"/>'), "type: 'ball'"),
        ('<attach model="a" body="b" prefix="c"/>', "<attach>.*one plain model"),
        ('<include file="../../../../../etc/passwd"/>', "include, file"),
        ('<include file="arm.xml"/>', "include, file|no frame"),
        (tool("", '<joint name="j2"/><geom type="box" size=".1"/>'), "3 finite"),
        (tool("", '<joint name="j2"/>'), "moves has no mass"),
    ],
)
def test_what_no_arm_can_have_is_refused_in_one_line(tmp_path, inner, message) -> None:
    with pytest.raises(RobotFileError, match=message) as caught:
        arm(tmp_path, inner)
    assert "\n" not in str(caught.value)


def test_a_urdf_may_end_in_xml_and_another_root_is_refused(tmp_path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(
        '<robot name="a"><link name="b"/><link name="c"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1"/></inertial></link><joint name="j" '
        'type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    assert read_description(str(path), "c").size == 1
    path.write_text("<html/>")
    with pytest.raises(RobotFileError, match=r"<html>.*robot, sdf, mujoco"):
        read_description(str(path), "c")


@pytest.mark.parametrize("text", ["<mujoco/>", "<robot/>"])
def test_a_file_without_a_link_is_refused(tmp_path, text) -> None:
    path = tmp_path / "empty.xml"
    path.write_text(text)
    with pytest.raises(RobotFileError, match="it has no link"):
        last_link(str(path))
