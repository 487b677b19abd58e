"""Objects in URDF, SDF and MJCF files: their form, mass and centre of mass."""

import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.taskfile.load import dump_task, task_from_data
from pushpressslide.taskfile.mesh_file import read_mesh

INERTIA = '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/>'
URDF = f"""<robot name="tee"><link name="bar">
<inertial><origin xyz="0 0.01 0.02"/><mass value="0.3"/>{INERTIA}</inertial>
<collision><origin xyz="0 0 0.02"/><geometry><box size="0.12 0.03 0.04"/></geometry>
</collision></link>
<link name="stem"><inertial><mass value="0.1"/>{INERTIA}</inertial>
<collision><geometry><box size="0.03 0.06 0.04"/></geometry></collision></link>
<joint name="weld" type="fixed"><parent link="bar"/><child link="stem"/>
<origin xyz="0 -0.045 0.02"/></joint></robot>"""
SDF = """<sdf version="1.7"><model name="mug"><link name="body">
<inertial><pose>0.01 0 0.04 0 0 0</pose><mass>0.31</mass>
<inertia><ixx>3e-4</ixx><iyy>3e-4</iyy><izz>3e-4</izz></inertia></inertial>
<collision name="wall"><pose>0 0 0.045 0 0 0</pose><geometry><cylinder>
<radius>0.04</radius><length>0.09</length></cylinder></geometry>
<surface><friction><ode><mu>0.6</mu></ode></friction></surface></collision>
<collision name="handle"><pose>0.05 0 0.05 0 0 0</pose><geometry>
<box><size>0.03 0.012 0.05</size></box></geometry></collision></link></model></sdf>"""
MJCF = """<mujoco><asset><mesh name="brick" file="brick.msh"/></asset><worldbody>
<body name="brick"><freejoint/>
<inertial pos="0.01 0 0.03" mass="0.4" diaginertia="1e-3 1e-3 1e-3"/>
<geom type="mesh" mesh="brick" friction="0.8 0.005 0.0001"/></body>
</worldbody></mujoco>"""


def brick_file(path: Path) -> None:
    """Write a box of 120 x 80 x 60 mm in MuJoCo's own format for meshes."""
    mesh = trimesh.creation.box((0.12, 0.08, 0.06))
    counts = struct.pack("<4i", len(mesh.vertices), 0, 0, len(mesh.faces))
    points = np.asarray(mesh.vertices, dtype="<f4").tobytes()
    path.write_bytes(counts + points + np.asarray(mesh.faces, dtype="<i4").tobytes())


def written(folder: Path, name: str, text: str) -> str:
    file = folder / name
    file.write_text(text)
    brick_file(folder / "brick.msh")
    return str(file)


def task_of(path: str, **fields: object) -> Task:
    data = {
        "name": "object",
        "object": {"shape": {"mesh": path}, **fields},
        "start": {"x": 0.45, "y": 0.0},
        "goal": {"x": 0.45, "y": 0.1},
        "robots": [{"model": "panda"}],
    }
    return task_from_data(data, "object.yaml")


def test_links_that_are_fixed_to_each_other_are_one_object(tmp_path: Path) -> None:
    """Mass and centre of mass are those of both links, whose areas are 0.12 x 0.03 and
    0.03 x 0.06 m^2.
    """
    body = task_of(written(tmp_path, "tee.urdf", URDF)).object
    assert body.mass == pytest.approx(0.4)
    assert body.center_of_mass == pytest.approx((0.0, (0.3 * 0.01 - 0.1 * 0.045) / 0.4))
    assert body.shape.base_area == pytest.approx(0.12 * 0.03 + 0.03 * 0.06, rel=1e-3)
    assert not body.shape.convex


def test_primitive_shapes_become_the_body_that_they_are(tmp_path: Path) -> None:
    body = task_of(written(tmp_path, "mug.sdf", SDF)).object
    assert body.mass == pytest.approx(0.31)
    assert body.center_of_mass == pytest.approx((0.01, 0.0))
    assert isinstance(body.shape, MeshBody)
    assert body.shape.height == pytest.approx(0.09)
    _, x_max, _, _ = body.shape.section(0.05).bounds(Pose2())
    assert x_max == pytest.approx(0.065, abs=1e-4)
    _, x_max, _, _ = body.shape.section(0.01).bounds(Pose2())
    assert x_max == pytest.approx(0.04, abs=1e-4)
    assert "gives frictions 0.6" in body.shape.note


def test_a_free_body_of_mujoco_is_read_with_its_binary_mesh(tmp_path: Path) -> None:
    body = task_of(written(tmp_path, "brick.xml", MJCF)).object
    assert body.mass == pytest.approx(0.4)
    assert body.center_of_mass == pytest.approx((0.01, 0.0))
    assert body.shape.height == pytest.approx(0.06)
    assert body.shape.base_area == pytest.approx(0.12 * 0.08)


def test_mass_and_centre_in_the_task_come_first(tmp_path: Path) -> None:
    path = written(tmp_path, "mug.sdf", SDF)
    body = task_of(path, mass=1.2, center_of_mass=[0.0, 0.005]).object
    assert body.mass == 1.2
    assert body.center_of_mass == (0.0, 0.005)


def test_a_mesh_alone_needs_a_mass_in_the_task(tmp_path: Path) -> None:
    mesh = tmp_path / "box.stl"
    trimesh.creation.box((0.1, 0.1, 0.1)).export(mesh)
    with pytest.raises(TaskError, match=r"object\.mass: .*it is missing"):
        task_of(str(mesh))


def test_a_task_with_an_object_from_its_file_comes_back(tmp_path: Path) -> None:
    task = task_of(written(tmp_path, "mug.sdf", SDF))
    file = tmp_path / "again.yaml"
    file.write_text(dump_task(task))
    from pushpressslide.taskfile.load import load_task

    assert load_task(file).object == task.object


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<robot name='a'><link name='b'/></robot>", "it holds no shapes"),
        ("<html/>", "its root is <html>"),
        ("nothing", "it is not XML"),
    ],
)
def test_a_file_without_an_object_is_refused(
    text: str, words: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=words):
        read_mesh(written(tmp_path, "object.urdf", text), 1.0)


def test_a_broken_mesh_of_an_object_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "brick.xml", MJCF)
    (tmp_path / "brick.msh").write_bytes(b"0" * 40)
    with pytest.raises(ValueError, match=r"brick\.msh cannot be read"):
        read_mesh(path, 1.0)
