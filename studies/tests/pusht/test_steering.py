"""Steering law: pushes corrected so that they still end at the goal."""

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide_studies.pusht.plans import best_plan, intrusion
from pushpressslide_studies.pusht.pushes import final_pose
from pushpressslide_studies.pusht.steering import halved, miss, steered
from pushpressslide_studies.pusht.tee import overlap

STARTS = (
    Pose2(180.0, 330.0, -2.0),
    Pose2(300.0, 250.0, 0.2),
    Pose2(240.0, 180.0, 2.6),
    Pose2(330.0, 340.0, 1.1),
)
every_start = pytest.mark.parametrize("start", STARTS)
PUSHER = (60.0, 60.0)


@every_start
def test_a_plan_ends_at_the_goal_and_keeps_clear_of_the_walls(start: Pose2) -> None:
    plan = best_plan(start, PUSHER)
    end = final_pose(start, plan.pushes)
    assert miss(end) < 1e-3
    assert overlap(end) > 0.999
    assert plan.intrusion == intrusion(start, plan.pushes) == 0.0


@every_start
def test_a_plan_that_is_right_is_left_as_it_is(start: Pose2) -> None:
    pushes = halved(best_plan(start, PUSHER).pushes)
    assert steered(start, pushes) == pushes


@every_start
def test_a_disturbed_start_is_steered_to_the_goal(start: Pose2) -> None:
    pushes = halved(best_plan(start, PUSHER).pushes)
    random = np.random.default_rng(3)
    for _ in range(20):
        x, y, turn = random.normal(size=3) * (2.0, 2.0, 0.03)
        off = Pose2(start.x + x, start.y + y, start.yaw + turn)
        before = miss(final_pose(off, pushes))
        corrected = steered(off, pushes)
        assert miss(final_pose(off, corrected)) < max(0.1 * before, 0.05)
        for push in corrected:
            assert push.length >= 0.0
            assert push.pushed.right <= push.left <= push.pushed.left


@every_start
def test_the_halves_of_the_last_push_stay_equally_long(start: Pose2) -> None:
    pushes = halved(best_plan(start, PUSHER).pushes)
    off = Pose2(start.x + 2.0, start.y - 1.0, start.yaw + 0.02)
    *_, first, second = steered(off, pushes)
    assert first.length == pytest.approx(second.length)
