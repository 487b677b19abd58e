"""Mesh files as programs write them: split corners, several bodies, gaps, axes, units."""

import json
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shapes import Box, Compound, MeshSolid, Part, Prism
from pushpressslide.report.plan_files import plan_from_dict, plan_to_dict
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data
from pushpressslide.taskfile.mesh_file import read_mesh
from pushpressslide.taskfile.mesh_surface import TURNS

SIZE = (0.12, 0.08, 0.06)
BOX_CORNERS = ((-0.06, -0.04), (0.06, -0.04), (0.06, 0.04), (-0.06, 0.04))


def box(size: tuple[float, ...] = SIZE, at: tuple[float, ...] = (0.0, 0.0, 0.0)):
    """Mesh of a box with its centre at a point."""
    return trimesh.creation.box(
        size, transform=trimesh.transformations.translation_matrix(at)
    )


def written(mesh: trimesh.Trimesh | trimesh.Scene, path: Path) -> str:
    mesh.export(path)
    return str(path)


def joined(*meshes: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.util.concatenate(meshes)


def without_faces(mesh: trimesh.Trimesh, *faces: int) -> trimesh.Trimesh:
    rest = np.delete(mesh.faces, faces, axis=0)
    return trimesh.Trimesh(mesh.vertices, rest, process=False)


def assert_is_box(solid: MeshSolid) -> None:
    assert solid.height == pytest.approx(SIZE[2])
    assert np.array(solid.polygon) == pytest.approx(np.array(BOX_CORNERS), abs=1e-6)
    assert solid.center == pytest.approx((0.0, 0.0), abs=1e-6)


QUADS = (
    (1, 4, 3, 2),
    (5, 6, 7, 8),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 4, 8, 7),
    (4, 1, 5, 8),
)
NORMALS = "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n"
TEXTURE = "".join(f"vt {i / 24} {i % 5 / 5}\n" for i in range(24))


def obj_text(corner: Callable[[int, int, int], str], head: Callable[[int], str]) -> str:
    """OBJ text of the box.

    ``corner`` writes a corner from its vertex, its face and its place in the file;
    ``head`` writes the lines before a face.
    """
    places = [(x, y, z) for z in (-0.03, 0.03) for x, y in BOX_CORNERS]
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in places) + NORMALS + TEXTURE
    for i, quad in enumerate(QUADS):
        words = [corner(v, i + 1, 4 * i + k + 1) for k, v in enumerate(quad)]
        text += head(i) + "f " + " ".join(words) + "\n"
    return text


@pytest.mark.parametrize(
    ("corner", "head"),
    [
        (lambda v, n, t: f"{v}", lambda _: ""),
        (lambda v, n, t: f"{v}//{n}", lambda _: ""),
        (lambda v, n, t: f"{v}/{t}", lambda _: ""),
        (lambda v, n, t: f"{v}/{t}/{n}", lambda _: ""),
        (lambda v, n, t: f"{v}/{t}/{n}", lambda i: f"usemtl m{i % 2}\n"),
        (lambda v, n, t: f"{v}//{n}", lambda i: f"o part{i}\ng side{i}\nusemtl m{i}\n"),
    ],
    ids=["plain", "normals", "texture", "both", "materials", "groups"],
)
def test_what_splits_the_corners_of_an_obj_file_does_not_open_the_solid(
    tmp_path: Path, corner: Callable[[int, int, int], str], head: Callable[[int], str]
) -> None:
    file = tmp_path / "box.obj"
    file.write_text("mtllib absent.mtl\n" + obj_text(corner, head))
    assert_is_box(read_mesh(str(file), 1.0))


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "glb", "STL"])
def test_every_format_gives_the_same_solid(tmp_path: Path, suffix: str) -> None:
    assert_is_box(read_mesh(written(box(), tmp_path / f"box.{suffix}"), 1.0))


L_CORNERS = ((0, 0), (0.16, 0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0, 0.16))


@pytest.mark.parametrize("first", range(len(L_CORNERS)))
def test_a_concave_face_of_many_corners_keeps_its_form(
    tmp_path: Path, first: int
) -> None:
    count = len(L_CORNERS)
    corners = L_CORNERS[first:] + L_CORNERS[:first]
    text = "".join(f"v {x} {y} {z}\n" for z in (0.0, 0.05) for x, y in corners)
    faces = [range(count, 0, -1), range(count + 1, 2 * count + 1)]
    for i in range(count):
        j = (i + 1) % count
        faces.append((i + 1, j + 1, count + j + 1, count + i + 1))
    text += "".join("f " + " ".join(map(str, face)) + "\n" for face in faces)
    (tmp_path / "l.obj").write_text(text)
    solid = read_mesh(str(tmp_path / "l.obj"), 1.0)
    assert solid.polygon == L_CORNERS
    exact = Prism(L_CORNERS, 0.05).centroid
    assert solid.center == pytest.approx(exact, abs=1e-6)


def gltf(folder: Path, mesh: trimesh.Trimesh) -> Path:
    """A glTF text with its buffers in files beside it."""
    for name, content in trimesh.exchange.gltf.export_gltf(mesh.scene()).items():
        (folder / name).write_bytes(content)
    return folder / "model.gltf"


def test_a_gltf_text_is_read_with_the_buffers_beside_it(tmp_path: Path) -> None:
    file = gltf(tmp_path, box())
    assert_is_box(read_mesh(str(file), 1.0))
    gltf(tmp_path, box((0.12, 0.08, 0.05)))
    assert read_mesh(str(file), 1.0).height == pytest.approx(0.05)


def test_meshes_of_a_scene_are_placed_by_its_transforms(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    half = box((0.06, 0.08, 0.06))
    scene.add_geometry(half, geom_name="half")
    for x in (-0.03, 0.03):
        place = trimesh.transformations.translation_matrix((x, 0.0, 0.0))
        scene.graph.update(f"at {x}", geometry="half", matrix=place)
    scene.graph.transforms.remove_node("half")
    assert_is_box(read_mesh(written(scene, tmp_path / "scene.glb"), 1.0))


def test_an_unknown_format_is_refused_with_those_that_are_read() -> None:
    with pytest.raises(ValueError, match=r"none of \.obj, \.stl, \.ply, \.glb, \.gltf"):
        read_mesh("part.step", 1.0)


BAR = ((0.12, 0.03, 0.04), (0.0, 0.06, 0.0))
STEM = ((0.03, 0.12, 0.04), (0.0, 0.015, 0.0))


def test_overlapping_bodies_count_as_their_union(tmp_path: Path) -> None:
    """The oracle is the compound of the same boxes."""
    tee = joined(box(*BAR), box(*STEM))
    solid = read_mesh(written(tee, tmp_path / "tee.stl"), 1.0)
    parts = [Part(Box(size), Pose2(x, y)) for size, (x, y, _) in (BAR, STEM)]
    exact = Compound(tuple(parts))
    assert np.array(solid.corners) == pytest.approx(np.array(exact.corners), abs=1e-6)
    assert solid.center == pytest.approx(exact.centroid, abs=1e-6)


def test_bodies_may_share_edges_and_whole_faces(tmp_path: Path) -> None:
    halves = [box((0.06, 0.08, 0.06), (x, 0.0, 0.0)) for x in (-0.03, 0.03)]
    assert_is_box(read_mesh(written(joined(*halves), tmp_path / "two.stl"), 1.0))


@pytest.mark.parametrize(
    ("other", "upper"),
    [
        (box((0.06, 0.06, 0.03)), SIZE[0]),
        (box((0.06, 0.06, 0.03), (0.05, 0.0, 0.015)), 0.14),
        (box((0.06, 0.06, 0.03), (0.05, 0.0, -0.015)), SIZE[0]),
    ],
    ids=["within", "higher", "lower"],
)
def test_bodies_of_different_heights_have_an_outline_at_each_height(
    tmp_path: Path, other: trimesh.Trimesh, upper: float
) -> None:
    """In the upper half, the body is as long as its bodies are there."""
    body = read_mesh(written(joined(box(), other), tmp_path / "pair.stl"), 1.0)
    assert isinstance(body, MeshBody)
    x_min, x_max, _, _ = body.section(0.045).bounds(Pose2())
    assert x_max - x_min == pytest.approx(upper, abs=1e-6)


def test_a_cavity_is_filled_and_a_solid_that_is_inside_out_is_turned(
    tmp_path: Path,
) -> None:
    inner = box((0.1, 0.06, 0.04))
    inner.invert()
    assert_is_box(read_mesh(written(joined(box(), inner), tmp_path / "h.stl"), 1.0))
    turned = box()
    turned.invert()
    assert_is_box(read_mesh(written(turned, tmp_path / "turned.stl"), 1.0))


def test_a_surface_with_a_triangle_turned_keeps_its_outline(tmp_path: Path) -> None:
    mesh = box()
    mesh.faces[0] = mesh.faces[0][::-1]
    file = written(trimesh.Trimesh(mesh.vertices, mesh.faces), tmp_path / "box.ply")
    solid = read_mesh(file, 1.0)
    x_min, x_max, y_min, y_max = solid.section(0.03).bounds(Pose2())
    assert (x_max - x_min, y_max - y_min) == pytest.approx(SIZE[:2], abs=2e-5)
    assert "do not all face outwards: at 3 edges" in solid.note


def test_a_small_gap_is_filled(tmp_path: Path) -> None:
    mesh = box()
    for face in range(len(mesh.faces)):
        file = written(without_faces(mesh, face), tmp_path / f"{face}.stl")
        assert_is_box(read_mesh(file, 1.0))
    top = np.flatnonzero(mesh.face_normals[:, 2] > 0.5)
    assert_is_box(
        read_mesh(written(without_faces(mesh, *top), tmp_path / "o.ply"), 1.0)
    )


def test_an_edge_that_only_one_side_divides_is_closed(tmp_path: Path) -> None:
    mesh = box()
    a, b, c = mesh.faces[0]
    middle = mesh.vertices[[a, b]].mean(axis=0)
    n = len(mesh.vertices)
    faces = np.vstack((mesh.faces[1:], [(a, n, c), (n, b, c)]))
    cracked = trimesh.Trimesh(np.vstack((mesh.vertices, middle)), faces, process=False)
    assert_is_box(read_mesh(written(cracked, tmp_path / "cracked.ply"), 1.0))


def test_a_surface_with_a_large_gap_keeps_its_outline(tmp_path: Path) -> None:
    can = trimesh.creation.cylinder(0.03, 0.06, sections=24)
    top = np.flatnonzero(can.face_normals[:, 2] > 0.5)
    file = written(without_faces(can, *top), tmp_path / "can.stl")
    solid = read_mesh(file, 1.0)
    assert solid.height == pytest.approx(0.06)
    assert len(solid.polygon) == 24
    assert "surface is not closed: 24 edges are open" in solid.note


def test_a_hollow_with_an_open_edge_elsewhere_stays_hollow(tmp_path: Path) -> None:
    """A cup without a strip of its wall: its floor is 5 mm above the table."""
    profile = [
        (0, 0),
        (0.04, 0),
        (0.04, 0.09),
        (0.036, 0.09),
        (0.036, 0.005),
        (0, 0.005),
    ]
    cup = trimesh.creation.revolve(np.array(profile), sections=24)
    wall = np.flatnonzero(np.hypot(*cup.triangles_center.T[:2]) > 0.0385)
    upright = [f for f in wall if abs(cup.face_normals[f, 2]) < 0.1]
    strip = upright[:6]
    body = read_mesh(written(without_faces(cup, *strip), tmp_path / "cup.ply"), 1.0)
    assert "is not closed" in body.note
    whole = read_mesh(written(cup, tmp_path / "whole.ply"), 1.0)
    assert body.top_height == pytest.approx(whole.top_height)


def test_a_corner_that_round_off_splits_is_one_corner(tmp_path: Path) -> None:
    mesh = box()
    noise = np.random.default_rng(0).uniform(-1e-9, 1e-9, (len(mesh.faces), 3, 3))
    corners = (mesh.triangles + noise).reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    split = trimesh.Trimesh(corners, faces, process=False)
    assert_is_box(read_mesh(written(split, tmp_path / "split.stl"), 1.0))


@pytest.mark.parametrize("up", TURNS)
def test_the_axis_that_points_up_is_that_of_the_file(tmp_path: Path, up: str) -> None:
    mesh = joined(box(*BAR), box(*STEM))
    upright = read_mesh(written(mesh, tmp_path / "tee.stl"), 1.0)
    turn = np.eye(4)
    turn[:3, :3] = np.array(TURNS[up]).T
    mesh.apply_transform(turn)
    solid = read_mesh(written(mesh, tmp_path / "turned.stl"), 1.0, up)
    assert np.array(solid.polygon) == pytest.approx(np.array(upright.polygon))
    assert (solid.height, *solid.center) == pytest.approx(
        (upright.height, *upright.center)
    )


@pytest.mark.parametrize("up", TURNS)
def test_the_axis_is_turned_up_by_the_shortest_rotation(up: str) -> None:
    turn = np.array(TURNS[up])
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    assert np.array_equal(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert tuple(turn @ axis) == (0.0, 0.0, 1.0)
    angle = np.arccos(0.5 * (np.trace(turn) - 1.0))
    assert angle == pytest.approx(np.arccos(axis[2]))


def data(mesh: object) -> dict:
    return {
        "name": "mesh",
        "object": {"shape": {"mesh": mesh}, "mass": 0.6},
        "robots": [{"model": "panda"}],
        "start": {"x": 0.45, "y": 0.0},
        "goal": {"x": 0.6, "y": 0.05, "yaw_deg": 20.0},
    }


@pytest.mark.parametrize("up", ["y", "-x"])
def test_the_axis_comes_back_from_task_files_and_plan_files(
    tmp_path: Path, up: str
) -> None:
    file = written(box(), tmp_path / "box.stl")
    task = task_from_data(data({"path": file, "up": up}), "mesh.yaml")
    shape = task.object.shape
    assert isinstance(shape, MeshSolid)
    assert shape.up == up
    assert f"{up} of the file up" in shape.description
    (tmp_path / "task.yaml").write_text(dump_task(task))
    assert load_task(tmp_path / "task.yaml") == task
    plan = pps.plan(task)
    read = plan_from_dict(json.loads(json.dumps(plan_to_dict(plan))), task)
    assert read == plan


def test_an_axis_that_is_none_is_refused(tmp_path: Path) -> None:
    file = written(box(), tmp_path / "box.stl")
    with pytest.raises(TaskError, match=r"mesh\.up.*one of x, y, z, -x, -y, -z"):
        task_from_data(data({"path": file, "up": "w"}), "mesh.yaml")


@pytest.mark.parametrize(
    ("factor", "scale", "words"),
    [
        (1e3, 1.0, ("120 x 80 x 60 m", "in millimetres? give scale: 0.001")),
        (1.0, 1e-3, ("0.00012 x 8e-05 x 6e-05 m", "in metres? give scale: 1")),
        (1e-3, 10.0, ("0.0012 x 0.0008 x 0.0006 m", "is scale: 10 right?")),
    ],
)
def test_an_implausible_size_is_refused_with_a_question_for_the_unit(
    tmp_path: Path, factor: float, scale: float, words: tuple[str, str]
) -> None:
    mesh = box()
    mesh.apply_scale(factor)
    file = written(mesh, tmp_path / "box.ply")
    with pytest.raises(TaskError) as error:
        task_from_data(data({"path": file, "scale": scale}), "mesh.yaml")
    line = str(error.value)
    size, question = words
    assert "object.shape.mesh.path: " in line
    assert (
        f"it is {size}, allowed 0.005 to 10 m on its longest side: {question};" in line
    )


MANY = 2_000_000


def ply_bytes(count: int) -> bytes:
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
    head += f"property float y\nproperty float z\nelement face {count}\n"
    head += "property list uchar int vertex_indices\nend_header\n"
    return head.encode() + bytes(36) + bytes(13 * count)


def gltf_tree(count: int, copies: int) -> bytes:
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}] * copies,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
        "accessors": [{"count": 3 * count}, {"count": 3}],
        "buffers": [{"byteLength": 12}],
    }
    return json.dumps(tree).encode()


def glb_bytes(count: int, copies: int) -> bytes:
    tree = gltf_tree(count, copies)
    tree += b" " * (-len(tree) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(tree), len(tree), 0x4E4F534A)
    return head + tree


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", ply_bytes(MANY)),
        ("a.glb", glb_bytes(MANY, 1)),
        ("a.glb", glb_bytes(2000, 1000)),
        ("a.gltf", gltf_tree(MANY, 1)),
    ],
    ids=["ply", "glb", "copies", "gltf"],
)
def test_too_many_triangles_are_counted_before_the_file_is_read(
    tmp_path: Path, name: str, content: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_bytes(content)
    monkeypatch.setattr("trimesh.load_mesh", lambda *_, **__: pytest.fail("read"))
    with pytest.raises(ValueError, match="2000000 triangles, allowed up to 200000"):
        read_mesh(str(tmp_path / name), 1.0)


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "glb", "gltf"])
@pytest.mark.parametrize(
    "content", [b"", b"\0" * 200, b"{}", b"[1]", b"ply\n", b"glTF"]
)
def test_a_damaged_file_is_refused(tmp_path: Path, suffix: str, content: bytes) -> None:
    file = tmp_path / f"damaged.{suffix}"
    file.write_bytes(content)
    with pytest.raises(ValueError, match=r"it cannot be read|it holds no triangles"):
        read_mesh(str(file), 1.0)


def test_the_default_axis_of_a_mesh_is_z(tmp_path: Path) -> None:
    solid = read_mesh(written(box(), tmp_path / "box.stl"), 1.0)
    assert solid == replace(solid, up="z")
    task = task_from_data(data(solid.path), "mesh.yaml")
    assert yaml.safe_load(dump_task(task))["object"]["shape"]["mesh"]["up"] == "z"
