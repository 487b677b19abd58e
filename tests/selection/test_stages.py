"""The order in which several bodies are brought to their goals."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import pytest

from pushpressslide.core.bodies import OBJECT, body_shape, stage_task, start_state
from pushpressslide.core.errors import InfeasibleTaskError, TaskError
from pushpressslide.core.footprint import overlap_area
from pushpressslide.core.task import Task
from pushpressslide.selection.select import select
from pushpressslide.selection.stages import (
    PlannedStage,
    after,
    goals_of,
    plan_stages,
)
from pushpressslide.taskfile.load import load_task, task_from_data

SIDE = 0.07  # [m]
PLACES = {"object": (0.50, 0.15), "b": (0.45, -0.05), "c": (0.62, -0.05)}


def cubes(goals: dict[str, tuple[float, float]], **others: Any) -> Task:
    """Return a task of three cubes at PLACES; the goals are x and y [m]."""
    box = [SIDE, SIDE, SIDE]
    x, y = PLACES["object"]
    data: dict[str, Any] = {
        "name": "cubes",
        "object": {"shape": {"box": box}, "mass": 0.5},
        "start": {"x": x, "y": y},
        "contact": {"friction": 0.8},
        "goals": [{"body": b, "x": x, "y": y} for b, (x, y) in goals.items()],
        "robots": [{"model": "panda"}],
        "obstacles": [
            {
                "name": name,
                "box": box,
                "pose": {"x": PLACES[name][0], "y": PLACES[name][1]},
                "movable": True,
                "mass": 0.5,
            }
            for name in ("b", "c")
        ],
        **others,
    }
    return task_from_data(data, "cubes")


def order(planned: list[PlannedStage]) -> list[tuple[str, bool]]:
    return [(one.stage.body, one.stage.aside) for one in planned]


def check(task: Task, planned: list[PlannedStage]) -> None:
    """Check that each stage begins where the one before ends, that no two bodies
    overlap between two stages, and that all are at their goals in the end.
    """
    state = start_state(task)
    for one in planned:
        plan = one.solution.plan
        assert plan.task.start == state.poses[one.stage.body]
        assert plan.goal == one.stage.goal
        state = after(state, one.stage)
        poses = state.poses
        for a, b in combinations(poses, 2):
            shapes = body_shape(task, a), body_shape(task, b)
            area = overlap_area(shapes[0], poses[a], shapes[1], poses[b])
            assert area <= 1e-8
    for body, goals in goals_of(task).items():
        assert task.tolerance.holds(state.poses[body], goals[-1])


def test_cubes_that_change_places_take_one_put_aside() -> None:
    task = load_task("swap")
    planned = plan_stages(task)
    check(task, planned)
    assert [aside for _, aside in order(planned)] == [True, False, False]
    assert planned[0].stage.body == planned[2].stage.body


def test_free_goals_take_a_stage_each() -> None:
    task = cubes({"object": (0.60, 0.20), "b": (0.40, -0.15), "c": (0.65, -0.2)})
    planned = plan_stages(task)
    check(task, planned)
    assert sorted(order(planned)) == [("b", False), ("c", False), ("object", False)]


def test_a_body_in_the_goal_of_another_goes_first() -> None:
    task = cubes({"object": PLACES["b"], "b": (0.42, -0.25)})
    planned = plan_stages(task)
    check(task, planned)
    assert order(planned) == [("b", False), (OBJECT, False)]


def test_a_ring_of_three_takes_one_put_aside() -> None:
    task = cubes({"object": PLACES["b"], "b": PLACES["c"], "c": PLACES["object"]})
    planned = plan_stages(task)
    check(task, planned)
    assert [aside for _, aside in order(planned)] == [True, False, False, False]


def test_a_tour_keeps_the_order_of_the_list() -> None:
    task = load_task("tour")
    planned = plan_stages(task)
    check(task, planned)
    assert [one.stage.goal for one in planned] == [goal.pose for goal in task.goals]


def test_a_search_finds_the_same_order_again() -> None:
    task = load_task("three-objects")
    first, second = (plan_stages(task) for _ in range(2))
    assert [one.stage for one in first] == [one.stage for one in second]
    for one, other in zip(first, second, strict=True):
        assert one.solution.plan == other.solution.plan


def test_a_body_without_a_goal_is_not_put_aside() -> None:
    task = cubes({"object": PLACES["b"]})
    with pytest.raises(InfeasibleTaskError, match="'object' cannot go") as refused:
        plan_stages(task)
    assert "'b' stands there" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_refusal_names_the_body_that_cannot_go() -> None:
    goals = {"object": PLACES["b"], "b": PLACES["object"]}
    heavy = cubes(goals, limits={"normal_force": 0.5, "legs": 1})
    with pytest.raises(InfeasibleTaskError, match=r"'(object|b)': no mode") as refused:
        plan_stages(heavy)
    assert "\n" not in str(refused.value)


def test_a_stage_is_a_task_of_the_body_with_all_others_as_obstacles() -> None:
    task = load_task("three-objects")
    stage = next(one.stage for one in plan_stages(task) if one.stage.body == "cube")
    own = stage_task(task, stage, start_state(task))
    cube = next(o for o in task.obstacles if o.name == "cube")
    assert own.object.mass == cube.mass
    assert own.support.friction == cube.friction
    assert own.start == cube.pose
    set_down = next(o for o in own.obstacles if o.name == "task-object")
    assert set_down.movable
    assert set_down.mass == task.object.mass
    assert set_down.friction == task.support.friction
    assert {o.name for o in own.obstacles} == {"block", "task-object"}


def test_a_task_of_several_goals_is_no_single_motion() -> None:
    with pytest.raises(TaskError, match=r"goals: .* is not allowed"):
        select(load_task("swap"))
