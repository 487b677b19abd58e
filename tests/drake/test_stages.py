"""Several bodies in Drake, moved one after the other without a reset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pushpressslide.jobs.monitor import Output
from pushpressslide.jobs.run import run_task
from pushpressslide.report.files import load_run
from pushpressslide.report.metrics import result as measure
from pushpressslide.taskfile.load import load_task

pytestmark = pytest.mark.long


# the tour of one body is run with noise, in test_noise.py
@pytest.mark.parametrize("name", ["swap", "three-objects"])
def test_every_body_reaches_its_goal_and_nothing_jumps(
    name: str, tmp_path: Path
) -> None:
    task = load_task(name)
    result = run_task(task, out=Output(tmp_path))
    record = load_run(tmp_path).record
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
    replay = (tmp_path / "replay.html").read_text("utf-8")
    assert all(f"stage {n + 1}" in replay for n in range(1, len(result["stages"])))
    for run in load_run(tmp_path).begun:
        assert "object_pose_3d" in run.record.arrays
        again = measure(run.plan.task, run.plan, run.record)
        assert again["success"] or run.stage.aside
