"""Look-ahead alignment: decay over the run-in, and the remaining error of a fixed
target.
"""

import math

import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment


def driven(
    law: LookAheadAlignment, y: float, yaw: float, way: float
) -> tuple[float, float]:
    """Return lateral error [m] and heading [rad] at the goal after driving along the x
    axis to it.
    """
    x = -way
    step = 1e-4
    while x < 0.0:
        turn, _ = law.curvature((x, y, yaw), -y, -yaw, 0.0)
        yaw += step * turn
        x = x + step * math.cos(yaw)
        y = y + step * math.sin(yaw)
    return y, yaw


@pytest.mark.parametrize("looks", [3.0, 4.0, 5.0])
def test_a_small_error_decays_critically(looks: float) -> None:
    ell = 0.1
    error = 1e-4
    left, _ = driven(LookAheadAlignment(ell, 50.0), error, 0.0, looks * ell)
    assert left / error == pytest.approx(
        (1.0 + 2.0 * looks) * math.exp(-2.0 * looks), rel=0.02
    )


def test_five_look_aheads_take_away_a_large_error() -> None:
    left, heading = driven(LookAheadAlignment(0.2, 50.0), 0.3, math.radians(45.0), 1.0)
    assert abs(left) < 3e-4 + 1e-3
    assert abs(math.degrees(heading)) < 1.0


def test_a_target_fixed_beyond_the_goal_leaves_an_error() -> None:
    ell = 0.2
    way = 1.0
    error = 0.1
    fixed = LookAheadAlignment(ell, 50.0, Pose2())
    left, heading = driven(fixed, error, 0.0, way)
    assert 0.01 < abs(left) < 0.13
    assert abs(math.degrees(heading)) > 3.0
    sliding, _ = driven(LookAheadAlignment(ell, 50.0), error, 0.0, way)
    assert abs(sliding) < 0.1 * abs(left)


def test_bounds_hold_and_are_told() -> None:
    law = LookAheadAlignment(0.1, 2.0)
    assert law.curvature((0.0, 0.0, 0.0), 0.5, 0.0, 0.0) == (2.0, True)
    assert law.curvature((0.0, 0.0, 0.0), -0.5, 0.0, 0.0, steering_scale=0.5) == (
        -1.0,
        True,
    )
    assert law.curvature((0.0, 0.0, 0.0), 0.0, 0.0, 1.5) == (1.5, False)


def test_a_curvature_that_is_its_bound_is_not_clipped() -> None:
    law = LookAheadAlignment(0.1, 2.0)
    for bound in (-2.0, 2.0):
        assert law.curvature((0.0, 0.0, 0.0), 0.0, 0.0, bound) == (bound, False)


def test_at_first_both_targets_ask_for_the_arc_through_them() -> None:
    """4 y / ell^2 for a target y aside, in metres whatever the look-ahead."""
    ell = 0.1
    fixed = LookAheadAlignment(ell, 50.0, Pose2(0.0, 0.002, 0.0))
    assert fixed.curvature((0.0, 0.0, 0.0), 0.0, 0.0, 0.0)[0] == pytest.approx(0.8)
    sliding = LookAheadAlignment(ell, 50.0)
    assert sliding.curvature((0.0, 0.0, 0.0), 0.002, 0.0, 0.0)[0] == pytest.approx(0.8)


@pytest.mark.parametrize("turn", [0.7, 2.0, -2.5])
def test_a_fixed_target_does_not_depend_on_where_the_axes_point(turn: float) -> None:
    goal = Pose2(0.3, 0.1, 0.2)
    start = Pose2(-0.1, 0.02, 0.1)
    turned = Pose2(0.0, 0.0, turn)
    asked = [
        LookAheadAlignment(0.1, 50.0, X_goal).curvature(
            (X.x, X.y, X.yaw), 0.0, 0.0, 0.0
        )[0]
        for X_goal, X in (
            (goal, start),
            (turned.compose(goal), turned.compose(start)),
        )
    ]
    assert asked[1] == pytest.approx(asked[0])
    assert abs(asked[0]) > 1.0
