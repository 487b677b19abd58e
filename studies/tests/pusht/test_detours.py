"""Paths of the free pusher round the T."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.detours import free_space, nearest_free, way_length
from pushpressslide_studies.pusht.tee import BODY, CENTER, FACES, PUSHER_RADIUS

MIDDLE = Pose2(256.0, 256.0, 0.9)
ROUNDING = 0.05  # [px]


def gap(point: Point) -> float:
    """Return the distance [px] of pusher and T for a pusher in W."""
    x, y = MIDDLE.unapply(point)
    distance = BODY.shape.distance((x + CENTER[0], y + CENTER[1]))
    return distance - PUSHER_RADIUS


def tip_position(face: int) -> Point:
    pushed = FACES[face]
    return MIDDLE.apply(pushed.pusher(0.5 * (pushed.left + pushed.right)))


@pytest.mark.parametrize("start", range(len(FACES)))
@pytest.mark.parametrize("goal", range(len(FACES)))
def test_a_way_between_faces_keeps_off_the_t(start: int, goal: int) -> None:
    way = (
        tip_position(start),
        *free_space(MIDDLE, tip_position(start), tip_position(goal)),
    )
    assert math.dist(way[-1], tip_position(goal)) < ROUNDING
    for a, b in pairwise(way):
        for part in (0.0, 0.25, 0.5, 0.75, 1.0):
            point = (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]))
            assert gap(point) > -ROUNDING


@given(x=st.floats(0.0, 512.0), y=st.floats(0.0, 512.0))
def test_a_way_is_no_shorter_than_the_straight_line(x: float, y: float) -> None:
    goal = tip_position(3)
    assert way_length(MIDDLE, (x, y), goal) >= math.dist((x, y), goal) - ROUNDING


def test_a_pusher_on_the_t_leaves_it_by_the_nearest_way() -> None:
    free = MIDDLE.apply(nearest_free((0.0, -40.0)))
    assert gap(free) > 0.0


def test_there_is_no_way_where_the_pusher_cannot_be_sent() -> None:
    # the bar closes off a corner of the world
    corner = Pose2(66.8, 66.8, -0.25 * math.pi)
    assert free_space(corner, (250.0, 250.0), (5.0, 5.0)) == ()
    assert math.isinf(way_length(corner, (250.0, 250.0), (5.0, 5.0)))
