"""The watch over the distance between arms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from pushpressslide.control.spacing import FASTEST, REACTION, SpacingWatch
from pushpressslide.core.arrays import Array

PERIOD = 0.004


def sliders(postures: Sequence[Array]) -> float:
    """Distance of two arms that slide on a line."""
    one, other = postures
    return float(other[0] - one[0])


def stopped_at(speed: float, start: float = 0.05) -> float | None:
    """Distance [m] at which two arms that approach at ``speed`` [m/s] are stopped."""
    watch = SpacingWatch(sliders)
    for i in range(2000):
        distance = start - speed * i * PERIOD
        if watch.step(i * PERIOD, [np.zeros(1), np.array([distance])]) is not None:
            return distance
    return None


@pytest.mark.parametrize("speed", [0.01, 0.1, 0.5 * FASTEST])
def test_arms_are_stopped_a_reaction_before_they_touch(speed: float) -> None:
    distance = stopped_at(speed)
    assert distance is not None
    late = speed * PERIOD
    assert speed * REACTION - late - 1e-9 <= distance <= speed * REACTION + 1e-9


def test_arms_that_keep_their_distance_go_on() -> None:
    assert stopped_at(0.0, 0.001) is None
    assert stopped_at(-0.1, 0.001) is None


def test_far_arms_are_rarely_measured() -> None:
    asked = []

    def far(postures: Sequence[Array]) -> float:
        asked.append(postures)
        return 0.08

    watch = SpacingWatch(far)
    for i in range(1000):
        assert watch.step(i * PERIOD, []) is None
    assert len(asked) == pytest.approx(1000 * PERIOD * FASTEST / 0.08, rel=0.1)


def test_the_text_says_how_near_and_how_fast() -> None:
    watch = SpacingWatch(sliders)
    ended = watch.step(0.0, [np.zeros(1), np.array([-0.006])])
    assert ended is not None
    assert (ended.code, ended.text) == (
        "collision",
        "the arms come as near as -6.0 mm",
    )
    assert watch.too_near
    watch.forget()
    assert not watch.too_near
