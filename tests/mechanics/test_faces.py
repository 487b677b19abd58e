"""Side faces of an object, and the space ahead of the CoM when one is pushed."""

import math

import pytest

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2, cross
from pushpressslide.core.task import (
    Box,
    Compound,
    Cylinder,
    ObjectModel,
    Part,
    Prism,
    Shape,
)
from pushpressslide.mechanics.faces import faces, room_ahead

TRIANGLE = Prism(((0.1, 0.0), (-0.05, 0.0866), (-0.05, -0.0866)), 0.12)
ANGLE = Prism(
    ((0.0, 0.0), (0.3, 0.0), (0.3, 0.08), (0.08, 0.08), (0.08, 0.3), (0.0, 0.3)), 0.1
)
SHAPES = [Box((0.4, 0.3, 0.2)), Cylinder(0.1, 0.12), TRIANGLE]


def body(shape: Shape, center_of_mass: tuple[float, float]) -> ObjectModel:
    return ObjectModel(shape, 1.0, center_of_mass)


@pytest.mark.parametrize("shape", SHAPES)
def test_what_the_com_moves_forward_is_gained_behind_it_and_lost_ahead(
    shape: Shape,
) -> None:
    for face, moved in zip(
        faces(body(shape, (0.0, 0.0)), 0.01),
        faces(body(shape, (0.02, -0.01)), 0.01),
        strict=True,
    ):
        forward = 0.02 * face.normal[0] - 0.01 * face.normal[1]
        before = room_ahead(body(shape, (0.0, 0.0)), face)
        after = room_ahead(body(shape, (0.02, -0.01)), moved)
        assert after == pytest.approx(before - forward)
        assert moved.depth == pytest.approx(face.depth + forward)


def test_behind_and_ahead_of_the_com_of_a_cylinder_together_are_its_diameter() -> None:
    off_centre = body(Cylinder(0.1, 0.12), (0.03, 0.02))
    round_it = faces(off_centre, 0.01)
    assert len(round_it) >= 4
    for face in round_it:
        assert face.depth + room_ahead(off_centre, face) == pytest.approx(0.2)
        assert math.hypot(*face.normal) == pytest.approx(1.0)


@pytest.mark.parametrize("shape", [*SHAPES, ANGLE])
def test_the_offset_of_a_face_is_how_far_its_point_is_to_the_left_of_the_com(
    shape: Shape,
) -> None:
    found = faces(body(shape, (0.02, -0.02)), 0.01)
    for face in found:
        assert face.offset == pytest.approx(cross(face.normal, face.foot), abs=1e-12)


def test_a_face_that_does_not_reach_beside_the_com_is_off_to_a_side() -> None:
    """The inner side of the upright leg of an L.

    Its point nearest to the CoM is its end, 70 mm in front, which is to the right for a
    push backwards.
    """
    inner = faces(body(ANGLE, (0.2, 0.04)), 0.01, 0.02)[3]
    assert inner.normal == pytest.approx((-1.0, 0.0))
    assert inner.offset == pytest.approx(-0.07, abs=1e-4)


def test_a_chord_of_a_fillet_is_no_face() -> None:
    tip = 0.0125
    narrow = 1.8 * margins.CREEP * tip / math.sqrt(2.0)
    wide = 2.2 * margins.CREEP * tip / math.sqrt(2.0)
    for cut, count in ((narrow, 4), (wide, 5)):
        corners = ((0, 0), (0.1, 0), (0.1, 0.1 - cut), (0.1 - cut, 0.1), (0, 0.1))
        assert len(faces(body(Prism(corners, 0.1), (0.05, 0.05)), 0.0075, tip)) == count


def test_short_chords_of_a_gentle_curve_are_faces() -> None:
    angles = [2.0 * math.pi * i / 96 for i in range(96)]
    oval = Prism(tuple((0.05 * math.cos(a), 0.04 * math.sin(a)) for a in angles), 0.1)
    assert len(faces(body(oval, (0.0, 0.0)), 0.0075, 0.0125)) == 96


@pytest.mark.parametrize(("share", "pushed"), [(0.9, False), (1.1, True)])
def test_a_round_corner_is_pushed_unless_it_is_sharp(
    share: float, pushed: bool
) -> None:
    tip = 0.0125
    radius = share * margins.CREEP / margins.CREPT_TURN * tip
    disc = Part(Cylinder(radius, 0.1), Pose2(0.1 - radius, 0.1 - radius, 0.0))
    inner = 0.1 - radius
    lower = Prism(((0, 0), (0.1, 0), (0.1, inner), (0, inner)), 0.1)
    upper = Prism(((0, 0), (inner, 0), (inner, 0.1), (0, 0.1)), 0.1)
    blocks = (Part(lower, Pose2()), Part(upper, Pose2()))
    rounded = Compound((*blocks, disc))
    found = faces(body(rounded, (0.05, 0.05)), 0.0075, tip)
    assert any(not face.flat for face in found) == pushed
