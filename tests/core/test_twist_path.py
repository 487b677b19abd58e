"""Paths of constant body twists."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath, integrate, reached, screw, screws

numbers = st.floats(-1.0, 1.0)
poses = st.builds(Pose2, numbers, numbers, st.floats(-3.0, 3.0))


@given(poses, numbers, numbers, st.floats(-3.0, 3.0))
def test_logarithm_and_exponential_are_inverse(
    start: Pose2, x: float, y: float, turn: float
) -> None:
    end = start.compose(Pose2(x, y, turn))
    there = integrate(start, screw(start, end), 1.0)
    assert (there.x, there.y) == pytest.approx((end.x, end.y), abs=1e-9)
    assert math.remainder(there.yaw - end.yaw, 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-9
    )


@given(st.lists(poses, min_size=2, max_size=4))
def test_logarithms_of_all_pairs_are_those_of_each(some: list[Pose2]) -> None:
    rows = np.array([(pose.x, pose.y, pose.yaw) for pose in some])
    table = screws(rows[:-1], rows)
    assert table.shape == (len(some) - 1, len(some), 3)
    for i, start in enumerate(some[:-1]):
        for j, end in enumerate(some):
            assert table[i, j] == pytest.approx(screw(start, end), abs=1e-9)


@given(
    poses,
    st.lists(st.tuples(numbers, numbers, st.floats(-3.0, 3.0)), min_size=1, max_size=4),
)
def test_many_twists_lead_where_each_does(
    start: Pose2, twists: list[tuple[float, float, float]]
) -> None:
    for row, twist in zip(reached(start, np.array(twists)), twists, strict=True):
        end = integrate(start, twist, 1.0)
        assert row == pytest.approx((end.x, end.y, end.yaw), abs=1e-9)


@given(poses, poses, poses)
def test_a_path_goes_through_its_poses_at_unit_speed(
    a: Pose2, b: Pose2, c: Pose2
) -> None:
    path = TwistPath.between((a, b, c), radius=0.2)
    for s, pose in path.section_starts:
        assert path.pose(s).position == pytest.approx(pose.position, abs=1e-9)
    assert path.end.position == pytest.approx(c.position, abs=1e-7)
    for rate, length in path.sections:
        assert math.hypot(rate[0], rate[1], 0.2 * rate[2]) == pytest.approx(1.0)
        assert length > 0.0


@pytest.mark.parametrize("turn", [0.0, 5e-324, 1.2e-161, 1e-15])
def test_poses_that_are_one_make_no_piece(turn: float) -> None:
    path = TwistPath.between((Pose2(0.1, 0.2, 0.0), Pose2(0.1, 0.2, turn)), radius=0.2)
    assert path.sections == ()
    assert path.length == 0.0
    assert path.pose(0.0) == path.start


def test_a_turn_on_the_spot_is_as_long_as_its_radius_times_its_angle() -> None:
    path = TwistPath.between((Pose2(0.3, 0.1, 0.2), Pose2(0.3, 0.1, 1.2)), radius=0.25)
    assert path.length == pytest.approx(0.25)
    assert path.pose(0.125).yaw == pytest.approx(0.7)


@given(st.floats(0.05, 0.2), st.floats(-0.01, 0.01), st.floats(-0.02, 0.02))
def test_the_nearest_place_is_found_near_the_path(
    s: float, left: float, turned: float
) -> None:
    path = TwistPath.between((Pose2(), Pose2(0.3, 0.0, 0.3)), radius=0.2)
    at = path.pose(s).compose(Pose2(0.0, left, turned))
    assert path.nearest(at, s - 0.02) == pytest.approx(s, abs=0.01)


def test_a_lead_in_ends_where_the_path_began() -> None:
    path = TwistPath.between((Pose2(0.1, 0.2, 0.3), Pose2(0.4, 0.2, 1.0)), radius=0.2)
    led = path.led_in(0.05)
    assert led.pose(0.05).position == pytest.approx(path.start.position)
    assert led.length == pytest.approx(path.length + 0.05)


def test_a_turn_on_the_spot_covers_no_distance() -> None:
    poses = (Pose2(), Pose2(0.3, 0.0, 0.0), Pose2(0.3, 0.0, 1.0))
    path = TwistPath.between(poses, radius=0.1)
    assert path.length == pytest.approx(0.4)
    assert path.distance == pytest.approx(0.3)
