"""Guidance of an object along its path."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.guidance import Guidance

TURNING = Guidance(
    progress=0.1,
    fx=1.0,
    fy=0.5,
    tau=0.1,
    about=(0.0, 0.0),
    vx=0.03,
    vy=-0.04,
    w=-2.0,
    point=(0.02, 0.0),
    steering=0.3,
    error=(0.0, 0.001, 0.1),
    saturated=False,
)


def test_an_object_that_would_turn_too_fast_is_led_more_slowly_along_the_same_way() -> (
    None
):
    slower = TURNING.turning_at_most(0.5)
    assert slower.w == -0.5
    assert math.hypot(slower.vx, slower.vy) == pytest.approx(0.25 * 0.05)
    assert slower.vx / slower.w == pytest.approx(TURNING.vx / TURNING.w)
    assert slower.vy / slower.w == pytest.approx(TURNING.vy / TURNING.w)
    assert slower.wrench == TURNING.wrench
    assert slower.progress == TURNING.progress


def test_an_object_that_turns_slowly_enough_is_led_as_before() -> None:
    assert TURNING.turning_at_most(2.0) is TURNING
