"""A light object: forces of the arm other than its push must not use up the friction."""

from __future__ import annotations

import numpy as np
import pytest

from pushpressslide.jobs.run import simulate
from pushpressslide.mechanics.pressing import lever_refusal
from pushpressslide.taskfile.load import load_task

PUSHED = (
    "object.mass=0.12",
    "start.x=0.45",
    "start.y=0.1",
    "goal.x=0.6",
    "goal.y=-0.02",
    "goal.yaw_deg=-50",
    "limits.legs=1",
)


@pytest.mark.long
def test_a_tip_does_not_lean_on_the_face_of_a_light_object() -> None:
    """A push of 0.35 N along a bend, while the tool turns by 50 degrees: the force
    along the height is a small share of it.
    """
    _, record, _ = simulate(load_task("rear-push-rear", PUSHED))
    assert record.reason == "goal_reached"
    moving = record.arrays["phase"] == 2
    force = record.arrays["measured_force"][moving][:, 0]
    along = np.hypot(force[:, 0], force[:, 1])
    assert 0.2 < np.median(along) < 0.5
    upright = np.abs(force[:, 2])
    assert np.median(upright) < 0.05
    assert np.percentile(upright, 75.0) < 0.08


LIGHT_PRESSED = (
    # shape, mass [kg], friction of support and tip, radius of the tip [m]
    ("{box: [0.0508, 0.0254, 0.0064]}", 0.025, 0.3, 0.6, 0.004),
    ("{box: [0.104, 0.042, 0.022]}", 0.030, 0.41, 0.64, 0.008),
    ("{box: [0.101, 0.104, 0.032]}", 0.042, 0.2, 0.39, 0.012),
)


@pytest.mark.long
@pytest.mark.parametrize("case", LIGHT_PRESSED, ids=str)
def test_a_light_object_that_the_press_can_turn_reaches_its_goal(
    case: tuple[str, float, float, float, float],
) -> None:
    shape, mass, support, contact, radius = case
    settings = (
        f"object.shape={shape}",
        f"object.mass={mass}",
        f"support.friction={support}",
        f"contact.friction={contact}",
        f"robots.0.tip_radius={radius}",
        "start={x: 0.45, y: 0.05}",
        "goal={x: 0.50, y: -0.08, yaw_deg: -20}",
        "motion={}",
    )
    _, record, _ = simulate(load_task("press-slide", settings))
    assert record.reason == "goal_reached"


@pytest.mark.long
def test_a_tool_that_turns_along_turns_what_its_tip_holds() -> None:
    """The friction under the tip has 1.3 times the drag's moment: a steered vehicle
    misses by 0.8 m.
    """
    plan, record, _ = simulate(load_task("press-slide", ["object.mass=0.03"]))
    (press,) = plan.segments[0].contacts
    assert lever_refusal(plan.task.scene, press) is not None
    end = record.arrays["object_pose"][-1]
    goal = plan.task.goal
    assert np.hypot(end[0] - goal.x, end[1] - goal.y) < 0.002
    assert abs(end[2] - goal.yaw) < np.radians(1.0)
