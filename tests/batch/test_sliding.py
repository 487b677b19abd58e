"""Balance of many bodies under tips, like that of one of them by the single form."""

import math
from functools import cache

import numpy as np
import pytest

from pushpressslide.batch.sliding import slide
from pushpressslide.batch.support import ellipsoid_support, exact_support
from pushpressslide.mechanics.pressure import (
    PressureSamples,
    pin_pressure,
    rectangle_pressure,
)
from pushpressslide.planar.contact import SideContact, TipLaw
from pushpressslide.planar.sliding import REST
from pushpressslide.planar.sliding import slide as slide_one
from pushpressslide.planar.support_friction import SupportFriction

LOAD = 10.0  # [N]
RADIUS = 0.02  # [m] of the tips
ROWS = 400
BOX = rectangle_pressure(0.2, 0.12, LOAD, (0.01, 0.0), 4)
LIFTED = rectangle_pressure(0.2, 0.12, LOAD, (0.05, 0.02), 4)
PINS = pin_pressure(((0.1, 0.0), (-0.05, 0.06), (-0.05, -0.06)), (0.01, 0.005))


def touched(rng):
    """A tip at a side of a box somewhere, touching it or about to."""
    angle = rng.uniform(-math.pi, math.pi)
    n = (math.cos(angle), math.sin(angle))
    along = rng.uniform(-0.1, 0.1)
    out = rng.uniform(0.03, 0.15)
    point = (-out * n[0] - along * n[1], -out * n[1] + along * n[0])
    center = (point[0] - RADIUS * n[0], point[1] - RADIUS * n[1])
    size = 10.0 ** rng.uniform(-0.5, 1.5)
    force = (size * abs(rng.normal()), size * rng.normal())
    first, second = rng.uniform(50.0, 1500.0, 2).tolist()
    damping = (first, first if rng.random() < 0.6 else second)
    approach = 0.0 if rng.random() < 0.7 else rng.uniform(0.0, 0.05)
    friction = 0.0 if rng.random() < 0.05 else rng.uniform(0.05, 1.2)
    return SideContact(point, center, TipLaw(n, force, damping), friction, approach)


def columns(contact, rho):
    """The same tip as the batch takes it."""
    (px, py), (cx, cy) = contact.point, contact.center
    nx, ny = contact.law.axis
    fn, ft = contact.law.force
    bn, bt = contact.law.damping
    return (
        nx,
        ny,
        fn - bn * contact.approach,
        ft,
        bn,
        bt,
        contact.friction,
        (px * ny - py * nx) / rho,
        (px * nx + py * ny) / rho,
        (cx * nx + cy * ny) / rho,
    )


def compared(support, single):
    """Both answers, (n, 3) with rho w, for the cases of ``single``."""
    cases, guesses, twists = single
    rho = np.broadcast_to(support.rho, len(cases))
    tips = [
        np.array([columns(c[k], r) for c, r in zip(cases, rho.tolist(), strict=True)])
        for k in range(len(cases[0]))
    ]
    scale = np.stack([np.ones_like(rho), np.ones_like(rho), rho], axis=1)
    return slide(support, tips, guesses * scale), twists * scale


def answers(supports, limits, count):
    """Random tips, guesses, and the twists of the single form."""
    rng = np.random.default_rng(count)
    cases = [tuple(touched(rng) for _ in range(count)) for _ in supports]
    guesses = rng.normal(size=(len(cases), 3)) * (0.05, 0.05, 0.5)
    guesses[rng.random(len(cases)) < 0.5] = REST
    twists = [
        slide_one(friction, limit, case, tuple(guess))
        for friction, limit, case, guess in zip(
            supports, limits.tolist(), cases, guesses.tolist(), strict=True
        )
    ]
    return cases, guesses, np.array(twists)


@cache
def on_ellipsoids(count):
    rng = np.random.default_rng(7)
    rho = rng.uniform(0.02, 0.12, ROWS)
    limits = LOAD * rng.uniform(0.1, 0.8, len(rho))
    supports = [
        SupportFriction(PressureSamples(np.zeros((1, 2)), [LOAD], [r]))
        for r in rho.tolist()
    ]
    return rho, limits, answers(supports, limits, count)


@pytest.mark.parametrize("count", [1, 2])
def test_the_twist_is_that_of_the_single_form_on_the_ellipsoid(engine, count):
    rho, limits, single = on_ellipsoids(count)
    many, one = compared(ellipsoid_support(limits, rho), single)
    np.testing.assert_allclose(many, one, rtol=1e-6, atol=1e-8)
    moving = np.abs(one).max(axis=1) > 1e-4
    assert 0.2 * ROWS < moving.sum() < 0.8 * ROWS
    assert ((one == 0.0).all(axis=1)).sum() > 0.01 * ROWS


@cache
def on_pressure(samples, count):
    friction = SupportFriction(samples)
    limits = LOAD * np.random.default_rng(8).uniform(0.1, 0.8, ROWS)
    return limits, answers([friction] * len(limits), limits, count)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("samples", [BOX, LIFTED], ids=["box", "lifted"])
def test_the_twist_is_that_of_the_single_form_on_the_exact_surface(
    engine, samples, count
):
    limits, single = on_pressure(samples, count)
    many, one = compared(exact_support(samples, limits / LOAD), single)
    np.testing.assert_allclose(many, one, rtol=1e-6, atol=1e-8)
    assert (np.abs(one).max(axis=1) > 1e-4).sum() > 0.2 * ROWS


def test_a_support_needs_a_size():
    with pytest.raises(ValueError, match="rho"):
        ellipsoid_support(1.0, 0.0)
    with pytest.raises(ValueError, match="max_force"):
        ellipsoid_support(np.inf, 0.1)
    with pytest.raises(ValueError, match="friction"):
        exact_support(BOX, 0.0)
    with pytest.raises(ValueError, match="radius of a sample"):
        exact_support(PINS, 0.3)
