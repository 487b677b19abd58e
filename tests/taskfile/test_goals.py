"""Refusals of goals of several bodies, in one line that names the field."""

from __future__ import annotations

import pytest
import yaml

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import BodyGoal
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data

REFUSED = {
    "an unknown body": ("swap", ["goals.1.body=cup"], r"goals\[1\]\.body: 'cup'"),
    "a fixed body": (
        "swap",
        ["obstacles.0.movable=false"],
        r"goals\[1\]\.body: 'other-cube' .* it is fixed",
    ),
    "two goals that overlap": (
        "swap",
        ["goals.1.y=-0.06"],
        r"goals\[1\]: .* no overlap with goals\[0\], of 'object', here 21\.00 cm",
    ),
    "goal and goals": ("swap", ["goal={x: 0.5, y: 0}"], "goal: .* one of the two"),
    "neither": ("swap", ["goals=null"], "goal: None .* it is missing"),
    "legs": ("swap", ["legs=[{mode: rear_push}]"], "legs: .* null beside goals"),
    "out of reach": ("swap", ["goals.1.x=1.6"], r"goals\[1\]: .* within reach"),
    "at a base": ("swap", ["goals.0={body: object, x: 0, y: 0}"], r"goals\[0\]: "),
    "outside the workspace": (
        "swap",
        ["limits.workspace={x: [0.3, 0.7], y: [-0.05, 0.3]}"],
        r"goals\[0\]: .*limits\.workspace",
    ),
    "a goal on a fixed obstacle": (
        "three-objects",
        ["obstacles.1.movable=false", "goals=[{body: block, x: 0.6, y: 0.2}]"],
        r"goals\[0\]: .* no overlap with obstacle 'cube'",
    ),
    "the name of the object that was set down": (
        "three-objects",
        ["obstacles.1.name=task-object", "goals.2.body=task-object"],
        r"obstacles\[1\]\.name: 'task-object'",
    ),
    "no goal at all": ("swap", ["goals=[]"], "goals: "),
}


@pytest.mark.parametrize("case", REFUSED)
def test_goals_that_cannot_be_are_refused(case: str) -> None:
    name, sets, message = REFUSED[case]
    with pytest.raises(TaskError, match=message) as refused:
        load_task(name, sets)
    assert "\n" not in str(refused.value)


def test_goals_survive_a_dump() -> None:
    task = load_task("swap")
    assert task.goals[1] == BodyGoal("other-cube", Pose2(0.5, 0.1, 0.0))
    assert task_from_data(yaml.safe_load(dump_task(task)), "again") == task


def test_goals_of_a_tour_may_overlap() -> None:
    goals = [goal.pose for goal in load_task("tour").goals]
    assert goals[8].position == (0.5, 0.1)
    assert len(goals) == 12


def test_a_tour_takes_any_shape() -> None:
    sets = ["object.shape={cylinder: {radius: 0.05, height: 0.08}}"]
    assert len(load_task("tour", sets).goals) == 12
