"""How tips follow an object into an opening."""

import math

import pytest

import pushpressslide as pps
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.pose import Pose2
from pushpressslide.pipeline.entry import BRAKE, LANDING, Entry, entry

ENTRY = Entry(0.15, ((1, 0.27), (0, 0.28)))


def at(left: float, right: float) -> Measurement:
    """Tips at depths [m] in the opening; the right arm is number 1 and has the first contact."""
    places = ((0.0, 0.0, 0.28 - left), (0.0, 0.0, 0.27 - right))
    still = (0.0, 0.0, 0.0)
    return Measurement(0.0, Pose2(), tuple(TipState(place, still, still) for place in places))


def test_the_depth_is_that_of_the_tip_below_where_it_touched() -> None:
    assert ENTRY.depths(at(0.0, 0.13)) == pytest.approx([0.13, 0.0])
    made = entry(pps.plan(pps.load_task("press-fit")))
    assert made is not None
    assert (made.stop, made.tips) == (0.15, ((0, 0.27), (1, 0.27)))


def test_one_deep_tip_begins_it_and_all_must_be_deep_to_end_it() -> None:
    assert ENTRY.speeds(at(0.002, 0.001)) == [None, None]
    assert None not in ENTRY.speeds(at(0.004, -0.001))
    assert not ENTRY.seated(at(0.1495, 0.12))
    assert ENTRY.seated(at(0.1495, 0.149))


def test_the_speed_lets_the_tips_stop_before_the_back() -> None:
    (right, left), way = ENTRY.speeds(at(0.10, 0.16)), 0.05
    assert right == pytest.approx(LANDING)
    assert math.sqrt(left**2 - 2.0 * BRAKE * way) == pytest.approx(LANDING)


def test_only_a_goal_within_the_opening_is_entered() -> None:
    assert pps.load_task("press-fit").enters
    opening = pps.load_task("press-fit").support.opening
    assert opening is not None
    upright = pps.load_task("press-fit", ["goal.x=0.7", "goal.y=0", "goal.yaw_deg=0"])
    assert not upright.enters
    assert not any(part.enters for part in pps.load_task("press-fit").parts[:2])
    assert pps.load_task("press-fit").parts[-1].enters
