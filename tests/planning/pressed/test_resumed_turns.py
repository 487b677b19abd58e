"""A manoeuvre that is resumed from the true poses of object and contact."""

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.plan import Contact, Plan, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.jobs.sampling import random_task
from pushpressslide.modes.press_slide import MODE
from pushpressslide.planning.pressed.resumed_turns import resume_turns
from pushpressslide.rom.drives import TurnDrive
from pushpressslide.selection.solve import plan


def manoeuvre(index: int) -> Plan:
    task = random_task(load_task("press-slide"), index, seed=7)
    made = plan(task, MODE.choices(task.query)[0])
    assert all(isinstance(segment.drive, TurnDrive) for segment in made.segments)
    return made


def resumed(
    made: Plan, segments: Sequence[Segment], X_WB: Pose2, contact: Contact
) -> tuple[Segment, ...]:
    scene = made.query.scene
    return resume_turns(scene, made.query.motion.speed, segments, X_WB, contact)


def end(segments: Sequence[Segment], X_WB: Pose2) -> Pose2:
    """Return X_WB after driving each segment as long as its path says, from where the
    one before ends.
    """
    for segment in segments:
        X_BV = segment.X_BV
        path = replace(segment.path, start=X_WB.compose(X_BV))
        X_WB = path.end.compose(X_BV.inverse())
    return X_WB


@pytest.mark.parametrize("index", [4, 5, 39])
@pytest.mark.parametrize("left", [3, 2])
def test_the_turns_that_are_left_lead_to_the_goal_from_where_the_object_is(
    index: int, left: int
) -> None:
    made = manoeuvre(index)
    task = made.task
    rest = made.segments[-left - 1 :]
    X_BG = task.object.X_GB.inverse()
    goal = task.goal
    planned = rest[0].body_pose(0.0)
    off = Pose2(planned.x + 0.003, planned.y - 0.002, planned.yaw + 0.03)
    before = end(rest, off).compose(X_BG)
    after = end(resumed(made, rest, off, made.contacts[0]), off).compose(X_BG)
    assert math.dist(before.position, goal.position) > 2e-3
    assert math.dist(after.position, goal.position) < 5e-4
    assert abs(math.remainder(after.yaw - goal.yaw, math.tau)) < 5e-3


def test_another_contact_has_its_own_turns_and_they_lead_to_the_goal_too() -> None:
    made = manoeuvre(10)
    (contact,) = made.contacts
    crept = replace(contact, point=(contact.point[0] + 1e-3, contact.point[1] + 1e-3))
    X_WB = made.segments[0].body_pose(0.0)
    fresh = resumed(made, made.segments, X_WB, crept)
    assert all(segment.contacts == (crept,) for segment in fresh)
    after = end(fresh, X_WB).compose(made.task.object.X_GB.inverse())
    goal = made.task.goal
    assert math.dist(after.position, goal.position) < 5e-4
