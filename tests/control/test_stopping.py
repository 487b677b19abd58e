"""A stop by levels, and the watch on joints that run away."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.control.limits import TORQUE_TIME, ArmLimits, ArmReading
from pushpressslide.control.stopping import (
    BEYOND,
    CALM,
    FLIP_SPEED,
    FLIPS,
    GRACE,
    GROWTH_TICKS,
    LONGEST,
    REST_TIME,
    JointWatch,
    Stop,
    StopLevel,
)
from pushpressslide.core.control import BrakeCommand, JointCommand, TipCommand

LIMIT = 2.0  # [rad/s]
PERIOD = 0.004
ZERO = (0.0, 0.0, 0.0)
LED = TipCommand(ZERO, ZERO, ZERO, ZERO, ZERO, 0.0, 0.0, 0.0, 5.0, 0.0)
LIMITS = ArmLimits(
    lower=np.full(2, -2.0),
    upper=np.full(2, 2.0),
    velocity=np.full(2, LIMIT),
    effort=np.full(2, 50.0),
    torque_rate=np.full(2, 1e3),
)


def first_complaint(rates: list[float]) -> int | None:
    """Return the first tick at which a watch of one joint complains of its rates."""
    watch = JointWatch([LIMIT])
    for tick, rate in enumerate(rates):
        if watch.step([rate]) is not None:
            return tick
    return None


@given(st.floats(0.05, LIMIT), st.floats(0.6, 2.0), st.floats(0.0, 6.3))
def test_a_joint_that_is_led_does_not_run_away(
    speed: float, period: float, phase: float
) -> None:
    times = np.arange(0.0, 2.0, PERIOD)
    rates = speed * np.sin(2.0 * np.pi * times / period + phase)
    rates *= np.minimum(times / 0.3, 1.0)  # from rest
    assert first_complaint(rates.tolist()) is None


@given(st.floats(1.1, 50.0), st.floats(1e-4, 0.1))
def test_a_joint_that_turns_about_ever_faster_runs_away(
    gain: float, first: float
) -> None:
    rates = [first]
    while abs(rates[-1]) < 1e6:
        rates.append(-gain * rates[-1])
    found = first_complaint(rates)
    assert found is not None
    seen = [abs(rate) for rate in rates[: found + 1]]
    # at once where it is far too fast, else once it turned about often enough
    late = [speed for speed in seen[:-1] if speed > FLIP_SPEED * LIMIT]
    assert len(late) <= FLIPS + 1
    assert max(seen[:-1], default=0.0) <= BEYOND * LIMIT


def test_a_joint_that_becomes_faster_from_tick_to_tick_runs_away() -> None:
    step = 1.2 * CALM * LIMIT
    assert first_complaint([step * n for n in range(30)]) == GROWTH_TICKS
    assert first_complaint([0.5 * step * n for n in range(20)]) is None


def test_a_joint_far_above_its_limit_runs_away_at_once() -> None:
    assert first_complaint([0.0, 1.1 * BEYOND * LIMIT]) == 1
    assert first_complaint([0.0, 0.9 * BEYOND * LIMIT]) is None


def test_a_rate_that_is_no_number_counts_as_running_away() -> None:
    assert first_complaint([0.0, math.nan]) == 1


def reading(speed: float = 0.0, share: float = 0.0) -> ArmReading:
    return ArmReading(np.array([0.3, -0.4]), np.array([speed, 0.0]), share)


def stop(arms: int = 1) -> Stop:
    return Stop([LIMITS] * arms, 0.0, PERIOD)


def test_an_arm_that_obeys_draws_back() -> None:
    one = stop()
    for tick in range(200):
        assert one.step(tick * PERIOD, [reading(0.5)], [None], (LED,)) == (LED,)
    assert not one.took_over


def test_an_arm_that_is_asked_for_too_much_torque_holds_where_it_is() -> None:
    one = stop()
    commands = ()
    for tick in range(round(TORQUE_TIME / PERIOD) + 2):
        commands = one.step(tick * PERIOD, [reading(0.1, 1.5)], [None], (LED,))
    (held,) = commands
    assert isinstance(held, JointCommand)
    np.testing.assert_array_equal(held.position, [0.3, -0.4])
    np.testing.assert_array_equal(held.velocity, [0.0, 0.0])
    # it stays there, wherever the arm is by then
    elsewhere = ArmReading(np.array([0.5, 0.5]), np.zeros(2))
    assert one.step(1.0, [elsewhere], [None], (LED,)) == (held,)


def test_an_arm_that_stays_too_fast_holds_where_it_is() -> None:
    one = stop()
    fast = reading(1.1 * LIMIT)
    assert one.step(0.5 * GRACE, [fast], [None], (LED,)) == (LED,)
    (held,) = one.step(1.1 * GRACE, [fast], [None], (LED,))
    assert isinstance(held, JointCommand)


def test_an_arm_that_runs_away_brakes_and_the_others_hold() -> None:
    two = stop(arms=2)
    commands = two.step(
        0.0, [reading(), reading(9.0)], [None, "joint 1 ..."], (LED, LED)
    )
    assert isinstance(commands[0], JointCommand)
    assert isinstance(commands[1], BrakeCommand)
    assert two.levels == [StopLevel.HOLD, StopLevel.BRAKE]
    # and goes on to, when its joints are slow again
    again = two.step(PERIOD, [reading(), reading()], [None, None], (LED, LED))
    assert isinstance(again[1], BrakeCommand)


def test_a_stop_is_over_when_all_joints_have_come_to_rest() -> None:
    one = stop()
    one.step(0.0, [reading(9.0)], ["joint 1 ..."], (LED,))
    assert not one.at_rest(0.0)
    for tick in range(round(REST_TIME / PERIOD) + 1):
        one.step((tick + 1) * PERIOD, [reading()], [None], (LED,))
    assert one.at_rest(REST_TIME)


def test_a_stop_is_over_at_last_where_joints_never_rest() -> None:
    one = stop()
    one.step(0.0, [reading(9.0)], ["joint 1 ..."], (LED,))
    assert not one.at_rest(0.9 * LONGEST)
    assert one.at_rest(1.1 * LONGEST)


def test_an_arm_that_gives_up_late_is_given_as_long_to_come_to_rest() -> None:
    one = stop()
    late = 2.0 * LONGEST
    one.step(0.0, [reading(0.5)], [None], (LED,))
    one.step(late, [reading(9.0)], ["joint 1 ..."], (LED,))
    assert not one.at_rest(late)
    assert one.at_rest(late + 1.1 * LONGEST)


@pytest.mark.parametrize("command", [LED, None])
def test_tips_without_arms_draw_back_whatever_happens(
    command: TipCommand | None,
) -> None:
    one = Stop([], 0.0, PERIOD)
    assert one.step(0.0, [], [], (command,)) == (command,)
    assert not one.took_over
