"""Meshes of supports, and surface frictions that reproduce the frictions of pairs."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.core.task import Box, Obstacle, Opening, Support
from pushpressslide.mechanics.surface_friction import (
    OBJECT_FRICTION,
    SurfaceFrictions,
    partner_friction,
)
from pushpressslide.sim.surfaces import (
    support_grid,
)
from pushpressslide.taskfile.load import load_task

WALL = SupportFrame.of_wall((0.9, 0.2, 0.7), 2.0)
SLOPE = math.radians(20.0)
INCLINE = SupportFrame(
    (0.3, 0.0, 0.1),
    (
        (1.0, 0.0, 0.0),
        (0.0, math.cos(SLOPE), -math.sin(SLOPE)),
        (0.0, math.sin(SLOPE), math.cos(SLOPE)),
    ),
)
BOUNDS = (-0.21, 0.33, -0.12, 0.17)
FRICTIONS = st.floats(0.05, 1.5)


def triangles(mesh):
    """Corners (m, 3, 3) [m] of a mesh's triangles in the world."""
    text = mesh.source().in_memory().mesh_file.contents().decode()
    rows = [line.split() for line in text.splitlines()]
    vertices = np.array([row[1:] for row in rows if row[0] == "v"], dtype=float)
    faces = np.array([row[1:] for row in rows if row[0] == "f"], dtype=int) - 1
    return vertices[faces]


def areas(corners):
    """Area vectors (m, 3) [m^2] of triangles, along their outer normals."""
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def test_the_support_s_surface_ends_at_the_edge_of_its_region() -> None:
    region = ((-0.1, -0.08), (0.25, -0.11), (0.2, 0.12), (0.05, 0.03))
    grid = support_grid(BOUNDS, 0.05, Support(region=region))
    corners = triangles(grid)
    top = shapely.Polygon(region)
    faces = shapely.polygons(corners[:, :, :2])
    assert shapely.union_all(faces).symmetric_difference(top).area < 1e-6
    upwards = areas(corners)[:, 2]
    assert (upwards > 0.0).all()
    assert upwards.sum() == pytest.approx(top.area, rel=1e-6)


@pytest.mark.parametrize(
    "frame", [TABLE, WALL, INCLINE], ids=["table", "wall", "slope"]
)
def test_a_support_lies_in_its_plane_and_faces_outwards(frame) -> None:
    kind = "table" if frame == TABLE else "wall"
    corners = triangles(support_grid(BOUNDS, 0.05, Support(kind, 0.3, frame)))
    heights = np.array([[frame.coordinates(p)[2] for p in face] for face in corners])
    plane = np.abs(heights).max(axis=1) < 1e-6
    out = areas(corners)[plane] @ np.array(frame.normal)
    assert (out > 0.0).all()
    x_min, x_max, y_min, y_max = BOUNDS
    assert out.sum() >= (x_max - x_min) * (y_max - y_min)
    # a plane that is not level has a lower edge, so that its hull is not flat
    assert plane.all() == (frame == TABLE)


def test_a_support_with_an_opening_is_closed_at_its_sides_and_back() -> None:
    opening = Opening((0.2, 0.1), (0.03, 0.02), 0.07)
    support = Support("wall", 0.3, WALL, opening)
    vectors = areas(triangles(support_grid(BOUNDS, 0.05, support)))
    x_min, x_max, y_min, y_max = BOUNDS
    whole = (x_max - x_min) * (y_max - y_min)
    # the sum of the area vectors depends on the outline alone
    np.testing.assert_allclose(
        vectors.sum(axis=0), whole * np.array(WALL.normal), atol=1e-7
    )
    sides = 2.0 * opening.depth * sum(opening.size)
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(whole + sides)


def pair(a: float, b: float) -> float:
    """Drake's friction of a pair."""
    return 2.0 * a * b / (a + b)


@given(FRICTIONS, st.floats(0.1, 4.0))
def test_a_partner_gives_the_friction_of_the_pair(wanted, own) -> None:
    if wanted >= 2.0 * own:
        with pytest.raises(ValueError, match="pair friction"):
            partner_friction(wanted, own)
    else:
        assert pair(own, partner_friction(wanted, own)) == pytest.approx(wanted)


@given(FRICTIONS, FRICTIONS, st.none() | FRICTIONS)
def test_every_pair_of_a_task_comes_out_as_asked(support, contact, post) -> None:
    task = load_task("rear-push-rear")
    obstacles = ()
    if post is not None:
        box = (0.1, 0.1, 0.1)
        obstacles = (Obstacle("post", Box(box), Pose2(), movable=True, friction=post),)
    task = replace(
        task,
        support=replace(task.support, friction=support),
        contact_friction=contact,
        obstacles=obstacles,
    )
    frictions = SurfaceFrictions.of_task(task)
    assert pair(frictions.object, frictions.support) == pytest.approx(support)
    assert pair(frictions.object, frictions.tip) == pytest.approx(contact)
    if post is None:
        assert frictions.object == OBJECT_FRICTION
        return
    made = pair(frictions.support, frictions.obstacle(post))
    if post < 1.98 * frictions.support:
        assert made == pytest.approx(post)
    else:
        assert made <= max(post, 2.0 * frictions.support)
