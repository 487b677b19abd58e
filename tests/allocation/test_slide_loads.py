"""Loads of two presses for a motion: they slide the object, or a number says why not."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide import load_task
from pushpressslide.allocation.slide_loads import (
    cop_fraction,
    slide_loads,
)
from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.twist_path import TwistPath

TASK = load_task("bimanual-slide")
SCENE = TASK.scene
CAP = TASK.limits.planned_force
POINTS = ((0.02, 0.10), (0.02, -0.10))


def path(x: float, y: float, yaw: float) -> TwistPath:
    """The path of the body from the origin to a pose."""
    return TwistPath.between((Pose2(), Pose2(x, y, yaw)), 0.2)


def pressed(loads: tuple[float, float]) -> list[Contact]:
    """The contacts with their loads."""
    return [
        Contact(i, "top", point, (0.0, 0.0), 0.1, load)
        for i, (point, load) in enumerate(zip(POINTS, loads, strict=True))
    ]


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-1.0, 1.0))
def test_loads_stay_between_what_is_felt_and_the_cap_and_the_second_ones_are_harder(
    x: float, y: float, yaw: float
) -> None:
    refusal, (first, harder) = slide_loads(
        SCENE, TASK.motion, CAP, POINTS, path(x + 1e-3, y, yaw)
    )
    assert refusal is None
    assert min(first) >= margins.ARM.least_press
    assert max(first) <= max(harder) <= CAP


@pytest.mark.parametrize("wanted", [0.4, 0.5, 0.6])
def test_a_wanted_centre_of_pressure_is_where_the_loads_put_it(wanted: float) -> None:
    motion = replace(TASK.motion, cop=wanted)
    _, loads = slide_loads(SCENE, motion, CAP, POINTS, path(0.2, 0.0, 0.0))
    assert cop_fraction(SCENE, pressed(loads[0])) == pytest.approx(wanted)


def test_a_given_press_is_the_only_one_and_one_above_the_cap_is_refused() -> None:
    motion = replace(TASK.motion, press_force=0.5 * CAP)
    _, loads = slide_loads(SCENE, motion, CAP, POINTS, path(0.2, 0.0, 0.0))
    assert loads == [(0.5 * CAP, 0.5 * CAP)]
    hard = replace(TASK.motion, press_force=1.5 * CAP)
    with pytest.raises(RefusedError) as caught:
        slide_loads(SCENE, hard, CAP, POINTS, path(0.2, 0.0, 0.0))
    assert caught.value.refusal.allowed == CAP


def test_where_the_cap_is_too_low_the_tips_slip_at_it_with_their_utilisation() -> None:
    low = margins.ARM.least_press
    refusal, loads = slide_loads(SCENE, TASK.motion, low, POINTS, path(0.2, 0.0, 0.0))
    assert refusal is not None
    assert refusal.code == "friction"
    assert refusal.figure is not None
    assert refusal.allowed == margins.FRICTION_USES[-1]
    assert refusal.figure > margins.FRICTION_USES[-1]
    assert loads == [(low, low)]


def test_tips_that_are_no_rougher_than_the_support_drag_nothing() -> None:
    smooth = replace(SCENE, contact_friction=SCENE.support.friction)
    with pytest.raises(RefusedError, match="must exceed the support's"):
        slide_loads(smooth, TASK.motion, CAP, POINTS, path(0.2, 0.0, 0.0))


def test_on_a_wall_both_loads_are_the_same_and_hold_the_weight_whatever_the_motion() -> (
    None
):
    wall = load_task("press-fit")
    assert wall.scene.weight_along.count(0.0) == 1  # straight down
    for goal in (path(0.1, 0.0, 0.0), path(0.0, 0.1, 0.0), path(0.0, 0.0, 0.8)):
        refusal, ((left, right),) = slide_loads(
            wall.scene, wall.motion, wall.limits.planned_force, POINTS, goal
        )
        assert refusal is None
        assert left == right
        mu = margins.FRICTION_USES[-1] * wall.contact_friction + wall.support.friction
        assert mu * (left + right) > math.hypot(*wall.scene.weight_along)


def test_the_centre_of_pressure_is_a_part_of_the_way_wherever_the_contacts_are() -> (
    None
):
    """With loads that outweigh the object: nearly their own."""
    points = ((0.12, 0.10), (0.02, -0.10))
    contacts = [
        Contact(i, "top", point, (0.0, 0.0), 0.1, load)
        for i, (point, load) in enumerate(zip(points, (3000.0, 1000.0), strict=True))
    ]
    assert cop_fraction(SCENE, contacts) == pytest.approx(0.25, abs=0.01)


def test_a_centre_of_pressure_that_cannot_be_is_told_what_can() -> None:
    motion = replace(TASK.motion, cop=0.02)
    with pytest.raises(RefusedError, match="allowed from 0") as caught:
        slide_loads(SCENE, motion, 10.0, POINTS, path(0.2, 0.0, 0.0))
    assert caught.value.refusal.code == "cop"
    with pytest.raises(RefusedError, match="and so does any other"):
        slide_loads(SCENE, motion, 0.5, POINTS, path(0.2, 0.0, 0.0))
