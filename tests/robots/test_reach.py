"""Reach: quick checks must not refuse what the arm can do, nor allow what it cannot."""

import math

import numpy as np
import pytest

from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.reach import (
    REACH_MARGIN,
    Reach,
    held_somehow_problem,
    reachable,
)
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

ARMS = [Robot("panda", (0.1, 0.2, 0.1), 0.3), Robot("iiwa7", (0.1, 0.2, 0.1), -0.4)]


def line(
    robot: Robot, near: float, far: float, height: float = 0.1
) -> list[tuple[float, float, float]]:
    """Return points straight ahead of a robot."""
    cos = math.cos(robot.base_yaw)
    sin = math.sin(robot.base_yaw)
    return [
        (robot.base[0] + r * cos, robot.base[1] + r * sin, robot.base[2] + height)
        for r in np.linspace(near, far, 8)
    ]


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.model)
def test_no_posture_has_the_wrist_farther_from_the_shoulder_than_the_span_and_some_come_near(
    robot,
):
    kin = arm_kinematics(robot)
    shoulder, wrist, span = kin.span
    q = np.random.default_rng(0).uniform(-math.pi, math.pi, (20_000, kin.facts.size))
    R, p = kin.tip_pose(q)
    farthest = np.linalg.norm(p - wrist * R[..., 2] - shoulder, axis=-1).max()
    assert 0.99 * span < farthest <= span + 1e-12


def test_a_tip_on_slides_has_no_span():
    assert arm_kinematics(Robot("hand", (0.0, 0.0, 0.0))).span[2] == math.inf


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.model)
@pytest.mark.parametrize(("near", "far"), [(0.35, 0.6), (0.35, 0.95), (0.05, 0.5)])
def test_the_quick_verdict_is_that_of_a_long_search(robot, near, far):
    points = line(robot, near, far)
    long = reachable(
        arm_kinematics(robot), np.array(points), UPRIGHT, None, REACH_MARGIN
    )
    assert (
        held_somehow_problem(robot, points, [(UPRIGHT, None)]) is None
    ) == long.ok.all()


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.model)
def test_where_an_upright_tool_fails_a_tilted_one_may_do(robot):
    points = line(robot, 0.6, 0.7, -0.1)
    while held_somehow_problem(robot, points, [(UPRIGHT, None)]) is None:
        points = [
            (
                x + 0.02 * math.cos(robot.base_yaw),
                y + 0.02 * math.sin(robot.base_yaw),
                z,
            )
            for x, y, z in points
        ]
    outward = (ToolAttitude(math.radians(36.0), robot.base_yaw), None)
    assert "cannot bring its tip" in held_somehow_problem(
        robot, points, [(UPRIGHT, None)]
    )
    assert held_somehow_problem(robot, points, [(UPRIGHT, None), outward]) is None
    fixed = (outward[0], np.full(len(points), robot.base_yaw))
    assert held_somehow_problem(robot, points, [(UPRIGHT, None), fixed]) is None


def test_replaced_rows_are_those_of_the_other_search_and_the_rest_stays():
    first = Reach(
        np.array([True, False, False]),
        np.array([0.3, 0.0, 0.1]),
        np.array([0.0, 0.2, 0.1]),
        np.zeros((3, 7)),
    )
    better = Reach(np.array([True]), np.array([0.5]), np.array([0.0]), np.ones((1, 7)))
    merged = first.replaced(np.array([1]), better)
    assert merged.ok.tolist() == [True, True, False]
    assert merged.joint_margin.tolist() == [0.3, 0.5, 0.1]
    assert merged.miss.tolist() == [0.0, 0.0, 0.1]
    assert merged.q.sum(axis=1).tolist() == [0.0, 7.0, 0.0]
    assert first.ok.tolist() == [True, False, False]
