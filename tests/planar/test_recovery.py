"""Recovery from failures: the arms let go, and the rest is replanned from the object's
pose.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control import run_loop
from pushpressslide.control.recovery import restart
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core import margins
from pushpressslide.core.control import Commands, TipCommand
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.identification.parameter_estimates import NOTHING
from pushpressslide.planar.engine import run
from pushpressslide.report.metrics import result
from pushpressslide.report.plan_files import plan_from_dict, plan_to_dict
from pushpressslide.report.series import by_placement
from pushpressslide.selection import placement_planner
from pushpressslide.selection.placement_planner import ALIKE
from pushpressslide.taskfile.load import task_from_data

TWO_LEGS: dict[str, Any] = {
    "name": "bar",
    "object": {"shape": {"box": [0.3, 0.2, 0.1]}, "mass": 0.5},
    "contact": {"friction": 0.9},
    "start": {"x": 0.50, "y": 0.20},
    "goal": {"x": 0.70, "y": -0.10, "yaw_deg": -30},
    "tolerance": {"position": 0.005, "yaw_deg": 1},
    "limits": {"normal_force": 80},
    "robots": [{"model": "panda"}],
    "legs": [
        {"mode": "press_slide", "pose": {"x": 0.45, "y": 0.10, "yaw_deg": -20}},
        {"mode": "rear_push"},
    ],
}


def jumps_at(*times: float) -> Callable[[float, Commands], Commands]:
    """Return a hook that moves the tips' references by 5 cm, for a tick each time."""

    def disturb(time: float, commands: Commands) -> Commands:
        if not any(begin <= time < begin + 0.004 for begin in times):
            return commands
        return tuple(map(raised, commands))

    return disturb


def raised(command: Any) -> Any:
    if not isinstance(command, TipCommand):
        return command
    x, y, z = command.position
    return replace(command, position=(x, y, z + 0.05))


def overloaded(command: Any) -> Any:
    if not isinstance(command, TipCommand):
        return command
    return replace(command, force=(0.0, 0.0, -200.0), stiffness=(0.0, 0.0, 0.0))


def run_of(
    task: Task, disturb: Callable[[float, Commands], Commands] | None = None
) -> tuple[Plan, Record, dict[str, Any]]:
    record = run(pps.plan(task), RunOptions(disturb=disturb))
    return record.plan, record, result(task, record.plan, record, {})


@pytest.mark.parametrize(
    ("name", "time"),
    [("rear-push-rear", 5.0), ("press-slide", 1.5), ("bimanual-slide", 1.5)],
)
def test_a_run_that_was_stopped_goes_on_and_reaches_its_goal(
    name: str, time: float
) -> None:
    task = pps.load_task(name)
    _, record, found = run_of(task, jumps_at(time))
    (event,) = found["events"]
    assert event["code"] == "reference_jump"
    assert event["recovered"]
    assert event["time"] > time
    assert found["success"], found["reason"]
    assert np.unique(record.arrays["placement"]).tolist() == [0.0, 1.0]


def test_after_a_force_limit_the_rest_is_planned_with_less_force() -> None:
    def overload(time: float, commands: Commands) -> Commands:
        return tuple(map(overloaded, commands)) if 1.5 <= time < 1.6 else commands

    task = pps.load_task("bimanual-slide")
    made, _, found = run_of(task, overload)
    (event,) = found["events"]
    assert event["code"] == "force_limit"
    assert found["success"], found["reason"]
    (later,) = made.later
    allowed = margins.LIMITED_SHARE * task.limits.planned_force
    assert later.query.planned_force == pytest.approx(allowed)
    back = plan_from_dict(plan_to_dict(made), task)
    assert back.later[0].restart == later.restart


def test_an_arm_that_failed_is_given_other_contacts_if_there_are_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(run_loop, "OF_ARMS", frozenset({"reference_jump"}))
    made, _, found = run_of(pps.load_task("press-slide"), jumps_at(1.5))
    assert found["success"], found["reason"]
    (later,) = made.later
    first = made.segments[0]
    again = later.segments[0]
    near = math.dist(first.contacts[0].point, again.contacts[0].point) < ALIKE
    assert not (near and first.mode == again.mode)


@pytest.mark.parametrize(("at", "others"), [(2.2, True), (3.0, False)])
def test_a_press_that_does_not_move_the_object_is_not_repeated(
    at: float, others: bool
) -> None:
    def overload(time: float, commands: Commands) -> Commands:
        return tuple(map(overloaded, commands)) if at <= time < at + 0.1 else commands

    made, _, found = run_of(pps.load_task("press-slide"), overload)
    assert [event["code"] for event in found["events"]] == ["force_limit"]
    first, second = made.segments[0], made.later[0].segments[0]
    near = math.dist(first.contacts[0].point, second.contacts[0].point) < ALIKE
    assert (near and first.mode == second.mode) == (not others)


def test_an_arm_that_failed_repeats_the_only_contacts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(run_loop, "OF_ARMS", frozenset({"reference_jump"}))
    monkeypatch.setattr(placement_planner, "ALIKE", math.inf)
    task = replace(pps.load_task("rear-push-rear"), modes=("rear_push",))
    made, _, found = run_of(task, jumps_at(5.0))
    assert found["success"], found["reason"]
    assert made.later[0].segments[0].mode == "rear_push"


def test_without_recoveries_the_same_run_ends_there() -> None:
    task = pps.load_task("rear-push-rear", ["motion.recoveries=0"])
    _, _, found = run_of(task, jumps_at(5.0))
    assert found["reason"]["code"] == "reference_jump"
    assert found["events"] == []


def test_no_more_is_recovered_from_than_the_task_allows() -> None:
    task = pps.load_task("rear-push-rear", ["motion.recoveries=2"])
    _, record, found = run_of(task, jumps_at(*np.arange(3.0, 120.0, 2.0)))
    assert [event["recovered"] for event in found["events"]] == [True, True]
    assert found["reason"]["code"] == "reference_jump"
    assert record.arrays["placement"].max() == 2.0


def test_a_goal_that_is_missed_is_tried_again_from_there() -> None:
    tight = ["tolerance.position=1e-6", "motion.recoveries=1", "limits.time=600"]
    _, _, found = run_of(pps.load_task("press-slide", tight))
    assert [event["code"] for event in found["events"]] == ["goal_missed"]
    assert found["events"][0]["recovered"]
    assert found["final_position_error"] < 1e-3


def test_nothing_is_begun_that_cannot_end_in_time() -> None:
    task = pps.load_task("rear-push-rear", ["limits.time=24"])
    _, record, found = run_of(task, jumps_at(12.0))
    (event,) = found["events"]
    assert not event["recovered"]
    assert "limits.time leaves" in event["lacking"]
    assert found["reason"]["code"] == "reference_jump"
    assert record.arrays["time"][-1] < 24.0


def test_the_legs_that_are_left_are_planned_anew() -> None:
    task = task_from_data(TWO_LEGS, "by-hand")
    first = pps.plan(task)
    before = first.by_placement[0].duration
    _, calm, _ = run_of(task)
    second = calm.arrays["time"][np.argmax(calm.arrays["leg"] == 1.0)]
    assert second > before
    made, record, found = run_of(task, jumps_at(3.0, float(second) + 15.0))
    assert found["success"], found["reason"]
    assert all(event["recovered"] for event in found["events"])
    legs = [placement.segments[0].leg for placement in made.by_placement]
    assert legs == sorted(legs)
    assert len(legs) == 2 + len(found["events"])
    parts = by_placement(made, record)
    assert sum(len(part.arrays["time"]) for _, part in parts) == len(
        record.arrays["time"]
    )


def test_what_was_planned_anew_is_kept_with_the_plan() -> None:
    task = pps.load_task("press-slide")
    made, record, found = run_of(task, jumps_at(1.5))
    assert len(made.later) == 1
    back = plan_from_dict(plan_to_dict(made), task)
    assert back.by_placement == made.by_placement
    assert result(task, back, record, {}) == found


def test_a_restart_believes_what_was_identified() -> None:
    task = pps.load_task("press-slide", ["belief.rho=0.05"])
    segment = pps.plan(task).segments[0]
    load = segment.contacts[0].load
    drag = 1.2 * task.scene.max_friction(load)
    pose = Pose2(0.4, 0.1, 0.2)
    found = NOTHING._replace(rho=0.06, drag=drag, center=(0.01, -0.02))
    begin = restart(task.scene, segment, pose, found)
    x, y = task.object.center_of_mass
    assert begin.center_of_mass == pytest.approx((x + 0.01, y - 0.02))
    assert begin.support_friction == pytest.approx(1.2 * task.support.friction)
    assert begin.rho == 0.06
    rest = task.resumed(begin)
    assert rest.start == pose
    assert rest.goal == task.goal
    assert rest.object == task.object  # the truth is as it was
    assert rest.scene.support.friction == begin.support_friction
    assert rest.X_GB.position == begin.center_of_mass
    assert restart(task.scene, segment, pose, NOTHING).support_friction == (
        task.support.friction
    )


def test_contacts_that_a_task_names_are_free_after_the_first_attempt() -> None:
    task = pps.load_task("press-slide-pivot")
    pinned = restart(task.scene, pps.plan(task).segments[0], task.start, NOTHING)
    free = task.resumed(replace(pinned, free=True))
    assert task.resumed(pinned).motion == task.motion
    assert task.motion.vehicle == "pivot"
    assert (free.motion.vehicle, free.motion.contacts, free.motion.face) == (None,) * 3
    assert free.motion.freed == free.motion
