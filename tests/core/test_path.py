"""Laws of arc paths and speed profiles."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.pose import Pose2

lengths = st.floats(0.01, 0.5)
curvatures = st.one_of(
    st.just(0.0), st.floats(-15.0, 15.0).filter(lambda k: abs(k) > 0.05)
)
poses = st.builds(Pose2, st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3))
paths = st.builds(
    lambda start, pieces: ArcPath(
        start, tuple((k, min(n, 6.0 / abs(k)) if k else n) for k, n in pieces)
    ),
    poses,
    st.lists(st.tuples(curvatures, lengths), min_size=1, max_size=4),
)


@given(paths, st.floats(0.0, 1.0), st.floats(-0.02, 0.02), st.floats(0.0, 0.01))
def test_a_point_beside_the_path_is_projected_onto_it(path, share, offset, behind):
    s = share * path.length
    pose = path.pose(s)
    # the path is to the left of the point by the offset
    x, y = pose.apply((0.0, -offset))
    near, left, heading, curvature = path.nearest(x, y, max(0.0, s - behind))
    found = path.pose(near)
    assert abs(near - s) < 1e-7
    assert abs(left - offset) < 1e-9
    assert abs(math.remainder(heading - pose.yaw, 2.0 * math.pi)) < 1e-6
    assert math.dist((found.x, found.y), (pose.x, pose.y)) < 1e-7
    assert curvature in [k for k, _ in path.sections] + [0.0]


@given(paths)
def test_past_the_end_the_path_goes_on_straight(path):
    beyond = advance(path.end, 0.0, 0.03)
    near, left, heading, curvature = path.nearest(beyond.x, beyond.y, path.length)
    assert abs(near - path.length - 0.03) < 1e-9
    assert abs(left) < 1e-9
    assert curvature == 0.0
    assert abs(math.remainder(heading - path.end.yaw, 2.0 * math.pi)) < 1e-9


@given(paths, st.floats(0.001, 0.1))
def test_an_eased_path_turns_as_much_without_jumps_of_its_curvature(path, half):
    n = 4000
    step = path.length / n
    turning = 0.0
    largest = 0.0
    before = path.sections[0][0]
    for i in range(n):
        s = (i + 0.5) * step
        curvature = path.curvature(s) + path.eased(s, half)[1]
        turning += curvature * step
        largest = max(largest, abs(curvature - before))
        before = curvature
    jumps = [abs(b - a) for (a, _), (b, _) in itertools.pairwise(path.sections)]
    windows = [min(half, s, path.length - s) for s, _ in path.section_starts[1:-1]]
    steepest = sum(j / (2.0 * w) for j, w in zip(jumps, windows, strict=True))
    assert abs(turning - path.turning) < 3.0 * sum(jumps) * step + 1e-9
    assert largest <= steepest * step + 1e-9


@given(paths, st.floats(0.001, 0.1), st.floats(0.0, 1.0))
def test_the_heading_of_an_eased_path_belongs_to_its_curvature(path, half, share):
    s = share * path.length
    step = 1e-6
    turned = path.eased(s + step, half)[0] - path.eased(s - step, half)[0]
    bent = path.eased(s, half)[1]
    if all(abs(s - bend) > 2.0 * step for bend, _ in path.section_starts):
        assert turned / (2.0 * step) == pytest.approx(bent, abs=0.05)


@given(paths, st.floats(0.0, 0.1), st.floats(0.0, 1.1), st.floats(-0.01, 0.01))
def test_the_nearest_place_of_an_eased_path_has_what_easing_adds(
    path, half, share, left
):
    pose = path.pose(share * path.length)
    x, y = pose.apply((0.0, left))
    s, off, heading, curvature = path.nearest(x, y, share * path.length)
    turned, bent = path.eased(s, half)
    eased = (s, off, heading + turned, curvature + bent)
    assert path.nearest(x, y, share * path.length, half) == eased


@given(poses, curvatures, lengths, lengths)
def test_advancing_twice_is_advancing_once(pose, curvature, a, b):
    one = advance(pose, curvature, a + b)
    two = advance(advance(pose, curvature, a), curvature, b)
    assert math.dist((one.x, one.y, one.yaw), (two.x, two.y, two.yaw)) < 1e-12


@given(st.floats(1e-4, 2.0), st.floats(0.01, 0.2), st.floats(0.02, 1.0))
def test_a_profile_covers_its_length_from_rest_to_rest(length, speed, acceleration):
    profile = SpeedProfile(length, speed, acceleration)
    steps = 400
    travelled = sum(
        profile.state_at((i + 0.5) * profile.duration / steps)[1]
        * profile.duration
        / steps
        for i in range(steps)
    )
    assert abs(travelled - length) < 1e-2 * length
    assert profile.state_at(0.0) == (0.0, 0.0)
    assert profile.state_at(profile.duration) == (length, 0.0)


def test_the_rest_of_a_path_is_where_the_path_is() -> None:
    path = ArcPath(Pose2(0.1, -0.2, 0.3), ((2.0, 0.4), (0.0, 0.1), (-3.0, 0.2)))
    rest = path.rest(0.45)
    assert rest.length == pytest.approx(path.length - 0.45)
    for s in (0.0, 0.02, 0.2):
        here = rest.pose(s)
        there = path.pose(0.45 + s)
        assert (here.x, here.y, here.yaw) == pytest.approx(
            (there.x, there.y, there.yaw)
        )
