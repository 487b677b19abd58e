"""The guard: which limits it enforces, when, and with which words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.control.limits import (
    JOINT_JUMP,
    JUMP,
    MEAN_TIME,
    PEAK,
    POSITION_MARGIN,
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
    judge.begin()
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
    assert not judge.cramped([REST])
    inside = margins.ARM.joint_buffer
    assert inside > POSITION_MARGIN
    for room, cramped in ((inside + 0.001, False), (inside - 0.001, True)):
        near = ArmReading(np.array([0.0, side * (2.0 - room)]), np.zeros(2))
        assert judge.cramped([near]) == cramped
        assert judged(judge, reading=near) is None


def test_an_arm_that_begins_to_draw_back_near_a_limit_may_go_on_if_not_nearer() -> None:
    judge = guard()
    for room, cramped in ((0.02, False), (0.025, False), (0.016, False), (0.014, True)):
        near = ArmReading(np.array([1.0 - room, 0.0]), np.zeros(2))
        assert judge.cramped([near]) == cramped
    judge.begin()
    assert not judge.cramped([ArmReading(np.array([0.986, 0.0]), np.zeros(2))])
