"""A cell whose clock runs on while a recovery is planned, as a robot's does: the tips
hold, and continue from their positions at that time.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Cell
from pushpressslide.control.limits import JUMP, Guard
from pushpressslide.control.run_loop import RunOptions, run_loop
from pushpressslide.core import margins
from pushpressslide.core.control import Commands, TipCommand
from pushpressslide.core.record import Record
from pushpressslide.planar.cell import PlanarTip, planar_cell
from pushpressslide.planar.physics import PlanarPhysics
from pushpressslide.selection.placement_planner import PlacementPlanner

PLANNING = 2.0  # [s] of the cell's time, that a plan takes
BREAKS = 5.0  # [s] at which a reference jumps for a tick, in the push
ZERO = (0.0, 0.0, 0.0)


class Running(PlanarPhysics):
    """A planar world that obeys its last commands while somebody plans."""

    planned_at: float | None = None  # [s]
    held: Commands = ()
    drift = 0.0  # [m] that the tip moves by meanwhile

    def prepare(self) -> PlacementPlanner:
        self.planned_at = self.time
        self.held = tuple(self.commands)
        before = self.now.tips[0].position
        while self.time < self.planned_at + PLANNING:
            self.advance()
        after = self.now.tips[0].position
        self.drift = float(np.linalg.norm(np.subtract(after, before)))
        return super().prepare()


def running(plan: pps.Plan) -> tuple[Running, Cell]:
    physics = Running(plan)
    tip = PlanarTip(physics, 0)
    return physics, Cell("planar", physics, [tip], physics, physics, physics)


def jumps_once(time: float, commands: Commands) -> Commands:
    if not BREAKS <= time < BREAKS + 0.004:
        return commands
    return tuple(
        replace(c, position=(c.position[0], c.position[1], c.position[2] + 0.05))
        if isinstance(c, TipCommand)
        else c
        for c in commands
    )


@pytest.fixture(scope="module")
def ran() -> tuple[Running, Record]:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    physics, cell = running(plan)
    return physics, run_loop(cell, plan, RunOptions(disturb=jumps_once))


def test_the_run_goes_on_and_reaches_its_goal(ran: tuple[Running, Record]) -> None:
    physics, record = ran
    assert physics.planned_at is not None
    assert record.reason == "goal_reached"
    times = record.arrays["time"]
    gaps = np.diff(times)
    assert gaps.max() == pytest.approx(PLANNING, abs=0.02)


def test_tips_are_told_to_stay_while_a_recovery_is_planned(
    ran: tuple[Running, Record],
) -> None:
    physics, _ = ran
    (held,) = physics.held
    assert isinstance(held, TipCommand)
    assert held.velocity == ZERO
    assert held.force == ZERO
    assert min(held.stiffness) > 0.0
    assert physics.drift < 1e-3


def test_no_reference_jumps_when_planning_is_over(ran: tuple[Running, Record]) -> None:
    physics, record = ran
    assert physics.planned_at is not None
    times = record.arrays["time"]
    references = record.arrays["tip_reference"][:, 0]
    steps = np.linalg.norm(np.diff(references, axis=0), axis=1)
    after = times[1:] > physics.planned_at
    assert steps[after].max() < 0.1 * JUMP
    # where planning ended, the reference begins at the tip
    first = int(np.argmax(times > physics.planned_at + 0.5 * PLANNING))
    place = record.arrays["tip_position"][first, 0]
    assert references[first] == pytest.approx(place, abs=1e-3)


def test_a_guard_that_takes_over_knows_the_last_references() -> None:
    held = TipCommand(
        ZERO, ZERO, ZERO, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 0.0, 0.0, 0.0, 5.0, 0.0
    )
    guard = Guard(10.0, 0.004, ()).successor(20.0, (held,))
    assert guard.normal_force == 20.0
    far = replace(held, position=(0.0, 1.5 * JUMP, 0.0))
    breach = guard.breach([0.0], (), (far,))
    assert breach is not None
    assert breach.code == "reference_jump"


def test_a_recovery_is_not_begun_that_planning_left_no_time_for() -> None:
    """The time that counts is the cell's after planning: beside it, what the same
    recovery needs where planning takes none.
    """
    plan = pps.plan(pps.load_task("rear-push-rear"))
    quick = run_loop(planar_cell(plan), plan, RunOptions(disturb=jumps_once))
    (rest,) = quick.plan.later
    (event,) = quick.meta["events"]
    needed = event["time"] + rest.duration + margins.ARM.regrasp
    limits = [f"limits.time={needed + 0.5 * PLANNING}"]
    tight = pps.plan(pps.load_task("rear-push-rear", limits))
    _, cell = running(tight)
    slow = run_loop(cell, tight, RunOptions(disturb=jumps_once))
    assert not slow.meta["events"][0]["recovered"]
    assert "limits.time leaves" in slow.meta["events"][0]["lacking"]
    assert slow.reason == "reference_jump"
