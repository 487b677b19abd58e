"""One arm of two at work, in Drake: the other waits out of the way."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

from pushpressslide.arms.paths.arm_problem import ArmProblem
from pushpressslide.arms.paths.clearance import CLEARANCE
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.sim.arm_library import DRAKE
from pushpressslide.taskfile.load import task_from_data

BOX: dict[str, Any] = {
    "name": "cell",
    "object": {"shape": {"box": [0.2, 0.2, 0.12]}, "mass": 1.0},
    "support": {"friction": 0.25},
    "contact": {"friction": 0.7},
    "start": {"x": 0.45, "y": 0.05},
    "goal": {"x": 0.52, "y": 0.07, "yaw_deg": 5},
    "robots": [
        {"model": "panda", "base": {"y": 0.35}},
        {"model": "panda", "base": {"y": -0.35}},
    ],
}
RIGHT_ONLY = BOX | {
    "start": {"x": 0.45, "y": -0.75},
    "goal": {"x": 0.50, "y": -0.75},
    "modes": ["rear_push"],
}
# the right arm's home posture has its tip at (0.51, -0.3, 0.11), where the object goes
IN_THE_WAY = BOX | {
    "object": {"shape": {"box": [0.16, 0.16, 0.16]}, "mass": 1.0},
    "start": {"x": 0.5, "y": -0.12},
    "goal": {"x": 0.5, "y": -0.22},
    "modes": ["rear_push"],
    "motion": {"arm": "left"},
    "robots": [
        {"model": "iiwa7", "base": {"y": 0.3}},
        {"model": "iiwa7", "base": {"y": -0.3}},
    ],
}
LEGS = BOX | {
    "legs": [
        {
            "mode": "rear_push",
            "pose": {"x": 0.50, "y": 0.05},
            "motion": {"arm": "left"},
        },
        {
            "mode": "rear_push",
            "pose": {"x": 0.50, "y": 0.10},
            "motion": {"arm": "right"},
        },
        {"mode": "bimanual_press_slide"},
    ]
}
HOLDS_ON = {
    "name": "hold-and-slide",
    "object": {"shape": {"box": [0.4, 0.3, 0.1]}, "mass": 2.0},
    "contact": {"friction": 0.8},
    "start": {"x": 0.50, "y": 0.0},
    "goal": {"x": 0.459, "y": 0.069, "yaw_deg": 12},
    "limits": {"normal_force": 60},
    "robots": [
        {"model": "iiwa7", "base": {"y": 0.4, "z": 0.2}},
        {"model": "iiwa7", "base": {"y": -0.4, "z": 0.2}},
    ],
    "motion": {"contacts": [[-0.08, 0.10]]},
    "legs": [
        {
            "mode": "press_and_push",
            "pose": {"x": 0.51904, "y": 0.01882, "yaw_deg": 12},
        },
        {"mode": "press_slide"},
    ],
}
# [N] that the sensor feels of the tip's own inertia while the arm comes to rest
NOTHING = 0.01
TASKS = {
    "right only": RIGHT_ONLY,
    "in the way": IN_THE_WAY,
    "legs": LEGS,
    "holds on": HOLDS_ON,
}


@functools.cache
def run_of(name: str) -> tuple[Task, Plan, Record, dict[str, Any]]:
    """Run a task and check that it succeeds and no arm comes too near to anything."""
    task = task_from_data(TASKS[name], name)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"], found["reason"]
    assert found["clearance_driven"] > 0.5 * CLEARANCE  # of what was planned with
    return task, plan, record, found


def travel(
    record: Record, arm: int, ticks: np.ndarray[Any, np.dtype[np.bool_]]
) -> float:
    """Largest range of motion [rad] of any joint of an arm at these ticks."""
    return float(np.ptp(record.arrays[f"joint_position_{arm}"][ticks], axis=0).max())


def felt(record: Record, arm: int, ticks: np.ndarray[Any, np.dtype[np.bool_]]) -> float:
    """Return the largest contact force [N] of an arm at these ticks."""
    return float(np.abs(record.arrays["measured_force"][ticks, arm]).max())


def test_an_object_that_only_the_right_arm_reaches_is_pushed_by_the_right_arm() -> None:
    _, _, record, found = run_of("right only")
    assert [c["arm"] for c in found["contacts"]] == [1]
    assert travel(record, 0, record.arrays["time"] >= 0.0) < 0.01
    assert felt(record, 0, record.arrays["phase"] >= 1) < NOTHING


def test_an_arm_whose_home_is_in_the_way_is_parked_before_the_object_moves() -> None:
    _, plan, record, _ = run_of("in the way")
    waiting = ArmProblem(DRAKE, plan.by_placement[0], 1)
    q = record.arrays["joint_position_1"]
    moving = record.arrays["phase"] == 2
    assert np.allclose(q[0], waiting.kin.facts.home, atol=1e-3)
    at_home = waiting.waiting_clearance(q[0])
    assert at_home.distance < 0.0
    assert "object" in at_home.pair
    assert waiting.waiting_clearance(q[moving][0]).distance > 0.02
    assert travel(record, 1, record.arrays["phase"] >= 1) < 0.01


@pytest.mark.long
def test_one_arm_then_the_other_then_both_take_the_object_to_its_goal() -> None:
    _, _, record, found = run_of("legs")
    assert [c["arm"] for c in found["contacts"]] == [0, 1, 0, 1]
    assert found["modes"] == ["rear_push", "bimanual_press_slide"]
    arrays = record.arrays
    for leg, arm in ((0, 1), (1, 0)):
        waits = (arrays["leg"] == leg) & (arrays["phase"] >= 1)
        assert travel(record, arm, waits) < 0.01
        assert felt(record, arm, waits) < NOTHING


@pytest.mark.long
def test_an_arm_goes_on_with_its_press_while_the_other_gets_out_of_the_way() -> None:
    _, _, record, found = run_of("holds on")
    assert [c["arm"] for c in found["contacts"]] == [0, 1, 0]
    arrays = record.arrays
    alone = arrays["placement"] == 1
    waits = alone & (arrays["phase"] >= 1)
    assert travel(record, 1, waits) < 0.01
    assert felt(record, 1, waits) < NOTHING
    before = alone & (arrays["phase"] == 0)
    press = -arrays["measured_force"][before, 0, 2]
    assert press.min() > 1.0  # never lets go
