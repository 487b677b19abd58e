"""Plans of one short push to within the goal's tolerances."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.placement import share_of_tolerance
from pushpressslide.core import margins
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.selection.placement_planner import PlansAlone
from pushpressslide.selection.select import nudges
from pushpressslide.selection.solve import nudged

WIDE = ["tolerance.position=0.01", "tolerance.yaw_deg=2"]
TASK = pps.load_task("rear-push-rear", WIDE)


def turned_by(degrees: float, task: Task = TASK) -> Task:
    goal = task.goal
    return replace(task, start=Pose2(goal.x, goal.y, goal.yaw + math.radians(degrees)))


@pytest.mark.parametrize("degrees", [-6.0, -3.0, 2.5, 4.0])
def test_a_few_degrees_take_a_few_millimetres(degrees: float) -> None:
    task = turned_by(degrees)
    plan = nudged(PlansAlone(), Plan(task))
    assert plan is not None
    (segment,) = plan.segments
    assert segment.path.length < task.object.radius
    off = share_of_tolerance(segment.goal, task.goal, task.tolerance)
    assert off <= margins.NUDGED_WITHIN
    end = segment.body_pose(segment.path.length).compose(task.X_GB.inverse())
    assert end.position == pytest.approx(segment.goal.position)
    assert segment.profile.speed < task.motion.speed


def test_a_push_beside_the_centre_of_mass_turns_without_friction() -> None:
    """Its force may be along the normal of the face."""
    smooth = replace(TASK, contact_friction=0.1)
    choices = nudges(turned_by(4.0, smooth).query)
    assert any(choice.feasible for choice in choices)
    body = smooth.object
    for choice in choices:
        if choice.feasible:
            (contact,) = choice.contacts
            assert contact.normal is not None
            x, y = contact.point
            nx, ny = contact.normal
            assert abs(nx * y - ny * x) > 0.05 * body.radius


def test_no_short_push_leads_far() -> None:
    assert nudged(PlansAlone(), Plan(TASK)) is None
    assert nudged(PlansAlone(), Plan(turned_by(60.0))) is None


def test_a_push_about_an_unsure_centre_turns_by_little_only() -> None:
    """Its lever is known to a half, and the turn to half of that."""
    unsure = replace(TASK, belief=replace(TASK.belief, center_error=0.0375))
    little = nudged(PlansAlone(), Plan(turned_by(3.0, unsure)))
    assert little is not None
    assert nudged(PlansAlone(), Plan(turned_by(12.0))) is not None
    assert nudged(PlansAlone(), Plan(turned_by(12.0, unsure))) is None
    reasons = [str(choice.refusal) for choice in nudges(turned_by(12.0, unsure).query)]
    assert any("deg more or less, allowed 2.0 deg" in reason for reason in reasons)


def test_only_allowed_modes_push_and_only_the_last_leg_ends_nearby() -> None:
    press = replace(turned_by(3.0), modes=("press_slide",))
    assert nudged(PlansAlone(), Plan(press)) is None
    legs = pps.load_task("pivot-and-move", WIDE)
    assert nudged(PlansAlone(), Plan(legs)) is None


def test_a_light_object_counts_on_the_touch() -> None:
    """Its force is below the noise: it moves before it is noticed."""
    noisy = [
        "sensing={force_noise: 1, position_noise: 0.0035, pose_rate: 10}",
        "object.mass=0.05",
    ]
    light = pps.load_task("rear-push-rear", [*WIDE, *noisy])
    behind = light.goal.compose(Pose2.deg(-0.01, 0.0, 3.0))
    light = replace(light, start=behind)
    travel = light.query.touch_travel
    assert light.query.slides_unfelt
    assert travel > light.sensing.seen_motion
    plan = nudged(PlansAlone(), Plan(light))
    assert plan is not None
    assert plan.segments[0].path.length > travel
    assert not TASK.query.slides_unfelt
    assert TASK.query.touch_travel == 0.0
