"""Loads of two presses that put the centre of pressure at a requested point."""

import math

import numpy as np
import pytest

from pushpressslide.allocation.cop_strategy import (
    least_loads,
    loads_with,
    possible_fractions,
    safe_loads,
)
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.core.wrench import Twist

LEFT = (0.0, 0.12)
RIGHT = (0.0, -0.12)
WEIGHT = 20.0
MU_S = 0.3
MU_A = 0.8
RHO = 0.13
USES = (0.7, 0.8, 0.9)
TWISTS = [
    Twist(1.0, 0.0, 0.0),
    Twist(0.3, 1.0, 2.0),
    Twist(0.0, 0.0, -1.0),
    Twist(-1.0, 0.4, 5.0),
]


def presses(use: float = 1.0, cap: float = 60.0) -> TwoPresses:
    return TwoPresses(LEFT, RIGHT, WEIGHT, MU_S, use * MU_A, RHO, cap)


def fraction(normals: tuple[float, float]) -> float:
    """Where the centre of pressure is, from left to right; the CoM is in the middle."""
    return (normals[1] + 0.5 * WEIGHT) / (WEIGHT + sum(normals))


@pytest.mark.parametrize("cop", [0.4, 0.5, 0.57])
def test_a_fraction_is_where_the_centre_of_pressure_comes_to_be(cop: float) -> None:
    for twist in TWISTS:
        loads = least_loads(presses(), cop, twist)
        assert loads is not None
        assert fraction(loads) == pytest.approx(cop)
        assert fraction(loads_with(presses(), cop, 30.0)) == pytest.approx(cop)


@pytest.mark.parametrize("cop", ["balanced", "left", "right", 0.3, 0.6])
def test_the_larger_load_is_the_one_that_is_given(cop) -> None:
    left, right = loads_with(presses(), cop, 25.0)
    assert max(left, right) == pytest.approx(25.0)
    if cop == "balanced":
        assert left == right
    else:
        assert (left > right) == (cop == "left" or cop == 0.3)


def test_left_and_right_leave_the_lighter_contact_just_what_a_turn_on_the_spot_takes() -> (
    None
):
    for cop in ("left", "right"):
        loads = loads_with(presses(), cop, 40.0)
        turn = presses().loads_for(loads, Twist(0.0, 0.0, 1.0, cop_of(loads)))
        assert turn.status == "ok"
        assert 0.0 < turn.margin < 0.1 * MU_A * min(loads)


def cop_of(loads: tuple[float, float]) -> tuple[float, float]:
    return (0.0, 0.12 * (loads[0] - loads[1]) / (WEIGHT + sum(loads)))


def test_balanced_loads_drive_every_twist_with_the_share_of_friction_that_was_asked() -> (
    None
):
    loads = safe_loads(presses, "balanced", TWISTS[0], USES, 2.0)
    assert loads is not None
    assert loads[0] == loads[1]
    use = next(u for u in USES if presses(u).press_for_every_twist() <= 2.0 * 60.0)
    rng = np.random.default_rng(0)
    margins = [
        presses(use).loads_for(loads, Twist(*rng.normal(size=2), rng.normal() / RHO))
        for _ in range(500)
    ]
    assert all(found.status == "ok" for found in margins)
    assert min(found.margin for found in margins) < 0.3


def test_the_first_share_of_friction_that_the_cap_allows_is_taken() -> None:
    free = safe_loads(
        lambda use: presses(use, cap=1e3), "balanced", TWISTS[0], USES, 2.0
    )
    tight = safe_loads(
        lambda use: presses(use, cap=0.9 * free[0]), "balanced", TWISTS[0], USES, 2.0
    )
    assert tight is not None
    assert tight[0] < 0.9 * free[0]


def test_no_load_is_lighter_than_can_be_felt_and_a_ratio_is_kept_for_it() -> None:
    light = TwoPresses(LEFT, RIGHT, 3.0, 0.3, 1.2, RHO, 60.0)
    for cop in ("balanced", "left", "right"):
        loads = safe_loads(lambda _: light, cop, TWISTS[2], USES, 2.0)
        assert loads is not None
        assert min(loads) >= 2.0 - 1e-12
        least = least_loads(light, cop, TWISTS[2])
        assert min(least) < 2.0
        assert loads[0] / loads[1] == pytest.approx(least[0] / least[1])


def test_a_fraction_stays_where_it_is_when_its_loads_are_raised_to_be_felt() -> None:
    light = TwoPresses(LEFT, RIGHT, 3.0, 0.3, 1.2, RHO, 60.0)
    for twist in TWISTS:
        loads = safe_loads(lambda _: light, 0.42, twist, USES, 2.0)
        assert loads is not None
        assert min(least_loads(light, 0.42, twist)) < 2.0
        assert min(loads) == pytest.approx(2.0)
        assert (loads[1] + 1.5) / (3.0 + sum(loads)) == pytest.approx(0.42)
        assert light.loads_for(loads, twist).status == "ok"


def test_a_fraction_that_needs_a_pull_has_no_loads_and_the_possible_ones_are_an_interval() -> (
    None
):
    twist = TWISTS[2]
    low, high = possible_fractions(presses, twist, (1.0,), 2.0)
    assert 0.0 < low < 0.5 < high < 1.0
    assert low == pytest.approx(1.0 - high)
    for cop in (0.0, low - 0.02, high + 0.02):
        assert least_loads(presses(), cop, twist) is None
        assert safe_loads(presses, cop, twist, USES, 2.0) is None
    assert math.isclose(fraction(safe_loads(presses, low, twist, (1.0,), 2.0)), low)
    for cop in (0.0, 0.05, 1.0):
        normals = loads_with(presses(), cop, 40.0)
        assert min(normals) < 0.0
        assert max(normals) == pytest.approx(40.0)
        assert fraction(normals) == pytest.approx(cop)
