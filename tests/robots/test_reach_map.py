"""Tables of reach: a search reaches the points that they contain."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.reach import REACH_MARGIN, reachable
from pushpressslide.robots.reach_map import surely_reached
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

ARMS = [
    Robot("panda", (0.0, 0.0, 0.0)),
    Robot("panda", (0.2, -0.3, 0.1), base_yaw=1.0, tip_length=0.1),
    Robot("iiwa7", (0.0, 0.4, 0.0), base_yaw=-0.5),
    Robot("gen3", (0.0, 0.1, 0.0), base_yaw=0.5),  # its first axis points down
]


@pytest.mark.parametrize("robot", ARMS)
def test_what_is_surely_reached_is_found_by_a_search(robot: Robot) -> None:
    rng = np.random.default_rng(3)
    kin = arm_kinematics(robot)
    seen = 0
    for _ in range(60):
        distance = rng.uniform(0.2, 1.0)
        bearing = rng.uniform(-math.pi, math.pi)
        height = float(rng.choice([0.03, 0.12]))
        tilt = float(rng.choice([0.0, math.radians(24.0)]))
        hold = ToolAttitude(tilt, float(rng.uniform(-math.pi, math.pi)))
        x, y, z = robot.base
        point = (
            float(x + distance * math.cos(bearing)),
            float(y + distance * math.sin(bearing)),
            z + height,
        )
        if surely_reached(robot, [point], [hold]):
            seen += 1
            found = reachable(kin, np.array([point]), hold, joint_margin=REACH_MARGIN)
            assert found.ok.all(), (point, hold)
    assert seen > 15


def test_what_is_far_away_is_not_surely_reached() -> None:
    assert not surely_reached(ARMS[0], [(1.0, 0.0, 0.05)], [UPRIGHT])
    assert not surely_reached(ARMS[0], [(3.0, 0.0, 0.05)], [UPRIGHT])


def test_one_place_out_of_reach_is_enough() -> None:
    near = (0.5, 0.0, 0.05)
    assert surely_reached(ARMS[0], [near], [UPRIGHT])
    assert not surely_reached(ARMS[0], [near, (1.0, 0.0, 0.05)], [UPRIGHT])


def test_a_tip_without_an_arm_is_not_in_the_tables() -> None:
    assert not surely_reached(
        Robot("hand", (0.0, 0.0, 0.0)), [(0.5, 0.0, 0.05)], [UPRIGHT]
    )
