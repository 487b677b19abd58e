"""Dubins paths on arrays: those of the single form, and OMPL's lengths."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.batch.dubins import NONE, WORDS, shortest_lengths, shortest_paths
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.kernels import dubins as kernels
from pushpressslide.planning import dubins as single
from pushpressslide.planning.dubins import shortest_path

CASES = 1000
NEAR = 1e-9


def random_poses(rng, size):
    return rng.uniform(-1.0, 1.0, (CASES, 3)) * (size, size, math.pi)


@pytest.mark.parametrize("size", [0.1, 1.0, 4.0])
def test_a_thousand_paths_are_the_single_ones(engine, size):
    rng = np.random.default_rng(0)
    starts = random_poses(rng, size)
    goals = random_poses(rng, size)
    left = rng.uniform(0.2, 5.0, CASES)
    right = rng.uniform(0.2, 5.0, CASES)
    right[: CASES // 2] = left[: CASES // 2]
    paths = shortest_paths(starts, goals, left, right)
    rows = zip(
        starts.tolist(), goals.tolist(), left.tolist(), right.tolist(), strict=True
    )
    expected = [shortest_path(Pose2(*a), Pose2(*b), kl, kr) for a, b, kl, kr in rows]
    lengths = [path.length for path in expected]
    np.testing.assert_allclose(paths.length, lengths, rtol=0.0, atol=NEAR)
    np.testing.assert_allclose(paths.lengths.sum(axis=-1), lengths, atol=NEAR)
    words = np.array(
        ["".join(letter(k) for k, _ in path.sections) for path in expected]
    )
    got = np.array(WORDS)[paths.word]
    full = np.array([len(word) == 3 for word in words])
    assert (got[full] == words[full]).all()
    assert full.mean() > 0.99


def test_a_batch_runs_the_kernel_of_planning():
    assert kernels.shortest_solution is single.shortest_solution
    assert kernels.turning_circles is single.turning_circles


def letter(curvature):
    if curvature == 0.0:
        return "S"
    return "L" if curvature > 0.0 else "R"


def test_every_path_ends_at_its_goal(engine):
    rng = np.random.default_rng(1)
    starts = random_poses(rng, 1.0)[:500]
    goals = random_poses(rng, 1.0)[:500]
    paths = shortest_paths(starts, goals, 2.0, 3.0)
    for i, (start, goal) in enumerate(
        zip(starts.tolist(), goals.tolist(), strict=True)
    ):
        pieces = zip(
            paths.curvatures[i].tolist(), paths.lengths[i].tolist(), strict=True
        )
        end = ArcPath(Pose2(*start), tuple(p for p in pieces if p[1] > 0.0)).end
        assert math.hypot(end.x - goal[0], end.y - goal[1]) < NEAR
        assert abs(wrap_angle(end.yaw - goal[2])) < NEAR


def test_lengths_are_ompls(engine):
    base = pytest.importorskip("ompl.base")
    rng = np.random.default_rng(2)
    starts = random_poses(rng, 4.0)
    goals = random_poses(rng, 4.0)
    space = base.DubinsStateSpace(0.7)
    a = space.allocState()
    b = space.allocState()
    lengths = []
    for start, goal in zip(starts.tolist(), goals.tolist(), strict=True):
        for state, pose in ((a, start), (b, goal)):
            state.setXY(pose[0], pose[1])
            state.setYaw(pose[2])
        lengths.append(space.distance(a, b))
    paths = shortest_paths(starts, goals, 1.0 / 0.7, 1.0 / 0.7)
    np.testing.assert_allclose(paths.length, lengths, rtol=0.0, atol=NEAR)
    alone = shortest_lengths(starts, goals, 1.0 / 0.7, 1.0 / 0.7)
    np.testing.assert_allclose(alone, lengths, rtol=0.0, atol=NEAR)


def test_where_cases_meet(engine):
    goals = np.array(
        [
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 2.0 * math.pi),
            (1e-13, 0.0, 1e-13),
            (1.0, 0.0, 0.0),
            (0.0, 1.0, math.pi),
            (0.0, -2.0, math.pi),
            (0.0, 2.0, 0.0),
            (0.0, 0.0, math.pi),
            (0.0, 0.0, -math.pi),
            (0.0, 4.0, 0.0),
            (2.0, 2.0, 0.0),
            (-1.0, 0.0, 0.0),
        ]
    )
    paths = shortest_paths((0.0, 0.0, 0.0), goals, 1.0, 1.0)
    expected = [shortest_path(Pose2(), Pose2(*g), 1.0, 1.0) for g in goals.tolist()]
    np.testing.assert_allclose(paths.length, [p.length for p in expected], atol=NEAR)
    assert (paths.length[:3] == 0.0).all()


def test_a_tiny_way_straight_ahead_is_no_whole_circle(engine):
    rng = np.random.default_rng(5)
    starts = rng.uniform(-1.0, 1.0, (1000, 3)) * (5.0, 5.0, math.pi)
    ways = 10.0 ** rng.uniform(-9.0, -5.0, 1000)
    ahead = [np.cos(starts[:, 2]), np.sin(starts[:, 2]), np.zeros(1000)]
    goals = starts + ways[:, None] * np.transpose(ahead)
    assert np.all(shortest_lengths(starts, goals, 2.0, 3.0) <= ways + 1e-8)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", range(3))
def test_a_pose_that_is_no_number_has_no_path(engine, bad, place):
    goals = np.ones((3, 3))
    goals[1, place] = bad
    paths = shortest_paths((0.0, 0.0, 0.0), goals, 1.0, 2.0)
    assert np.isnan(paths.length).tolist() == [False, True, False]
    assert (paths.word == NONE).tolist() == [False, True, False]


def test_any_shape(engine):
    starts = np.zeros((4, 1, 3))
    goals = np.random.default_rng(3).normal(size=(5, 3))
    limits = np.array([1.0, 2.0, 3.0])[:, None, None]
    assert shortest_paths(starts, goals, limits, 1.0).lengths.shape == (3, 4, 5, 3)
    assert shortest_paths(starts[0, 0], goals[0], 1.0, 1.0).length.shape == ()


@pytest.mark.parametrize("limit", [0.0, -1.0, math.nan, math.inf])
def test_a_limit_that_cannot_be_is_named(limit):
    with pytest.raises(ValueError, match=rf"kappa_right {limit} 1/m; must be finite"):
        shortest_paths(np.zeros(3), np.ones(3), 1.0, limit)


coordinates = st.floats(-3.0, 3.0)


@given(st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=1))
def test_mirrored_goals_have_mirrored_paths(goals):
    there = np.array(goals)
    mirrored = there * (1.0, -1.0, -1.0)
    paths = shortest_paths(np.zeros(3), there, 1.5, 0.8)
    others = shortest_paths(np.zeros(3), mirrored, 0.8, 1.5)
    far = np.hypot(there[:, 0], there[:, 1]) > 1e-3
    np.testing.assert_allclose(paths.length[far], others.length[far], atol=1e-9)
