"""Limits, enforced on Drake and on the planar engine: after any violation the arms stop
safely and the run gives the reason.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control import limits
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.control import Commands, TipCommand
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.planar.engine import run as run_planar
from pushpressslide.report.metrics import result
from pushpressslide.sim.arm_library import joint_paths_of
from pushpressslide.sim.engine import run as run_drake

BEGINS = 4.0  # [s] at which a hook begins to act, in contact on both engines
# believed to be half as heavy as it is, so that more force is needed than allowed
TOO_HEAVY = ["belief.mass=0.5", "limits.normal_force=2.2"]


@cache
def plan_of(*sets: str) -> Plan:
    once = "motion.recoveries=0"  # nothing is tried again
    return pps.plan(pps.load_task("rear-push-rear", [*sets, once]))


@cache
def paths_of(plan: Plan) -> object:
    return joint_paths_of(plan)


def run(engine: str, plan: Plan, disturb: Callable | None = None) -> Record:
    options = RunOptions(disturb=disturb)
    if engine == "planar":
        return run_planar(plan, options)
    return run_drake(plan, options, paths=paths_of(plan))


def from_then(
    change: Callable[[float, TipCommand], TipCommand],
) -> Callable[[float, Commands], Commands]:
    """Return a hook that changes the command of the arm from BEGINS on."""

    def disturb(time: float, commands: Commands) -> Commands:
        (command,) = commands
        if time < BEGINS or not isinstance(command, TipCommand):
            return commands
        return (change(time, command),)

    return disturb


def raised(time: float, command: TipCommand) -> TipCommand:
    """A reference 5 cm higher, at once."""
    x, y, z = command.position
    return replace(command, position=(x, y, z + 0.05))


def lifted(time: float, command: TipCommand) -> TipCommand:
    """A force that throws the arm up."""
    return replace(command, force=(0.0, 0.0, 80.0))


def shaken(time: float, command: TipCommand) -> TipCommand:
    """A force that changes its sign at every tick."""
    sign = 1.0 if round(time / 0.004) % 2 else -1.0
    return replace(command, force=(0.0, 0.0, 60.0 * sign))


def assert_stopped_safely(record: Record, code: str) -> None:
    """The run ends with its code, at rest, and slower than its limits all along."""
    assert record.reason == code
    assert record.reason_text
    times = record.arrays["time"][-10:]
    tips = record.arrays["tip_position"][-10:, 0]
    moved = np.linalg.norm(tips[-1] - tips[0]) / (times[-1] - times[0])
    assert moved < 0.01  # [m/s]
    moved = np.hypot(*record.arrays["object_twist"][-1, :2])
    assert moved < 1e-3
    assert np.nanmax(record.arrays["joint_torque_0"]) <= 87.0 + 1e-9


@pytest.mark.parametrize(
    ("hook", "code"),
    [
        (raised, "reference_jump"),
        (lifted, "joint_limit"),
        (shaken, "torque_limit"),
    ],
    ids=["jump", "speed", "torque"],
)
def test_a_breach_stops_the_arm_safely(hook: Callable, code: str) -> None:
    record = run("drake", plan_of(), from_then(hook))
    assert_stopped_safely(record, code)
    assert record.arrays["time"][-1] > BEGINS


def test_a_joint_near_its_end_stops_the_approach(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(limits, "POSITION_MARGIN", 0.9)
    record = run("drake", plan_of())
    assert_stopped_safely(record, "joint_limit")
    assert "rad from its limit" in record.reason_text
    assert record.arrays["time"][-1] < BEGINS


@pytest.mark.parametrize("engine", ["planar", "drake"])
def test_a_push_that_takes_more_force_than_allowed_is_given_up(engine: str) -> None:
    plan = plan_of(*TOO_HEAVY)
    record = run(engine, plan)
    assert record.reason == "force_limit"
    assert "limits.normal_force of 2.2 N" in record.reason_text
    measured = result(plan.task, plan, record, {})
    assert not measured["success"]
    assert measured["max_normal_force"] < 1.5 * 2.2 + 1.0


def test_a_jump_is_refused_on_the_planar_engine_too() -> None:
    record = run("planar", plan_of(), from_then(raised))
    assert record.reason == "reference_jump"
    assert "allowed 20 mm" in record.reason_text


def test_nothing_is_broken_in_a_run_as_planned(
    shipped_run: Callable[[str], tuple[Plan, Record]],
) -> None:
    plan, record = shipped_run("rear-push-rear")
    measured = result(plan.task, plan, record, {})
    assert measured["success"], measured["reason"]
    assert not measured["events"]  # nothing was tried again
    assert measured["max_mean_normal_force"] < plan.task.limits.normal_force
    assert 0.0 < measured["max_joint_speed_share"] < 1.0
    assert measured["clearance_driven"] > 0.0
    assert 0.0 <= measured["cone_use_commanded"]["share"] < 0.2
