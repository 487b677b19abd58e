"""Shapes in the task file: concave prisms, compounds, meshes, and refusals."""

import math
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml

from pushpressslide import load_task
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.geometry.pieces import triangles
from pushpressslide.geometry.shapes import (
    Box,
    Compound,
    Cylinder,
    MeshSolid,
    Part,
    Prism,
)
from pushpressslide.selection.solve import plan
from pushpressslide.taskfile.load import dump_task, task_from_data
from pushpressslide.taskfile.mesh_file import read_mesh

BOX = {"box": [0.2, 0.1, 0.05]}
L_CORNERS = [[0, 0], [0.16, 0], [0.16, 0.06], [0.06, 0.06], [0.06, 0.16], [0, 0.16]]
T_PARTS = [
    {"box": [0.12, 0.03, 0.04], "pose": {"y": 0.06}},
    {"box": [0.03, 0.09, 0.04]},
]


def data(shape: object, **others: object) -> dict:
    return {
        "name": "shaped",
        "object": {"shape": shape, "mass": 0.6},
        "robots": [{"model": "panda", "tip_radius": 0.01}],
        "start": {"x": 0.45, "y": 0.0},
        "goal": {"x": 0.6, "y": 0.05, "yaw_deg": 20.0},
        **others,
    }


def task(shape: object, **others: object) -> Task:
    return task_from_data(data(shape, **others), "shaped.yaml")


def refusal(shape: object, **others: object) -> str:
    with pytest.raises(TaskError) as error:
        task(shape, **others)
    line = str(error.value)
    assert "\n" not in line
    return line


def prism(corners: object, height: float = 0.05) -> dict:
    return {"prism": {"polygon": corners, "height": height}}


def solid(corners: object, height: float, bottom: float = 0.0) -> trimesh.Trimesh:
    """Return the mesh of an upright prism on a polygon, counter-clockwise."""
    polygon = tuple((float(x), float(y)) for x, y in corners)
    n = len(polygon)
    vertices = [(x, y, bottom) for x, y in polygon]
    vertices += [(x, y, bottom + height) for x, y in polygon]
    caps = triangles(polygon)
    faces = [(c, b, a) for a, b, c in caps]
    faces += [(n + a, n + b, n + c) for a, b, c in caps]
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n + j), (i, n + j, n + i)]
    return trimesh.Trimesh(vertices, faces, process=False)


def written(mesh: trimesh.Trimesh, path: Path) -> str:
    mesh.export(path)
    return str(path)


def test_a_prism_may_be_concave_and_turn_either_way() -> None:
    shape = task(prism(L_CORNERS)).object.shape
    assert isinstance(shape, Prism)
    assert shape.corners == tuple(tuple(map(float, c)) for c in L_CORNERS)
    back = L_CORNERS[:1] + L_CORNERS[:0:-1]
    assert task(prism(back)).object.shape == shape


def test_a_corner_on_a_straight_line_is_left_out() -> None:
    """A box as a prism with a fifth corner is the prism with four, to the plan."""
    corners = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]
    plain = task(prism(corners))
    redundant = task(prism([*corners[:1], [0.02, -0.05], *corners[1:]]))
    assert redundant == plain
    assert plan(redundant) == plan(plain)


def test_a_compound_that_is_a_box_has_the_box_s_plan() -> None:
    halves = [
        {"box": [0.12, 0.1, 0.05], "pose": {"x": -0.04}},
        {"box": [0.1, 0.1, 0.05], "pose": {"x": 0.05, "yaw_deg": 180}},
    ]
    assert_same_plan(task({"compound": halves}), task(BOX))


@pytest.mark.parametrize("suffix", ["obj", "stl"])
def test_a_mesh_of_a_box_has_the_box_s_plan(suffix: str, tmp_path: Path) -> None:
    box = trimesh.creation.box((200.0, 100.0, 50.0))
    file = written(box, tmp_path / f"box.{suffix}")
    assert_same_plan(task({"mesh": {"path": file, "scale": 0.001}}), task(BOX))


def assert_same_plan(one: Task, other: Task) -> None:
    """Assert that two tasks with other words for one object have one plan, for each of
    two modes.
    """
    for mode in ("rear_push", "press_slide"):
        mine, theirs = (
            plan(task_from_data({**yaml.safe_load(dump_task(t)), "modes": [mode]}, "x"))
            for t in (one, other)
        )
        assert len(mine.segments) == len(theirs.segments)
        for a, b in zip(mine.segments, theirs.segments, strict=True):
            assert a.mode == b.mode
            assert a.path.length == pytest.approx(b.path.length, rel=1e-5)
            for p, q in zip(a.contacts, b.contacts, strict=True):
                assert p.point == pytest.approx(q.point, abs=1e-6)
                assert p.normal == pytest.approx(q.normal, abs=1e-6)
                assert p.load == pytest.approx(q.load, rel=1e-5)
            for share in (0.0, 0.3, 0.7, 1.0):
                x = a.path.pose(share * a.path.length)
                y = b.path.pose(share * b.path.length)
                assert (x.x, x.y, x.yaw) == pytest.approx((y.x, y.y, y.yaw), abs=1e-5)


def test_a_compound_is_read_and_written() -> None:
    parts = [
        *T_PARTS,
        {"cylinder": {"radius": 0.02, "height": 0.04}, "pose": {"y": -0.05}},
    ]
    loaded = task({"compound": parts})
    shape = loaded.object.shape
    assert shape == Compound(
        (
            Part(Box((0.12, 0.03, 0.04)), Pose2(0.0, 0.06)),
            Part(Box((0.03, 0.09, 0.04)), Pose2()),
            Part(Cylinder(0.02, 0.04), Pose2(0.0, -0.05)),
        )
    )
    assert task_from_data(yaml.safe_load(dump_task(loaded)), "again") == loaded
    assert loaded.object.center_of_mass == pytest.approx(shape.centroid)


def test_a_mesh_is_read_relative_to_the_task_file_and_written_with_its_path(
    tmp_path: Path,
) -> None:
    written(solid(L_CORNERS, 0.06, bottom=0.3), tmp_path / "part.stl")
    file = tmp_path / "task.yaml"
    file.write_text(yaml.safe_dump(data({"mesh": "part.stl"})))
    loaded = load_task(file)
    shape = loaded.object.shape
    assert isinstance(shape, MeshSolid)
    assert shape.height == pytest.approx(0.06)
    assert np.array(shape.corners) == pytest.approx(np.array(L_CORNERS), abs=1e-6)
    exact = Prism(tuple(map(tuple, L_CORNERS)), 0.06)
    assert loaded.object.center_of_mass == pytest.approx(exact.centroid, abs=1e-6)
    assert shape.path == str(tmp_path / "part.stl")
    elsewhere = tmp_path / "below"
    elsewhere.mkdir()
    (elsewhere / "task.yaml").write_text(dump_task(loaded))
    assert load_task(elsewhere / "task.yaml") == loaded


def test_a_mesh_with_fine_round_sides_keeps_few_corners(tmp_path: Path) -> None:
    round_solid = trimesh.creation.cylinder(0.05, 0.06, sections=400)
    shape = task({"mesh": written(round_solid, tmp_path / "disc.stl")}).object.shape
    assert 20 < len(shape.corners) < 100
    assert shape.placed(Pose2()).area == pytest.approx(math.pi * 0.05**2, rel=0.02)


def test_the_centre_of_mass_may_be_in_a_notch() -> None:
    inside_hull = {"object": {"shape": prism(L_CORNERS), "mass": 1.0}}
    inside_hull["object"]["center_of_mass"] = [0.07, 0.07]
    assert task(None, **inside_hull).object.center_of_mass == (0.07, 0.07)
    inside_hull["object"]["center_of_mass"] = [0.12, 0.12]
    line = refusal(None, **inside_hull)
    assert "object.center_of_mass: [0.12, 0.12]" in line


SLIT = [[0, 0], [0.2, 0], [0.2, 0.1], [0.11, 0.1], [0.11, 0.02], [0.1, 0.02]]
SLIT += [[0.1, 0.1], [0, 0.1]]


def test_a_face_that_no_tip_reaches_is_refused_by_name() -> None:
    line = refusal(prism(SLIT), motion={"face": 4})
    assert "motion.face: 4 is not allowed" in line
    assert "a tip of radius 10 mm cannot reach it" in line
    assert "allowed: null, 0, 1, 2, 6, 7" in line
    assert task(prism(SLIT), motion={"face": 7}).motion.face == 7


def test_a_face_that_is_not_there_is_refused() -> None:
    line = refusal(prism(L_CORNERS), motion={"face": 6})
    assert "motion.face: 6 is not allowed; allowed: null or 0 to 5" in line


@pytest.mark.parametrize(
    "shape",
    [
        {"prism": {"polygon": [[0, 0], [0.1, 0], [0.05, 0.1]], "height": 0.1}},
        {"cylinder": {"radius": 0.03, "height": 0.2}},
        {"compound": T_PARTS},
    ],
)
def test_an_obstacle_of_any_shape_comes_back_from_its_file(
    shape: dict,
) -> None:
    stand = {"name": "post", "pose": {"x": 0.5, "y": 0.5, "yaw_deg": 20}}
    loaded = task(BOX, obstacles=[{**stand, **shape}])
    written = yaml.safe_load(dump_task(loaded))
    assert task_from_data(written, "shaped.yaml") == loaded
    assert set(written["obstacles"][0]) & {"box", *shape} == set(shape)


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        ({}, ("obstacles[0]", "exactly one of box, prism")),
        ({**BOX, "compound": T_PARTS}, ("obstacles[0]", "exactly one of box, prism")),
        (
            {
                "prism": {
                    "polygon": [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1]],
                    "height": 0.1,
                }
            },
            ("obstacles[0].prism.polygon", "does not cross itself"),
        ),
    ],
)
def test_what_is_no_shape_of_an_obstacle_is_refused(
    shape: dict, words: tuple[str, ...]
) -> None:
    stand = {"name": "post", "pose": {"x": 0.5, "y": 0.5}}
    line = refusal(BOX, obstacles=[{**stand, **shape}])
    assert all(word in line for word in words)


APART = [{"box": [0.1, 0.03, 0.04]}, {"box": [0.1, 0.03, 0.04], "pose": {"x": 0.2}}]
RING = [
    {"box": [0.14, 0.02, 0.04], "pose": {"y": 0.06}},
    {"box": [0.14, 0.02, 0.04], "pose": {"y": -0.06}},
    {"box": [0.02, 0.14, 0.04], "pose": {"x": 0.06}},
    {"box": [0.02, 0.14, 0.04], "pose": {"x": -0.06}},
]
UNEQUAL = [T_PARTS[0], {"box": [0.03, 0.09, 0.05]}]


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (prism([[0, 0], [1, 1], [1, 0], [0, 1]]), ("prism.polygon", "crosses itself")),
        (
            prism([[0, 0], [0.2, 0], [0.2, 0.1], [0.1, 0.1], [0.1, 0], [0, 0.1]]),
            ("prism.polygon", "itself"),
        ),
        (
            prism([[0, 0], [0.1, 0], [0.2, 0], [0.1, 0.1], [0.1, 0.3], [0.1, 0.1001]]),
            ("prism.polygon", "turns back"),
        ),
        ({"compound": APART}, ("compound: 2 parts", "do not touch")),
        ({"compound": RING}, ("compound: 4 parts", "hole of 100 cm^2")),
        ({"compound": UNEQUAL}, ("compound[1]", "0.05", "0.04 m")),
        ({"compound": [{"pose": {"x": 0.1}}]}, ("compound[0]", "exactly one of")),
        ({"compound": [{**BOX, "mass": 1}]}, ("compound[0].mass", "unknown field")),
        (
            {"compound": [{**BOX}, {**prism([[0, 0], [1, 1], [1, 0], [0, 1]])}]},
            ("compound[1].prism.polygon", "crosses itself"),
        ),
        ({**BOX, "compound": T_PARTS}, ("object.shape:", "exactly one of box, prism")),
        ({"mesh": "nowhere.stl"}, ("mesh.path", "no such file")),
        ({"mesh": "task.step"}, ("mesh.path", "it ends in none of .obj, .stl")),
        (
            {"mesh": {"path": "a.stl", "scale": 0}},
            ("mesh.scale: 0 is not", "(0, 1000]"),
        ),
    ],
)
def test_what_is_no_shape_is_refused_in_one_line(
    shape: object, words: tuple[str, ...]
) -> None:
    line = refusal(shape)
    for part in words:
        assert part in line, line


def tilted() -> trimesh.Trimesh:
    """Return a box that stands on an edge, with its centre of mass beside it."""
    turn = trimesh.transformations.rotation_matrix(0.1, [1, 0, 0])
    return trimesh.creation.box((0.1, 0.1, 0.1), transform=turn)


def pair() -> trimesh.Trimesh:
    one = trimesh.creation.box((0.05, 0.05, 0.05))
    other = one.copy().apply_translation([0.1, 0.0, 0.0])
    return trimesh.util.concatenate([one, other])


def flat() -> trimesh.Trimesh:
    return trimesh.Trimesh([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], [(0, 1, 2)])


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (tilted, "it tips over"),
        (pair, "its footprint is not in one piece"),
        (flat, "its height 0 m is below 1 %"),
    ],
)
def test_a_mesh_of_no_body_that_stands_is_refused(
    mesh, words: str, tmp_path: Path
) -> None:
    line = refusal({"mesh": written(mesh(), tmp_path / "solid.stl")})
    assert "object.shape" in line
    assert words in line


def test_a_file_that_is_no_mesh_is_refused(tmp_path: Path) -> None:
    for text in ("", "solid nothing\nendsolid nothing\n", "v 0 0\nf 1 2 3\n"):
        for suffix in ("stl", "obj"):
            file = tmp_path / f"text.{suffix}"
            file.write_text(text)
            assert "mesh.path" in refusal({"mesh": str(file)})


def test_a_changed_mesh_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "solid.stl"
    first = task({"mesh": written(trimesh.creation.box((0.1, 0.1, 0.1)), file)})
    second = task({"mesh": written(trimesh.creation.box((0.1, 0.12, 0.1)), file)})
    assert first.object.shape.breadth == pytest.approx(0.1)
    assert second.object.shape.bounds(Pose2())[3] == pytest.approx(0.06)


def _box_obj(size: float) -> str:
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    vertices = "\n".join(
        f"v {size * x!r} {size * y!r} {size * z!r}" for x, y, z in corners
    )
    quads = ((1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7))
    faces = "\n".join("f " + " ".join(map(str, q)) for q in (*quads, (4, 1, 5, 8)))
    return f"{vertices}\n{faces}\n"


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (1e300, "a corner of it is 1e\\+300 m from its origin"),
        (float("nan"), "no finite number"),
        (float("inf"), "no finite number"),
        (
            120.0,
            r"it is 120 x 120 x 120 m, allowed .* 10 m .*: in millimetres\? give scale",
        ),
    ],
)
def test_a_mesh_beyond_all_sizes_is_refused_with_its_size(
    tmp_path: Path, size: float, words: str
) -> None:
    path = tmp_path / "box.obj"
    path.write_text(_box_obj(size))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match=words):
            read_mesh(str(path), 1.0)


@pytest.mark.parametrize("kind", ["binary.stl", "text.stl", "text.obj"])
def test_a_mesh_of_too_many_triangles_is_not_read(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / kind
    count = 200_001
    if kind == "binary.stl":
        path.write_bytes(bytes(80) + count.to_bytes(4, "little") + bytes(50 * count))
    elif kind == "text.stl":
        path.write_bytes(b"solid a\n" + b"facet\nendfacet\n" * count + b"endsolid")
    else:
        path.write_bytes(b"v 0 0 0" + b"\nf 1 1 1" * count)
    monkeypatch.setattr("trimesh.load_mesh", lambda *_, **__: pytest.fail("read"))
    with pytest.raises(ValueError, match="200001 triangles, allowed up to 200000"):
        read_mesh(str(path), 1.0)


def test_a_mesh_file_of_endless_text_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(ValueError, match="100 MB, allowed up to 64 MB"):
        read_mesh(str(path), 1.0)
