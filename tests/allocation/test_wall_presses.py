"""Presses that hold an object on a wall and slide it there."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.allocation.press_loads import TwoPresses, wall_press
from pushpressslide.allocation.wall_presses import wall_loads
from pushpressslide.core.wrench import Twist

WEIGHT = 19.62
USES = (0.7, 0.8, 0.9)


def presses(mu_a=0.8, mu_w=0.2, cap=100.0, left=(0.02, 0.25), right=(0.02, -0.25)):
    return lambda use: TwoPresses(left, right, 0.0, mu_w, use * mu_a, 0.2, cap)


def down(angle: float) -> tuple[float, float]:
    return (WEIGHT * math.cos(angle), WEIGHT * math.sin(angle))


@settings(max_examples=50, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(0.0, 6.0), st.floats(-0.5, 0.5))
def test_the_loads_drive_every_step_of_a_turn_and_a_little_less_does_not(
    heading, first, turn
) -> None:
    twist = Twist(math.cos(heading), math.sin(heading), 3.0)
    steps = [(twist, down(first + turn * i)) for i in range(4)]
    loads = wall_loads(presses(), steps, USES, 2.0)
    pair = presses()(USES[0])
    assert all(pair.loads_for(loads, *step).status == "ok" for step in steps)
    less = (0.99 * loads[0], 0.99 * loads[1])
    assert not all(pair.loads_for(less, *step).status == "ok" for step in steps)


def test_level_contacts_that_lift_straight_up_need_what_the_closed_form_says() -> None:
    level = presses(left=(0.25, 0.0), right=(-0.25, 0.0))
    loads = wall_loads(level, [(Twist(0.0, 1.0, 0.0), (0.0, -WEIGHT))], USES, 2.0)
    assert sum(loads) == pytest.approx(
        wall_press(WEIGHT, 0.7 * 0.8, 0.2, 1.0), rel=1e-6
    )


def test_what_is_asked_at_least_is_given_and_the_cap_lets_more_of_the_friction_be_used() -> (
    None
):
    step = (Twist(0.0, 1.0, 0.0), (0.0, -WEIGHT))
    assert wall_loads(presses(), [step], USES, 65.0) == (65.0, 65.0)
    tight = wall_loads(presses(cap=20.0), [step], USES, 2.0)
    assert max(tight) <= 20.0
    assert presses(cap=20.0)(USES[0]).loads_for(tight, *step).status != "ok"


@pytest.mark.parametrize(
    ("given", "least", "says"),
    [
        ({"cap": 8.0}, 2.0, "to hold 19.6 N"),
        ({"mu_a": 0.3, "mu_w": 0.3}, 2.0, "must exceed the wall's, 0.30"),
        ({"cap": 15.0}, 2.0, "allowed 15 N by limits.normal_force"),
        ({"cap": 15.0}, 15.1, "takes 1[5-9].* N or more of each arm; allowed 15 N"),
        (
            {"cap": 60.0},
            65.4,
            "65.4 N of each arm; allowed 60 N by limits.normal_force",
        ),
    ],
)
def test_what_cannot_be_is_refused_with_the_number_that_decides(
    given, least, says
) -> None:
    step = (Twist(0.0, 1.0, 0.0), (0.0, -WEIGHT))
    with pytest.raises(ValueError, match=says):
        wall_loads(presses(**given), [step], USES, least)


@pytest.mark.parametrize(("up", "motion"), [(1.0, (0.0, 2.0)), (0.0, (3.0, 0.0))])
def test_a_refusal_names_the_press_that_the_direction_of_sliding_takes(
    up, motion
) -> None:
    step = (Twist(*motion, 0.0), (0.0, -WEIGHT))
    each = 0.5 * wall_press(WEIGHT, USES[-1] * 0.8, 0.2, up)
    with pytest.raises(ValueError, match=f"takes {each:.1f} N or more"):
        wall_loads(presses(cap=0.8 * each), [step], USES, 2.0)


def test_a_turn_on_the_spot_does_not_lift() -> None:
    step = (Twist(0.0, 0.0, 1.0), (0.0, -WEIGHT))
    each = 0.5 * wall_press(WEIGHT, USES[-1] * 0.8, 0.2, 0.0)
    with pytest.raises(ValueError, match=f"takes {each:.1f} N or more"):
        wall_loads(presses(cap=0.95 * each), [step], USES, 2.0)


def test_one_step_that_the_cap_does_not_allow_is_enough_to_refuse_all() -> None:
    down_the_wall = (Twist(0.0, -1.0, 0.0), (0.0, -WEIGHT))
    up_the_wall = (Twist(0.0, 1.0, 0.0), (0.0, -WEIGHT))
    each = 0.5 * wall_press(WEIGHT, USES[-1] * 0.8, 0.2, 1.0)
    tight = presses(cap=0.95 * each)
    assert max(wall_loads(tight, [down_the_wall], USES, 2.0)) <= 0.95 * each
    for steps in ([down_the_wall, up_the_wall], [up_the_wall, down_the_wall]):
        with pytest.raises(ValueError, match=f"takes {each:.1f} N or more"):
            wall_loads(tight, steps, USES, 2.0)
