"""Constant data of a placement during its run."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.execution import USUAL
from pushpressslide.control.placement import Placement, leads_on, share_of_tolerance
from pushpressslide.core.plan import Plan, arms_kept
from pushpressslide.core.pose import Pose2

FIT = pps.plan(pps.load_task("press-fit"))
PUSH = pps.plan(pps.load_task("rear-push-rear"))
TWO = pps.plan(pps.load_task("pivot-and-move"))


def placement(plan: Plan, number: int = 0) -> Placement:
    return Placement(plan, number, USUAL.tracker)


def test_each_placement_has_its_own_segments_and_their_queries() -> None:
    for number, segments in enumerate(TWO.placements):
        made = placement(TWO, number)
        assert made.segments == segments
        assert made.query == made.queries[segments[0].leg]
        assert made.last == made.queries[segments[-1].leg]
        assert len(made.planned_poses) > 10


def test_an_object_is_held_at_a_last_goal_where_nothing_carries_it() -> None:
    assert not placement(PUSH).holds
    assert not placement(FIT).holds  # the opening carries it
    lifted = replace(FIT, segments=FIT.segments[:1])  # off its ledge, on the wall
    made = placement(lifted)
    assert not made.scene.carried(made.last.goal)
    assert made.holds
    assert made.waits


def test_an_object_that_enters_an_opening_is_waited_for() -> None:
    fit = placement(FIT, len(FIT.placements) - 1)
    assert fit.entry is not None
    assert fit.waits
    assert fit.reaches_far
    push = placement(PUSH)
    assert push.entry is None
    assert not push.waits


@pytest.mark.parametrize(("recoveries", "far"), [(0, True), (1, False), (2, False)])
def test_retries_reach_far_where_nothing_else_can_mend_a_miss(
    recoveries: int, far: bool
) -> None:
    overrides = [f"motion.recoveries={recoveries}"]
    plan = pps.plan(pps.load_task("rear-push-rear", overrides))
    assert placement(plan).reaches_far == far


def test_arms_last_that_have_the_same_contact_in_the_next_placement() -> None:
    first, second = TWO.placements
    assert placement(TWO).kept_arms == arms_kept(first, second)
    assert placement(TWO, 1).kept_arms == frozenset()
    assert placement(PUSH).kept_arms == frozenset()


def test_an_error_is_the_larger_share_of_its_two_tolerances() -> None:
    task = PUSH.task
    x, y, yaw = task.goal.x, task.goal.y, task.goal.yaw
    position = task.tolerance.position
    turn = task.tolerance.yaw

    def share(right: float, left: float, turned: float) -> float:
        pose = Pose2(x + right * position, y + left * position, yaw + turned * turn)
        return share_of_tolerance(pose, task.goal, task.tolerance)

    assert share(0.0, 0.0, 0.0) == 0.0
    assert share(0.6, 0.8, 0.0) == pytest.approx(1.0)
    assert share(0.0, -0.5, 0.3) == pytest.approx(0.5)
    assert share(0.3, 0.0, -2.0) == pytest.approx(2.0)
    around = Pose2(x, y, yaw + 6.283185307179586)
    left = share_of_tolerance(around, task.goal, task.tolerance)
    assert left == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("along", "aside", "yaw_deg", "leads"),
    [
        (0.0, 0.0, 0.0, True),
        (-0.02, 0.005, 2.0, True),
        (0.9, 0.05, 0.0, False),  # near the goal, and beside its line
        (0.9, 0.0, 30.0, False),
    ],
)
def test_a_push_leads_on_from_a_place_where_enough_of_its_way_is_left(
    along: float, aside: float, yaw_deg: float, leads: bool
) -> None:
    (segment,) = PUSH.segments
    share = max(0.0, along)
    pose = PUSH.object_pose(segment, share * segment.path.length)
    off = Pose2(min(0.0, along), aside, math.radians(yaw_deg))
    assert leads_on(PUSH, pose.compose(off)) == leads


def test_every_placement_leads_on_from_where_it_is_planned_to_begin() -> None:
    for plan in (TWO, FIT):
        for part in plan.by_placement:
            assert leads_on(part, part.object_pose(part.segments[0], 0.0))
