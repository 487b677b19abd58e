"""Sticking of a flat finger: against the cone of its two ends, closed forms, and the
planar engine.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

import pushpressslide as pps
from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_edges
from pushpressslide.mechanics.line_push import FlatFinger, push_sticks

BODY = ObjectModel(Box((0.2, 0.3, 0.1)), 1.0, (0.0, 0.0))
# on the rear face, the object to the left of it
FINGER = FlatFinger((-0.1, 0.06), (-0.1, -0.06), 0.5)
numbers = st.floats(-1.0, 1.0)


def test_a_finger_has_the_object_on_its_left() -> None:
    assert FINGER.normal == pytest.approx((1.0, 0.0))
    assert FINGER.length == pytest.approx(0.12)


@given(st.floats(-0.14, 0.1), st.floats(0.01, 0.04), st.floats(0.01, 1.0))
def test_straight_ahead_it_sticks_exactly_where_the_ends_embrace_the_com(
    low, width, friction
) -> None:
    finger = FlatFinger((-0.1, low + width), (-0.1, low), friction)
    push = push_sticks(BODY, 0.3, finger, Twist(1.0, 0.0, 0.0))
    assert push.friction_utilisation == pytest.approx(0.0, abs=1e-9)
    middle = low + 0.5 * width
    assert push.center == pytest.approx(middle / (0.5 * width), abs=1e-6)
    assert push.sticks == (abs(push.center) <= 1.0)


def test_sideways_it_sticks_within_the_friction_cone() -> None:
    for slope, sticks in ((0.49, True), (0.51, False)):
        wide = FlatFinger((-0.1, 0.14), (-0.1, -0.14), 0.5)
        push = push_sticks(BODY, 0.3, wide, Twist(1.0, slope, 0.0))
        assert push.sticks == sticks
        assert push.friction_utilisation == pytest.approx(slope / 0.5)


milli = st.integers(-1000, 1000).map(lambda part: 1e-3 * part)


@given(milli, milli, milli, st.floats(0.05, 1.2))
def test_it_sticks_where_the_cones_at_both_ends_give_the_wrench(
    vx, vy, turn, friction
) -> None:
    finger = FlatFinger((-0.1, 0.08), (-0.1, -0.03), friction)
    twist = Twist(vx, vy, 8.0 * turn)
    if not any(twist[:3]):
        return
    push = push_sticks(BODY, 0.3, finger, twist)
    columns = [
        wrench_of_forces([end], [edge], push.wrench.about)[:3]
        for end in (finger.start, finger.end)
        for edge in cone_edges(finger.normal, friction)
    ]
    scale = np.array([1.0, 1.0, 10.0])
    _, distance = optimize.nnls((np.array(columns) * scale).T, push.wrench[:3] * scale)
    clear = abs(push.friction_utilisation - 1.0) > 1e-6
    if clear and abs(abs(push.center) - 1.0) > 1e-6:
        assert push.sticks == (distance < 1e-9)


@given(numbers, numbers, st.floats(0.1, 10.0))
def test_only_the_direction_of_the_twist_counts(vy, w, size) -> None:
    one = push_sticks(BODY, 0.3, FINGER, Twist(1.0, vy, w))
    other = push_sticks(BODY, 0.3, FINGER, Twist(size, size * vy, size * w))
    assert other.friction_utilisation == pytest.approx(one.friction_utilisation)
    assert other.center == pytest.approx(one.center)


@given(numbers, numbers)
def test_the_mirrored_push_has_the_mirrored_resultant(vy, w) -> None:
    left = push_sticks(BODY, 0.3, FINGER, Twist(1.0, vy, w), 0.05)
    right = push_sticks(BODY, 0.3, FINGER, Twist(1.0, -vy, -w), 0.05)
    assert right.center == pytest.approx(-left.center, abs=1e-6)
    assert right.friction_utilisation == pytest.approx(left.friction_utilisation)


@given(numbers, st.floats(0.1, 0.6))
def test_without_height_the_support_s_friction_does_not_matter(w, mu) -> None:
    one = push_sticks(BODY, 0.3, FINGER, Twist(1.0, 0.1, w))
    other = push_sticks(BODY, mu, FINGER, Twist(1.0, 0.1, w))
    assert other.center == pytest.approx(one.center)


def test_a_pull_never_sticks() -> None:
    push = push_sticks(BODY, 0.3, FINGER, Twist(-1.0, 0.0, 0.0))
    assert push.friction_utilisation == math.inf
    assert not push.sticks


def test_without_friction_only_the_pure_normal_force_sticks() -> None:
    slick = FlatFinger(FINGER.start, FINGER.end, 0.0)
    assert push_sticks(BODY, 0.3, slick, Twist(1.0, 0.0, 0.0)).sticks
    assert not push_sticks(BODY, 0.3, slick, Twist(1.0, 0.01, 0.0)).sticks


def test_the_height_of_the_finger_moves_the_resultant() -> None:
    twist = Twist(1.0, 0.0, 2.0)
    low = push_sticks(BODY, 0.4, FINGER, twist)
    high = push_sticks(BODY, 0.4, FINGER, twist, 0.1)
    shift = high.wrench.about
    assert shift == pytest.approx(
        (0.1 * high.wrench.fx, 0.1 * high.wrench.fy), abs=1e-7
    )
    assert abs(high.center - low.center) > 0.05


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: FlatFinger((0.0, 0.0), (0.0, 0.0), 0.5), "has no length"),
        (lambda: FlatFinger((0.0, 0.0), (0.0, 0.1), -0.5), "friction -0.5"),
        (lambda: FlatFinger((0.0, math.nan), (0.0, 0.1), 0.5), "must be finite"),
        (lambda: push_sticks(BODY, 0.3, FINGER, Twist(0.0, 0.0, 0.0)), "zero"),
        (lambda: push_sticks(BODY, 0.9, FINGER, Twist(1.0, 0.0, 0.0), 0.2), "outline"),
    ],
)
def test_what_is_no_push_is_refused(call, words) -> None:
    with pytest.raises(ValueError, match=words):
        call()


def test_it_is_public() -> None:
    assert pps.push_sticks is push_sticks
    assert pps.FlatFinger is FlatFinger
