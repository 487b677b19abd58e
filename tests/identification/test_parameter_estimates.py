"""What the forces of the tips tell of the support."""

from __future__ import annotations

import math

import pytest

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.identification.parameter_estimates import withstood_friction

SCENE = pps.load_task("rear-push-rear").scene
WEIGHT = SCENE.weight_on


def test_an_object_that_does_not_move_tells_the_least_friction_of_its_support() -> None:
    push = 0.3 * WEIGHT
    assert withstood_friction(SCENE, [(push, 0.0, 0.0)], 0.0, 0.0) == pytest.approx(0.3)
    # two tips at a right angle, then one against the other
    pair = [(0.3 * WEIGHT, 0.0, 0.0), (0.0, 0.4 * WEIGHT, 0.0)]
    assert withstood_friction(SCENE, pair, 0.0, 0.0) == pytest.approx(0.5)
    squeeze = [(push, 0.0, 0.0), (-push, 0.0, 0.0)]
    assert withstood_friction(SCENE, squeeze, 0.0, 0.0) == 0.0


def test_a_press_adds_to_what_the_support_carries() -> None:
    press = [(0.3 * WEIGHT, 0.0, -0.5 * WEIGHT)]
    assert withstood_friction(SCENE, press, 0.0, 0.0) == pytest.approx(0.2)


def test_what_noise_and_acceleration_explain_tells_nothing() -> None:
    push = [(0.3 * WEIGHT, 0.0, 0.0)]
    faster = withstood_friction(SCENE, push, 0.0, 0.1)
    assert (0.3 - faster) * WEIGHT == pytest.approx(0.1 * SCENE.body.mass)
    noisy = withstood_friction(SCENE, push * 2, 0.1, 0.0)
    assert (0.6 - noisy) * WEIGHT == pytest.approx(margins.DOUBT * math.sqrt(2.0) * 0.1)
    assert withstood_friction(SCENE, push, WEIGHT, 0.0) == 0.0


def test_a_slope_tells_nothing() -> None:
    tilted = pps.load_task(
        "rear-push-rear", ["support.kind=incline", "support.angle_deg=5.0"]
    ).scene
    assert withstood_friction(tilted, [(WEIGHT, 0.0, 0.0)], 0.0, 0.0) == 0.0
