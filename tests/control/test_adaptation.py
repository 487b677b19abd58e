"""What the controller adapts to: contacts near slipping, and tips that do not move."""

from __future__ import annotations

import pytest

from pushpressslide.control.adaptation import (
    EFFORT_MOST,
    EFFORT_RISE,
    EFFORT_SHARE,
    GRIP,
    Adaptation,
    TipSpeed,
)

USE, FALL, RISE, LEAST = GRIP
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
    assert near.grip == pytest.approx(1.0 - FALL * DT)
    back = near.step(0.99 * USE, [], None, DT)
    assert back.grip == pytest.approx(near.grip + RISE * DT)


def test_steering_stays_within_its_bounds() -> None:
    assert after(1000, 1.0, []).grip == LEAST
    assert after(1000, 0.0, []).grip == 1.0


def test_tips_that_rest_push_harder_up_to_a_bound() -> None:
    once = Adaptation().step(0.0, RESTING, None, DT)
    assert once.effort == pytest.approx(1.0 + EFFORT_RISE * EFFORT_SHARE * DT)
    assert after(1000, 0.0, RESTING).effort == EFFORT_MOST


def test_tips_that_follow_push_as_planned_again() -> None:
    harder = after(1000, 0.0, RESTING)
    assert harder.step(0.0, FOLLOWING, None, DT).effort < harder.effort
    assert after(1000, 0.0, FOLLOWING).effort == 1.0


@pytest.mark.parametrize("speeds", [[], NOT_LED])
def test_tips_that_nothing_leads_change_no_force(speeds: list[TipSpeed]) -> None:
    harder = Adaptation(effort=1.3)
    assert harder.step(0.0, speeds, None, DT).effort == 1.3
