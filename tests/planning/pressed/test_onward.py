"""A manoeuvre that goes on from where object and contact really are."""

import math
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes.press_slide import MODE
from pushpressslide.planning.pressed.onward import onward
from pushpressslide.selection.planner import grasp


def manoeuvre(index: int) -> Plan:
    task = random_task(load_task("press-slide"), index, seed=7)
    plan = grasp(task, MODE.choices(task)[0])
    assert plan.choice.parameters["manoeuvre"]
    return plan


def end(plan: Plan, X_WB: Pose2) -> Pose2:
    """Return X_WB after driving each stretch as long as its path says, from where the
    one before ends.
    """
    for stretch in plan.stretches:
        X_BV = stretch.X_BV
        path = replace(stretch.path, start=X_WB.compose(X_BV))
        X_WB = path.end.compose(X_BV.inverse())
    return X_WB


@pytest.mark.parametrize("index", [4, 10, 39])
@pytest.mark.parametrize("left", [3, 2])
def test_the_turns_that_are_left_lead_to_the_goal_from_where_the_object_is(
    index: int, left: int
) -> None:
    plan = manoeuvre(index)
    rest = plan.stretches[-left - 1]
    X_BG = plan.task.object.X_GB.inverse()
    goal = plan.task.goal
    at = rest.path.start.compose(rest.X_BV.inverse())
    off = Pose2(at.x + 0.003, at.y - 0.002, at.yaw + 0.03)
    contact = plan.choice.contacts[0]
    before = end(rest, off).compose(X_BG)
    after = end(onward(rest, off, contact), off).compose(X_BG)
    assert math.dist(before.position, goal.position) > 2e-3
    assert math.dist(after.position, goal.position) < 5e-4
    assert abs(math.remainder(after.yaw - goal.yaw, math.tau)) < 5e-3


def test_another_contact_has_its_own_turns_and_they_lead_to_the_goal_too() -> None:
    plan = manoeuvre(10)
    contact = plan.choice.contacts[0]
    crept = replace(contact, point=(contact.point[0] + 1e-3, contact.point[1] + 1e-3))
    X_WB = plan.path.start.compose(plan.X_BV.inverse())
    fresh = onward(plan, X_WB, crept)
    assert all(stretch.choice.contacts == (crept,) for stretch in fresh.stretches)
    after = end(fresh, X_WB).compose(plan.task.object.X_GB.inverse())
    goal = plan.task.goal
    assert math.dist(after.position, goal.position) < 5e-4
