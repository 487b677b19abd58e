"""Two iiwa7 at work, in Drake."""

import math

import pytest

from pushpressslide.arms.paths.clearance import CLEARANCE
from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import load_task


@pytest.mark.parametrize(
    "name",
    [
        "bimanual-slide",
        pytest.param("orthogonal-push", marks=pytest.mark.long),
        pytest.param("parallel-push", marks=pytest.mark.long),
    ],
)
def test_two_arms_reach_their_goal(name: str) -> None:
    task = load_task(name)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"]
    assert found["final_position_error"] < 0.005
    assert math.degrees(found["final_yaw_error"]) < 1.0
    assert found["torque_limit_violation_fraction"] == 0.0
    assert found["clearance_driven"] > 0.5 * CLEARANCE  # of what was planned with
