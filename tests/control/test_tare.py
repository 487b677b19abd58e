"""Zero of the force sensors."""

from __future__ import annotations

import numpy as np
import pytest

from pushpressslide.control.tare import Tare
from pushpressslide.core.control import TipState, Vector3

ZERO = (0.0, 0.0, 0.0)


def feeling(*forces: Vector3) -> tuple[TipState, ...]:
    return tuple(TipState(ZERO, ZERO, force) for force in forces)


def test_what_free_tips_measure_is_taken_off_later() -> None:
    tare = Tare(2)
    random = np.random.default_rng(2)
    zero = (0.4, -0.2, 1.0)
    for _ in range(400):
        x, y, z = (np.array(zero) + 0.1 * random.normal(size=3)).tolist()
        tare.add(feeling((x, y, z), (9.0, 9.0, 9.0)), (True, False))
    first, second = tare.removed(feeling((3.4, -0.2, 1.0), (9.0, 9.0, 9.0)))
    assert first.force == pytest.approx((3.0, 0.0, 0.0), abs=4 * 0.1 / 20)
    assert second.force == (9.0, 9.0, 9.0)  # it was never free


def test_a_sensor_without_an_offset_is_left_alone() -> None:
    tare = Tare(1)
    tips = feeling((1.0, 2.0, 3.0))
    assert tare.removed(tips)[0] is tips[0]
    tare.add(feeling(ZERO), (True,))
    assert tare.removed(tips)[0] is tips[0]
