"""The guard: the limits it enforces, their timing and their messages."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.control.limits import (
    JOINT_JUMP,
    JUMP,
    MEAN_TIME,
    PEAK,
    POSITION_MARGIN,
    STOPPING_TIME,
    TORQUE_TIME,
    ArmLimits,
    ArmReading,
    Guard,
)
from pushpressslide.core import margins
from pushpressslide.core.control import Commands, JointCommand, TipCommand
from pushpressslide.core.record import Ending

LIMIT = 20.0  # [N]
ZERO = (0.0, 0.0, 0.0)
ARM = ArmLimits(
    lower=np.array([-1.0, -2.0]),
    upper=np.array([1.0, 2.0]),
    velocity=np.array([2.0, 3.0]),
    effort=np.array([80.0, 80.0]),
    torque_rate=np.array([1e3, 1e3]),
)
REST = ArmReading(np.zeros(2), np.zeros(2))
HOLD = TipCommand(ZERO, ZERO, ZERO, (1.0, 1.0, 1.0), ZERO, 0.0, 0.0, 0.0, 5.0, 0.0)


def guard(period: float = 0.002) -> Guard:
    return Guard(LIMIT, period, (ARM,))


def judged(
    judge: Guard,
    force: float = 0.0,
    reading: ArmReading = REST,
    command: TipCommand | JointCommand | None = None,
) -> Ending | None:
    commands: Commands = (command,)
    return judge.breach([force], [reading], commands)


def ticks_to_a_breach(judge: Guard, **tick: object) -> int | None:
    for i in range(500):
        if judged(judge, **tick) is not None:  # type: ignore[arg-type]
            return i + 1
    return None


def test_nothing_is_broken_at_rest() -> None:
    assert ticks_to_a_breach(guard(), command=HOLD, force=LIMIT) is None


@pytest.mark.parametrize("period", [0.001, 0.002, 0.005])
def test_a_mean_force_above_the_limit_ends_after_its_time(period: float) -> None:
    count = ticks_to_a_breach(guard(period), force=1.01 * LIMIT)
    assert count is not None
    assert count * period == pytest.approx(MEAN_TIME, abs=1.01 * period)


def test_a_single_sample_may_exceed_the_limit_but_not_by_half() -> None:
    judge = guard()
    for _ in range(20):
        assert judged(judge, force=0.5 * LIMIT) is None
    assert judged(judge, force=0.99 * PEAK * LIMIT) is None
    ending = judged(judge, force=1.01 * PEAK * LIMIT)
    assert ending is not None
    assert ending.code == "force_limit"
    assert ending.text == (
        "tip 0: 30.3 N in one sample, allowed 1.5 times limits.normal_force of 20 N"
    )


def test_what_is_no_number_breaks_a_limit() -> None:
    broken = judged(guard(), force=math.nan)
    assert broken is not None
    assert broken.code == "force_limit"
    judge = guard()
    judged(judge, command=HOLD)
    broken = judged(judge, command=replace(HOLD, position=(math.nan, 0.0, 0.0)))
    assert broken is not None
    assert broken.code == "reference_jump"


def test_the_mean_is_of_the_last_samples_only() -> None:
    judge = guard()
    for _ in range(100):
        assert judged(judge, force=0.0) is None
    count = ticks_to_a_breach(judge, force=2.0 * 0.7 * LIMIT)
    assert count is not None
    assert count <= MEAN_TIME / 0.002


@pytest.mark.parametrize("speed", [2.01, -2.01])
def test_a_joint_that_is_too_fast_breaks_its_limit_at_once(speed: float) -> None:
    fast = replace(REST, v=np.array([speed, 0.0]))
    ending = judged(guard(), reading=fast)
    assert ending is not None
    assert ending.code == "joint_limit"
    assert ending.text == "arm 0: joint 1 at 2.01 rad/s, allowed 2 rad/s"
    assert judged(guard(), reading=replace(REST, v=np.array([0.0, 2.9]))) is None


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_keeps_a_margin_to_its_end(side: float) -> None:
    inside = np.array([0.0, side * (2.0 - 1.1 * POSITION_MARGIN)])
    outside = np.array([0.0, side * (2.0 - 0.9 * POSITION_MARGIN)])
    assert judged(guard(), reading=replace(REST, q=inside)) is None
    ending = judged(guard(), reading=replace(REST, q=outside))
    assert ending is not None
    assert ending.code == "joint_limit"
    assert "joint 2 is 0.009 rad from its limit" in ending.text


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_may_not_approach_its_end_too_fast_to_stop(side: float) -> None:
    """Slower, or on its way back, it may be as near."""
    room = POSITION_MARGIN + 0.02
    near = replace(REST, q=np.array([0.0, side * (2.0 - room)]))
    speed = 0.02 / STOPPING_TIME
    fast = replace(near, v=np.array([0.0, side * 1.05 * speed]))
    ending = judged(guard(), reading=fast)
    assert ending is not None
    assert ending.code == "joint_limit"
    assert "joint 2 approaches its limit at 0.70 rad/s, 0.030 rad" in ending.text
    for v in (0.95 * side * speed, -1.5 * side * speed):
        assert judged(guard(), reading=replace(near, v=np.array([0.0, v]))) is None


@pytest.mark.parametrize("what", ["torque_share", "rate_share"])
def test_too_much_torque_may_be_asked_for_a_short_time_only(what: str) -> None:
    period = 0.002
    asked = replace(REST, **{what: 1.2})
    judge = guard(period)
    count = ticks_to_a_breach(judge, reading=asked)
    assert count is not None
    assert count * period == pytest.approx(TORQUE_TIME, abs=1.01 * period)
    judge = guard(period)
    for _ in range(5):  # a pause begins the time anew
        for _ in range(round(0.9 * TORQUE_TIME / period)):
            assert judged(judge, reading=asked) is None
        assert judged(judge) is None


def moved(x: float, stiffness: float = 1.0) -> TipCommand:
    return replace(HOLD, position=(x, 0.0, 0.0), stiffness=(stiffness, 1.0, 1.0))


def test_a_reference_that_jumps_is_refused() -> None:
    judge = guard()
    assert judged(judge, command=moved(0.0)) is None
    assert judged(judge, command=moved(0.99 * JUMP)) is None
    ending = judged(judge, command=moved(2.1 * JUMP))
    assert ending is not None
    assert ending.code == "reference_jump"
    assert "jumps by 22 mm, allowed 20 mm" in ending.text


def test_a_reference_may_jump_along_an_axis_that_does_not_hold_the_tip() -> None:
    judge = guard()
    assert judged(judge, command=moved(0.0, stiffness=0.0)) is None
    assert judged(judge, command=moved(1.0, stiffness=0.0)) is None


def test_a_new_placement_has_references_of_its_own() -> None:
    judge = guard()
    assert judged(judge, command=moved(0.0)) is None
    judge.forget_references()
    assert judged(judge, command=moved(1.0)) is None


def test_a_joint_reference_may_go_no_farther_than_a_joint_could() -> None:
    judge = guard(0.01)
    allowed = JOINT_JUMP * 0.01 * 3.0
    zero = np.zeros(2)
    assert judged(judge, command=JointCommand(zero, zero)) is None
    near = JointCommand(np.array([0.0, 0.9 * allowed]), zero)
    assert judged(judge, command=near) is None
    far = JointCommand(np.array([0.0, 2.1 * allowed]), zero)
    ending = judged(judge, command=far)
    assert ending is not None
    assert ending.code == "reference_jump"
    assert "joint 2" in ending.text


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_arm_that_draws_back_is_cramped_before_its_limit_is_broken(
    side: float,
) -> None:
    judge = guard()
    assert not judge.near_joint_limit([REST])
    inside = margins.ARM.joint_buffer
    assert inside > POSITION_MARGIN
    for room, near_joint_limit in ((inside + 0.001, False), (inside - 0.001, True)):
        near = ArmReading(np.array([0.0, side * (2.0 - room)]), np.zeros(2))
        assert judge.near_joint_limit([near]) == near_joint_limit
        assert judged(judge, reading=near) is None


def test_an_arm_that_begins_to_draw_back_near_a_limit_may_go_on_if_not_nearer() -> None:
    judge = guard()
    for room, near_joint_limit in (
        (0.02, False),
        (0.025, False),
        (0.016, False),
        (0.014, True),
    ):
        near = ArmReading(np.array([1.0 - room, 0.0]), np.zeros(2))
        assert judge.near_joint_limit([near]) == near_joint_limit
    judge.forget_references()
    assert not judge.near_joint_limit([ArmReading(np.array([0.986, 0.0]), np.zeros(2))])


def count(judge: Guard, readings: ArmReading) -> int | None:
    return ticks_to_a_breach(judge, reading=readings)


def test_what_is_just_allowed_breaks_no_limit() -> None:
    """A force, a speed, a torque, a place or a step that is the limit itself."""
    arm = replace(ARM, lower=np.zeros(2), upper=np.full(2, 9.0))
    judge = Guard(LIMIT, 0.002, (arm,))
    edge = ArmReading(np.array([POSITION_MARGIN, 5.0]), np.array([2.0, 3.0]), 1.0, 1.0)
    fast = JointCommand(np.zeros(2), np.zeros(2))
    step = JointCommand(JOINT_JUMP * 0.002 * arm.velocity, np.zeros(2))
    for command in (fast, step) * 100:
        assert judged(judge, 0.0, edge, command) is None
    assert judged(guard(1.0), force=LIMIT) is None
    judge = guard()
    assert judged(judge, PEAK * LIMIT, command=moved(0.0)) is None
    assert judged(judge, command=moved(JUMP)) is None


def test_torque_may_exceed_its_limit_for_its_time_exactly() -> None:
    period = 0.25 * TORQUE_TIME
    assert count(guard(period), replace(REST, torque_share=1.01)) == 5
    assert count(guard(period), replace(REST, torque_share=1.0)) is None


def test_a_tick_that_is_longer_than_the_mean_is_judged_by_itself() -> None:
    assert judged(guard(5.0 * MEAN_TIME), force=1.01 * LIMIT) is not None
    assert judged(guard(5.0 * MEAN_TIME), force=0.99 * LIMIT) is None


@pytest.mark.parametrize(
    ("shares", "words"),
    [
        ((1.3, 1.2), "1.30 times its torque"),
        ((1.2, 1.3), "1.30 times its change of torque"),
    ],
)
def test_an_ending_says_whether_a_torque_or_its_change_is_too_large(
    shares: tuple[float, float], words: str
) -> None:
    judge = guard(1.0)
    ending = judged(judge, reading=ArmReading(REST.q, REST.v, *shares))
    assert ending is not None
    assert ending.code == "torque_limit"
    assert words in ending.text


def test_the_fastest_joint_for_its_limit_is_named() -> None:
    reading = replace(REST, v=np.array([-2.5, 3.1]))
    ending = judged(guard(), reading=reading)
    assert ending is not None
    assert ending.text == "arm 0: joint 1 at 2.50 rad/s, allowed 2 rad/s"


def test_each_tip_and_arm_is_judged_and_named_by_its_number() -> None:
    judge = Guard(LIMIT, 0.002, (ARM, ARM))
    fast = replace(REST, v=np.array([9.0, 0.0]))
    ending = judge.breach([0.0, 0.0], [REST, fast], (None, None))
    assert ending is not None
    assert ending.text.startswith("arm 1: joint 1 at 9.00")
    ending = judge.breach([0.0, 2.0 * LIMIT], [REST, REST], (None, None))
    assert ending is not None
    assert ending.text.startswith("tip 1: 40.0 N in one sample")


def test_of_several_breaches_the_force_is_told_first_and_a_jump_last() -> None:
    judge = guard()
    assert judged(judge, command=moved(0.0)) is None
    fast = ArmReading(np.array([0.999, 0.0]), np.array([9.0, 0.0]))
    ending = judged(judge, 2.0 * LIMIT, fast, moved(1.0))
    assert ending is not None
    assert ending.code == "force_limit"
    ending = judged(judge, LIMIT, fast, moved(2.0))
    assert ending is not None
    assert "rad/s" in ending.text
    ending = judged(judge, LIMIT, replace(fast, v=REST.v), moved(3.0))
    assert ending is not None
    assert "from its limit" in ending.text
    ending = judged(judge, LIMIT, REST, moved(4.0))
    assert ending is not None
    assert ending.code == "reference_jump"


def test_a_breach_keeps_no_limit_from_being_watched() -> None:
    """What is watched over time is counted at every tick, whatever else is broken."""
    period = 0.25 * TORQUE_TIME
    judge = guard(period)
    asked = replace(REST, torque_share=1.2)
    for _ in range(4):
        ending = judged(judge, 2.0 * LIMIT, asked)
        assert ending is not None
        assert ending.code == "force_limit"
    for _ in range(2):
        ending = judged(judge, 0.0, asked)
    assert ending is not None
    assert ending.code == "torque_limit"


@pytest.mark.parametrize("yaw", [0.0, 0.6, -2.0])
@pytest.mark.parametrize("axis", range(3))
def test_a_jump_is_measured_along_the_axes_of_the_contact_that_hold(
    yaw: float, axis: int
) -> None:
    c = np.cos(yaw)
    s = np.sin(yaw)
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    stiffness = [0.0, 0.0, 0.0]
    stiffness[axis] = 5.0
    for other in range(3):
        judge = guard()
        hold = replace(HOLD, stiffness=tuple(stiffness), normal_yaw=yaw)
        away = tuple(1.5 * JUMP * axes[other])
        assert judged(judge, command=hold) is None
        ending = judged(judge, command=replace(hold, position=away))
        assert (ending is not None) == (other == axis)


def test_a_jump_counts_along_axes_that_hold_before_and_after_alone() -> None:
    for before, after in ((0.0, 1.0), (1.0, 0.0)):
        judge = guard()
        assert judged(judge, command=moved(0.0, before)) is None
        assert judged(judge, command=moved(1.0, after)) is None


def test_a_jump_along_several_axes_is_their_distance() -> None:
    judge = guard()
    assert judged(judge, command=HOLD) is None
    away = replace(HOLD, position=(0.8 * JUMP, 0.0, -0.8 * JUMP))
    ending = judged(judge, command=away)
    assert ending is not None
    assert "jumps by 23 mm" in ending.text


def test_a_command_of_another_kind_is_no_jump() -> None:
    judge = guard()
    joints = JointCommand(np.ones(2), np.zeros(2))
    for command in (moved(0.0), joints, moved(1.0), None, moved(2.0)):
        assert judged(judge, command=command) is None


def test_the_reference_that_jumps_farthest_for_its_joint_is_named() -> None:
    judge = guard(0.01)
    zero = np.zeros(2)
    assert judged(judge, command=JointCommand(zero, zero)) is None
    allowed = JOINT_JUMP * 0.01 * ARM.velocity
    far = JointCommand(np.array([-1.3, 1.1]) * allowed, zero)
    ending = judged(judge, command=far)
    assert ending is not None
    assert "joint 1 jumps by 0.052 rad, allowed 0.040 rad" in ending.text


def near(room: float) -> ArmReading:
    """Return a reading of an arm whose first joint has ``room`` [rad] to its limit."""
    return ArmReading(np.array([ARM.upper[0] - room, 0.0]), np.zeros(2))


def test_after_a_recovery_an_arm_may_leave_a_limit() -> None:
    """But come no nearer again than a little, and not at all once it is well inside."""
    judge = guard().successor(LIMIT, (None,))
    for room in (0.004, 0.001, 0.006, 0.003, 0.011, 0.0075):
        assert judged(judge, reading=near(room)) is None
    assert judged(judge, reading=near(0.0055)) is not None
    judge = guard().successor(LIMIT, (None,))
    for room in (0.05, 0.011):
        assert judged(judge, reading=near(room)) is None
    assert judged(judge, reading=near(0.009)) is not None


def test_at_first_an_arm_near_a_limit_breaks_it() -> None:
    assert judged(guard(), reading=near(0.009)) is not None
    assert judged(guard(), reading=near(0.011)) is None


def test_after_a_recovery_the_force_has_its_own_limit() -> None:
    judge = guard().successor(3.0 * LIMIT, (None,))
    assert judged(judge, force=PEAK * 3.0 * LIMIT) is None
    assert judged(judge, force=1.01 * PEAK * 3.0 * LIMIT) is not None


def test_after_a_recovery_references_go_on_from_where_the_arms_are_held() -> None:
    judge = guard().successor(LIMIT, (moved(0.0),))
    ending = judged(judge, command=moved(2.0 * JUMP))
    assert ending is not None
    assert ending.code == "reference_jump"
    judge = guard().successor(LIMIT, (moved(1.0),))
    assert judged(judge, command=moved(1.0 + 0.5 * JUMP)) is None


def test_an_arm_is_cramped_inside_the_buffer_and_not_at_its_edge() -> None:
    arm = replace(ARM, lower=np.zeros(2), upper=np.full(2, 9.0))
    judge = Guard(LIMIT, 0.002, (arm, arm))
    buffer = margins.ARM.joint_buffer
    middle = ArmReading(np.full(2, 4.0), np.zeros(2))
    edge = ArmReading(np.array([4.0, buffer]), np.zeros(2))
    inside = ArmReading(np.array([4.0, 0.99 * buffer]), np.zeros(2))
    assert not judge.near_joint_limit([middle, middle])
    assert not judge.near_joint_limit([edge, middle])
    assert judge.near_joint_limit([inside, middle])
    assert judge.near_joint_limit([middle, inside])


def test_margins_to_limits_are_small_and_times_short() -> None:
    """A hundredth of a radian is half a degree; a contact's force may peak for a tick."""
    assert 0.0 < POSITION_MARGIN < margins.ARM.joint_buffer
    judge = guard()
    calm = [judged(judge, force=0.5 * LIMIT) for _ in range(100)]
    assert not any(calm)
    assert judged(judge, force=2.0 * LIMIT) is not None
    assert judged(judge, command=moved(0.0)) is None
    assert judged(judge, command=moved(0.05)) is not None
    ticks = count(guard(), replace(REST, torque_share=1.2))
    assert ticks is not None
    assert ticks * 0.002 < 0.2
    ticks = ticks_to_a_breach(guard(), force=1.2 * LIMIT)
    assert ticks is not None
    assert ticks * 0.002 < 0.05


def test_a_noisy_force_is_stopped_before_the_true_one_is_at_the_limit() -> None:
    quiet = Guard(LIMIT, 0.002, (ARM,), noise=0.4)
    assert ticks_to_a_breach(quiet, force=LIMIT - 0.41) is None
    assert ticks_to_a_breach(quiet, force=LIMIT - 0.39) is not None
    # however noisy: plans use 0.9 of the limit
    loud = Guard(LIMIT, 0.002, (ARM,), noise=5.0)
    assert ticks_to_a_breach(loud, force=0.94 * LIMIT) is None
    ending = None
    for _ in range(20):
        ending = ending or judged(loud, force=0.96 * LIMIT)
    assert ending is not None
    assert (
        "allowed 1 N, for its noise, below limits.normal_force of 20 N" in ending.text
    )
    # also after a recovery
    assert loud.successor(LIMIT, (None,)).noise == 5.0
