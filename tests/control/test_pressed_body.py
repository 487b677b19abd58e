"""Mass, centre of mass and friction by the turns of an object under single presses."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.pressed_body import PressedFit, pressed_body
from pushpressslide.core.pose import Point
from pushpressslide.core.scene import Scene
from pushpressslide.identification.pressed_travel import PressedTravel
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.planning.pressed.turns import dragged_along

TRUE = pps.load_task("press-slide").scene
BODY = TRUE.body
LOAD = 8.0
PLACES = ((0.2, 0.0), (-0.1, 0.06))
ANGLES = (0.0, 0.5, -0.9, 1.4, 2.5)


def believed(
    mass: float = 1.0, friction: float = 1.0, center: Point = (0.0, 0.0)
) -> Scene:
    """Scene with wrong factors of mass and friction and a centre elsewhere."""
    x, y = BODY.center_of_mass
    body = replace(
        BODY,
        mass=mass * BODY.mass,
        center_of_mass=(x + center[0], y + center[1]),
    )
    support = replace(TRUE.support, friction=friction * TRUE.support.friction)
    return replace(
        TRUE,
        body=body,
        support=support,
        mass_error=0.3,
        friction_error=0.3,
        center_error=0.03,
    )


def travels(noise: float = 0.0, seed: int = 0) -> tuple[PressedTravel, ...]:
    """Travels of the true object, with a standard deviation of turns of ``noise`` [rad]."""
    random = np.random.default_rng(seed)
    x, y = BODY.center_of_mass
    out = []
    for place in PLACES:
        contact = (place[0] - x, place[1] - y)
        press = Press(BODY, TRUE.support.friction, contact, LOAD)
        for angle in ANGLES:
            twist = press.twist(angle).moved_to(contact)
            size = 0.05 / math.hypot(twist.vx, twist.vy)
            way = (size * twist.vx, size * twist.vy)
            turn = size * twist.w + noise * float(random.normal())
            (_,), (share,) = dragged_along(
                [press], np.array([math.atan2(way[1], way[0])])
            )
            force = float(share) * TRUE.max_friction(LOAD)
            deviation = max(noise, 1e-3)
            out.append(
                PressedTravel(place, place, LOAD, way, turn, deviation, force, 9)
            )
    return tuple(out)


def test_turns_and_forces_are_those_of_the_press_itself() -> None:
    x, y = BODY.center_of_mass
    contact = (PLACES[0][0] - x, PLACES[0][1] - y)
    press = Press(BODY, TRUE.support.friction, contact, LOAD)
    for angle in ANGLES:
        twist = press.twist(angle).moved_to(contact)
        direction = np.array([math.atan2(twist.vy, twist.vx)])
        (turn,), (share,) = dragged_along([press], direction)
        expected = twist.w / math.hypot(twist.vx, twist.vy)
        assert turn == pytest.approx(expected, rel=0.02, abs=0.05)
        assert 0.3 < share < 1.01


def test_a_wrong_belief_is_corrected() -> None:
    scene = believed(1.3, 0.8, (0.02, -0.01))
    found = pressed_body(scene, CenterBelief.before_run(scene), travels(), 0.1)
    assert found is not None
    assert found.mass == pytest.approx(BODY.mass, rel=0.1)
    assert found.friction == pytest.approx(TRUE.support.friction, rel=0.05)
    before = math.dist(scene.body.center_of_mass, BODY.center_of_mass)
    off = math.dist(found.center.place, BODY.center_of_mass)
    assert off < 0.25 * before
    assert off < 2.0 * found.center.error
    assert found.mass_error < 0.3
    assert found.center.error < 0.02


def test_the_stated_errors_hold_the_truth() -> None:
    """Of twenty noisy fits, the centre is within two deviations in 85 % or more."""
    scene = believed(1.2, 0.9, (0.0, 0.02))
    held = 0
    for seed in range(20):
        given = travels(0.02, seed)
        found = pressed_body(scene, CenterBelief.before_run(scene), given, 0.1)
        assert found is not None
        off = found.center.y - BODY.center_of_mass[1]
        held += abs(off) < 2.0 * found.center.deviation((0.0, 1.0))
    assert held >= 17


def test_a_belief_that_is_sure_of_the_mass_keeps_it() -> None:
    scene = replace(believed(1.0, 1.0, (0.02, 0.0)), mass_error=0.0, friction_error=0.0)
    found = pressed_body(scene, CenterBelief.before_run(scene), travels(), 0.1)
    assert found is not None
    assert found.mass == pytest.approx(BODY.mass)
    assert found.mass_error == 0.0
    assert found.friction == pytest.approx(TRUE.support.friction)
    assert math.dist(found.center.place, BODY.center_of_mass) < 0.005


def test_one_travel_that_slid_unseen_hardly_counts() -> None:
    scene = believed(1.2, 0.9, (0.01, 0.0))
    center = CenterBelief.before_run(scene)
    good = pressed_body(scene, center, travels(), 0.1)
    slid = travels()[0]._replace(turn=0.6)
    bad = pressed_body(scene, center, (*travels(), slid), 0.1)
    assert good is not None
    assert bad is not None
    assert bad.mass == pytest.approx(good.mass, rel=0.1)
    assert math.dist(bad.center.place, good.center.place) < 0.005


def test_nothing_is_told_without_travels_or_of_a_sure_centre() -> None:
    scene = believed()
    fit = PressedFit(scene, 0.1)
    center = CenterBelief.before_run(scene)
    assert fit.body(center, ()) is None
    assert fit.body(None, travels()) is None
    found = fit.body(center, travels())
    assert found is not None
    assert fit.body(center, travels()) is found
