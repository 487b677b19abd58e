"""Checks of several goals: of different bodies, or of one body in sequence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from pushpressslide.core.bodies import (
    OBJECT,
    SET_DOWN,
    Stage,
    body_shape,
    stage_task,
    start_state,
)
from pushpressslide.core.errors import TaskError
from pushpressslide.core.footprint import overlap_area
from pushpressslide.core.task import Obstacle, Task
from pushpressslide.taskfile.checks import MAX_OVERLAP, check_places, pose_text
from pushpressslide.taskfile.place import Fault, nearest, refuse


def goals_faults(
    plain: Mapping[str, Any], obstacles: Sequence[Obstacle]
) -> Iterator[Fault]:
    """Yield faults for both or neither of ``goal`` and ``goals``, for goals in addition
    to legs, and for goals of bodies that cannot be moved.
    """
    goals = plain["goals"]
    if goals is None:
        if plain["goal"] is None:
            yield "goal", None, "it is missing; allowed: goal, or goals"
        return
    if plain["goal"] is not None:
        value = {key: v for key, v in plain["goal"].items() if v is not None}
        yield "goal", value, "a task has goal or goals; allowed: one of the two"
    if plain["legs"]:
        reason = "allowed: null beside goals: the legs of each stage are found"
        yield "legs", plain["legs"], reason
    movable = [OBJECT, *(o.name for o in obstacles if o.movable)]
    fixed = {o.name for o in obstacles} - set(movable)
    for i, goal in enumerate(goals):
        name = goal["body"]
        field = f"goals[{i}].body"
        if name in fixed:
            allowed = f"allowed: a body that is movable: {', '.join(movable)}"
            yield field, name, f"it is fixed; {allowed}"
        elif name not in movable:
            yield field, name, f"unknown body; {nearest(name, movable)}"
    if all(goal["body"] == OBJECT for goal in goals):
        return
    for i, obstacle in enumerate(obstacles):
        if obstacle.name == SET_DOWN:
            allowed = "allowed: another name; in goals it is the object's"
            yield f"obstacles[{i}].name", obstacle.name, allowed


def check_goals(task: Task) -> None:
    """Check that each goal is within reach and in the workspace, and clear of the
    bases, the fixed obstacles and the last goals of other bodies.

    Raises TaskError for the first goal that is not.
    """
    if task.goals and task.support.kind != "table":
        reason = "allowed: table, where a task has goals"
        raise TaskError(task.source, "support.kind", task.support.kind, reason)
    fixed = tuple(o for o in task.obstacles if not o.movable)
    first = start_state(task)
    for i, goal in enumerate(task.goals):
        own = stage_task(task, Stage(goal.body, goal.pose), first)
        own = replace(own, obstacles=fixed, source=task.source)
        start = "start" if goal.body == OBJECT else _pose_field(task, goal.body)
        try:
            check_places(own.query, own.object, own.true_start)
        except TaskError as error:
            fields = {"start": start, "goal": f"goals[{i}]"}
            where = fields.get(error.field, error.field)
            raise TaskError(task.source, where, error.value, error.allowed) from None
    refuse(task.source, _shared_faults(task))


def _pose_field(task: Task, body: str) -> str:
    index = [obstacle.name for obstacle in task.obstacles].index(body)
    return f"obstacles[{index}].pose"


def _shared_faults(task: Task) -> Iterator[Fault]:
    """Yield a fault for two bodies whose last goals overlap."""
    last = {goal.body: i for i, goal in enumerate(task.goals)}
    placed: list[int] = []
    for body, i in last.items():
        goal = task.goals[i]
        shape = body_shape(task, body)
        for j in placed:
            other = task.goals[j]
            beside = body_shape(task, other.body)
            area = overlap_area(shape, goal.pose, beside, other.pose)
            if area > MAX_OVERLAP:
                there = f"goals[{j}], of {other.body!r}, here {area * 1e4:.2f} cm^2"
                allowed = f"allowed: no overlap with {there}"
                yield f"goals[{i}]", pose_text(goal.pose), allowed
        placed.append(i)
