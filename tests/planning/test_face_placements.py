"""Contacts on the faces of an object, as laws of any box."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide import load_task
from pushpressslide.core import margins
from pushpressslide.core.scene import Belief, ObjectModel, Scene
from pushpressslide.geometry.shapes import Box
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.planning.face_placements import (
    angle_between,
    on_two_faces,
    side_by_side,
    side_by_side_refusal,
    spread,
)
from pushpressslide.planning.side_contacts import least_distance

TASK = load_task("parallel-push")
HEIGHT = 0.04
SIDES = st.floats(0.06, 0.6)


def scene_of(length: float, width: float, center: tuple[float, float]) -> Scene:
    """A scene with a box of that size, its CoM at ``center`` [m]."""
    body = ObjectModel(Box((length, width, 0.2)), 2.0, center)
    return replace(TASK.scene, body=body)


def face_of(scene: Scene, index: int) -> Face:
    """The face of the object with an index."""
    return faces(scene.body, scene.inset)[index]


def beside(face: Face, point: tuple[float, float]) -> float:
    """How far [m] a point is to the left of the CoM's line along a face's normal."""
    nx, ny = face.normal
    return -ny * point[0] + nx * point[1]


@given(SIDES, SIDES)
def test_contacts_side_by_side_are_alike_on_either_side_and_clear_of_the_corners(
    length: float, width: float
) -> None:
    scene = scene_of(length, width, (0.0, 0.0))
    face = face_of(scene, 3)
    _, left = face.ends
    pairs = side_by_side(scene, face, HEIGHT)
    assert pairs
    for a, b in pairs:
        assert beside(face, a.point) == pytest.approx(-beside(face, b.point))
        assert beside(face, a.point) > 0.0
        assert beside(face, a.point) <= max(left - scene.inset, scene.inset)
        assert (a.height, b.height) == (HEIGHT, HEIGHT)
        assert (a.normal, b.normal) == (face.normal, face.normal)


@given(SIDES, SIDES, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_contacts_on_two_faces_leave_room_for_the_tools_and_for_the_corners(
    length: float, width: float, x: float, y: float
) -> None:
    scene = scene_of(length, width, (x * length, y * width))
    pair = (face_of(scene, 3), face_of(scene, 2))
    placements = on_two_faces(scene, pair, HEIGHT)
    assert placements or min(length, width) < 0.15  # two tools beside each other
    for contacts in placements:
        apart = math.dist(contacts[0].point, contacts[1].point)
        assert apart >= least_distance(scene)
        for face, contact in zip(pair, contacts, strict=True):
            right, left = face.ends
            place = beside(face, contact.point)
            clear = min(scene.inset, 0.5 * (left - right))
            assert right + clear - 1e-9 <= place <= left - clear + 1e-9


def test_two_tools_that_have_no_room_on_a_face_are_refused_with_the_distance() -> None:
    scene = scene_of(0.3, 0.08, (0.0, 0.0))
    task = replace(TASK, object=scene.body, belief=Belief())
    face = face_of(scene, 3)
    widest = 0.08 - 2.0 * scene.inset
    placed = side_by_side(scene, face, HEIGHT)
    for share, contacts in zip(margins.WIDTHS, placed, strict=True):
        refusal = side_by_side_refusal(task.query, face, contacts)
        assert refusal is not None
        assert refusal.code == "too_close"
        assert refusal.figure == pytest.approx(share * widest)
        assert refusal.allowed == least_distance(scene)


def test_neighbouring_faces_of_a_box_are_at_right_angles_and_opposite_ones_at_180() -> (
    None
):
    scene = scene_of(0.3, 0.2, (0.0, 0.0))
    first = face_of(scene, 0)
    assert angle_between(first, face_of(scene, 1)) == pytest.approx(0.5 * math.pi)
    assert angle_between(first, face_of(scene, 2)) == pytest.approx(math.pi)


def test_the_spread_of_contacts_is_the_same_for_a_mirrored_object() -> None:
    scene = scene_of(0.3, 0.2, (0.03, 0.02))
    mirrored = scene_of(0.3, 0.2, (0.03, -0.02))
    face = face_of(scene, 3)
    other = face_of(mirrored, 3)
    pairs = side_by_side(scene, face, HEIGHT), side_by_side(mirrored, other, HEIGHT)
    assert [spread(pair) for pair in pairs[0]] == [spread(pair) for pair in pairs[1]]
