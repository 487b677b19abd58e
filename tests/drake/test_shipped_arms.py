"""The arms that come as facts equal the public files that they are from."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

import pushpressslide as pps
from pushpressslide.robots.description import read_description
from pushpressslide.robots.facts import RobotFacts, exact_angle, load_facts
from pushpressslide.robots.urdf import urdf_text


class Source(NamedTuple):
    package: str  # its name and version on PyPI
    path: str
    flange: str


DATA = "cmeel.prefix/share/example-robot-data/robots"
ERD = "example-robot-data 6.0.0"
KINOVA = "robosuite/models/assets/robots/kinova3/robot.xml"
ARMS = {
    "ur5e": Source("airo-models 0.0.12", "airo_models/arms/ur5e/ur5e.urdf", "tool0"),
    "ur10": Source(ERD, f"{DATA}/ur_description/urdf/ur10_robot.urdf", "tool0"),
    "xarm7": Source(ERD, f"{DATA}/xarm_description/urdf/xarm7.urdf", "link7"),
    "fr3": Source("franka-sim 1.1.7", "franka_sim/models/fr3.urdf", "link8"),
    "gen3": Source("robosuite 1.5.2", KINOVA, "right_hand"),
}
TASKS = ["rear-push-rear", "press-slide", "book"]


def without_rotors(facts: RobotFacts) -> RobotFacts:
    """The facts without rotors, and with exact quarter turns."""
    joints = tuple(
        replace(
            joint,
            rotor_inertia=0.0,
            rpy=tuple(exact_angle(angle) for angle in joint.rpy),
        )
        for joint in facts.joints
    )
    return replace(facts, joints=joints)


def urdf_plant(text: str, kind: str, base: str) -> MultibodyPlant:
    """The arm on its base."""
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, kind)
    frame = plant.GetFrameByName(base)
    if "world" not in text:
        plant.WeldFrames(plant.world_frame(), frame)
    plant.Finalize()
    return plant


def read_by_us(path: Path, base: str, flange: str) -> MultibodyPlant:
    facts = read_description(str(path), flange)
    return urdf_plant(urdf_text(without_rotors(facts)), "urdf", base)


def read_by_drake(path: Path, base: str, flange: str) -> MultibodyPlant:
    """The original file without its shapes, its rounded quarter turns made exact."""
    shapes = r"<(visual|collision|asset)\b.*?</\1>|<(geom|site|camera)\b[^>]*/>"
    text = re.sub(shapes, "", path.read_text(), flags=re.DOTALL)
    text = re.sub(r'<inertial [^>]*mass="0"[^>]*/>', "", text)
    text = re.sub(r'(?<=rpy=")[^"]*', exact_numbers(exact_angle), text)
    text = re.sub(r'(?<=" quat=")[^"]*', exact_numbers(exact_share), text)
    return urdf_plant(text, "xml" if "<mujoco" in text else "urdf", base)


def exact_numbers(exact: Callable[[float], float]) -> Callable[[re.Match[str]], str]:
    def replaced(match: re.Match[str]) -> str:
        return " ".join(repr(exact(float(word))) for word in match[0].split())

    return replaced


def exact_share(value: float) -> float:
    """A component of a quaternion, exact for turns by multiples of a quarter."""
    for exact in (0.0, math.sqrt(0.5), -math.sqrt(0.5), 1.0, -1.0):
        if abs(value - exact) < 1e-5:
            return exact
    return value


@pytest.mark.long
@pytest.mark.parametrize("reader", [read_by_us, read_by_drake])
@pytest.mark.parametrize("name", ARMS)
def test_a_shipped_arm_equals_its_public_file(public_file, name: str, reader) -> None:
    package, path, flange = ARMS[name]
    facts = load_facts(name)
    ours = urdf_plant(urdf_text(without_rotors(facts)), "urdf", facts.base)
    theirs = reader(public_file(package, path), facts.base, flange)
    assert theirs.num_positions() == facts.size
    rng = np.random.default_rng(3)
    contexts = [plant.CreateDefaultContext() for plant in (ours, theirs)]
    for _ in range(20):
        q = facts.lower + rng.random(facts.size) * (facts.upper - facts.lower)
        results = []
        for plant, context in zip((ours, theirs), contexts, strict=True):
            plant.SetPositions(context, q)
            pose = plant.GetFrameByName(flange).CalcPoseInWorld(context)
            results.append(
                (
                    plant.CalcMassMatrix(context),
                    plant.CalcGravityGeneralizedForces(context),
                    pose.GetAsMatrix34(),
                )
            )
        for mine, public in zip(*results, strict=True):
            np.testing.assert_allclose(mine, public, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("name", ARMS)
def test_a_source_and_its_licence_stand_beside_the_facts(name: str) -> None:
    models = Path(pps.__file__).parent / "robots" / "models"
    head = (models / f"{name}.yaml").read_text("utf-8").split("\nname:")[0]
    package, version = ARMS[name].package.split()
    assert f"{package} {version}" in head
    assert re.search(r"\((MIT|BSD|BSD-3-Clause|Apache-2.0)\)", head)


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("name", ARMS)
def test_a_shipped_arm_pushes_and_presses(name: str, task: str) -> None:
    record = pps.run(pps.load_task(task, [f"robots.0.model={name}"]), engine="drake")
    assert record.success, record.reason_text
    assert record.figures["final_position_error"] < 2e-3
    assert record.figures["final_yaw_error"] < math.radians(1.0)
