"""Frame of all plans, on a table and on a wall."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.support_frame import TABLE, SupportFrame

places = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


@given(places, st.floats(-7.0, 7.0), places)
def test_what_goes_to_the_world_comes_back(origin, yaw, p) -> None:
    frame = SupportFrame.of_wall(origin, yaw)
    assert frame.coordinates(frame.point(p)) == pytest.approx(p, abs=1e-12)
    assert frame.components(frame.direction(p)) == pytest.approx(p, abs=1e-12)
    assert math.hypot(*frame.direction(p)) == pytest.approx(math.hypot(*p), abs=1e-12)


def test_on_a_wall_x_is_to_the_left_and_y_up_for_robots_that_face_it() -> None:
    # robots that look along +x have +y to their left
    ahead = SupportFrame.of_wall((0.9, 0.0, 0.5), math.pi)
    assert ahead.direction((1.0, 0.0, 0.0)) == (0.0, 1.0, 0.0)
    assert ahead.direction((0.0, 1.0, 0.0)) == (0.0, 0.0, 1.0)
    assert ahead.direction((0.0, 0.0, 1.0)) == (-1.0, 0.0, 0.0)
    assert ahead.point((0.2, -0.1, 0.3)) == pytest.approx((0.6, 0.2, 0.4))
    # they look along +y: left is -x
    to_the_left = SupportFrame.of_wall((0.0, 1.0, 0.5), -0.5 * math.pi)
    assert to_the_left.direction((1.0, 0.0, 0.0)) == (-1.0, 0.0, 0.0)


def test_a_yaw_turns_about_the_normal_of_a_table_and_into_a_wall() -> None:
    assert TABLE.spin_axis == (0.0, 0.0, 1.0)
    assert TABLE.point((1.0, 2.0, 3.0)) == (1.0, 2.0, 3.0)
    wall = SupportFrame.of_wall((0.0, 0.0, 0.0), 0.7)
    x, y, z = wall.direction((0.0, 0.0, 1.0))
    assert wall.spin_axis == pytest.approx((-x, -y, -z), abs=1e-15)


@given(st.floats(-3.1, 3.1))
def test_the_normal_is_where_heights_grow_and_a_wall_is_left_handed(yaw):
    wall = SupportFrame.of_wall((0.3, -0.2, 0.8), yaw)
    for frame, hand in ((wall, -1.0), (TABLE, 1.0)):
        assert frame.components(frame.normal) == pytest.approx((0.0, 0.0, 1.0))
        assert frame.handedness == hand
        assert frame.spin_axis == pytest.approx([hand * n for n in frame.normal])
