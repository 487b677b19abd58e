"""A robot file from which no arm can be built is refused when the task is loaded.

The error is one line with the file, the link or joint, the value and what is allowed.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import RobotFileError
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.description import read_description

LINK = (
    '<link name="l{i}"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="j{i}" type="{kind}"><parent link="l{before}"/><child link="l{i}"/>'
    '<origin xyz="0 0 0.3" rpy="{roll} 0 0"/><axis xyz="0 0 1"/>'
    '<limit lower="-2.5" upper="2.5" effort="100" velocity="2"/></joint>'
)
TIP = (
    '<link name="tcp"/><joint name="rod" type="fixed"><parent link="l6"/>'
    '<child link="tcp"/><origin xyz="0 0 0.15"/></joint>'
)


def urdf() -> str:
    """Return an arm of six joints."""
    links = [LINK.format(i=i) for i in range(7)]
    joints = [
        JOINT.format(i=i, before=i - 1, kind="revolute", roll=1.5708 * (i % 2))
        for i in range(1, 7)
    ]
    return f'<robot name="arm">{"".join([*links, *joints])}{TIP}</robot>'


def refused(tmp_path: Path, text: str, suffix: str = ".urdf") -> str:
    path = tmp_path / f"arm{suffix}"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotFileError) as caught:
        read_description(str(path), "tcp")
    line = str(caught.value)
    assert line.startswith(f"{path}: ")
    assert "\n" not in line
    return line.removeprefix(f"{path}: ")


def put(old: str, new: str, part: str = "<robot") -> Callable[[str], str]:
    """Return the edit of the first ``old`` after ``part``."""

    def edit(text: str) -> str:
        before, found, after = text.partition(part)
        assert old in after
        return before + found + after.replace(old, new, 1)

    return edit


MASS = '<mass value="2"/>'
ORIGIN = 'xyz="0 0 0.3"'
FAULTS: dict[str, tuple[Callable[[str], str], tuple[str, ...]]] = {
    "negative mass": (
        put(MASS, '<mass value="-2"/>', 'name="l3"'),
        ("link 'l3', mass: -2", "[0, 1e+06]"),
    ),
    "mass that is no number": (
        put(MASS, '<mass value="NaN"/>', 'name="l3"'),
        ("link 'l3', mass: NaN",),
    ),
    "infinite mass": (
        put(MASS, '<mass value="inf"/>', 'name="l0"'),
        ("link 'l0', mass: inf",),
    ),
    "negative moment of inertia": (
        put('iyy="0.01"', 'iyy="-0.01"', 'name="l2"'),
        ("link 'l2', iyy: -0.01", "0 or more"),
    ),
    "centre of mass that is no number": (
        put('xyz="0 0 0.1"', 'xyz="0 nan 0.1"', 'name="l2"'),
        ("link 'l2', inertial xyz: '0 nan 0.1'", "3 finite numbers"),
    ),
    "nothing with mass behind a joint": (
        put(MASS, '<mass value="0"/>', 'name="l6"'),
        ("link 'l6', mass: 0 kg", "joint 'j6'"),
    ),
    "origin that is no number": (
        put(ORIGIN, 'xyz="0 0 NaN"', 'name="j2"'),
        ("joint 'j2', origin xyz: '0 0 NaN'", "3 finite numbers"),
    ),
    "origin in millimetres": (
        put(ORIGIN, 'xyz="0 0 300"', 'name="j2"'),
        ("joint 'j2', origin xyz", "[-100, 100]"),
    ),
    "origin of two numbers": (
        put(ORIGIN, 'xyz="0 0"', 'name="j2"'),
        ("joint 'j2', origin xyz: '0 0'",),
    ),
    "angle that is no number": (
        put('rpy="0.0 0 0"', 'rpy="inf 0 0"', 'name="j2"'),
        ("joint 'j2', origin rpy: 'inf 0 0'",),
    ),
    "axis of length zero": (
        put('axis xyz="0 0 1"', 'axis xyz="0 0 0"', 'name="j4"'),
        ("joint 'j4', axis: [0.0, 0.0, 0.0]", "a direction"),
    ),
    "reversed limits": (
        put('lower="-2.5" upper="2.5"', 'lower="2.5" upper="-2.5"', 'name="j5"'),
        ("joint 'j5', limit lower: 2.5", "at most the upper one, -2.5"),
    ),
    "limit that is no number": (
        put('lower="-2.5"', 'lower="nan"', 'name="j5"'),
        ("joint 'j5', limit lower: nan",),
    ),
    "speed that is no number": (
        put('velocity="2"', 'velocity="NaN"', 'name="j5"'),
        ("joint 'j5', limit velocity: NaN",),
    ),
    "negative effort": (
        put('effort="100"', 'effort="-5"', 'name="j1"'),
        ("joint 'j1', limit effort: -5", "above 0"),
    ),
    "effort that is no number": (
        put('effort="100"', 'effort="much"', 'name="j1"'),
        ("joint 'j1', limit effort: much",),
    ),
    "mimic on the way to the tip": (
        put("<limit", '<mimic joint="j1"/><limit', 'name="j3"'),
        ("joint 'j3': mimic of 'j1'", "driven by itself"),
    ),
    "circle": (
        put('<parent link="l0"/>', '<parent link="l6"/>', 'name="j1"'),
        ("joint 'j1', parent: 'l6'", "circle"),
    ),
    "joint to itself": (
        put('<parent link="l0"/>', '<parent link="l1"/>', 'name="j1"'),
        ("joint 'j1', parent: 'l1'",),
    ),
    "two links of a name": (
        put('name="l4"', 'name="l3"'),
        ("link 'l3': a second one",),
    ),
    "two joints of a name": (
        put('joint name="j4"', 'joint name="j3"'),
        ("joint 'j3': a second one",),
    ),
    "two joints to a link": (
        put('<child link="l4"/>', '<child link="l3"/>', 'name="j4"'),
        ("joint 'j4', child: 'l3'", "'j3' leads to it already"),
    ),
    "joint to no link": (
        put('<child link="l4"/>', '<child link="l9"/>', 'name="j4"'),
        ("joint 'j4', child: 'l9'", "a link of the file: l0, l1"),
    ),
    "kind that is not known": (
        put('type="revolute"', 'type="planar"', 'name="j4"'),
        ("joint 'j4', type: 'planar'", "revolute, continuous, prismatic, fixed"),
    ),
    "no XML": (lambda text: text[:100], ("it is not XML",)),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_a_urdf_is_named_with_its_place(tmp_path: Path, name: str) -> None:
    edit, words = FAULTS[name]
    line = refused(tmp_path, edit(urdf()))
    for word in words:
        assert word in line


FINE: dict[str, Callable[[str], str]] = {
    "as it is": lambda text: text,
    "axis of a fixed joint": put("<origin", '<axis xyz="0 0 0"/><origin', '"rod"'),
    "massless frame that moves with others": put(
        MASS, '<mass value="0"/>', 'name="l3"'
    ),
    "root without mass": put(MASS, '<mass value="0"/>', 'name="l0"'),
    "effort of zero": put('effort="100"', 'effort="0"', 'name="j1"'),
    "speed of zero": put('velocity="2"', 'velocity="0"', 'name="j5"'),
    "no limits at all": put(
        '<limit lower="-2.5" upper="2.5" effort="100" velocity="2"/>', "", 'name="j5"'
    ),
    "infinite limits": put('effort="100"', 'effort="inf"', 'name="j5"'),
    "finger that follows another, without effort": put(
        "</robot>",
        '<link name="f"/><joint name="f" type="prismatic"><parent link="l6"/>'
        '<child link="f"/><mimic joint="j6"/><limit lower="0" upper="1" effort="0" '
        'velocity="1"/></joint></robot>',
    ),
    "held by the world": put(
        "</robot>",
        '<link name="world"/><joint name="held" type="fixed"><parent link="world"/>'
        '<child link="l0"/></joint></robot>',
    ),
}


@pytest.mark.parametrize("name", FINE)
def test_what_public_files_leave_in_is_accepted(tmp_path: Path, name: str) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(FINE[name](urdf()), encoding="utf-8")
    kinematics = arm_kinematics(Robot(str(path), tip_frame="tcp"))
    assert kinematics.facts.size == 6


SDF = """<sdf version="1.9"><model name="arm">
<link name="l0"/>
<link name="l1"><pose>0 0 0.3 0 0 0</pose>
<inertial><mass>2</mass><inertia><ixx>0.1</ixx></inertia></inertial></link>
<link name="tcp"><pose>0 0 0.6 0 0 0</pose><inertial><mass>0</mass></inertial></link>
<joint name="j1" type="revolute"><parent>l0</parent><child>l1</child><axis>
<xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>9</effort>
<velocity>-1</velocity></limit></axis></joint>
<joint name="rod" type="fixed"><parent>l1</parent><child>tcp</child></joint>
</model></sdf>"""

OF_SDF = {
    "<mass>2</mass>": ("<mass>-2</mass>", "link 'l1', mass: -2"),
    "<ixx>0.1</ixx>": ("<ixx>nan</ixx>", "link 'l1', ixx: nan"),
    "<lower>-1</lower>": ("<lower>4</lower>", "joint 'j1', limit lower: 4"),
    "<effort>9</effort>": ("<effort>nan</effort>", "joint 'j1', limit effort: nan"),
    "<velocity>-1</velocity>": ("<velocity>NaN</velocity>", "limit velocity: NaN"),
    "<xyz>0 0 1</xyz>": ("<xyz>0 0 0</xyz>", "joint 'j1', axis"),
    "<pose>0 0 0.6 0 0 0</pose>": ("<pose>0 0 nan 0 0 0</pose>", "link 'tcp', pose"),
    "<child>l1</child>": ("<child>l7</child>", "joint 'j1', child: 'l7'"),
    "<parent>l0</parent>": ("<parent>l7</parent>", "joint 'j1', parent: 'l7'"),
}


@pytest.mark.parametrize("old", OF_SDF)
def test_a_fault_of_an_sdf_is_named_with_its_place(tmp_path: Path, old: str) -> None:
    new, words = OF_SDF[old]
    assert words in refused(tmp_path, SDF.replace(old, new, 1), ".sdf")


def test_an_sdf_may_give_negative_limits_for_none(tmp_path: Path) -> None:
    path = tmp_path / "arm.sdf"
    path.write_text(SDF.replace("<effort>9", "<effort>-1"))
    (joint,) = read_description(str(path), "tcp").moving
    assert joint.effort == joint.velocity == float("inf")


def test_a_task_with_such_a_file_is_refused_as_it_is_loaded(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(urdf().replace('effort="100"', 'effort="-1"'))
    with pytest.raises(RobotFileError, match=r"arm\.urdf: joint 'j1', limit effort"):
        pps.load_task("rear-push-rear", [f"robots=[{{model: {path}, tip_frame: tcp}}]"])
