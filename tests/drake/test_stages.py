"""Several bodies in Drake, moved one after the other without a reset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pushpressslide.jobs.goals import run_goals
from pushpressslide.jobs.stages import StageOptions
from pushpressslide.taskfile.load import load_task

pytestmark = pytest.mark.long


# the tour of one body is run with noise, in test_noise.py
@pytest.mark.parametrize("name", ["swap", "three-objects"])
def test_every_body_reaches_its_goal_and_nothing_jumps(
    name: str, tmp_path: Path
) -> None:
    task = load_task(name)
    result, record = run_goals(task, StageOptions("drake"))
    assert result["success"], result["reason"]
    for goal in task.goals:
        assert result["bodies"][goal.body]["position_error"] <= task.tolerance.position
        assert result["bodies"][goal.body]["yaw_error"] <= task.tolerance.yaw
    assert all(stage["reached"] for stage in result["stages"])
    arrays = record.arrays
    (last,) = np.nonzero(np.diff(arrays["stage"]))
    assert len(last) == len(result["stages"]) - 1
    bodies = [f"body_{body}" for body in result["bodies"]]
    for array in (*bodies, "joint_position_0", "joint_velocity_0"):
        step = np.abs(arrays[array][last + 1] - arrays[array][last])
        assert step.max() <= 1e-9, array
