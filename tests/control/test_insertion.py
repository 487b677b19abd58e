"""How tips follow an object into an opening."""

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.insertion import (
    BRAKE,
    LANDING,
    Insertion,
    braking,
    insertion_of,
)
from pushpressslide.core.control import TipState

TASK = pps.load_task("press-fit")
PLAN = pps.plan(TASK)
ENTRY = Insertion(0.15, ((1, 0.27), (0, 0.28)))
# [m] of the tips, 4 mm into the face; that of arm 1 first
PRESSED = ((0.0, 0.0, 0.266), (0.0, 0.0, 0.276))


def at(left: float, right: float, speed: float = 0.0) -> tuple[TipState, ...]:
    """Tips at depths [m] in the opening; the right arm is number 1 and has the first
    contact.
    """
    places = ((0.0, 0.0, 0.28 - left), (0.0, 0.0, 0.27 - right))
    inwards = (0.0, 0.0, -speed)
    none = (0.0, 0.0, 0.0)
    return tuple(TipState(place, inwards, none) for place in places)


def test_the_depth_is_that_of_the_tip_below_where_it_touched() -> None:
    assert ENTRY.depths(at(0.0, 0.13)) == pytest.approx([0.13, 0.0])
    made = insertion_of(PLAN.task.scene, PLAN.goal, PLAN.contacts)
    assert made is not None
    assert (made.stop, made.tips) == (0.15, ((0, 0.27), (1, 0.27)))


def test_one_deep_tip_begins_it_and_all_must_be_deep_to_end_it() -> None:
    # as deep as the press alone takes them
    assert ENTRY.speeds(at(0.005, 0.004), PRESSED) == [None, None]
    assert None not in ENTRY.speeds(at(0.007, 0.0), PRESSED)
    assert not ENTRY.seated(at(0.1495, 0.12))
    assert ENTRY.seated(at(0.1495, 0.149))


def test_tips_that_still_move_are_not_seated() -> None:
    assert not ENTRY.seated(at(0.1495, 0.149, speed=0.05))


def test_the_speed_lets_the_tips_stop_before_the_back() -> None:
    right, left = ENTRY.speeds(at(0.10, 0.16), PRESSED)
    way = 0.05
    assert right == pytest.approx(LANDING)
    assert math.sqrt(left**2 - 2.0 * BRAKE * way) == pytest.approx(LANDING)


def test_a_tip_braked_so_from_what_it_may_do_meets_the_back_at_the_landing_speed() -> (
    None
):
    depth = 0.02
    dt = 1e-4
    speed = ENTRY.speeds(at(depth, depth), PRESSED)[0]
    while depth < ENTRY.stop:
        allowed = ENTRY.speeds(at(depth, depth), PRESSED)[0]
        speed -= braking(speed, allowed) * dt
        depth += speed * dt
    assert speed == pytest.approx(LANDING, rel=0.1)
    assert braking(-0.1, LANDING) == 0.0


def test_only_a_goal_within_the_opening_is_entered() -> None:
    scene = TASK.scene
    assert scene.enters(TASK.goal)
    opening = TASK.support.opening
    assert opening is not None
    upright = pps.load_task("press-fit", ["goal.x=0.7", "goal.y=0", "goal.yaw_deg=0"])
    assert not scene.enters(upright.goal)
    entered = [scene.enters(query.goal) for query in TASK.queries()]
    assert entered[:2] == [False, False]
    assert entered[-1]


def test_tips_that_press_as_at_first_are_not_going_in() -> None:
    """They are from 2 mm deeper on, one of them at least."""
    for deeper, enters in ((0.0019, False), (0.0021, True)):
        for left, right in ((deeper, 0.0), (0.0, deeper)):
            speeds = ENTRY.speeds(at(0.004 + left, 0.004 + right), PRESSED)
            assert (None not in speeds) == enters


def test_an_object_is_seated_close_to_the_back_and_when_it_rests() -> None:
    assert ENTRY.seated(at(0.1481, 0.1481))
    assert not ENTRY.seated(at(0.1479, 0.15))
    assert not ENTRY.seated(at(0.15, 0.1479))
    for speed, rests in ((0.009, True), (0.011, False), (-0.011, False)):
        assert ENTRY.seated(at(0.15, 0.15, speed)) == rests


def test_one_tip_that_moves_keeps_both_from_being_seated() -> None:
    for moving in range(2):
        tips = list(at(0.15, 0.15))
        assert ENTRY.seated(tips)
        tips[moving] = replace(tips[moving], velocity=(0.0, 0.0, -0.02))
        assert not ENTRY.seated(tips)


def test_a_tip_is_braked_as_its_speed_asks_and_no_harder() -> None:
    assert braking(0.1, 0.1) == BRAKE
    assert braking(0.05, 0.1) == pytest.approx(0.25 * BRAKE)
    assert braking(0.3, 0.1) == BRAKE
    assert braking(0.0, 0.1) == 0.0


def test_beyond_the_back_a_tip_goes_at_the_landing_speed() -> None:
    assert ENTRY.speeds(at(0.2, 0.2), PRESSED) == pytest.approx([LANDING, LANDING])
    assert 0.0 < LANDING < 0.2


def test_a_task_without_an_opening_has_nothing_to_enter() -> None:
    assert insertion_of(TASK.scene, PLAN.queries[0].goal, PLAN.contacts) is None
    flat = pps.load_task("press-slide")
    assert insertion_of(flat.scene, flat.goal, pps.plan(flat).contacts) is None
