"""How tips follow an object into an opening."""

import math

import pytest

from pushpressslide import load_task
from pushpressslide.core.control import TipState
from pushpressslide.core.plan import Contact
from pushpressslide.pipeline.entry import BRAKE, LANDING, Entry

ENTRY = Entry(0.15, (0.02, 0.03))
CONTACT = Contact(1, "top", (0.02, -0.25), (0.0, 0.0), 0.25, 60.0)
STILL = (0.0, 0.0, 0.0)


def test_the_depth_is_that_of_the_tip_below_where_it_touched() -> None:
    assert ENTRY.depth(TipState((0.0, 0.0, 0.28), STILL, STILL), CONTACT) == pytest.approx(0.0)
    assert ENTRY.depth(TipState((0.0, 0.0, 0.15), STILL, STILL), CONTACT) == pytest.approx(0.13)


def test_one_deep_tip_begins_it_and_all_must_be_deep_to_end_it() -> None:
    assert not ENTRY.begun([0.002, 0.001])
    assert ENTRY.begun([0.004, -0.001])
    assert not ENTRY.ended([0.1495, 0.12])
    assert ENTRY.ended([0.1495, 0.149])


def test_the_speed_lets_the_tips_stop_before_the_back() -> None:
    way, speed = 0.05, ENTRY.speed(0.10)
    left = math.sqrt(speed**2 - 2.0 * BRAKE * way)
    assert left == pytest.approx(LANDING)
    assert ENTRY.speed(0.16) == pytest.approx(LANDING)


def test_only_a_goal_within_the_opening_is_entered() -> None:
    assert load_task("press-fit").enters
    opening = load_task("press-fit").support.opening
    assert opening is not None
    upright = load_task("press-fit", ["goal.x=0.7", "goal.y=0", "goal.yaw_deg=0"])
    assert not upright.enters
    assert not any(part.enters for part in load_task("press-fit").parts[:2])
    assert load_task("press-fit").parts[-1].enters
