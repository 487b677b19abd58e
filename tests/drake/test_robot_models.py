"""The robots in the physics engine agree with the array kinematics and with the makers'
published models.
"""

import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import ProximityProperties
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import DiagramBuilder

from pushpressslide.core.errors import RobotFileError, TaskError
from pushpressslide.core.scene import MODELS, Robot, Tip
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.facts import TIP, TIP_MASS, load_facts
from pushpressslide.robots.sheet import gravity_torque
from pushpressslide.robots.urdf import urdf_text
from pushpressslide.sim.robot_models import (
    DRAKE_MODELS,
    DRAKE_MODELS_VARIABLE,
    add_robot,
)

DRAKE_MODELS_COPY = (
    Path(__file__).resolve().parents[2].parent / "shared" / "data" / "drake_models"
)
needs_copy = pytest.mark.skipif(
    not (DRAKE_MODELS_COPY / "package.xml").is_file(),
    reason="no copy of Drake's models in ../shared/data/drake_models",
)


def build(robot, **options):
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
    instance = add_robot(plant, robot, 0, **options)
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    return plant, instance, plant.GetMyMutableContextFromRoot(context), scene_graph


def random_postures(facts, count=20):
    rng = np.random.default_rng(7)
    return facts.lower + rng.random((count, facts.size)) * (facts.upper - facts.lower)


def tip_of(plant, instance, context, q):
    plant.SetPositions(context, instance.model_instance, q)
    X = instance.tip_frame.CalcPoseInWorld(context)
    world = plant.world_frame()
    J = plant.CalcJacobianSpatialVelocity(
        context, JacobianWrtVariable.kV, instance.tip_frame, np.zeros(3), world, world
    )
    return X.rotation().matrix(), X.translation(), J


def assert_kinematics_agree(robot, **options):
    kin = arm_kinematics(robot)
    plant, instance, context, _ = build(robot, **options)
    for q in random_postures(kin.facts):
        for ours, drakes in zip(
            kin.tip_and_jacobian(q), tip_of(plant, instance, context, q), strict=True
        ):
            np.testing.assert_allclose(ours, drakes, atol=1e-10)


@pytest.mark.parametrize("model", MODELS)
def test_array_kinematics_equal_the_generated_models(model):
    assert_kinematics_agree(Robot(model, (0.1, -0.2, 0.3), 0.7, tip_length=0.12))


@pytest.mark.parametrize("model", MODELS)
def test_limits_and_rotors_arrive_in_the_plant(model):
    plant, instance, context, _ = build(Robot(model, (0.0, 0.0, 0.0)))
    facts = instance.facts
    np.testing.assert_array_equal(plant.GetPositionLowerLimits(), facts.lower)
    np.testing.assert_array_equal(plant.GetPositionUpperLimits(), facts.upper)
    np.testing.assert_array_equal(plant.GetVelocityUpperLimits(), facts.velocity_limit)
    np.testing.assert_array_equal(plant.GetEffortUpperLimits(), facts.effort_limit)
    joints = [
        plant.get_joint(i).name()
        for i in plant.GetJointIndices(instance.model_instance)
    ]
    assert [name for name in joints if name in {j.name for j in facts.moving}] == [
        j.name for j in facts.moving
    ]
    plant.SetPositions(context, facts.home)
    rigid, _, bare, _ = build(Robot(model, (0.0, 0.0, 0.0)))
    for index in rigid.GetJointActuatorIndices():
        rigid.get_joint_actuator(index).SetRotorInertia(bare, 0.0)
    rigid.SetPositions(bare, facts.home)
    rotors = plant.CalcMassMatrix(context) - rigid.CalcMassMatrix(bare)
    np.testing.assert_allclose(rotors, np.diag(facts.armature), atol=1e-12)


def test_the_hand_weighs_half_a_kilogram():
    plant, instance, context, _ = build(Robot("hand", (0.0, 0.0, 0.0)))
    assert plant.CalcTotalMass(context, [instance.model_instance]) == pytest.approx(0.5)
    assert np.all(np.linalg.eigvalsh(plant.CalcMassMatrix(context)) > 0)


def official_text(model):
    """The published file, its rounded quarter turns made exact, so that models compare
    to 1e-8.
    """
    path = DRAKE_MODELS_COPY / DRAKE_MODELS[model].removeprefix(
        "package://drake_models/"
    )
    text = re.sub(
        r"<visual.*?</visual>|<collision>.*?</collision>",
        "",
        path.read_text(),
        flags=re.S,
    )
    for rounded, exact in (
        ("1.570796327", math.pi / 2),
        ("3.14159", math.pi),
        ("1.5708", math.pi / 2),
    ):
        text = re.sub(rf"(?<![\d.]){re.escape(rounded)}(?=[\s\"<])", repr(exact), text)
    return text, path.suffix[1:]


@needs_copy
@pytest.mark.parametrize("model", ["panda", "iiwa7"])
def test_the_generated_arm_equals_the_published_one(model):
    facts = load_facts(model)
    plants = []
    for text, kind in ((urdf_text(facts), "urdf"), official_text(model)):
        plant = MultibodyPlant(0.0)
        Parser(plant).AddModelsFromString(text, kind)
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(facts.base))
        plant.Finalize()
        plants.append((plant, plant.CreateDefaultContext()))
    last = facts.moving[-1].child
    for q in random_postures(facts):
        quantities = []
        for plant, context in plants:
            plant.SetPositions(context, q)
            X = plant.GetFrameByName(last).CalcPoseInWorld(context)
            gravity = plant.CalcGravityGeneralizedForces(context)
            quantities.append(
                (X.GetAsMatrix34(), plant.CalcMassMatrix(context), gravity)
            )
        for ours, published in zip(*quantities, strict=True):
            np.testing.assert_allclose(ours, published, atol=1e-8)


@needs_copy
@pytest.mark.parametrize("model", ["panda", "iiwa7"])
def test_drakes_own_models_carry_our_tip(model, monkeypatch):
    monkeypatch.setenv(DRAKE_MODELS_VARIABLE, str(DRAKE_MODELS_COPY))
    robot = Robot(model, (0.1, -0.2, 0.3), 0.7)
    plant, instance, context, _ = build(robot, models="drake_models")
    kin = arm_kinematics(robot)
    for q in random_postures(kin.facts):
        R, p, _ = tip_of(plant, instance, context, q)
        # The published iiwa7 rounds its quarter turns to five decimals.
        np.testing.assert_allclose(R, kin.tip_pose(q)[0], atol=1e-5)
        np.testing.assert_allclose(p, kin.tip_pose(q)[1], atol=1e-5)
    np.testing.assert_array_equal(plant.GetEffortUpperLimits(), kin.facts.effort_limit)


def test_a_folder_without_drakes_models_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv(DRAKE_MODELS_VARIABLE, str(tmp_path))
    with pytest.raises(TaskError, match=r"package\.xml"):
        build(Robot("panda", (0.0, 0.0, 0.0)), models="drake_models")


@pytest.mark.parametrize("model", MODELS)
def test_the_reaction_at_the_tip_joint_is_the_weight_of_the_tip_at_rest(model):
    plant, instance, context, _ = build(Robot(model, (0.0, 0.0, 0.0)))
    plant.SetPositions(context, instance.facts.home)
    holding = -plant.CalcGravityGeneralizedForces(context)
    plant.get_actuation_input_port(instance.model_instance).FixValue(context, holding)
    joint = plant.GetJointByName(instance.tip_joint_name, instance.model_instance)
    reaction = plant.get_reaction_forces_output_port().Eval(context)[int(joint.index())]
    force = (
        instance.tip_frame.CalcRotationMatrixInWorld(context).matrix()
        @ reaction.translational()
    )
    np.testing.assert_allclose(force, [0.0, 0.0, 9.81 * TIP_MASS], atol=1e-9)


def test_only_the_tip_touches_unless_capsules_are_asked_for():
    bare = build(Robot("panda", (0.0, 0.0, 0.0)))
    touching = build(
        Robot("panda", (0.0, 0.0, 0.0)), tip_properties=ProximityProperties()
    )
    full = build(Robot("panda", (0.0, 0.0, 0.0)), collision=True)
    assert bare[1].tip_geometry is None
    assert bare[0].num_collision_geometries() == 0
    assert touching[0].num_collision_geometries() == 1
    assert full[0].num_collision_geometries() == len(load_facts("panda").capsules) + 2
    name = touching[3].model_inspector().GetName(touching[1].tip_geometry)
    assert name.endswith("tip_sphere")


@pytest.mark.parametrize("model", [model for model in MODELS if model != "hand"])
def test_the_capsules_do_not_touch_each_other_in_the_home_posture(model):
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
    instance = add_robot(plant, Robot(model, (0.0, 0.0, 0.0)), 0, collision=True)
    plant.Finalize()
    context = builder.Build().CreateDefaultContext()
    own = plant.GetMyMutableContextFromRoot(context)
    plant.SetPositions(own, instance.facts.home)
    query = plant.get_geometry_query_input_port().Eval(own)
    pairs = query.ComputeSignedDistancePairwiseClosestPoints(0.1)
    assert all(pair.distance > 0.005 for pair in pairs)
    assert scene_graph.model_inspector().num_geometries() > 0


def test_two_robots_of_one_kind_stand_side_by_side():
    plant = MultibodyPlant(0.0)
    left, right = (
        add_robot(plant, Robot("iiwa7", (0.0, y, 0.2)), i)
        for i, y in enumerate((0.5, -0.5))
    )
    plant.Finalize()
    assert left.name != right.name
    assert plant.num_positions() == 14
    assert left.tip_geometry is None


def test_a_raised_base_gets_a_pedestal_and_the_free_hand_none():
    def count(robot):
        return build(robot)[3].model_inspector().num_geometries()

    assert (
        count(Robot("panda", (0.0, 0.0, 0.4)))
        == count(Robot("panda", (0.0, 0.0, 0.0))) + 2
    )
    assert count(Robot("hand", (0.0, 0.0, 0.4))) == count(
        Robot("hand", (0.0, 0.0, 0.0))
    )


def arm_file(folder, edit=lambda text: text, name="arm.urdf"):
    """A URDF as a user might have: our iiwa7 with a frame at the tip."""
    frame = (
        '<frame name="tcp" link="iiwa_flange" xyz="0.01 0 0.2" rpy="0 0.1 0"/></robot>'
    )
    path = folder / name
    path.write_text(edit(urdf_text(load_facts("iiwa7")).replace("</robot>", frame)))
    return str(path)


def test_a_robot_given_by_its_urdf_has_the_kinematics_of_the_file(tmp_path):
    robot = Robot(arm_file(tmp_path), (0.1, 0.2, 0.3), -0.5, tip_frame="tcp")
    assert_kinematics_agree(robot)
    plant, instance, _, _ = build(robot, tip_properties=ProximityProperties())
    assert instance.tip_geometry is not None
    np.testing.assert_array_equal(
        plant.GetEffortUpperLimits(), load_facts("iiwa7").effort_limit
    )


def test_a_urdf_without_transmissions_is_driven_all_the_same(tmp_path):
    path = arm_file(
        tmp_path, lambda text: re.sub(r"<transmission.*?</transmission>", "", text)
    )
    plant, _, _, _ = build(Robot(path, (0.0, 0.0, 0.0), tip_frame="tcp"))
    np.testing.assert_array_equal(
        plant.GetEffortUpperLimits(), load_facts("iiwa7").effort_limit
    )


def test_links_and_joints_of_a_robot_may_be_called_tip(tmp_path):
    def named_tip(text):
        named = text.replace('"iiwa_link_7"', '"tip"')
        return named.replace('"iiwa_joint_7"', '"tip_joint"')

    robot = Robot(arm_file(tmp_path, named_tip), (0.1, 0.2, 0.3), tip_frame="tcp")
    assert "tip" in Path(robot.model).read_text()
    assert_kinematics_agree(robot)
    poses = arm_kinematics(robot).link_poses(arm_kinematics(robot).facts.home)
    assert not np.allclose(poses["tip"][1], poses[TIP][1])


@needs_copy
def test_a_robot_given_by_its_sdf_has_the_kinematics_of_the_file(tmp_path):
    text, _ = official_text("iiwa7")
    path = tmp_path / "iiwa.sdf"
    path.write_text(text)
    assert_kinematics_agree(
        Robot(str(path), (0.0, 0.1, 0.2), 0.4, tip_frame="iiwa_link_7")
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"model": "ur5"}, "panda, iiwa7, .*hand"),
        ({"model": "nowhere.urdf"}, "no such file"),
        ({"tip_frame": None}, "needs tip, .* or tip_frame"),
        ({"tip_frame": "tpc"}, "no frame 'tpc'.*tcp"),
    ],
)
def test_a_model_that_is_not_there_is_refused_with_its_field(tmp_path, change, message):
    robot = Robot(arm_file(tmp_path), (0.0, 0.0, 0.0), tip_frame="tcp")
    with pytest.raises(TaskError, match=message) as caught:
        build(dataclasses.replace(robot, **change), source="task.yaml")
    assert str(caught.value).startswith("task.yaml: robots[0].model")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "edit", "message"),
    [
        ({}, lambda text: text[:200], "not XML"),
        (
            {},
            lambda text: text.replace('type="revolute"', 'type="planar"', 1),
            "planar",
        ),
        (
            {},
            lambda text: text.replace('name="iiwa_link_0"', 'name="base"', 1),
            "iiwa_link_0",
        ),
    ],
)
def test_a_model_that_cannot_be_used_is_refused_in_one_line(
    tmp_path, change, edit, message
):
    robot = Robot(
        arm_file(tmp_path, edit or (lambda text: text)),
        (0.0, 0.0, 0.0),
        tip_frame="tcp",
    )
    with pytest.raises(RobotFileError, match=message) as caught:
        build(dataclasses.replace(robot, **change), source="task.yaml")
    assert str(caught.value).startswith(f"{robot.model}: ")
    assert "\n" not in str(caught.value)


def test_a_base_that_the_file_holds_in_the_world_stands_where_the_task_says(tmp_path):
    def held(text):
        joint = '<joint name="held" type="fixed"><parent link="world"/><child link="iiwa_link_0"/></joint>'
        return text.replace("</robot>", f'<link name="world"/>{joint}</robot>')

    robot = Robot(arm_file(tmp_path, held), (0.1, 0.2, 0.3), 0.4, tip_frame="tcp")
    assert_kinematics_agree(robot)


def test_joints_beyond_the_tip_are_held(tmp_path):
    robot = Robot(arm_file(tmp_path), (0.0, 0.1, 0.2), 0.4, tip_frame="iiwa_link_4")
    assert_kinematics_agree(robot)


def test_a_rod_on_a_link_of_a_file_is_built_and_reaches_as_far(tmp_path):
    tip = Tip("iiwa_link_7", (0.0, 0.01, 0.04), (0.1, 0.0, 0.3), 0.015, 0.2)
    robot = Robot(arm_file(tmp_path), (0.0, 0.1, 0.2), 0.4, tip=tip)
    assert_kinematics_agree(robot)
    _, instance, _, _ = build(robot)
    assert instance.tip_body.default_mass() > 0.0


def test_the_weight_of_an_arm_is_that_in_the_plant(tmp_path):
    robot = Robot(arm_file(tmp_path), (0.0, 0.1, 0.2), 0.4, tip_frame="tcp")
    plant, instance, context, _ = build(robot)
    kin = arm_kinematics(robot)
    for q in random_postures(kin.facts):
        plant.SetPositions(context, instance.model_instance, q)
        weight = -plant.CalcGravityGeneralizedForces(context)
        np.testing.assert_allclose(gravity_torque(kin, q[None])[0], weight, atol=1e-4)
