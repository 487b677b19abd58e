"""Order in which presses are planned."""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, ObjectModel, Task
from pushpressslide.mechanics.top import top_places
from pushpressslide.planning.pressed.manoeuvre import pressed_manoeuvres
from pushpressslide.planning.pressed.ranking import AT_ONCE, by_time, soonest

BASE = load_task("press-slide")
BODIES = {
    "cube": ObjectModel(Box((0.15, 0.15, 0.15)), 1.0, (0.0, 0.0)),
    "tile": ObjectModel(Box((0.2, 0.15, 0.06)), 0.5, (0.0, 0.0)),
    "puck": ObjectModel(Cylinder(0.08, 0.06), 0.5, (0.0, 0.0)),
}


def moved(
    body: ObjectModel, x: float, y: float, yaw: float
) -> tuple[Task, list[Contact]]:
    """Return a task from (0.5, 0) on, and contacts all over the top of its object."""
    goal = Pose2(0.5 + x, y, math.radians(yaw))
    task = replace(
        BASE, object=body, start=Pose2(0.5, 0.0, 0.0), goal=goal, contact_friction=0.8
    )
    places = top_places(body, 0.012)
    return task, [
        Contact(0, "top", place, (0.0, 0.0), body.shape.height, 10.0)
        for place in places
    ]


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize(
    "goal", [(0.2, 0.0, 0.0), (0.02, -0.2, 20.0), (-0.15, 0.05, -40.0)]
)
def test_a_press_as_quick_as_any_is_among_the_first(
    body: str, goal: tuple[float, float, float]
) -> None:
    task, contacts = moved(BODIES[body], *goal)
    best = pressed_manoeuvres(task.query, task.start, contacts)[0]
    first = list(by_time(task.query, task.start, contacts))[:AT_ONCE]
    assert pressed_manoeuvres(task.query, task.start, first)[0].time < 1.05 * best.time


def test_each_contact_comes_with_its_quickest_manoeuvre_before_any_other_comes_again() -> (
    None
):
    task, contacts = moved(BODIES["cube"], 0.2, 0.0, 0.0)
    found = [
        manoeuvre.contact for manoeuvre in soonest(task.query, task.start, contacts[:6])
    ]
    count = len(set(found))
    assert len(set(found[:count])) == count < len(found)
