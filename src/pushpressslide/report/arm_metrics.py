"""What a run asked of the arms: torques, joint angles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.record import Record
from pushpressslide.core.task import Robot
from pushpressslide.robots.facts import MODELS, RobotFacts, load_facts


def robot_facts(robot: Robot) -> RobotFacts | None:
    """Return the facts of a task's robot; None if its description cannot be read."""
    if robot.model in MODELS:
        return load_facts(robot.model)
    from pushpressslide.robots.description import read_description

    try:
        return read_description(robot.model, robot.tip_frame)
    except (PushPressSlideError, OSError):
        return None


def torque_figures(robots: Sequence[Robot], record: Record) -> dict[str, float | None]:
    """Return the share of ticks above a torque limit, and the largest share of one."""
    names = [f"torque_share_{i}" for i in range(len(robots))]
    shares = np.array([record.arrays[name] for name in names if name in record.arrays])
    fraction = largest = None
    if shares.size:
        fraction = float((shares > 1.0).any(axis=0).mean())
        largest = float(shares.max())
    return {"torque_limit_violation_fraction": fraction, "max_torque_share": largest}


def joint_margin(robots: Sequence[Robot], record: Record) -> float | None:
    """Return the least distance [rad] of a joint to its limits; None without joints."""
    margins = []
    for i, robot in enumerate(robots):
        q = record.arrays.get(f"joint_position_{i}")
        if q is None or not len(q):
            continue
        facts = robot_facts(robot)
        if facts is not None and q.shape[1] == facts.size:
            margins.append(float(np.minimum(q - facts.lower, facts.upper - q).min()))
    return min(margins, default=None)
