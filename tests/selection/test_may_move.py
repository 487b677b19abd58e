"""Obstacles that the object may push along its path."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import InfeasibleTaskError, TaskError
from pushpressslide.core.footprint import gaps, overlap_area
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.planning.carried import MET, carried_ways
from pushpressslide.planning.swept import swept
from pushpressslide.planning.tool_drag import tool_load
from pushpressslide.selection.select import placements
from pushpressslide.selection.solve import plan
from pushpressslide.taskfile.load import task_from_data

CAN: dict[str, Any] = {
    "name": "can",
    "cylinder": {"radius": 0.03, "height": 0.06},
    "pose": {"x": 0.47, "y": 0.0},
    "movable": True,
    "may_move": True,
    "mass": 0.2,
}
PUSHED: dict[str, Any] = {
    "name": "push-aside",
    "support": {"friction": 0.3},
    "object": {"shape": {"box": [0.12, 0.12, 0.08]}, "mass": 0.8},
    "contact": {"friction": 0.7},
    "start": {"x": 0.45, "y": -0.25},
    "goal": {"x": 0.45, "y": 0.2},
    "robots": [{"model": "panda"}],
    "limits": {"legs": 1},
    "obstacles": [CAN],
}

STRAIGHT: dict[str, Any] = {"modes": ["rear_push"], "motion": {"face": 0}}
WHERE = "'can', pushed along,"


def task(can: dict[str, Any] | None = None, **changes: object) -> Task:
    obstacles = [{**CAN, **(can or {})}, *changes.pop("others", [])]  # type: ignore[misc]
    return task_from_data(
        {**PUSHED, **changes, "obstacles": obstacles}, "push-aside.yaml"
    )


def refused(part: Task, why: str) -> str:
    """Reason for the refusal of the motion that pushes movable obstacles."""
    with pytest.raises(InfeasibleTaskError):
        plan(part)
    (reason,) = (
        choice.reason
        for group in placements(part.queries(may_push=True))
        for choice in group
        if why in choice.reason
    )
    return reason


def test_what_may_move_is_pushed_where_no_way_leads_past_it() -> None:
    made = plan(task(modes=["rear_push"]))
    assert made.may_push
    assert [body.name for body in made.query.yielding] == ["can"]


def test_it_is_not_pushed_where_a_way_leads_past_it() -> None:
    around = plan(task())
    several = plan(task(modes=["rear_push"], limits={"legs": 4}))
    beside = plan(task({"pose": {"x": 0.62, "y": 0.0}}))
    for made in (around, several, beside):
        assert not made.may_push
        poses = swept(made.task.object, made.segments, 0.01)
        can = made.task.obstacles[0].footprint
        assert gaps(made.task.object.shape, poses, [can]).min() >= 0.01 - 1e-6


def test_it_is_not_pushed_where_the_task_does_not_say_so() -> None:
    with pytest.raises(InfeasibleTaskError, match="can"):
        plan(task({"may_move": False}, modes=["rear_push"]))


def test_the_goal_may_lie_where_it_stands() -> None:
    here = {"pose": {"x": 0.45, "y": 0.2}}
    assert plan(task(here)).may_push
    with pytest.raises(TaskError, match=r"goal.*overlap with obstacle 'can'"):
        task({**here, "may_move": False})


def test_it_goes_on_with_the_object_and_never_overlaps_it() -> None:
    made = plan(task(modes=["rear_push"]))
    part = made.task
    poses = swept(part.object, made.segments, 0.01)
    way = carried_ways(part.object.shape, part.obstacles, poses)["can"]
    can = part.obstacles[0]
    assert len(way) == len(poses)
    assert way[0] == can.pose
    assert math.dist(way[-1].position, can.pose.position) > 0.1
    shared = [
        overlap_area(part.object.shape, X, can.shape, Y)
        for X, Y in zip(poses, way, strict=True)
    ]
    assert max(shared) <= MET


def test_what_is_left_behind_stays() -> None:
    part = task()
    there = [Pose2(0.45, y) for y in np.linspace(-0.25, 0.0, 60)]
    back = there[::-1]
    way = carried_ways(part.object.shape, part.obstacles, [*there, *back])["can"]
    assert way[len(there) :] == [way[len(there)]] * len(back)


def test_it_is_not_pushed_into_another_obstacle() -> None:
    wall = {"name": "wall", "box": [0.3, 0.02, 0.05], "pose": {"x": 0.45, "y": 0.32}}
    assert plan(task(**STRAIGHT)).may_push
    assert WHERE in refused(task(others=[wall], **STRAIGHT), "'wall'")


def test_it_is_not_pushed_over_the_edge_of_the_table() -> None:
    table = [[0.2, -0.5], [0.8, -0.5], [0.8, 0.27], [0.2, 0.27]]
    support = {"friction": 0.3, "region": table}
    short = {**STRAIGHT, "goal": {"x": 0.45, "y": 0.18}}
    assert plan(task(**short)).may_push
    assert WHERE in refused(task(support=support, **short), "falls over the edge")


def test_its_friction_counts_as_drag() -> None:
    part = task()
    assert tool_load(part.query, 0.0) == (0.0, 0.0)
    drag, skew = tool_load(replace(part.query, may_push=True), 0.0)
    assert drag == pytest.approx(0.3 * 0.2 * GRAVITY)
    assert skew == 0.0


def test_what_is_fixed_may_not_move() -> None:
    with pytest.raises(TaskError, match=r"obstacles\[0\].may_move.*movable: true"):
        task({"movable": False})
