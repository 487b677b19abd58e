"""Arms as robotics packages ship them: grippers, cameras, world links, meshes by
package; and what the task adds to a file.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.errors import InputError, RobotFileError, TaskError
from pushpressslide.core.scene import JointLimits, Robot, Tip
from pushpressslide.robots.arm_files import ROTOR, arm_kinematics, robot_facts
from pushpressslide.robots.description import read_description

LINK = (
    '<link name="l{i}"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
    "{shapes}</link>"
)
JOINT = (
    '<joint name="j{i}" type="{kind}"><parent link="{before}"/><child link="l{i}"/>'
    '<origin xyz="0 0 {z}" rpy="{roll} 0 0"/><axis xyz="0 0 1"/>'
    '<limit lower="-2.9" upper="2.9" effort="100" velocity="2"/></joint>'
)
FINGERS = (
    '<link name="f1"/><joint name="finger1" type="prismatic"><parent link="l6"/>'
    '<child link="f1"/><axis xyz="1 0 0"/><limit lower="0.01" upper="0.04"/></joint>'
    '<link name="f2"/><joint name="finger2" type="prismatic"><parent link="l6"/>'
    '<child link="f2"/><axis xyz="1 0 0"/><limit lower="0" upper="0.04"/>'
    '<mimic joint="finger1"/></joint>'
)
CAMERA = (
    '<link name="camera"/><joint name="mount" type="floating"><parent link="l3"/>'
    '<child link="camera"/><axis xyz="0 0 0"/></joint>'
)
WORLD = (
    '<link name="world"/><joint name="fix" type="fixed"><parent link="world"/>'
    '<child link="l0"/><origin xyz="0 0 1"/><axis xyz="0 0 0"/></joint>'
)
MESH = (
    '<{role}><geometry><mesh filename="{name}" scale="0.001 0.001 0.001"/></geometry>'
    "</{role}>"
)


def arm(*more: str, shapes: str = "") -> str:
    """An arm of six joints like a UR's: two short links and two long ones."""
    turned = {1: 0.0, 2: 1.5708, 3: 0.0, 4: 0.0, 5: 1.5708, 6: -1.5708}
    height = {1: 0.2, 2: 0.0, 3: 0.0, 4: 0.0, 5: 0.1, 6: 0.1}
    out = [LINK.format(i=0, shapes=shapes)]
    for i in range(1, 7):
        joint = JOINT.format(
            i=i, before=f"l{i - 1}", kind="revolute", z=height[i], roll=turned[i]
        )
        if i in (3, 4):  # along the link before
            joint = joint.replace('xyz="0 0 0.0"', 'xyz="0.4 0 0"')
        out += [LINK.format(i=i, shapes=""), joint]
    return f'<robot name="arm">{"".join([*out, *more])}</robot>'


def written(folder: Path, text: str) -> str:
    path = folder / "arm.urdf"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_fingers_and_cameras_are_held_where_they_are(tmp_path: Path) -> None:
    facts = read_description(written(tmp_path, arm(FINGERS, CAMERA)), "l6")
    assert [joint.name for joint in facts.moving] == [f"j{i}" for i in range(1, 7)]
    assert facts.notes == ("held where it is: joint finger1, finger2, mount",)
    first = next(joint for joint in facts.branches if joint.name == "finger1")
    assert first.kind == "fixed"
    assert first.xyz == (0.01, 0.0, 0.0)  # the limit next to zero


def test_a_world_link_is_left_out(tmp_path: Path) -> None:
    facts = read_description(written(tmp_path, arm(WORLD)), "l6")
    assert facts.base == "l0"
    assert "world" not in {link.name for link in facts.links}
    assert "left out: link 'world' and joint fix" in facts.notes[0]


def test_a_stand_that_moves_in_the_world_is_part_of_the_arm(tmp_path: Path) -> None:
    slide = (
        '<link name="world"/><joint name="rail" type="prismatic"><parent link="world"/>'
        '<child link="l0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="500"/>'
        "</joint>"
    )
    kin = arm_kinematics(Robot(written(tmp_path, arm(slide)), tip=Tip("l6")))
    assert kin.facts.moving[0].name == "rail"
    assert kin.facts.size == 7
    q = kin.facts.home.copy()
    before = kin.tip_pose(q)[1]
    q[0] += 0.2
    np.testing.assert_allclose(kin.tip_pose(q)[1] - before, (0.0, 0.2, 0.0), atol=1e-12)


def test_a_joint_of_an_odd_type_on_the_way_to_the_tip_is_refused(
    tmp_path: Path,
) -> None:
    text = arm().replace('type="revolute"', 'type="floating"', 1)
    with pytest.raises(RobotFileError, match=r"'j1', type.*on the way to the tip"):
        read_description(written(tmp_path, text), "l6")


def test_prefixes_that_nobody_declared_are_read_over(tmp_path: Path) -> None:
    extra = '<gazebo:sensor xacro:name="x"/>'
    assert len(read_description(written(tmp_path, arm(extra)), "l6").moving) == 6


def mesh_in(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / "part.stl").write_bytes(b"")


@pytest.mark.parametrize(
    ("uri", "place"),
    [
        ("package://arm_description/meshes/part.stl", "download-main/meshes"),
        ("package://other_parts/part.stl", "other_parts"),
        ("../meshes/part.stl", "download-main/meshes"),
        ("model://far/part.stl", "elsewhere/far"),
    ],
    ids=["package.xml", "sibling", "relative", "field"],
)
def test_meshes_are_found_by_their_package(
    tmp_path: Path, uri: str, place: str
) -> None:
    package = tmp_path / "ws" / "download-main"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package><name>arm_description</name></package>", encoding="utf-8"
    )
    mesh_in(tmp_path / "ws" / place)
    text = arm(shapes=MESH.format(role="collision", name=uri))
    elsewhere = (str(tmp_path / "ws" / "elsewhere"),)
    facts = read_description(written(package / "urdf", text), "l6", elsewhere)
    (shape,) = facts.shapes
    assert shape.mesh == str(tmp_path / "ws" / place / "part.stl")
    assert facts.notes == ()


def test_nothing_outside_the_package_is_read(tmp_path: Path) -> None:
    package = tmp_path / "a" / "b" / "arm"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<name>arm</name>", encoding="utf-8")
    (tmp_path / "secret.stl").write_bytes(b"")
    text = arm(shapes=MESH.format(role="visual", name="../../../../secret.stl"))
    facts = read_description(written(package / "urdf", text), "l6")
    assert facts.shapes == ()
    assert "not found" in facts.notes[0]


def test_a_tip_stands_on_a_link_as_the_task_says(tmp_path: Path) -> None:
    model = written(tmp_path, arm())
    foot = arm_kinematics(Robot(model, tip_frame="l6"))
    tip = Tip("l6", (0.0, 0.02, 0.05), (0.0, math.pi / 2, 0.0), 0.01, 0.1)
    robot = Robot(model, tip=tip)
    kin = arm_kinematics(robot)
    q = np.linspace(-1.0, 1.0, 6)
    R, p = foot.tip_pose(q)
    np.testing.assert_allclose(
        kin.tip_pose(q)[1], p + R @ (0.1, 0.02, 0.05), atol=1e-12
    )
    assert (robot.tip_radius, robot.tip_length) == (0.01, 0.1)


def test_a_tip_excludes_the_fields_it_replaces(tmp_path: Path) -> None:
    model = written(tmp_path, arm())
    with pytest.raises(InputError, match="tip_frame and tip"):
        Robot(model, tip_frame="l6", tip=Tip("l6"))
    with pytest.raises(InputError, match="tip_radius and tip"):
        Robot(model, tip_radius=0.03, tip=Tip("l6"))
    sets = [f"robots=[{{model: {model}, tip: {{link: l6}}, tip_length: 0.3}}]"]
    with pytest.raises(TaskError, match=r"robots\[0\].tip_length: 0.3 is not allowed"):
        pps.load_task("rear-push-rear", sets)
    with pytest.raises(TaskError, match=r"robots\[0\].tip.link: 'l9'"):
        pps.load_task(
            "rear-push-rear", [f"robots=[{{model: {model}, tip: {{link: l9}}}}]"]
        )


def test_a_task_with_a_tip_is_written_and_read_again(tmp_path: Path) -> None:
    model = written(tmp_path, arm())
    robot = f"{{model: {model}, tip: {{link: l6, radius: 0.015}}}}"
    task = pps.load_task("rear-push-rear", [f"robots=[{robot}]"])
    path = tmp_path / "task.yaml"
    path.write_text(pps.dump_task(task), encoding="utf-8")
    assert pps.load_task(path).robots == task.robots


def test_the_ready_posture_points_the_tool_down_over_the_workspace(
    tmp_path: Path,
) -> None:
    kin = arm_kinematics(Robot(written(tmp_path, arm()), tip=Tip("l6")))
    R, p = kin.tip_pose(kin.facts.home)
    np.testing.assert_allclose(R[:, 2], (0.0, 0.0, -1.0), atol=1e-5)
    assert p[0] > 0.25
    assert abs(p[1]) < 1e-4
    assert p[2] > 0.05
    assert kin.joint_margin(kin.facts.home) > 0.3


def test_the_ready_posture_of_the_task_is_taken(tmp_path: Path) -> None:
    model = written(tmp_path, arm())
    home = (0.1, -0.2, 0.3, -0.4, 0.5, -0.6)
    assert robot_facts(Robot(model, tip_frame="l6", home=home)).home_posture == home
    with pytest.raises(
        RobotFileError, match=r"home_deg.*6 numbers, one for each of j1"
    ):
        robot_facts(Robot(model, tip_frame="l6", home=home[:5]))
    with pytest.raises(
        RobotFileError, match=r"home_deg: 171.887.*in \[-166.2, 166.2\]"
    ):
        robot_facts(Robot(model, tip_frame="l6", home=(3.0, *home[1:])))


def test_joints_without_a_rotor_get_one_by_their_effort(tmp_path: Path) -> None:
    model = written(tmp_path, arm())
    facts = robot_facts(Robot(model, tip_frame="l6"))
    np.testing.assert_allclose(facts.armature, 100.0 * ROTOR)
    assert "assumed: rotors" in facts.notes[-1]
    own = (0.1, 0.2, 0.3, 0.4, 0.5, 0.0)
    facts = robot_facts(Robot(model, tip_frame="l6", rotor_inertia=own))
    assert tuple(facts.armature) == own
    assert facts.notes == ()


def test_rotors_of_the_file_stay(tmp_path: Path) -> None:
    rotor = (
        '<transmission><joint name="j{i}"/><actuator><drake:rotor_inertia value="2e-5"/>'
        '<drake:gear_ratio value="100"/></actuator></transmission>'
    )
    text = arm(*(rotor.format(i=i) for i in range(1, 7)))
    facts = robot_facts(Robot(written(tmp_path, text), tip_frame="l6"))
    np.testing.assert_allclose(facts.armature, 0.2)
    assert facts.notes == ()


def test_a_changed_file_is_read_again(tmp_path: Path) -> None:
    robot = Robot(written(tmp_path, arm()), tip_frame="l6")
    assert robot_facts(robot).moving[0].effort == 100.0
    path = Path(robot.model)
    changed = path.stat().st_mtime_ns + 10**9
    path.write_text(arm().replace('effort="100"', 'effort="50"', 1), encoding="utf-8")
    import os

    os.utime(path, ns=(changed, changed))
    assert robot_facts(robot).moving[0].effort == 50.0


def test_limits_by_a_joints_name_take_the_place_of_those_of_the_file(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, arm())
    limits = (JointLimits("j2", (-1.0, 1.5), 0.7, 60.0), JointLimits("j4", speed=1.5))
    facts = robot_facts(Robot(path, tip=Tip("l6"), limits=limits))
    _, second, _, fourth, _, _ = facts.moving
    assert (second.lower, second.upper) == (-1.0, 1.5)
    assert (second.velocity, second.effort) == (0.7, 60.0)
    assert (fourth.lower, fourth.velocity, fourth.effort) == (-2.9, 1.5, 100.0)
    assert second.rotor_inertia == pytest.approx(60.0 * ROTOR)


def test_limits_of_a_slide_are_in_metres(tmp_path: Path) -> None:
    text = arm().replace('"revolute"', '"prismatic"', 1)
    limit = JointLimits("j1", (math.radians(0.1), math.radians(0.6)), math.radians(0.2))
    facts = robot_facts(Robot(written(tmp_path, text), tip=Tip("l6"), limits=(limit,)))
    slide = facts.moving[0]
    figures = (slide.lower, slide.upper, slide.velocity)
    assert figures == pytest.approx((0.1, 0.6, 0.2))


def test_gear_ratios_multiply_the_motors_inertia_and_friction_is_damping(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, arm())
    robot = Robot(
        path,
        tip=Tip("l6"),
        rotor_inertia=(1e-4,) * 6,
        gear_ratio=(100.0,) * 6,
        joint_friction=(0.5,) * 6,
    )
    facts = robot_facts(robot)
    np.testing.assert_allclose(facts.armature, 1.0)
    assert {joint.damping for joint in facts.moving} == {0.5}


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ((JointLimits("elbow"),), r"limits\[\]\.joint: 'elbow'.*j1, j2"),
        ((JointLimits("j1", (1.0, -1.0)),), "lower < upper"),
    ],
)
def test_limits_that_fit_no_joint_are_refused(tmp_path, limits, message) -> None:
    robot = Robot(written(tmp_path, arm()), tip=Tip("l6"), limits=limits)
    with pytest.raises(RobotFileError, match=message):
        robot_facts(robot)


@pytest.mark.parametrize("limit", ["", 'effort="0" velocity="0"'])
def test_a_file_without_limits_is_refused_with_the_lines_that_fill_them(
    tmp_path: Path, limit: str
) -> None:
    path = written(tmp_path, arm().replace('effort="100" velocity="2"', limit, 1))
    base = f"model: {path}, tip: {{link: l6}}"
    with pytest.raises(TaskError, match=r"robots\[0\]\.limits") as caught:
        pps.load_task("rear-push-rear", [f"robots=[{{{base}}}]"])
    asked = "[{joint: j1, speed_deg_s: ..., torque: ...}]"
    assert asked in str(caught.value)
    filled = asked.replace("s: ...", "s: 115").replace("e: ...", "e: 100")
    task = pps.load_task("rear-push-rear", [f"robots=[{{{base}, limits: {filled}}}]"])
    (limit,) = task.robots[0].limits or ()
    assert limit.speed == pytest.approx(math.radians(115.0))


def test_a_joint_too_weak_for_its_own_arm_is_refused_at_load(tmp_path: Path) -> None:
    path = written(tmp_path, arm())
    base = f"model: {path}, tip: {{link: l6}}"
    weak = f"robots=[{{{base}, limits: [{{joint: j2, torque: 1}}]}}]"
    with pytest.raises(TaskError, match=r"robots\[0\]\.limits: torque 1 of joint 'j2'"):
        pps.load_task("rear-push-rear", [weak])


def test_a_press_beyond_the_arms_torques_is_refused_by_plan() -> None:
    sets = ["motion.press_force=180", "limits.normal_force=250"]
    task = pps.load_task("press-slide", sets)
    with pytest.raises(pps.InfeasibleTaskError, match=r"panda gives at most 1\d\d"):
        pps.plan(task)
