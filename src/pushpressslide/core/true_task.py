"""The task as physics has it: object, tips and obstacles as they really are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pushpressslide.core.bodies import SET_DOWN
from pushpressslide.core.errors import InputError, TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.core.scene import Obstacle, Robot
from pushpressslide.core.task import ObjectModel, Task

STREAM = 2
"""Second entry of the seeds of obstacles, which share no draws with sensors or arms."""


def true_plan(plan: Plan, seed: int) -> Plan:
    """A plan of the true task. Its segments remain those of the believed one.

    Raises as ``true_task``.
    """
    task = true_task(plan.task, seed)
    return plan if task is plan.task else replace(plan, task=task)


def true_task(task: Task, seed: int) -> Task:
    """The task with the true sizes of object and tips, and the true places of its
    obstacles.

    Raises TaskError if the object or a tip cannot have its true size.
    """
    truth = task.truth
    if truth.size != (0.0, 0.0):
        task = replace(task, object=_true_object(task))
    if truth.tip_radius != 0.0:
        robots = tuple(_true_tip(task, robot) for robot in task.robots)
        task = replace(task, robots=robots)
    if truth.obstacle_offset > 0.0:
        spread = truth.obstacle_offset
        placed = (_displaced(obstacle, spread, seed) for obstacle in task.obstacles)
        task = replace(task, obstacles=tuple(placed))
    return task


def _true_object(task: Task) -> ObjectModel:
    try:
        shape = task.object.shape.resized(task.truth.size)
    except InputError as error:
        source = task.source or task.name
        raise TaskError(source, "truth.size", task.truth.size, str(error)) from None
    return replace(task.object, shape=shape)


def _true_tip(task: Task, robot: Robot) -> Robot:
    """A robot with the true radius of its tip."""
    grown = task.truth.tip_radius
    radius = robot.tip_radius + grown
    if radius <= 0.0:
        allowed = f"allowed: more than minus the radius, {robot.tip_radius:g} m"
        raise TaskError(task.source or task.name, "truth.tip_radius", grown, allowed)
    tip = None if robot.tip is None else replace(robot.tip, radius=radius)
    return replace(robot, tip=tip, tip_radius=radius)


def _displaced(obstacle: Obstacle, spread: float, seed: int) -> Obstacle:
    """An obstacle where it really stands. ``spread`` [m] is along each axis. The task's
    own object is where it was set down.
    """
    if obstacle.name == SET_DOWN:
        return obstacle
    rng = np.random.default_rng((seed, STREAM, *obstacle.name.encode()))
    dx, dy = (spread * rng.normal(size=2)).tolist()
    pose = obstacle.pose
    return replace(obstacle, pose=replace(pose, x=pose.x + dx, y=pose.y + dy))
