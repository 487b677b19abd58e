"""Paths of twists within a cone."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core import margins
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.planning.in_cone import (
    Inside,
    describe_cone_margin,
    least_cone_margin,
    paths_in_cone,
    resume_path,
)

RADIUS = 0.15
LEAST = 0.05
INSIDE = Inside(LEAST, LEAST, LEAST)


class RoundCone:
    """Twists within ``half`` [rad] of straight ahead, turning counted at RADIUS."""

    def __init__(self, half: float) -> None:
        self.half = half

    def cone_margin(self, vx: float, vy: float, w: float) -> float:
        return self.half - math.atan2(math.hypot(vy, RADIUS * w), vx)

    def cone_margins(self, twists: np.ndarray) -> np.ndarray:
        return np.array([self.cone_margin(*twist) for twist in twists.tolist()])

    def rays(self, least: float) -> list[tuple[float, float, float]]:
        out = [(1.0, 0.0, 0.0)]
        size = math.tan(self.half - least)
        for i in range(8):
            angle = 0.25 * math.pi * i
            out.append((1.0, size * math.cos(angle), size * math.sin(angle) / RADIUS))
        return [ray for ray in out if self.cone_margin(*ray) >= least - 1e-12]


CONE = RoundCone(math.radians(30.0))


def shortest(
    start: Pose2, goal: Pose2, longest: float, inside: Inside = INSIDE
) -> TwistPath | None:
    """Return the shortest path in CONE."""
    return next(paths_in_cone(start, goal, CONE, inside, RADIUS, longest), None)


@given(x=st.floats(0.05, 0.5), y=st.floats(-0.4, 0.4), yaw=st.floats(-1.0, 1.0))
def test_a_path_leads_to_the_goal_keeps_to_the_cone_and_is_no_longer_than_allowed(
    x, y, yaw
) -> None:
    start = Pose2(0.3, -0.2, 0.7)
    goal = start.compose(Pose2(x, y, yaw))
    path = shortest(start, goal, 0.8)
    if path is None:
        assert CONE.cone_margin(*screw(start, goal)) < LEAST or math.hypot(x, y) > 0.5
        return
    assert (path.end.x, path.end.y) == pytest.approx((goal.x, goal.y), abs=1e-9)
    assert math.remainder(path.end.yaw - goal.yaw, 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-9
    )
    assert len(path.sections) <= 3
    assert path.length <= 0.8 + 1e-9
    assert least_cone_margin(path, CONE) >= LEAST - 1e-9


def test_what_one_twist_can_do_is_done_by_one() -> None:
    path = shortest(Pose2(), Pose2(0.3, 0.1, 0.2), 1.0)
    assert path is not None
    assert len(path.sections) == 1


def test_a_goal_beside_the_cone_is_reached_by_turning_the_cone() -> None:
    goal = Pose2(0.45, 0.30, 0.0)  # 34 degrees off, the cone has 30
    assert CONE.cone_margin(*screw(Pose2(), goal)) < 0.0
    path = shortest(Pose2(), goal, 1.0)
    assert path is not None
    assert len(path.sections) > 1
    assert path.pose(0.3 * path.length).yaw > 0.02


@pytest.mark.parametrize(
    "goal", [Pose2(-0.2, 0.0, 0.0), Pose2(0.0, 0.0, 1.0), Pose2(0.0, 0.3, 0.0)]
)
def test_back_on_the_spot_and_sideways_there_is_no_path(goal: Pose2) -> None:
    assert shortest(Pose2(), goal, 3.0) is None


def test_a_path_longer_than_allowed_is_not_taken() -> None:
    assert shortest(Pose2(), Pose2(0.5, 0.0, 0.0), 0.49) is None


def test_the_first_piece_may_be_nearer_the_edge_than_the_rest() -> None:
    goal = Pose2(0.45, 0.24, 0.0)
    inside = Inside(0.4, 0.05, 0.2)
    path = shortest(Pose2(), goal, 1.2, inside)
    assert path is not None
    assert len(path.sections) > 1
    first, *rest = (CONE.cone_margin(*rate) for rate, _ in path.sections)
    assert first >= 0.05 - 1e-9
    assert min(rest) >= 0.2 - 1e-9
    assert first < 0.2


def test_as_many_pieces_as_allowed() -> None:
    goal = Pose2(0.45, 0.35, 0.0)
    three = shortest(Pose2(), goal, 1.2)
    two = shortest(Pose2(), goal, 1.2, Inside(LEAST, LEAST, LEAST, 2))
    assert three is not None
    assert two is not None
    assert len(three.sections) == 3
    assert len(two.sections) == 2
    assert two.length > three.length


def test_the_rest_of_a_way_goes_well_inside_the_cone_where_it_can() -> None:
    goal = Pose2(0.45, 0.20, 0.0)  # 24 degrees off: 6 inside
    path = resume_path(Pose2(), goal, CONE, RADIUS, 1.0)
    assert path is not None
    assert len(path.sections) == 1
    goal = Pose2(0.45, 0.225, 0.0)  # 26.6 off
    path = resume_path(Pose2(), goal, CONE, RADIUS, 1.0)
    assert path is not None
    assert len(path.sections) > 1
    last, _ = path.sections[-1]
    assert CONE.cone_margin(*last) >= margins.BENT_MARGIN - 1e-9
    # with no room for a bend it takes what there is
    direct = math.hypot(0.45, 0.225)
    path = resume_path(Pose2(), goal, CONE, RADIUS, 1.001 * direct)
    assert path is not None
    assert least_cone_margin(path, CONE) >= margins.REPLAN_MARGIN - 1e-9


def test_the_words_say_inside_or_outside_and_what_is_needed() -> None:
    assert describe_cone_margin(math.radians(20.0), LEAST) == "20 deg inside the cone"
    assert (
        describe_cone_margin(math.radians(-53.0), math.radians(6.0))
        == "53 deg outside the cone, needed 6 deg inside"
    )
    assert (
        describe_cone_margin(math.radians(1.84), math.radians(6.0))
        == "1.8 deg inside the cone, needed 6 deg inside"
    )
