"""The joint trajectory of a plan, as other programs read it."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.jobs.trajectory import arm_limits
from pushpressslide.taskfile.load import load_task

PERIOD = 0.01


def planned(task: str, path: Path) -> str:
    out = path.parent / "plan"
    args = ["plan", task, "--trajectory", str(path), "--out", str(out), "--force"]
    result = CliRunner().invoke(app, args)
    assert result.exit_code == 0, result.stderr
    return result.stdout


@pytest.mark.parametrize("task", ["rear-push-rear", "bimanual-slide"])
def test_a_csv_file_keeps_the_limits_of_the_arms(task: str, tmp_path: Path) -> None:
    path = tmp_path / "joints.csv"
    said = planned(task, path)
    assert "rad off the planned joint path" in said
    lines = path.read_text().splitlines()
    names = lines[0].split(",")
    rows = [line.split(",") for line in lines[1:]]
    phases = [row[1] for row in rows]
    assert list(dict.fromkeys(phases)) == ["approach", "touch", "move", "release"]
    table = np.array([[row[0], *row[2:]] for row in rows], dtype=float)
    robots = load_task(task).robots
    limits = arm_limits(robots)
    n = len(limits.speed)
    assert len(names) == 2 + 3 * n
    first = "left_iiwa_joint_1" if len(robots) > 1 else "panda_joint1"
    assert names[2] == f"{first}_position"
    positions, velocities, accelerations = np.split(table[:-1, 1:], 3, axis=1)
    assert (np.abs(velocities) <= 1.001 * limits.speed).all()
    assert (np.abs(accelerations) <= 1.001 * limits.acceleration).all()
    jerk = np.abs(np.diff(accelerations, axis=0)) / PERIOD
    assert (jerk <= 1.001 * limits.jerk).all()
    # the numbers belong to each other
    steps = np.diff(positions, axis=0) / PERIOD
    means = 0.5 * (velocities[1:] + velocities[:-1])
    assert steps == pytest.approx(means, abs=PERIOD**2 * limits.jerk.max() / 12.0)


def test_a_yaml_file_is_a_ros_joint_trajectory(tmp_path: Path) -> None:
    path = tmp_path / "joints.yaml"
    planned("rear-push-rear", path)
    message = yaml.safe_load(path.read_text())
    assert message["joint_names"] == [f"panda_joint{i}" for i in range(1, 8)]
    stamps = [
        point["time_from_start"]["sec"] + 1e-9 * point["time_from_start"]["nanosec"]
        for point in message["points"]
    ]
    assert stamps[0] == 0.0
    assert (np.diff(stamps) > 0.0).all()
    for key in ("positions", "velocities", "accelerations"):
        assert {len(point[key]) for point in message["points"]} == {7}
    assert message["points"][-1]["velocities"] == pytest.approx([0.0] * 7, abs=1e-6)


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    args = ["plan", "rear-push-rear", "--trajectory", str(tmp_path / "a.json")]
    result = CliRunner().invoke(app, args)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "allowed: a .csv file, or a .yaml file" in result.stderr
