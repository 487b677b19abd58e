"""A known force moves a free object of the planar engine by what F = m a says."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.cell import Cell
from pushpressslide.control.run_loop import RunLoop, RunOptions, run_loop
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import TaskError
from pushpressslide.core.task import Task
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planar.physics import PlanarPhysics

BEGINS = 0.4  # [s], while the tip is still before the object
LASTS = 0.3  # [s]


def knocked(push: str, begins: str = f"time: {BEGINS}") -> Task:
    knock = f"{{{begins}, push: {{duration: {LASTS}, {push}}}}}"
    return pps.load_task("rear-push-rear", [f"disturbances=[{knock}]"])


def slid(task: Task, seconds: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and poses (n, 3) of an object that no tip touches."""
    physics = PlanarPhysics(pps.plan(task))
    rows = []
    for _ in range(round(seconds / physics.period)):
        pose = physics.read().X_WG
        rows.append((physics.time, pose.x, pose.y, pose.yaw))
        physics.advance()
    table = np.array(rows)
    return table[:, 0], table[:, 1:]


@pytest.mark.parametrize("force", [4.0, 9.0])
def test_a_force_moves_a_free_object_as_newton_says(force: float) -> None:
    task = knocked(f"force: [0, {force}]")
    times, poses = slid(task)
    friction = task.support.friction * GRAVITY  # [m/s^2]
    gained = force / task.object.mass - friction
    speed = gained * LASTS
    way = 0.5 * speed * LASTS + 0.5 * speed**2 / friction
    moved = poses - poses[0]
    assert moved[-1, 1] == pytest.approx(way, rel=1e-3)
    assert np.abs(moved[:, [0, 2]]).max() < 1e-6
    assert np.abs(moved[times <= BEGINS + 1e-6]).max() == 0.0
    assert moved[times > BEGINS + 0.05, 1].min() > 1e-4


def test_a_force_below_friction_moves_nothing() -> None:
    task = knocked("force: [0, 2.9]")
    assert task.support.friction * task.object.mass * GRAVITY > 2.9
    assert np.abs(np.ptp(slid(task)[1], axis=0)).max() < 1e-6


def test_a_moment_turns_a_free_object_as_euler_says() -> None:
    moment = 0.3
    task = knocked(f"force: [0, 0], moment: {moment}")
    side = 0.15
    assert task.object.shape.base_area == pytest.approx(side**2)
    inertia = task.object.mass * side**2 / 6.0
    # mean distance of a square's points from its centre
    arm = side * (math.sqrt(2.0) + math.log(1.0 + math.sqrt(2.0))) / 6.0
    friction = task.support.friction * task.object.mass * GRAVITY * arm
    rate = (moment - friction) / inertia * LASTS
    turn = 0.5 * rate * LASTS + 0.5 * rate**2 * inertia / friction
    yaw = np.unwrap(slid(task)[1][:, 2])
    assert yaw[-1] - yaw[0] == pytest.approx(turn, rel=5e-3)


def test_a_push_by_share_begins_there_and_the_goal_is_reached() -> None:
    task = knocked("force: [0, 4]", "share: 0.3")
    record = run_loop(planar_cell(pps.plan(task)), pps.plan(task), RunOptions())
    (began,) = record.meta["pushed"]
    tick = int(np.searchsorted(record.arrays["time"], began - 1e-9))
    x, y, yaw = record.arrays["object_pose"][tick]
    goal = task.goal
    radius = task.object.shape.circumradius
    start = task.start
    whole = math.dist(start.position, goal.position)
    whole += radius * abs(goal.yaw - start.yaw)
    come = math.dist(start.position, (x, y)) + radius * abs(yaw - start.yaw)
    assert come / whole == pytest.approx(0.3, abs=0.01)
    assert pps.result(record)["success"]


def test_a_ball_is_refused() -> None:
    task = pps.load_task("rear-push-rear", ["disturbances=[{time: 1, ball: {}}]"])
    with pytest.raises(TaskError, match=r"disturbances\[0\]\.ball"):
        planar_cell(pps.plan(task))


def test_a_robot_is_not_knocked() -> None:
    class Robot(PlanarPhysics):
        simulated = False

    plan = pps.plan(knocked("force: [1, 0]"))
    made = planar_cell(plan)
    robot = Robot(plan)
    cell = Cell("robot", robot, made.arms, robot, robot, robot)
    with pytest.raises(TaskError, match="disturbances"):
        RunLoop(cell, plan)
