"""Joint names of a task's arms, for files that contain all arms."""

from __future__ import annotations

from collections.abc import Sequence

from pushpressslide.core.scene import ARM_NAMES, Robot
from pushpressslide.robots.arm_files import robot_facts


def joint_names(robots: Sequence[Robot]) -> list[list[str]]:
    """Names of the moving joints of each arm, from the base to the tip.

    They are the names in the robot's file, prefixed by ``left_`` or ``right_`` if there
    are two arms.
    """
    out = []
    for name, robot in zip(ARM_NAMES, robots, strict=False):
        prefix = f"{name}_" if len(robots) > 1 else ""
        out.append([prefix + joint.name for joint in robot_facts(robot).moving])
    return out
