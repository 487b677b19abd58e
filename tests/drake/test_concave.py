"""Concave objects in Drake: the volume mesh, and tasks that reach their goals."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.geometry import Convex

import pushpressslide as pps
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.pieces import convex_pieces
from pushpressslide.geometry.polygon import signed_area
from pushpressslide.geometry.shapes import Box, Compound, Cylinder, Part, Prism
from pushpressslide.planar.engine import run as run_planar
from pushpressslide.report.metrics import result
from pushpressslide.sim.engine import run as run_drake
from pushpressslide.sim.layered_mesh import layered_mesh
from pushpressslide.sim.surfaces import convex_shapes
from pushpressslide.sim.volume_mesh import VolumeMesh
from pushpressslide.taskfile.load import load_task

L_CORNERS = [[0, 0], [0.16, 0], [0.16, 0.06], [0.06, 0.06], [0.06, 0.16], [0, 0.16]]
L_SHAPE = Prism(tuple((float(x), float(y)) for x, y in L_CORNERS), 0.06)
T_PARTS = [
    {"box": [0.12, 0.03, 0.04], "pose": {"y": 0.06}},
    {"box": [0.03, 0.09, 0.04]},
]
KEY = Compound(
    (
        Part(Cylinder(0.05, 0.04), Pose2()),
        Part(Box((0.12, 0.02, 0.04)), Pose2(0.09, 0.0, 0.0)),
    )
)
KEY_PARTS = [
    {"cylinder": {"radius": 0.05, "height": 0.04}},
    {"box": [0.12, 0.02, 0.04], "pose": {"x": 0.09}},
]
# a block with a notch that is open to the robot
NOTCHED = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.1], [0.05, 0.1]]
NOTCHED += [[0.05, 0.05], [-0.05, 0.05], [-0.05, 0.1], [-0.1, 0.1]]


def volumes(mesh: VolumeMesh) -> np.ndarray:
    """Return the signed volumes (m,) [m^3] of the tetrahedra."""
    corners = np.array(mesh.vertices)[np.array(mesh.tetrahedra)]
    edges = corners[:, 1:] - corners[:, :1]
    return np.linalg.det(edges) / 6.0


@pytest.mark.parametrize("shape", [L_SHAPE, KEY], ids=["L", "key"])
def test_the_tetrahedra_fill_the_body_and_meet_face_to_face(shape) -> None:
    mesh = layered_mesh(shape.corners, shape.height).mesh
    sizes = volumes(mesh)
    assert (sizes > 0.0).all()
    whole = signed_area(shape.corners) * shape.height
    assert sizes.sum() == pytest.approx(whole, rel=1e-9)
    faces: dict[frozenset[int], int] = {}
    for cell in mesh.tetrahedra:
        for left_out in cell:
            face = frozenset(cell) - {left_out}
            faces[face] = faces.get(face, 0) + 1
    assert set(faces.values()) == {1, 2}
    # a face of one cell alone is on the surface
    area = shape.placed(Pose2())
    for face, count in faces.items():
        corners = np.array([mesh.vertices[i] for i in face])
        level = np.ptp(corners[:, 2]) < 1e-12
        base = level and abs(abs(corners[0, 2]) - 0.5 * shape.height) < 1e-12
        middle = corners.mean(axis=0)
        side = area.exterior.distance(shapely.Point(middle[:2])) < 1e-9
        assert (count == 1) == bool(base or side)


@pytest.mark.parametrize("shape", [L_SHAPE, KEY], ids=["L", "key"])
def test_inner_vertices_are_at_one_depth_under_the_surface(shape) -> None:
    layered = layered_mesh(shape.corners, shape.height)
    outline = shape.placed(Pose2()).exterior
    depths = []
    for x, y, z in layered.mesh.vertices:
        depth = min(outline.distance(shapely.Point(x, y)), 0.5 * shape.height - abs(z))
        depths.append(round(depth, 9))
    assert set(depths) == {0.0, round(layered.depth, 9)}
    assert layered.depth > 0.15 * min(shape.height, shape.breadth)


@st.composite
def star_polygons(draw) -> tuple[tuple[float, float], ...]:
    """Return a polygon that may be concave, its corners counter-clockwise [m]."""
    count = draw(st.integers(4, 10))
    radii = [draw(st.floats(0.05, 0.15)) for _ in range(count)]
    return tuple(
        (
            r * math.cos(2.0 * math.pi * i / count),
            r * math.sin(2.0 * math.pi * i / count),
        )
        for i, r in enumerate(radii)
    )


@given(star_polygons())
@settings(max_examples=60)
def test_any_outline_has_a_sound_mesh(corners: tuple[tuple[float, float], ...]) -> None:
    mesh = layered_mesh(corners, 0.05).mesh
    assert (volumes(mesh) > 0.0).all()
    assert volumes(mesh).sum() == pytest.approx(signed_area(corners) * 0.05, rel=1e-9)


def test_arms_keep_clear_of_convex_pieces() -> None:
    assert len(convex_shapes(L_SHAPE)) == len(convex_pieces(L_SHAPE.corners)) == 2
    assert all(isinstance(piece, Convex) for piece in convex_shapes(L_SHAPE))
    assert not isinstance(convex_shapes(Box((0.1, 0.1, 0.1)))[0], Convex)


def data(name: str) -> dict:
    """Return a developing task: an object of another shape, a goal that one leg
    reaches.
    """
    shared = {"name": name, "robots": [{"model": "panda", "tip_radius": 0.01}]}
    if name == "push-t":
        return {
            **shared,
            "object": {"shape": {"compound": T_PARTS}, "mass": 0.6},
            "start": {"x": 0.45, "y": -0.1, "yaw_deg": 90},
            "goal": {"x": 0.65, "y": -0.08, "yaw_deg": 80},
        }
    if name == "key":  # pushed at the round end
        return {
            **shared,
            "object": {"shape": {"compound": KEY_PARTS}, "mass": 0.7},
            "start": {"x": 0.45, "y": -0.1, "yaw_deg": 0},
            "goal": {"x": 0.63, "y": -0.09, "yaw_deg": 6},
            "motion": {"face": 3},
        }
    polygon = L_CORNERS if name == "l-shape" else NOTCHED
    starts = {"l-shape": (0.42, -0.05, 0), "notched": (0.45, 0.1, 90)}
    goals = {"l-shape": (0.58, -0.04, 8), "notched": (0.62, 0.08, 80)}
    x, y, yaw = starts[name]
    gx, gy, turned = goals[name]
    return {
        **shared,
        "object": {"shape": {"prism": {"polygon": polygon, "height": 0.06}}, "mass": 1},
        "start": {"x": x, "y": y, "yaw_deg": yaw},
        "goal": {"x": gx, "y": gy, "yaw_deg": turned},
        **({"motion": {"face": 4}} if name == "notched" else {}),
    }


CASES = [
    ("push-t", "rear_push"),
    ("push-t", "press_slide"),
    ("l-shape", "rear_push"),
    ("l-shape", "press_slide"),
    ("notched", "rear_push"),
    ("key", "rear_push"),
]


def planned(name: str, mode: str, folder: Path) -> Plan:
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump({**data(name), "modes": [mode]}))
    return pps.plan(load_task(file))


def check_reached(plan: Plan, record) -> None:
    figures = result(plan.task, plan, record, {})
    assert figures["reason"]["code"] == "goal_reached", figures["reason"]
    assert figures["final_position_error"] <= 3e-3
    assert figures["final_yaw_error"] <= math.radians(1.0)
    assert len(plan.segments) == 1 or plan.segments[0].mode == "press_slide"


@pytest.mark.parametrize(("name", "mode"), CASES)
def test_a_concave_object_reaches_its_goal_on_the_planar_engine(
    name: str, mode: str, tmp_path: Path
) -> None:
    plan = planned(name, mode, tmp_path)
    check_reached(plan, run_planar(plan))


# each shape once, either mode: the mesh is the same for both
@pytest.mark.parametrize(
    ("name", "mode"),
    [
        ("push-t", "press_slide"),
        ("l-shape", "rear_push"),
        ("notched", "rear_push"),
        ("key", "rear_push"),
    ],
)
def test_a_concave_object_reaches_its_goal_in_drake(
    name: str, mode: str, tmp_path: Path
) -> None:
    plan = planned(name, mode, tmp_path)
    check_reached(plan, run_drake(plan))


def test_a_touch_in_a_notch_begins_before_its_other_wall(tmp_path: Path) -> None:
    """The notch is 4 cm wide, the tip 2 cm, and the touch would begin 5 cm off."""
    from pushpressslide.planning.side_contacts import before_contacts

    plan = planned("notched", "rear_push", tmp_path)
    scene = plan.task.scene
    assert before_contacts(scene, plan.task.motion, plan.contacts) == 0.05
    x, y = scene.body.center_of_mass
    narrow = Prism(
        tuple((0.4 * a if abs(a) < 0.1 else float(a), float(b)) for a, b in NOTCHED),
        0.06,
    )
    body = replace(scene.body, shape=narrow)
    wall = replace(plan.contacts[0], point=(0.02 - x, 0.075 - y), normal=(1.0, 0.0))
    room = before_contacts(replace(scene, body=body), plan.task.motion, (wall,))
    assert room == pytest.approx(0.01, abs=1e-4)
