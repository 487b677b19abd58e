"""A flat finger on the planar engine: the prediction is right away from its limits."""

import random

import pytest

from pushpressslide.core.task import Box, ObjectModel
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.line_push import FlatFinger
from pushpressslide_studies.bench.sticking import (
    Case,
    distance,
    random_case,
    scores,
    sticks_on_the_engine,
)

CLEAR = 0.03  # of a limit: nearer, the engine's tolerance decides
BODY = ObjectModel(Box((0.2, 0.3, 0.1)), 1.0, (0.0, 0.0))


def case(friction: float, twist: Twist) -> Case:
    finger = FlatFinger((-0.1, 0.06), (-0.1, -0.06), friction)
    return Case(BODY, 0.3, finger, twist, 0.0)


@pytest.mark.parametrize(
    ("friction", "twist", "sticks"),
    [
        (0.5, Twist(0.05, 0.0, 0.0), True),
        (0.5, Twist(0.05, 0.024, 0.0), True),
        (1.0, Twist(0.05, 0.04, 0.0), False),  # the resultant is beside the finger
        (0.5, Twist(0.05, 0.0, 1.0), False),
        (0.1, Twist(0.05, 0.01, 0.0), False),
        (0.5, Twist(-0.05, 0.0, 0.0), False),
    ],
)
def test_on_the_engine_a_finger_sticks_slips_or_is_left(friction, twist, sticks):
    assert sticks_on_the_engine(case(friction, twist)) == sticks
    assert case(friction, twist).predicted().sticks == sticks


def test_away_from_its_limits_the_prediction_is_right():
    rng = random.Random(7)
    judged = 0
    stuck = 0
    for _ in range(30):
        push = random_case(rng)
        predicted = push.predicted()
        if distance(predicted) < CLEAR:
            continue
        judged += 1
        stuck += predicted.sticks
        assert sticks_on_the_engine(push) == predicted.sticks, push
    assert judged > 20
    assert 0 < stuck < judged


@pytest.mark.long
def test_of_300_pushes_at_least_98_in_100_are_right():
    exact, ellipsoid = scores(300, seed=8)
    assert exact["model"] == "exact"
    assert exact["right"] >= 0.98
    assert exact["right"] > ellipsoid["right"]
    assert exact["near"] < CLEAR
