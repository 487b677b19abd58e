"""RRT-Connect on obstacles with known gaps."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.arms.paths.connect import CHECK_STEP, connect

LOWER = np.array([-2.0, -2.0])
UPPER = np.array([2.0, 2.0])
START = np.array([-1.0, 0.0])
GOAL = np.array([1.0, 0.0])


def gate(y: float, margin: float = 0.0):
    """Whether a posture is free of a wall about x = 0 with a gap about ``y``, to within
    ``margin``.
    """
    return lambda q: abs(q[0]) > 0.1 - margin or abs(q[1] - y) < 0.2 + margin


@settings(max_examples=20, deadline=None)
@given(st.floats(-1.0, 1.0))
def test_a_path_leads_through_the_gap_and_stays_free(y) -> None:
    path = connect(START, GOAL, gate(y), LOWER, UPPER)
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], [START, GOAL])
    assert (path >= LOWER).all()
    assert (path <= UPPER).all()
    # every posture is at most half a step from one that was checked
    free = gate(y, 0.5 * CHECK_STEP)
    for a, b in pairwise(path):
        assert all(free(a + u * (b - a)) for u in np.linspace(0.0, 1.0, 200))


def test_the_same_question_has_the_same_answer() -> None:
    one = connect(START, GOAL, gate(0.7), LOWER, UPPER)
    other = connect(START, GOAL, gate(0.7), LOWER, UPPER)
    np.testing.assert_array_equal(one, other)


def test_a_free_path_is_shortened_to_a_few_corners() -> None:
    path = connect(START, GOAL, lambda _: True, LOWER, UPPER)
    assert path is not None
    assert len(path) <= 3


@pytest.mark.parametrize("blocked", [START, GOAL])
def test_no_path_begins_or_ends_in_an_obstacle(blocked) -> None:
    def free(q):
        return bool(np.abs(q - blocked).max() > 0.05)

    assert connect(START, GOAL, free, LOWER, UPPER) is None


def test_a_closed_wall_has_no_path() -> None:
    assert connect(START, GOAL, lambda q: abs(q[0]) > 0.1, LOWER, UPPER) is None
