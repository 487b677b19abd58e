"""A face pushed at any point, on the exact surface (docs/mechanics.md, 1.1 and 5)."""

import pytest

from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.mechanics.face_push import Push, Turning, on_face, turnings
from pushpressslide.mechanics.faces import Face, faces

BODY = ObjectModel(Box((0.4, 0.3, 0.2)), 2.0, (0.0, 0.0))
LOW = 1e-4  # [m] height at which the load is not shifted
REAR, RIGHT = (next(f for f in faces(BODY, 0.01) if f.index == i) for i in (3, 0))


def turning(face: Face, height: float, left: float, slope: float) -> Turning:
    return turnings(BODY, 0.3, height, [Push(face, left, slope)])[0]


@pytest.mark.parametrize(("face", "length"), [(REAR, 0.4), (RIGHT, 0.3)])
def test_a_normal_force_a_little_off_the_com_turns_by_its_offset_over_the_variance(
    face, length
) -> None:
    axle, curvature = turning(face, LOW, 0.002, 0.0)
    assert curvature == pytest.approx(-0.002 / (length**2 / 12.0), rel=0.02)
    assert axle == pytest.approx(0.0, abs=1e-3)


def test_a_sloping_force_through_the_middle_has_its_axle_ahead_by_the_variance_over_the_lever() -> (
    None
):
    axle, curvature = turning(REAR, LOW, 0.0, 0.005)
    variance = 0.4**2 / 12.0
    assert axle == pytest.approx(variance / 0.2, rel=0.02)
    assert curvature == pytest.approx(-0.2 * 0.005 / variance, rel=0.02)


def test_to_the_left_of_the_com_it_turns_to_the_right_and_the_mirror_image_to_the_left() -> (
    None
):
    left = turning(REAR, 0.05, 0.06, 0.2)
    right = turning(REAR, 0.05, -0.06, -0.2)
    assert left.curvature < 0.0
    assert right.curvature == pytest.approx(-left.curvature)
    assert right.axle == pytest.approx(left.axle)


def test_a_push_at_a_height_moves_the_axle_ahead_by_the_height_term() -> None:
    low, high = (turning(REAR, h, 0.002, 0.0).axle for h in (LOW, 0.1))
    assert high - low == pytest.approx(0.1 * 0.3, rel=0.02)


def test_a_force_through_the_com_is_refused() -> None:
    with pytest.raises(ValueError, match="does not turn"):
        turning(REAR, 0.05, 0.0, 0.0)


def test_points_of_a_face_are_left_of_the_com_seen_along_the_push() -> None:
    assert on_face(REAR, 0.1) == pytest.approx((-0.2, 0.1))
    assert on_face(RIGHT, 0.1) == pytest.approx((-0.1, -0.15))
