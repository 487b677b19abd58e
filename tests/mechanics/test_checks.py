"""Allowed and forbidden values in the checks that all constructors share."""

import math

import pytest

from pushpressslide.mechanics.checks import (
    check_caps,
    check_force,
    check_friction,
    check_normal,
    check_point,
    check_press,
    check_rho,
)

ALLOWED = {
    "no friction": lambda: check_friction(0.0),
    "friction above one": lambda: check_friction(1.7),
    "a small rho": lambda: check_rho(1e-9),
    "a small force": lambda: check_force(1e-9, "load"),
    "a press without friction": lambda: check_press(1e-9, 0.0),
    "no caps": lambda: check_caps((math.inf, math.inf)),
    "a small cap": lambda: check_caps((1e-9, 5.0)),
    "a point anywhere": lambda: check_point((-3.0, 1e6), "contact"),
    "a unit vector": lambda: check_normal((0.6, -0.8)),
    "a unit vector to three digits": lambda: check_normal((0.707, 0.707)),
}
REFUSED = {
    "friction -0.1": lambda: check_friction(-0.1),
    "friction inf": lambda: check_friction(math.inf),
    "friction nan": lambda: check_friction(math.nan),
    "support_friction -1.0": lambda: check_friction(-1.0, "support_friction"),
    "rho 0.0 m": lambda: check_rho(0.0),
    "rho inf m": lambda: check_rho(math.inf),
    "load 0.0 N": lambda: check_force(0.0, "load"),
    "load nan N": lambda: check_force(math.nan, "load"),
    "load -1.0 N": lambda: check_press(-1.0, 0.5),
    "friction -2.0": lambda: check_press(1.0, -2.0),
    "must be two": lambda: check_caps((1.0,)),
    "cap 0.0 N": lambda: check_caps((5.0, 0.0)),
    "cap nan N": lambda: check_caps((math.nan, 5.0)),
    "contact .*nan.* m": lambda: check_point((0.0, math.nan), "contact"),
    "push .*inf.* m": lambda: check_point((math.inf, 0.0), "push"),
    "normal .* unit": lambda: check_normal((0.6, 0.81)),
    "normal .*0.5.* unit": lambda: check_normal((0.5, 0.0)),
    "normal .*nan.* unit": lambda: check_normal((math.nan, 0.0)),
}


@pytest.mark.parametrize("what", ALLOWED)
def test_what_can_be_passes(what: str) -> None:
    ALLOWED[what]()


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_is_refused_with_its_name_and_value(words: str) -> None:
    with pytest.raises(ValueError, match=words):
        REFUSED[words]()
