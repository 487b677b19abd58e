"""Every shipped task reaches its goal with noisy and late sensors, on Drake."""

from __future__ import annotations

import pytest

import pushpressslide as pps
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import shipped_tasks

NOISE = [
    "sensing.position_noise=0.0005",
    "sensing.yaw_noise_deg=0.2",
    "sensing.force_noise=0.2",
    "sensing.delay=0.02",
]
SHORT = "rear-push-rear"


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name == SHORT else pytest.mark.long)
        for name in shipped_tasks()
    ],
)
def test_a_shipped_task_reaches_its_goal_with_noise_and_delay(name: str) -> None:
    task = pps.load_task(name, NOISE)
    measured = pps.run(task, engine="drake", seed=11).figures
    assert measured["success"], measured["reason"]
    assert measured["torque_limit_violation_fraction"] == 0.0
    assert measured["max_joint_speed_share"] < 1.0
    assert measured["clearance_driven"] >= 0.0


def test_pictures_that_are_missing_cost_nothing() -> None:
    task = pps.load_task(SHORT, [*NOISE, "sensing.pose_dropout=0.5"])
    plan, record, _ = simulate(task, engine="planar", seed=11)
    measured = result(task, plan, record, {})
    assert measured["success"], measured["reason"]
    assert measured["final_position_error"] < 2e-3


def test_a_late_sensor_is_late_in_time_over_a_hand_over_on_the_planar_engine() -> None:
    task = pps.load_task("pivot-and-move", NOISE)
    plan, record, _ = simulate(task, engine="planar", seed=11)
    measured = result(task, plan, record, {})
    assert measured["success"], measured["reason"]
