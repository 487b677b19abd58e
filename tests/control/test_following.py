"""The followed path, and the arc length on the planned path at which the joints are
led.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.execution import USUAL
from pushpressslide.control.following import (
    JOINT_LEAD,
    BoundLaws,
    Following,
    bind_laws,
)
from pushpressslide.core.control import Measurement, TipState
from pushpressslide.core.plan import Segment

ZERO = (0.0, 0.0, 0.0)
TASK = pps.load_task("press-slide-car")
PLAN = pps.plan(TASK)
FIRST, LAST = PLAN.segments
LENGTH = FIRST.path.length
START = FIRST.body_pose(0.0)


@cache
def following() -> Following:
    made = Controller(PLAN)
    measured = Measurement(0.0, TASK.start, (TipState(ZERO, ZERO, ZERO),))
    return made.init(measured).following


def led_by(segment: Segment) -> Following:
    """Following state with ``segment`` in place of the planned one."""
    binding = bind_laws(TASK.scene, segment, USUAL.tracker(TASK.query, segment))
    return following()._replace(binding=binding)


def test_what_is_left_is_the_path_without_the_progress() -> None:
    assert following().left == LENGTH
    assert following()._replace(progress=0.25).left == LENGTH - 0.25


def test_a_motion_begins_once_and_each_segment_by_itself() -> None:
    begun = following().begun(3.0)
    assert begun.began == begun.reference_start == 3.0
    assert begun.reference is FIRST
    assert begun.begun(5.0) == begun
    # the next segment of the same motion
    segment = begun._replace(reference=None)
    again = segment.begun(5.0)
    assert (again.began, again.reference_start) == (3.0, 5.0)
    assert again.reference is FIRST
    known = following()._replace(reference=LAST, reference_start=1.0).begun(5.0)
    assert (known.reference, known.reference_start, known.began) == (LAST, 1.0, 5.0)


@pytest.mark.parametrize("done", [0.0, 0.1, LENGTH])
def test_joints_are_as_far_from_the_end_as_the_object_is(done: float) -> None:
    led = following()._replace(progress=done, joint_start=2.0)
    assert led.joint_progress(START) == pytest.approx(2.0 + done)
    half = led_by(FIRST.follows(FIRST.path.rest(0.4 * LENGTH))).binding
    rest = following()._replace(progress=0.4 * LENGTH).replanned(half, (), 0.0, START)
    assert rest._replace(progress=0.1).joint_progress(START) == pytest.approx(
        0.4 * LENGTH + 0.1
    )


@pytest.mark.parametrize("share", [0.3, 0.7, 1.4])
def test_joints_do_not_jump_where_the_path_becomes_shorter_or_longer(
    share: float,
) -> None:
    """And they end with the object."""
    before = following()._replace(progress=0.4 * LENGTH, joint_start=2.0)
    path = FIRST.path.rest((1.0 - 0.6 * share) * LENGTH)
    if share > 1.0:
        path = replace(path, sections=((0.0, 0.6 * share * LENGTH),))
    other = led_by(FIRST.follows(path)).binding
    led = before.replanned(other, (), 0.05, START)
    here = before.joint_progress(START)
    assert led.joint_progress(START) == pytest.approx(here)
    way = path.length - 0.05
    middle = led._replace(progress=0.05 + 0.5 * way)
    expected = here + 0.5 * (2.0 + LENGTH - here)
    assert middle.joint_progress(START) == pytest.approx(expected)
    again = middle.replanned(half_of(other), (), 0.0, START)
    assert again.joint_progress(START) == pytest.approx(expected)
    for done in (led._replace(progress=path.length), again._replace(progress=LENGTH)):
        assert done.joint_progress(START) == pytest.approx(2.0 + LENGTH)


def half_of(laws: BoundLaws) -> BoundLaws:
    """Laws for the second half of the path."""
    segment = laws.segment
    return led_by(segment.follows(segment.path.rest(0.5 * segment.path.length))).binding


def test_joints_wait_at_the_start_of_a_path_that_has_become_longer() -> None:
    longer = following()._replace(progress=-0.2, joint_start=2.0)
    assert longer.joint_progress(START) == 2.0


def timed(time: float, progress: float, joint_start: float = 0.0) -> float:
    led = following().begun(10.0)._replace(progress=progress, joint_start=joint_start)
    return led.joint_reference(led.joint_progress(START), time, True)


def test_joints_led_by_time_are_where_they_are_planned_then() -> None:
    duration = FIRST.profile.duration
    for share in (0.3, 0.5, 0.7):
        planned = FIRST.profile.state_at(share * duration)[0]
        time = 10.0 + share * duration
        assert timed(time, planned) == pytest.approx(planned)
        assert timed(time, planned - 0.01) == pytest.approx(planned)
        assert timed(time, planned + 0.01, 2.0) == pytest.approx(planned + 2.0)


def test_joints_led_by_time_keep_near_the_object() -> None:
    middle = 10.0 + 0.5 * FIRST.profile.duration
    planned = FIRST.profile.state_at(middle - 10.0)[0]
    for off in (1.5, 3.0):
        far = off * JOINT_LEAD
        assert timed(middle, planned - far) == pytest.approx(planned - far + JOINT_LEAD)
        assert timed(middle, planned + far) == pytest.approx(planned + far - JOINT_LEAD)
    assert 0.005 < JOINT_LEAD < 0.1  # [m]
    assert timed(10.0, 0.0) == 0.0


def test_joints_led_by_time_never_go_before_their_path() -> None:
    led = following().begun(10.0)
    longer = FIRST.follows(FIRST.path.rest(0.5 * LENGTH))
    ahead = led._replace(reference=longer, joint_start=-LENGTH)
    assert ahead.joint_reference(ahead.joint_progress(START), 10.0, True) == 0.0


def test_joints_that_time_does_not_lead_follow_the_object() -> None:
    led = following()._replace(progress=0.2)
    here = led.joint_progress(START)
    late = 10.0 + FIRST.profile.duration
    assert led.begun(10.0).joint_reference(here, late, False) == here
    assert led.joint_reference(here, late, True) == here  # nothing has begun


def test_a_turn_is_remade_only_by_arcs_of_its_own_leg() -> None:
    assert not following().replanned_as_arcs(FIRST)
    task = pps.load_task("press-slide-pivot")
    (turn,) = pps.plan(task).segments
    spot = following()._replace(segment=turn)
    arcs = replace(FIRST, leg=turn.leg)
    assert spot.replanned_as_arcs(arcs)
    assert not spot.replanned_as_arcs(turn)
    assert not spot.replanned_as_arcs(replace(arcs, leg=turn.leg + 1))


def test_a_binding_says_where_tips_are_and_touch_the_object() -> None:
    task = pps.load_task("parallel-push")
    (segment,) = pps.plan(task).segments
    binding = bind_laws(task.scene, segment, USUAL.tracker(task.query, segment))
    X_WB = segment.body_pose(0.0)
    for contact, point in zip(segment.contacts, binding.tip_points, strict=True):
        radius = task.robots[contact.arm].tip_radius
        assert math.dist(point, contact.point) == pytest.approx(radius)
    places = {
        c.arm: p for c, p in zip(segment.contacts, binding.tip_points, strict=True)
    }
    tips = [
        TipState((*X_WB.apply(places[arm]), 0.05), ZERO, ZERO) for arm in sorted(places)
    ]
    touched = binding.contact_points(X_WB, tips)
    for contact, point in zip(segment.contacts, touched, strict=True):
        assert point == pytest.approx(contact.point)
