"""Runs of arms that are stopped during the approach: by levels, with their messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from whole_plant import PlantRow, cell_of

import pushpressslide as pps
from pushpressslide.control.limits import TORQUE_TIME, ArmLimits, ArmReading
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.control.state import tip_position
from pushpressslide.control.stopping import LONGEST, REST_TIME
from pushpressslide.core.control import (
    BrakeCommand,
    Commands,
    JointCommand,
    Measurement,
    TipCommand,
    TipState,
)
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.record import Record

PERIOD = 0.004
AT = 0.1  # [s] at which something goes wrong
ZERO = (0.0, 0.0, 0.0)
STILL = ArmReading(np.zeros(2), np.zeros(2))
FAST = replace(STILL, v=np.array([0.0, 2.2]))
FAR_TOO_FAST = replace(STILL, v=np.array([0.0, -4.0]))
OVERLOADED = replace(STILL, torque_share=1.5)
LIMITS = ArmLimits(
    lower=np.full(2, -2.0),
    upper=np.full(2, 2.0),
    velocity=np.full(2, 2.0),
    effort=np.full(2, 50.0),
    torque_rate=np.full(2, 1e3),
)
PATH = JointPath(
    approach_time=np.array([0.0, 3.0]),
    approach=np.array([[0.0, 0.0], [0.3, -0.3]]),
    arc_length=np.array([0.0, 1.0]),
    move=np.array([[0.3, -0.3], [1.0, 1.0]]),
    tool_yaw_offset=0.0,
    joint_margin=1.0,
    condition=1.0,
    clearance=1.0,
    gap=0.05,
)


@dataclass
class Arms:
    """Arms on their approach whose joints do what a script says, of each at a time."""

    plan: Plan
    script: Callable[[int, float], ArmReading]
    ticks: int = 0
    name: str = "script"
    meta: Mapping[str, Any] = field(default_factory=dict)
    applied: list[Commands] = field(default_factory=list)

    @property
    def arms(self) -> int:
        return len(self.plan.task.robots)

    @property
    def time(self) -> float:
        return self.ticks * PERIOD

    @property
    def joint_paths(self) -> tuple[JointPath, ...]:
        return (PATH,) * self.arms

    @property
    def arm_limits(self) -> tuple[ArmLimits, ...]:
        return (LIMITS,) * self.arms

    def readings(self) -> tuple[ArmReading, ...]:
        return tuple(self.script(arm, self.time) for arm in range(self.arms))

    def measure(self) -> Measurement:
        start = self.plan.task.start
        X_WB = start.compose(self.plan.task.X_GB)
        tips = [TipState(ZERO, ZERO, ZERO)] * self.arms
        for contact in self.plan.contacts:  # before their contacts
            place = tip_position(contact, X_WB, 0.02, PATH.gap)
            last = self.applied[-1][contact.arm] if self.applied else None
            if isinstance(last, TipCommand):  # a tip is where it is led to
                place = last.position
            tips[contact.arm] = TipState(place, ZERO, ZERO)
        return Measurement(self.time, start, tuple(tips))

    def apply(self, commands: Commands) -> None:
        self.applied.append(commands)

    def advance(self) -> None:
        self.ticks += 1

    def row(self) -> PlantRow:
        return PlantRow(ZERO, (ZERO,) * self.arms)

    def diverged(self) -> None:
        return None


@cache
def plan(name: str) -> Plan:
    made = pps.plan(pps.load_task(name))
    motion = replace(made.task.motion, control_period=PERIOD, recoveries=0)
    return replace(made, task=replace(made.task, motion=motion))


def stopped(
    script: Callable[[int, float], ArmReading], name: str = "rear-push-rear"
) -> tuple[Arms, Record]:
    arms = Arms(plan(name), script)
    return arms, run_loop(cell_of(arms, arms.arms), arms.plan, RunOptions())


def until(end: float, reading: ArmReading, arm: int = 0) -> Callable[..., ArmReading]:
    """Return a script: one arm has a ``reading`` from AT until ``end`` [s]."""

    def script(number: int, time: float) -> ArmReading:
        wrong = number == arm and AT - 1e-9 <= time < end - 1e-9
        return reading if wrong else STILL

    return script


def test_an_arm_too_fast_for_a_moment_rests_on_its_path() -> None:
    arms, record = stopped(until(AT + PERIOD, FAST))
    assert record.reason == "joint_limit"
    text = "arm 0: joint 2 at 2.20 rad/s, allowed 2 rad/s (at 0.10 s, approach)"
    assert record.reason_text == text
    assert all(isinstance(c, JointCommand) for (c,) in arms.applied)
    last = arms.applied[-1][0]
    assert isinstance(last, JointCommand)
    assert not last.velocity.any()
    # on its way, not far from where it was stopped
    assert 0.0 < last.position[0] < 0.3 * (AT + 0.3) / 3.0
    assert AT < arms.time < AT + 1.0


def test_an_arm_that_stays_too_fast_holds_where_it_is_told() -> None:
    arms, record = stopped(until(AT + 0.3, FAST))
    assert record.reason == "joint_limit"
    assert record.reason_text.endswith(
        "(at 0.10 s, approach); then an arm did not draw back"
    )
    (held,) = arms.applied[-1]
    assert isinstance(held, JointCommand)
    assert held.position.tolist() == [0.0, 0.0]
    assert arms.time == pytest.approx(AT + 0.3 + REST_TIME, abs=3 * PERIOD)


def test_an_arm_that_is_asked_for_too_much_holds_as_well() -> None:
    _, record = stopped(until(AT + 0.3, OVERLOADED))
    assert record.reason == "torque_limit"
    assert "did not draw back" in record.reason_text
    at = AT + TORQUE_TIME
    assert f"(at {at:.2f} s, approach)" in record.reason_text


def test_a_run_ends_when_an_arm_that_ran_away_rests() -> None:
    arms, record = stopped(until(AT + 0.2, FAR_TOO_FAST))
    assert record.reason == "runaway"
    said = "arm 0 runs away: joint 2 at 4.00 rad/s, allowed 2 rad/s"
    assert record.reason_text == f"{said} (at 0.10 s, approach)"
    first = round(AT / PERIOD)
    kinds = [isinstance(command, BrakeCommand) for (command,) in arms.applied]
    assert not any(kinds[:first])
    assert all(kinds[first:])
    assert arms.time == pytest.approx(AT + 0.2 + REST_TIME, abs=3 * PERIOD)


def test_an_arm_that_never_rests_is_waited_for_no_longer_than_so() -> None:
    arms, record = stopped(until(9.0, FAR_TOO_FAST))
    assert record.reason == "runaway"
    assert arms.time == pytest.approx(AT + LONGEST, abs=3 * PERIOD)


def test_an_arm_that_runs_away_after_a_breach_is_told_with_it() -> None:
    def script(arm: int, time: float) -> ArmReading:
        if time < AT:
            return STILL
        return FAST if time < AT + 0.05 else until(AT + 0.2, FAR_TOO_FAST)(arm, time)

    _, record = stopped(script)
    assert record.reason == "joint_limit"
    assert record.reason_text.endswith("; then an arm ran away")


@pytest.mark.parametrize("arm", [0, 1])
def test_the_arm_that_runs_away_is_named_and_the_other_holds(arm: int) -> None:
    arms, record = stopped(until(AT + 0.2, FAR_TOO_FAST, arm), "parallel-push")
    assert record.reason_text.startswith(f"arm {arm} runs away")
    last = arms.applied[-1]
    assert isinstance(last[arm], BrakeCommand)
    assert isinstance(last[1 - arm], JointCommand)


def test_arms_whose_joints_are_led_come_to_the_touch() -> None:
    """There the controller takes over, and nothing has been stopped."""
    arms, record = stopped(lambda arm, time: STILL)
    assert record.reason == "contact_lost"
    ends = [isinstance(c, JointCommand) for (c,) in arms.applied]
    count = sum(ends)
    assert ends == [True] * count + [False] * (len(ends) - count)
    assert count * PERIOD == pytest.approx(3.2, abs=0.1)
    assert record.meta["events"] == []
