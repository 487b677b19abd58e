"""What the last look says of a goal."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.control.estimator import filtered_noise, pose_gain
from pushpressslide.control.last_look import LastLook
from pushpressslide.core import margins
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.pose import Pose2
from pushpressslide.core.sensing import Sensing

GOAL = Pose2(0.4, -0.2, math.pi)
ALLOWED = Tolerance(0.01, math.radians(2.0))


def code(off: float, turned: float, place: float, yaw: float) -> str:
    """Code at an error in shares of the tolerances, with deviations in the same."""
    X_WG = Pose2(GOAL.x, GOAL.y + off * 0.01, GOAL.yaw - math.radians(2.0 * turned))
    spread = (0.01 * place, math.radians(2.0 * yaw))
    return LastLook(X_WG, spread).ending(GOAL, ALLOWED).code


@pytest.mark.parametrize(
    ("off", "turned", "place", "yaw", "expected"),
    [
        (0.99, 0.99, 0.0, 0.0, "goal_reached"),
        (1.01, 0.0, 0.0, 0.0, "goal_missed"),
        (0.0, 1.01, 0.0, 0.0, "goal_missed"),
        (0.79, 0.0, 0.1, 0.1, "goal_reached"),
        (0.81, 0.0, 0.1, 0.0, "not_verified"),
        (0.0, 0.81, 0.0, 0.1, "not_verified"),
        (1.19, 0.0, 0.1, 0.0, "not_verified"),
        (1.21, 0.0, 0.1, 0.0, "goal_missed"),
        (0.0, 0.0, 0.51, 0.0, "not_verified"),
        (0.9, 0.0, 0.0, 0.4, "goal_reached"),
    ],
)
def test_a_goal_is_reached_or_missed_only_by_two_standard_deviations(
    off: float, turned: float, place: float, yaw: float, expected: str
) -> None:
    assert code(off, turned, place, yaw) == expected


def test_a_look_that_may_go_on_is_surer() -> None:
    """Whoever looks until two deviations fit is deceived too often."""
    look = LastLook(Pose2(GOAL.x + 0.0075, GOAL.y, GOAL.yaw), (0.001, 0.0))
    assert look.ending(GOAL, ALLOWED).code == "goal_reached"
    early = look.ending(GOAL, ALLOWED, margins.EARLY_DOUBT)
    assert early.code == "not_verified"


@pytest.mark.parametrize(
    ("place", "yaw", "expected"),
    [(0.24, 0.24, True), (0.26, 0.0, False), (0.0, 0.26, False)],
)
def test_a_look_tells_if_the_inner_half_of_the_tolerance_would_be_verified(
    place: float, yaw: float, expected: bool
) -> None:
    look = LastLook(GOAL, (0.01 * place, math.radians(2.0 * yaw)))
    assert look.tells(ALLOWED) is expected


def test_what_is_not_verified_says_what_was_seen_and_how_well() -> None:
    look = LastLook(Pose2(GOAL.x + 0.009, GOAL.y, GOAL.yaw), (0.001, 0.0))
    ending = look.ending(GOAL, ALLOWED)
    assert ending.text == "seen 9.0 mm and 0.0 deg off, known to 2.0 mm and 0.0 deg"


def test_the_noise_of_a_filtered_pose_is_that_of_the_filter() -> None:
    sensing = Sensing(position_noise=8e-4, yaw_noise=1e-3)
    gain = pose_gain(sensing)
    random = np.random.default_rng(1)
    value = 0.0
    values = []
    for noise in random.normal(scale=8e-4, size=200_000).tolist():
        value += gain * (noise - value)
        values.append(value)
    place, yaw = filtered_noise(sensing)
    assert place == pytest.approx(float(np.std(values[1000:])), rel=0.03)
    assert yaw == pytest.approx(place * 1e-3 / 8e-4)


def test_a_filter_of_its_own_spread_adds_none() -> None:
    assert filtered_noise(Sensing(position_noise=1e-3, pose_rate=30.0)) == (0.0, 0.0)


def test_what_was_not_seen_since_the_tips_let_go_is_not_verified() -> None:
    look = LastLook(GOAL, (0.0, 0.0), after_release=False)
    ending = look.ending(GOAL, ALLOWED)
    assert ending.code == "not_verified"
    assert (
        ending.text == "seen 0.0 mm and 0.0 deg off before the tips let go, not since"
    )
    assert not look.tells(ALLOWED)
    missed = LastLook(Pose2(), (0.0, 0.0), after_release=False)
    assert missed.ending(GOAL, ALLOWED).code == "goal_missed"


def test_what_more_pictures_do_not_lessen_is_judged_the_same_all_the_time() -> None:
    look = LastLook(Pose2(GOAL.x + 0.005, GOAL.y, GOAL.yaw), (0.0, 0.0), 0.0024)
    for doubt in (margins.EARLY_DOUBT, margins.DOUBT):
        assert look.ending(GOAL, ALLOWED, doubt).code == "goal_reached"
        worse = look._replace(lasting_error=0.0026)
        assert worse.ending(GOAL, ALLOWED, doubt).code == "not_verified"
    assert look.tells(ALLOWED)
    assert not look._replace(lasting_error=0.0026).tells(ALLOWED)


def test_resolution_and_drift_of_a_camera_last() -> None:
    assert Sensing(position_noise=0.01).lasting_error(60.0) == 0.0
    steps = np.random.default_rng(2).uniform(-0.01, 0.01, 100_000)
    coarse = Sensing(position_step=0.02).lasting_error(60.0)
    assert coarse == pytest.approx(float(np.std(steps)), rel=0.01)
    both = Sensing(position_step=0.02, position_drift=1e-3)
    assert both.lasting_error(64.0) == pytest.approx(math.hypot(coarse, 8e-3))
