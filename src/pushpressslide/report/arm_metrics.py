"""Load on the arms in a run: torques and joint angles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.record import Record
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import robot_facts
from pushpressslide.robots.facts import RobotFacts


def facts_if_readable(robot: Robot) -> RobotFacts | None:
    """Facts about a task's robot. None if the robot's description cannot be read."""
    try:
        return robot_facts(robot)
    except (PushPressSlideError, OSError):
        return None


def torque_figures(robots: Sequence[Robot], record: Record) -> dict[str, float | None]:
    """Share of ticks in which a demanded torque exceeded its limit or its rate limit,
    and the largest demand as a share of each limit.
    """
    out: dict[str, float | None] = {}
    for kind, fraction, largest in (
        ("torque_share", "torque_limit_violation_fraction", "max_torque_share"),
        (
            "torque_rate_share",
            "torque_rate_saturated_fraction",
            "max_torque_rate_share",
        ),
    ):
        names = [f"{kind}_{i}" for i in range(len(robots))]
        rows = [record.arrays[name] for name in names if name in record.arrays]
        out[fraction] = out[largest] = None
        if rows and len(rows[0]):
            shares = np.array(rows)
            out[fraction] = float((shares > 1.0).any(axis=0).mean())
            out[largest] = float(shares.max())
    return out


def speed_share(robots: Sequence[Robot], record: Record) -> float | None:
    """Largest speed of any joint as a share of its limit. None if the record has no
    joints.
    """
    shares = []
    for i, robot in enumerate(robots):
        v = record.arrays.get(f"joint_velocity_{i}")
        facts = None if v is None or not len(v) else facts_if_readable(robot)
        if v is not None and facts is not None and v.shape[1] == facts.size:
            shares.append(float((np.abs(v) / facts.velocity_limit).max()))
    return max(shares, default=None)


def joint_margin(robots: Sequence[Robot], record: Record) -> float | None:
    """Smallest distance [rad] of a joint to its limits. None if the record has no
    joints.
    """
    margins = []
    for i, robot in enumerate(robots):
        q = record.arrays.get(f"joint_position_{i}")
        if q is None or not len(q):
            continue
        facts = facts_if_readable(robot)
        if facts is not None and q.shape[1] == facts.size:
            margins.append(float(np.minimum(q - facts.lower, facts.upper - q).min()))
    return min(margins, default=None)
