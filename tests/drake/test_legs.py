"""Tasks in several legs, in Drake: one continuous run with arms that let go and take
other contacts.
"""

from __future__ import annotations

import math

import pytest

from pushpressslide.jobs.run import simulate
from pushpressslide.report.metrics import result
from pushpressslide.taskfile.load import load_task

# 10 mm a side in place of the 20 that test_noise.py runs with noise
TIGHT = ["obstacles.0.pose.y=0.66", "obstacles.1.pose.y=-0.56"]


@pytest.mark.long
def test_pivot_and_move_puts_the_box_into_a_slot_of_ten_millimetres_a_side() -> None:
    task = load_task("pivot-and-move", TIGHT)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"]
    assert found["modes"] == ["press_and_push", "parallel_push"]
    assert found["final_position_error"] < 0.010
    assert math.degrees(found["final_yaw_error"]) < 1.0
    assert found["torque_limit_violation_fraction"] == 0.0
    assert found["max_torque_share"] < 0.8  # the way to the next contact begins at rest
    for name in ("left", "right"):
        assert found["bodies"][name]["displacement"] < 0.002
    assert found["pivots"][0]["distance"]["pressed"] < 0.01
