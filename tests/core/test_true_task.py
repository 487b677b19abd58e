"""What physics has of a task, and what planner and controller do not see of it."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.core.arm_truth import ArmTruth
from pushpressslide.core.bodies import SET_DOWN
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Obstacle, Tip
from pushpressslide.core.task import Box, Task
from pushpressslide.core.true_task import true_plan, true_task
from pushpressslide.core.truth import EXACT, Truth

TASK = pps.load_task("rear-push-rear")
POST = Box((0.05, 0.05, 0.2))
POSTS = tuple(Obstacle(f"post{i}", POST, Pose2(1.0 + i, 0.0)) for i in range(200))


def with_truth(truth: Truth, task: Task = TASK) -> Task:
    return replace(task, truth=truth)


def test_errors_of_arms_come_first_and_the_tier_last() -> None:
    names = [one.name for one in fields(Truth)]
    own = [one.name for one in fields(ArmTruth)]
    assert names[: len(own)] == own
    assert names[-1] == "tier"


def test_a_task_without_errors_of_sizes_and_places_is_its_own_truth() -> None:
    plan = pps.plan(TASK)
    assert true_plan(plan, 3) is plan
    task = with_truth(Truth(tilt=0.1, friction_patches=0.3))
    assert true_task(task, 3) is task


def test_a_level_support_has_the_usual_gravity_to_the_bit() -> None:
    assert EXACT.gravity == (0.0, 0.0, -GRAVITY)
    x, y, z = Truth(tilt=0.1, tilt_yaw=math.pi / 2).gravity
    assert (x, y, z) == pytest.approx(
        (0.0, GRAVITY * math.sin(0.1), -GRAVITY * math.cos(0.1))
    )


def test_object_and_tips_get_their_true_sizes() -> None:
    task = with_truth(Truth(size=(0.004, -0.002), tip_radius=0.003))
    true = true_task(task, 0)
    assert isinstance(TASK.object.shape, Box)
    length, width, height = TASK.object.shape.size
    assert true.object.shape == Box((length + 0.004, width - 0.002, height))
    assert true.object.center_of_mass == TASK.object.center_of_mass
    assert true.robots[0].tip_radius == TASK.robots[0].tip_radius + 0.003
    assert task.scene == TASK.scene
    assert pps.plan(task).segments == pps.plan(TASK).segments


def test_a_tip_on_a_link_grows_as_well() -> None:
    robot = replace(TASK.robots[0], tip=Tip("flange", radius=0.01), tip_radius=0.01)
    task = with_truth(Truth(tip_radius=0.002), replace(TASK, robots=(robot,)))
    (true,) = true_task(task, 0).robots
    assert true.tip is not None
    assert true.tip.radius == true.tip_radius == pytest.approx(0.012)


@pytest.mark.parametrize(
    ("truth", "field"),
    [
        (Truth(size=(-0.2, 0.0)), r"truth\.size"),
        (Truth(tip_radius=-0.02), r"truth\.tip_radius"),
    ],
)
def test_sizes_that_cannot_be_are_refused(truth: Truth, field: str) -> None:
    with pytest.raises(TaskError, match=field):
        true_task(with_truth(truth), 0)


def test_each_obstacle_is_off_by_its_own_draw() -> None:
    task = with_truth(Truth(obstacle_offset=0.01), replace(TASK, obstacles=POSTS))
    moved = true_task(task, 4).obstacles
    off = np.array(
        [
            (true.pose.x - post.pose.x, true.pose.y - post.pose.y)
            for true, post in zip(moved, POSTS, strict=True)
        ]
    )
    assert off.std() == pytest.approx(0.01, rel=0.1)
    assert abs(off.mean()) < 0.002
    fewer = true_task(replace(task, obstacles=POSTS[5:7]), 4).obstacles
    assert fewer == moved[5:7]
    assert true_task(task, 5).obstacles[0] != moved[0]
    assert task.scene.obstacles == POSTS
    own = replace(POSTS[0], name=SET_DOWN)
    assert true_task(replace(task, obstacles=(own,)), 4).obstacles == (own,)
