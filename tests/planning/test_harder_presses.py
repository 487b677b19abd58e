"""Presses that are made harder after they have slid."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core import margins
from pushpressslide.planning.pressed.harder import harder, harder_presses

TASK = pps.load_task("press-slide")
UNSURE = replace(TASK.scene, friction_error=0.5, mass_error=0.5)
(SEGMENT,) = pps.plan(TASK).segments
(PRESS,) = SEGMENT.contacts


def test_a_press_is_harder_by_half_of_what_errors_allow() -> None:
    assert harder(TASK.scene) == margins.HARDER
    assert harder(UNSURE) == pytest.approx(2.0)
    (pressed,) = harder_presses(TASK.scene, [PRESS], math.inf)
    assert pressed == replace(PRESS, load=margins.HARDER * PRESS.load)


def test_the_limit_holds_and_no_press_becomes_lighter() -> None:
    (pressed,) = harder_presses(TASK.scene, [PRESS], 1.1 * PRESS.load)
    assert pressed.load == pytest.approx(1.1 * PRESS.load)
    assert harder_presses(TASK.scene, [PRESS], 0.5 * PRESS.load) == (PRESS,)


def test_a_press_that_would_tip_the_object_is_not_made_harder() -> None:
    """At the edge of an object that may be half as heavy as believed."""
    shape = pps.Box((0.1, 0.1, 0.05))
    body = replace(UNSURE.body, shape=shape, mass=0.4)
    scene = replace(UNSURE, body=body)
    edge = replace(PRESS, point=(0.045, 0.0), height=0.05, load=4.0)
    middle = replace(edge, point=(0.004, 0.0))
    assert harder_presses(scene, [edge], math.inf) == (edge,)
    (pressed,) = harder_presses(scene, [middle], math.inf)
    assert pressed.load > edge.load


def test_two_presses_become_harder_alike() -> None:
    two = [PRESS, replace(PRESS, arm=1, load=2.0 * PRESS.load)]
    pressed = harder_presses(UNSURE, two, math.inf)
    assert [one.load for one in pressed] == [2.0 * one.load for one in two]
