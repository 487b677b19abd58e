"""The object keeps off the arms' bases along its path."""

from __future__ import annotations

from dataclasses import replace

from pushpressslide import load_task
from pushpressslide.core.footprint import gaps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Robot, Task
from pushpressslide.selection.clearance import base_discs, base_refusal
from pushpressslide.selection.select import select

PUSH = load_task("rear-push-rear")


def past_the_base(side: float, **more: object) -> Task:
    """Return a push straight past the base, its middle ``side`` [m] from it."""
    start, goal = Pose2(-0.3, side, 0.0), Pose2(0.5, side, 0.0)
    return replace(PUSH, start=start, goal=goal, **more)


def test_a_way_over_the_base_is_refused_with_the_gap() -> None:
    refusal = base_refusal(
        past_the_base(0.2).query, [Pose2(-0.3, 0.2), Pose2(0.0, 0.2)]
    )
    assert refusal is not None
    assert str(refusal) == (
        "the object comes within 0 mm of an arm's base at (0.000, 0.200), allowed "
        "from 10 mm"
    )
    off = 0.14 + 0.075 + PUSH.motion.clearance + 0.001
    assert base_refusal(past_the_base(off).query, [Pose2(0.0, off)]) is None


def test_an_object_that_stands_near_a_base_may_leave() -> None:
    start = Pose2(0.14 + 0.075 + 0.002, 0.0)
    task = replace(PUSH, start=start, goal=Pose2(0.6, 0.0))
    assert base_refusal(task.query, [start, Pose2(start.x + 0.06, 0.0)]) is None
    sideways = Pose2(start.x, 0.06)
    assert base_refusal(task.query, [start, sideways]) is not None


def test_where_the_task_itself_stands_at_a_base_is_not_asked() -> None:
    task = replace(PUSH, start=Pose2(0.2, 0.0), goal=Pose2(0.6, 0.0))
    assert base_refusal(task.query, [task.start, Pose2(0.2, 0.06)]) is None


def test_free_tips_have_no_base_and_high_ones_are_passed_below() -> None:
    hand = past_the_base(0.2, robots=(Robot("hand", (0.0, 0.0, 0.0)),))
    assert base_discs(hand.scene) == []
    high = past_the_base(0.2, robots=(Robot("iiwa7", (0.0, 0.0, 0.5)),))
    assert base_discs(high.scene) == []
    assert len(base_discs(past_the_base(0.2).scene)) == 1


def test_no_choice_leads_the_object_over_a_base() -> None:
    task = replace(PUSH, start=Pose2(0.2, 0.35, -1.57), goal=Pose2(0.2, -0.35, -1.57))
    discs = base_discs(task.scene)
    refused = 0
    for choice in select(replace(task, motion=task.motion.freed), 4):
        refused += choice.refusal is not None and "base" in str(choice.refusal)
        for segment in choice.segments if choice.feasible else ():
            steps = (segment.path.length * i / 40 for i in range(41))
            X_BG = task.X_GB.inverse()
            poses = [segment.body_pose(s).compose(X_BG) for s in steps]
            assert gaps(task.object.shape, poses, discs).min() > 0.005
    assert refused > 0
