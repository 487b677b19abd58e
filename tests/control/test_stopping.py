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
    own_rates,
)
from pushpressslide.core import margins
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


def watched(*rates: float) -> list[str | None]:
    """Verdicts of a watch on one joint at each of its rates [rad/s]."""
    watch = JointWatch([LIMIT])
    return [watch.step([rate]) for rate in rates]


def test_a_joint_half_above_its_limit_is_still_led() -> None:
    """As one is that brakes by a step that large, or is led backwards."""
    most = BEYOND * LIMIT
    assert watched(most) == [None]
    assert watched(-most) == [None]
    assert watched(1.001 * most)[0] is not None
    assert watched(-1.001 * most)[0] is not None
    assert watched(*(0.9 * most, 0.0) * 9) == [None] * 18


def test_a_change_that_counts_is_one_of_the_share_or_more() -> None:
    step = CALM * LIMIT
    exactly = [step * n for n in range(1, GROWTH_TICKS + 1)]
    assert watched(*exactly)[-1] is not None
    assert watched(*(-rate for rate in exactly))[-1] is not None
    assert not any(watched(*(0.999 * rate for rate in exactly)))


def test_growth_counts_only_tick_after_tick() -> None:
    """A calm tick, or one that slows the joint, begins the count anew."""
    step = 1.1 * CALM * LIMIT
    assert not any(watched(step, 2 * step, 2 * step, 3 * step, 4 * step, 4 * step))
    assert not any(watched(step, 2 * step, step, 2 * step, 3 * step, 2 * step))
    ran = watched(step, 2 * step, 3 * step)
    assert ran[:2] == [None, None]
    assert ran[2] is not None
    assert "faster" in ran[2]


def test_turning_about_counts_only_tick_after_tick() -> None:
    fast = 2.0 * FLIP_SPEED * LIMIT
    about = watched(fast, -fast, fast, -fast)
    assert about[:3] == [None, None, None]
    assert about[3] is not None
    assert "turns about" in about[3]
    assert not any(watched(fast, -fast, fast, fast, -fast, fast))
    slow = 0.9 * FLIP_SPEED * LIMIT
    assert not any(watched(*(slow, -slow) * 9))
    # at its slower end: from fast to slow and back it is led
    assert not any(watched(*(2.0 * fast, -slow) * 9))


def test_a_joint_that_stops_in_between_does_not_turn_about() -> None:
    fast = 4.0 * FLIP_SPEED * LIMIT
    assert not any(watched(*(fast, 0.0, -fast, 0.0) * 5))


def test_the_first_joint_that_runs_away_is_named() -> None:
    watch = JointWatch([LIMIT, 2.0 * LIMIT])
    far = 1.1 * BEYOND * LIMIT
    text = watch.step([far, 2.0 * far])
    assert text is not None
    assert text.startswith("joint 1 at 3.30 rad/s, allowed 2 rad/s")
    text = watch.step([0.0, 2.0 * far + 0.5])
    assert text is not None
    assert text.startswith("joint 2 at")
    # by its own limit
    assert JointWatch([LIMIT, 2.0 * LIMIT]).step([0.0, far]) is None


def test_a_second_joint_is_counted_while_the_first_one_runs_away() -> None:
    watch = JointWatch([LIMIT, LIMIT])
    step = 1.1 * CALM * LIMIT
    far = 2.0 * BEYOND * LIMIT
    said = [watch.step([far * n, step * n]) for n in range(1, 4)]
    assert all(said)
    text = watch.step([3.0 * far, 4.0 * step])  # the first has become calm
    assert text is not None
    assert text.startswith("joint 2 became faster")


def test_joints_that_run_away_are_noticed_within_a_few_ticks() -> None:
    """At speeds that are small for an arm: a tenth of its limit, grown by a fifth."""
    turning = watched(*(0.2, -0.2) * 4)
    growing = watched(*(0.4 * n for n in range(8)))
    assert any(turning)
    assert any(growing[:5])
    assert any(watched(2.0 * LIMIT))


def ticks_to(one: Stop, level: StopLevel, at: ArmReading) -> float | None:
    """Return when [s] an arm comes to a level, if it does within a second."""
    for tick in range(250):
        one.step(tick * PERIOD, [at], [None], (LED,))
        if one.levels == [level]:
            return tick * PERIOD
    return None


def test_an_arm_may_ask_for_more_torque_for_a_short_time() -> None:
    assert ticks_to(stop(), StopLevel.HOLD, reading(share=1.0)) is None
    late = ticks_to(stop(), StopLevel.HOLD, reading(share=1.01))
    assert late == pytest.approx(TORQUE_TIME, abs=1.01 * PERIOD)
    quarter = Stop([LIMITS], 0.0, 0.25 * TORQUE_TIME)
    for _ in range(4):
        quarter.step(0.0, [reading(share=1.01)], [None], (LED,))
    assert quarter.levels == [StopLevel.DRAW_BACK]
    quarter.step(0.0, [reading(share=1.01)], [None], (LED,))
    assert quarter.levels == [StopLevel.HOLD]


def test_a_pause_of_the_torque_begins_its_time_anew() -> None:
    one = stop()
    for _ in range(5):
        for _ in range(round(0.9 * TORQUE_TIME / PERIOD)):
            one.step(0.0, [reading(share=1.5)], [None], (LED,))
        one.step(0.0, [reading(share=0.5)], [None], (LED,))
    assert not one.took_over


def test_an_arm_is_too_fast_above_its_limit_and_after_a_grace() -> None:
    assert ticks_to(stop(), StopLevel.HOLD, reading(LIMIT)) is None
    late = ticks_to(stop(), StopLevel.HOLD, reading(-1.01 * LIMIT))
    assert late is not None
    assert GRACE < late <= GRACE + PERIOD + 1e-9
    assert late < 0.2  # [s]
    # from when the stop began
    later = Stop([LIMITS], 5.0, PERIOD)
    later.step(5.0 + 0.9 * GRACE, [reading(1.1 * LIMIT)], [None], (LED,))
    assert not later.took_over
    later.step(5.0 + 1.1 * GRACE, [reading(1.1 * LIMIT)], [None], (LED,))
    assert later.took_over


def test_each_arm_is_judged_by_its_own_limits() -> None:
    quick = ArmLimits(
        LIMITS.lower, LIMITS.upper, 3.0 * LIMITS.velocity, LIMITS.effort, LIMITS.effort
    )
    two = Stop([LIMITS, quick], 0.0, PERIOD)
    fast = reading(2.0 * LIMIT)
    two.step(2.0 * GRACE, [reading(), fast], [None, None], (LED, LED))
    assert two.levels == [StopLevel.DRAW_BACK, StopLevel.DRAW_BACK]
    two.step(2.0 * GRACE, [fast, fast], [None, None], (LED, LED))
    assert two.levels == [StopLevel.HOLD, StopLevel.DRAW_BACK]


def test_an_arm_that_holds_lets_the_other_one_draw_back() -> None:
    two = stop(arms=2)
    fast = reading(1.1 * LIMIT)
    held, led = two.step(2.0 * GRACE, [fast, reading()], [None, None], (LED, LED))
    assert isinstance(held, JointCommand)
    assert led == LED


@pytest.mark.parametrize(("share", "rests"), [(0.9, True), (1.1, False)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_joints_rest_below_a_hundredth_of_their_limits(
    share: float, rests: bool, side: float
) -> None:
    one = stop()
    for tick in range(round(REST_TIME / PERIOD) + 1):
        slow = reading(side * share * 0.01 * LIMIT)
        one.step(tick * PERIOD, [slow], [None], (LED,))
    assert one.at_rest(0.0) == rests


def test_all_joints_have_to_rest_without_a_pause() -> None:
    two = stop(arms=2)
    ticks = round(REST_TIME / PERIOD)
    still = reading()
    moving = reading(0.5)
    for arms in ((still, moving), (moving, still)):
        for _ in range(2 * ticks):
            two.step(0.0, arms, [None, None], (LED, LED))
        assert not two.at_rest(0.0)
    for _ in range(ticks - 2):
        two.step(0.0, [still, still], [None, None], (LED, LED))
    assert not two.at_rest(0.0)
    two.step(0.0, [moving, still], [None, None], (LED, LED))
    for _ in range(ticks - 2):
        two.step(0.0, [still, still], [None, None], (LED, LED))
    assert not two.at_rest(0.0)
    for _ in range(4):
        two.step(0.0, [still, still], [None, None], (LED, LED))
    assert two.at_rest(0.0)


def test_rest_is_counted_in_time_to_its_whole() -> None:
    one = Stop([LIMITS], 0.0, 0.25 * REST_TIME)
    for _ in range(3):
        one.step(0.0, [reading()], [None], (LED,))
    assert not one.at_rest(0.0)
    one.step(0.0, [reading()], [None], (LED,))
    assert one.at_rest(0.0)


def test_a_speed_that_is_no_number_is_no_rest() -> None:
    one = stop()
    for _ in range(100):
        one.step(0.0, [reading(math.nan)], [None], (LED,))
    assert not one.at_rest(0.0)


def test_a_stop_ends_within_two_seconds_and_not_at_once() -> None:
    one = Stop([LIMITS], 7.0, PERIOD)
    one.step(7.0, [reading(9.0)], ["joint 1 ..."], (LED,))
    assert not one.at_rest(7.0)
    assert not one.at_rest(8.0)
    assert one.at_rest(9.0)


def test_the_wait_for_rest_begins_once_when_an_arm_gives_up_first() -> None:
    two = stop(arms=2)
    two.step(1.0, [reading(9.0), reading(0.5)], ["joint 1 ...", None], (LED, LED))
    both = ["joint 1 ...", "joint 1 ..."]
    two.step(2.0, [reading(9.0), reading(9.0)], both, (LED, LED))
    assert not two.at_rest(1.0 + 0.99 * LONGEST)
    assert two.at_rest(1.0 + 1.01 * LONGEST)


def test_levels_go_up_as_less_is_asked_of_an_arm() -> None:
    assert StopLevel.DRAW_BACK < StopLevel.HOLD < StopLevel.BRAKE
    one = stop()
    one.step(2.0 * GRACE, [reading(1.1 * LIMIT)], [None], (LED,))
    assert one.levels == [StopLevel.HOLD]
    one.step(3.0 * GRACE, [reading()], [None], (LED,))
    assert one.levels == [StopLevel.HOLD]
    one.step(4.0 * GRACE, [reading()], ["joint 1 ..."], (LED,))
    assert one.levels == [StopLevel.BRAKE]


def test_a_joint_that_its_limit_pushes_back_does_not_run_away() -> None:
    near = 2.0 - 0.5 * margins.ARM.joint_buffer

    def rates(q: float, v: float) -> list[float]:
        return own_rates(LIMITS, ArmReading(np.array([q, 0.0]), np.array([v, 0.7])))

    assert rates(near, -1.0) == [0.0, 0.7]
    assert rates(-near, 1.0) == [0.0, 0.7]
    # one that moves on towards its limit may, and one that is elsewhere
    assert rates(near, 1.0) == [1.0, 0.7]
    assert rates(-near, -1.0) == [-1.0, 0.7]
    assert rates(1.9, -1.0) == [-1.0, 0.7]
