"""Random tasks among obstacles."""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps
from pushpressslide.core.footprint import gaps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.jobs.cluttered import (
    APART,
    BASE_ROOM,
    FREE,
    cluttered_task,
    started_task,
)
from pushpressslide.planning.free_space import FreeSpace, between

BASES = {1: pps.load_task("rear-push-rear"), 2: pps.load_task("bimanual-slide")}
SAMPLES = 12


@pytest.fixture(scope="module", params=[1, 2])
def tasks(request: pytest.FixtureRequest) -> list[Task]:
    return [cluttered_task(BASES[request.param], i, 9) for i in range(SAMPLES)]


def test_nothing_overlaps(tasks: list[Task]) -> None:
    for task in tasks:
        others = [o.footprint for o in task.obstacles]
        if others:
            assert (
                gaps(task.object.shape, [task.start, task.goal], others).min() >= APART
            )
        for robot in task.robots:
            for pose in (task.start, task.goal):
                there = pose.unapply(robot.base[:2])
                assert task.object.shape.distance(there) >= BASE_ROOM


def test_a_footprint_has_a_free_path(tasks: list[Task]) -> None:
    for task in tasks:
        others = tuple(o.footprint for o in task.obstacles)
        room = 0.3 + task.object.shape.circumradius
        xs = sorted((task.start.x, task.goal.x))
        ys = sorted((task.start.y, task.goal.y))
        region = (xs[0] - room, xs[1] + room, ys[0] - room, ys[1] + room)
        space = FreeSpace(task.object.shape, others, FREE, region)
        assert space.paths_to(task.goal).via_poses(task.start) is not None


def test_some_tasks_have_an_obstacle_on_the_straight_way_and_some_have_none(
    tasks: list[Task],
) -> None:
    blocked = 0
    for task in tasks:
        others = [o.footprint for o in task.obstacles]
        if not others:
            continue
        poses = [between(task.start, task.goal, i / 40) for i in range(41)]
        blocked += gaps(task.object.shape, poses, others).min() == 0.0
    assert 0 < blocked < len(tasks)
    assert any(not task.obstacles for task in tasks)


def test_a_seed_and_a_number_are_one_task(tasks: list[Task]) -> None:
    base = BASES[len(tasks[0].robots)]
    assert cluttered_task(base, 3, 9) == tasks[3]
    assert cluttered_task(base, 3, 8) != tasks[3]


def test_other_starts_keep_all_else() -> None:
    base = pps.load_task("turn-in-corner")
    drawn = [started_task(base, i, 5) for i in range(4)]
    assert len({task.start for task in drawn}) == 4
    for task in drawn:
        assert task.goal == base.goal
        assert task.obstacles == base.obstacles
        assert isinstance(task.start, Pose2)
        assert math.hypot(task.start.x, task.start.y) <= 0.72
