"""The turn of an object that a single tip moves tells where its virtual axle is."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.identification.turning import Sight, TurnState

REACH = 0.12
NOISE = 0.01


def moved(start: float, noise: float = 0.0, seed: int = 0) -> Iterator[Sight]:
    """Sights of an object whose axle is a wheel ``REACH`` behind the tip. It begins at
    the yaw ``start`` [rad], and is steered to both sides.
    """
    random = np.random.default_rng(seed)
    x, y, yaw = 0.3, 0.1, start
    for tick in range(1500):
        if tick % 10 == 0:
            place = Pose2(x, y, yaw).apply((REACH, 0.0))
            seen = wrap_angle(yaw + noise * float(random.normal()))
            yield Sight(place, wrap_angle(yaw), seen)
        turn = 2e-3 * math.sin(0.005 * tick)
        x += 5e-4 * math.cos(yaw + 0.5 * turn)
        y += 5e-4 * math.sin(yaw + 0.5 * turn)
        yaw += turn


def told(state: TurnState, sights: Iterator[Sight]) -> TurnState:
    for sight in sights:
        state = state.including(sight)
    return state


@pytest.mark.parametrize("start", [0.0, 3.1])
def test_the_reach_is_found_without_a_prior(start: float) -> None:
    reach = told(TurnState(), moved(start)).reach()
    assert reach is not None
    assert reach.value == pytest.approx(REACH, rel=1e-3)
    assert reach.direction == pytest.approx((1.0, 0.0), abs=1e-3)


def test_what_turns_the_object_between_two_drives_does_not_count() -> None:
    state = told(TurnState(), moved(0.0)).paused()
    assert state.paused() is state
    reach = told(state, moved(1.5)).reach()
    assert reach is not None
    assert reach.value == pytest.approx(REACH, rel=1e-3)


def test_the_interval_of_noisy_pictures_holds_the_truth_as_often_as_it_says() -> None:
    held = 0
    for seed in range(200):
        reach = told(TurnState(), moved(0.0, NOISE, seed)).reach()
        assert reach is not None
        held += abs(reach.value - REACH) <= 1.96 * reach.deviation
    assert 0.90 <= held / 200 <= 0.99


def test_a_straight_push_tells_no_reach() -> None:
    state = TurnState()
    for i in range(50):
        state = state.including(Sight((0.002 * i, 0.0), 0.0, 0.0))
    assert state.reach() is None
