"""Joint trajectory of a task's arms as a file for other programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pushpressslide.arms.smooth_joints import (
    JointLimits,
    JointTrajectory,
    planned_joints,
    smooth_trajectory,
)
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.scene import Robot
from pushpressslide.core.whole_file import write_whole
from pushpressslide.robots.arm_files import robot_facts
from pushpressslide.robots.joint_names import joint_names
from pushpressslide.selection.stages import PlannedStage

PERIOD = 0.01  # [s] between samples
# [s] to the largest speed, for a joint without a stated acceleration limit
SPEED_TIME = 0.3
# [s] to the largest acceleration, as in Franka's jerk limits
ACCELERATION_TIME = 2e-3
ENDS = (".csv", ".yaml", ".yml")


def check_trajectory_file(path: Path) -> None:
    """Raise PushPressSlideError unless the file is of a supported kind."""
    if path.suffix.lower() not in ENDS:
        raise PushPressSlideError(
            f"--trajectory: {str(path)!r} is not allowed; allowed: a .csv file, or a "
            ".yaml file with a ROS 2 JointTrajectory"
        )


def arm_limits(robots: Sequence[Robot]) -> JointLimits:
    """Limits of the joints of all arms.

    The manufacturer's acceleration limit is used if it is known.
    """
    joints = [joint for robot in robots for joint in robot_facts(robot).moving]
    speed = np.array([joint.velocity for joint in joints])
    stated = np.array([joint.acceleration for joint in joints])
    acceleration = np.where(np.isfinite(stated), stated, speed / SPEED_TIME)
    return JointLimits(speed, acceleration, acceleration / ACCELERATION_TIME)


def trajectory(
    stages: Sequence[PlannedStage], robots: Sequence[Robot]
) -> JointTrajectory:
    """Trajectory of all arms over planned stages with joint paths.

    Raises PushPressSlideError if there are no joint paths.
    """
    parts = [
        planned_joints(plan, [path for path, _ in paths])
        for stage in stages
        for plan, paths in zip(stage.planner.plans, stage.planner.paths, strict=True)
    ]
    if not parts:
        raise PushPressSlideError("--trajectory: nothing moves; the goal is the start")
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.followed_by(part)
    return smooth_trajectory(whole, arm_limits(robots), PERIOD)


def write_trajectory(
    made: JointTrajectory, robots: Sequence[Robot], path: Path
) -> Path:
    """Write a trajectory to a CSV or YAML file, and return its path."""
    names = [name for arm in joint_names(robots) for name in arm]
    if path.suffix.lower() == ".csv":
        return write_whole(path, _csv(made, names))
    text = yaml.safe_dump(_joint_trajectory(made, names), sort_keys=False)
    return write_whole(path, text)


def _csv(made: JointTrajectory, names: Sequence[str]) -> str:
    """CSV text with a row for each sample: time, phase, positions, velocities,
    accelerations.
    """
    kinds = ("position", "velocity", "acceleration")
    head = ["time", "phase", *(f"{name}_{kind}" for kind in kinds for name in names)]
    rows = np.hstack([made.positions, made.velocities, made.accelerations])
    lines = [",".join(head)]
    for time, phase, row in zip(made.times, made.phases, rows, strict=True):
        cells = [f"{value:.9g}" for value in row.tolist()]
        lines.append(",".join([f"{time:.9g}", phase, *cells]))
    return "\n".join(lines) + "\n"


def _joint_trajectory(made: JointTrajectory, names: Sequence[str]) -> dict[str, Any]:
    """Contents of a ROS 2 trajectory_msgs/JointTrajectory message."""
    points = []
    for i, time in enumerate(made.times.tolist()):
        seconds, rest = divmod(time, 1.0)
        nanoseconds = min(math.floor(1e9 * rest), 10**9 - 1)
        points.append(
            {
                "positions": _digits(made.positions[i]),
                "velocities": _digits(made.velocities[i]),
                "accelerations": _digits(made.accelerations[i]),
                "time_from_start": {"sec": int(seconds), "nanosec": nanoseconds},
            }
        )
    stamp = {"sec": 0, "nanosec": 0}
    return {
        "header": {"stamp": stamp, "frame_id": ""},
        "joint_names": list(names),
        "points": points,
    }


def _digits(values: Any) -> list[float]:
    """Numbers rounded to nine digits."""
    return [float(f"{value:.9g}") for value in values.tolist()]
