"""Sequences of motions, found if one motion does not reach the goal."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from pushpressslide.core.errors import InfeasibleTaskError
from pushpressslide.core.footprint import gaps
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.state import OBJECT, WorldState
from pushpressslide.core.task import Box, Restart, Task
from pushpressslide.planning.swept import swept
from pushpressslide.report.plan_files import plan_from_dict, plan_to_dict
from pushpressslide.selection.clearance import obstacle_refusal
from pushpressslide.selection.placement_planner import PlansAlone
from pushpressslide.selection.solve import Solution, plan, searchable, solve, solved
from pushpressslide.taskfile.load import task_from_data

# too heavy for one press of 40 N: it can only be pushed, and a post is in the way
BEHIND_A_POST: dict[str, Any] = {
    "name": "behind-a-post",
    "object": {"shape": {"cylinder": {"radius": 0.06, "height": 0.1}}, "mass": 4.7},
    "start": {"x": 0.53, "y": 0.10, "yaw_deg": -44},
    "goal": {"x": 0.25, "y": 0.46, "yaw_deg": 45},
    "support": {"friction": 0.4},
    "contact": {"friction": 0.9},
    "robots": [{"model": "panda"}],
    "obstacles": [
        {
            "name": "post",
            "box": [0.12, 0.15, 0.15],
            "pose": {"x": 0.41, "y": 0.28, "yaw_deg": 30},
        }
    ],
}


@pytest.fixture(scope="module")
def task() -> Task:
    return task_from_data(BEHIND_A_POST, "behind-a-post.yaml")


@pytest.fixture(scope="module")
def solution(task: Task) -> Solution:
    return solve(PlansAlone(), task, 1)


@pytest.fixture(scope="module")
def found(solution: Solution) -> Plan:
    return solution.plan


def test_a_push_round_a_post_is_found_as_several_motions(found: Plan) -> None:
    assert len(found.task.legs) > 1
    assert found.from_search
    assert [segment.leg for segment in found.segments] == sorted(
        segment.leg for segment in found.segments
    )


def test_what_the_search_dropped_is_told(solution: Solution) -> None:
    """A cylinder too heavy for a press: its motions are refused by their reasons."""
    searched = solution.search_notes
    assert searched is not None
    assert searched.evaluated >= sum(motions.count for motions in searched.refused) > 0
    assert searched.poses > 0
    for motions in searched.refused:
        assert motions.mode in ("rear_push", "press_slide")
        assert motions.text
    counts = [motions.count for motions in searched.refused]
    assert counts == sorted(counts, reverse=True)


def test_each_motion_begins_where_the_one_before_ends(task: Task, found: Plan) -> None:
    X_GB = task.X_GB
    first = found.segments[0].body_pose(0.0)
    assert (first.x, first.y) == pytest.approx(task.start.compose(X_GB).position)
    for before, after in pairwise(found.segments):
        end = before.body_pose(before.path.length)
        begin = after.body_pose(0.0)
        assert (begin.x, begin.y) == pytest.approx((end.x, end.y), abs=1e-6)
    last = found.segments[-1]
    end = last.body_pose(last.path.length)
    assert (end.x, end.y) == pytest.approx(task.goal.compose(X_GB).position, abs=1e-6)


def test_the_whole_way_keeps_its_clearance(task: Task, found: Plan) -> None:
    poses = swept(task.object, found.segments, task.motion.clearance)
    others = [o.footprint for o in task.obstacles]
    least = gaps(task.object.shape, poses, others).min()
    assert least >= task.motion.clearance - 1e-6


def test_the_same_sequence_is_found_again(task: Task, found: Plan) -> None:
    assert plan(task).segments == found.segments


def test_no_sequence_is_searched_for_where_one_motion_is_allowed(task: Task) -> None:
    one = replace(task, limits=replace(task.limits, legs=1))
    assert not searchable(one)
    with pytest.raises(InfeasibleTaskError, match="post"):
        plan(one)


def test_a_refusal_says_how_many_motions_were_looked_at(task: Task) -> None:
    shut_in = replace(task, obstacles=(_wall(task),))
    with pytest.raises(InfeasibleTaskError, match="nor does a sequence"):
        plan(shut_in)


def _wall(task: Task) -> Any:
    return replace(
        task.obstacles[0], shape=Box((0.05, 3.0, 0.2)), pose=Pose2(0.39, 0.28, 0.9)
    )


def test_a_found_plan_is_stored_and_read_with_its_legs(found: Plan) -> None:
    again = plan_from_dict(plan_to_dict(found), found.task)
    assert again.segments == found.segments
    assert again.task.legs == found.task.legs


def test_after_a_recovery_the_rest_is_searched_for_anew(
    task: Task, found: Plan
) -> None:
    here = Pose2(0.50, 0.15, -0.5)
    scene = task.scene
    center = scene.body.center_of_mass
    state = WorldState({OBJECT: here})
    begin = Restart(state, 0, center, scene.support.friction, None, legs=())
    rest = found.task.resumed(begin)
    assert rest.legs == ()
    again = solved(PlansAlone(), Plan(rest, restart=begin, from_search=True), 1).plan
    assert again.restart is not None
    assert again.restart.legs == again.task.legs
    assert found.task.resumed(again.restart) == again.task


def test_gaps_grow_from_what_the_start_has(task: Task) -> None:
    near = Pose2(0.41, 0.28 - 0.075 - 0.06 - 0.004, 0.0)
    post = replace(task.obstacles[0], pose=Pose2(0.41, 0.28, 0.0))
    there = replace(task, start=near, obstacles=(post,))
    along = [Pose2(near.x + 0.01 * i, near.y, 0.0) for i in range(4)]
    away = [Pose2(near.x, near.y - 0.01 * i, 0.0) for i in range(8)]
    assert obstacle_refusal(there.query, away) is None
    refusal = obstacle_refusal(there.query, along)
    assert refusal is not None
    assert refusal.code == "obstacle"
