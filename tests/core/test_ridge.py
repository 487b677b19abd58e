"""Ridges on a support."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.ridge import WIDTH, Ridge
from pushpressslide.core.scene import Obstacle
from pushpressslide.core.task import Box
from pushpressslide.core.truth import Truth

TASK = replace(
    pps.load_task("rear-push-rear"),
    start=Pose2(0.4, -0.2, 0.3),
    goal=Pose2(0.4, 0.6, 1.0),
)


def test_a_ridge_crosses_the_line_from_start_to_goal() -> None:
    assert Ridge.of_task(TASK) is None
    truth = Truth(ridge=0.001, ridge_place=0.3, ridge_angle=0.2)
    ridge = Ridge.of_task(replace(TASK, truth=truth))
    assert ridge is not None
    assert ridge.pose.position == pytest.approx((0.4, 0.04))
    assert math.tan(ridge.pose.yaw) == pytest.approx(math.tan(0.2))


def test_a_ridge_under_a_body_at_its_start_is_refused() -> None:
    truth = Truth(ridge=0.001, ridge_place=0.1)
    with pytest.raises(TaskError, match=r"ridge_place: 0\.1 .* under the object"):
        Ridge.of_task(replace(TASK, truth=truth))
    crate = Obstacle("crate", Box((0.1, 0.1, 0.1)), Pose2(0.6, 0.2), movable=True)
    with pytest.raises(TaskError, match="under 'crate'"):
        Ridge.of_task(replace(TASK, truth=Truth(ridge=0.001), obstacles=(crate,)))
    on_the_spot = replace(TASK, goal=replace(TASK.start, yaw=2.0))
    with pytest.raises(TaskError, match="under the object"):
        Ridge.of_task(replace(on_the_spot, truth=Truth(ridge=0.001)))


def test_a_task_with_goals_has_no_ridge() -> None:
    with pytest.raises(TaskError, match=r"truth\.ridge: 0\.001 .* `goals`"):
        pps.load_task("three-objects", ["truth.ridge=0.001"])


@pytest.mark.parametrize("height", [0.0005, 0.002])
def test_its_profile_stands_on_the_support(height: float) -> None:
    ridge = Ridge(Pose2(), height)
    profile = ridge.profile(8)
    assert profile[0] == pytest.approx((-0.5 * WIDTH, 0.0), abs=1e-9)
    assert profile[-1] == pytest.approx((0.5 * WIDTH, 0.0), abs=1e-9)
    assert max(profile, key=lambda point: point[1]) == pytest.approx((0.0, height))
