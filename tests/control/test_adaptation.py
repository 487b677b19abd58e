"""Adaptation of the controller: contacts near slipping, and tips that do not move."""

from __future__ import annotations

from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.control.adaptation import (
    FORCE_SCALE_RISE,
    MOST_FORCE_SCALE,
    SLOW_SHARE,
    STEERING_SCALE,
    Adaptation,
    TipSpeed,
    most_force_scale,
)

USE, FALL, RISE, LEAST = STEERING_SCALE
DT = 0.004
LED = (0.05, 0.0, 0.0)
RESTING = [(LED, (0.0, 0.0, 0.0))]
FOLLOWING = [(LED, LED)]
NOT_LED = [((0.0, 0.0, 0.0), LED)]


def after(ticks: int, utilisation: float, speeds: list[TipSpeed]) -> Adaptation:
    """Return the adaptation after some ticks of the same."""
    adaptation = Adaptation()
    for _ in range(ticks):
        adaptation = adaptation.step(utilisation, speeds, None, DT)
    return adaptation


def test_steering_falls_near_the_edge_of_a_cone_and_rises_inside_it() -> None:
    near = Adaptation().step(1.01 * USE, [], None, DT)
    assert near.steering_scale == pytest.approx(1.0 - FALL * DT)
    back = near.step(0.99 * USE, [], None, DT)
    assert back.steering_scale == pytest.approx(near.steering_scale + RISE * DT)


def test_steering_stays_within_its_bounds() -> None:
    assert after(1000, 1.0, []).steering_scale == LEAST
    assert after(1000, 0.0, []).steering_scale == 1.0


def test_tips_that_rest_push_harder_up_to_a_bound() -> None:
    once = Adaptation().step(0.0, RESTING, None, DT)
    assert once.force_scale == pytest.approx(1.0 + FORCE_SCALE_RISE * SLOW_SHARE * DT)
    assert after(1000, 0.0, RESTING).force_scale == MOST_FORCE_SCALE


def test_tips_that_follow_push_as_planned_again() -> None:
    harder = after(1000, 0.0, RESTING)
    assert harder.step(0.0, FOLLOWING, None, DT).force_scale < harder.force_scale
    assert after(1000, 0.0, FOLLOWING).force_scale == 1.0


@pytest.mark.parametrize("speeds", [[], NOT_LED])
def test_tips_that_nothing_leads_change_no_force(speeds: list[TipSpeed]) -> None:
    harder = Adaptation(force_scale=1.3)
    assert harder.step(0.0, speeds, None, DT).force_scale == 1.3


@pytest.mark.parametrize("share", [0.2, 0.8])
def test_effort_changes_by_how_far_tips_are_from_half_their_speed(share: float) -> None:
    """The direction of the command does not matter, nor does motion across it."""
    led = (0.03, -0.04, 0.0)
    moved = (share * 0.03 + 0.04, -share * 0.04 + 0.03, 0.0)
    before = Adaptation(force_scale=1.3)
    after = before.step(0.0, [(led, moved)], None, DT)
    slow = SLOW_SHARE - share
    assert after.force_scale == pytest.approx(1.3 + FORCE_SCALE_RISE * slow * DT)


def test_tips_are_judged_together_each_by_the_square_of_its_speed() -> None:
    fast = ((0.2, 0.0, 0.0), (0.2, 0.0, 0.0))
    slow = ((0.0, 0.1, 0.0), (0.0, 0.0, 0.0))
    after = Adaptation(force_scale=1.3).step(0.0, [fast, slow], None, DT)
    share = 0.04 / 0.05
    wanted = 1.3 + FORCE_SCALE_RISE * (SLOW_SHARE - share) * DT
    assert after.force_scale == pytest.approx(wanted)


def test_tips_that_are_led_at_all_count() -> None:
    """A tenth of a millimetre a second is a motion."""
    crawling = [((0.0, 1.1e-4, 0.0), (0.0, 0.0, 0.0))]
    resting = [((0.0, 0.9e-4, 0.0), (0.0, 0.0, 0.0))]
    before = Adaptation(force_scale=1.3)
    assert before.step(0.0, crawling, None, DT).force_scale > 1.3
    assert before.step(0.0, resting, None, DT).force_scale == 1.3


def test_tips_that_rest_push_half_as_hard_again_in_some_seconds() -> None:
    """A bound that no object is thrown by, and a rise that no contact is jerked by."""
    adaptation = Adaptation()
    ticks = 0
    while adaptation.force_scale < 1.5:
        adaptation = adaptation.step(0.0, RESTING, None, DT)
        ticks += 1
    assert 0.5 < ticks * DT < 3.0
    assert after(10_000, 0.0, RESTING).force_scale < 2.0


def test_forces_follow_gain_effort_and_the_drag_that_is_found() -> None:
    assert Adaptation().force_gain(1.05, 3.0) == 1.05
    assert Adaptation(force_scale=1.2).force_gain(1.5, 3.0) == pytest.approx(1.8)
    found = Adaptation(force_scale=1.2, drag=3.6)
    assert found.force_gain(1.5, 3.0) == pytest.approx(1.5 * 1.2 * 1.2)
    assert Adaptation().step(0.0, [], 3.6, DT).drag == 3.6


def test_pushes_may_push_as_much_harder_as_a_belief_may_be_wrong() -> None:
    plan = pps.plan(pps.load_task("rear-push-rear"))
    (segment,) = plan.segments
    limits = plan.task.limits

    def scaled(friction: float, mass: float) -> float:
        errors = {"friction_error": friction, "mass_error": mass}
        return most_force_scale(replace(plan.task.scene, **errors), limits, segment)

    assert scaled(0.0, 0.0) == MOST_FORCE_SCALE
    assert scaled(0.2, 0.5) == pytest.approx(MOST_FORCE_SCALE / 0.8 / 0.5)
    # but never beyond the force that a plan may use
    allowed = limits.planned_force / segment.drive.max_friction
    assert scaled(0.5, 0.9) == pytest.approx(allowed)


def test_a_press_pushes_no_harder_than_its_friction_holds() -> None:
    plan = pps.plan(pps.load_task("press-slide"))
    segment = plan.segments[0]
    scene = replace(plan.task.scene, friction_error=0.5, mass_error=0.5)
    load = sum(contact.load for contact in segment.contacts)
    holds = scene.contact_friction * load / segment.drive.max_friction
    scale = most_force_scale(scene, plan.task.limits, segment)
    assert scale == pytest.approx(max(MOST_FORCE_SCALE, holds))


def test_a_larger_factor_is_reached_in_the_same_time() -> None:
    for most in (MOST_FORCE_SCALE, 4.0 * MOST_FORCE_SCALE):
        adaptation = Adaptation().step(0.0, RESTING, None, DT, most)
        rise = FORCE_SCALE_RISE * SLOW_SHARE * DT * most / MOST_FORCE_SCALE
        assert adaptation.force_scale == pytest.approx(1.0 + rise)
