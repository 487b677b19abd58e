"""The models recover the parameters of synthetic pushes, and keep the laws that they
promise.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.core.wrench import Wrench
from pushpressslide.identification.ellipsoid import fit_full, fit_one_parameter
from pushpressslide.identification.fitted_pressure import fit_pressure, static_model
from pushpressslide.identification.pairs import LENGTH, Pairs, unit
from pushpressslide.identification.quartic import fit_quartic
from pushpressslide.identification.scoring import angles
from pushpressslide.identification.sliding import slide
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_level,
    exact_twist_direction,
)
from pushpressslide.mechanics.pressure import (
    PressureSamples,
    center_of_pressure,
    pin_pressure,
    polygon_pressure,
    rectangle_pressure,
)
from pushpressslide.mechanics.rho import rho_pole

PINS = ((-0.02, -0.02), (0.04, -0.02), (-0.02, 0.04))
BASE = ((-0.05, -0.05), (0.1, -0.05), (-0.05, 0.1))
WEIGHT = 14.715


def some_wrenches(n: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, 3)) * (3.0, 3.0, 0.12)


def ellipsoid_pairs(surface: EllipsoidLimitSurface, n: int) -> Pairs:
    wrenches = some_wrenches(n)
    levels = np.array([surface.level(Wrench(*w)) for w in wrenches])
    wrenches /= np.sqrt(levels)[:, None]
    twists = np.array([surface.twist_direction(Wrench(*w))[:3] for w in wrenches])
    return Pairs(wrenches, twists, np.zeros((n, 2)), np.zeros(n))


def test_many_wrenches_at_once_slide_as_each_alone_does() -> None:
    patch = rectangle_pressure(0.15, 0.1, 9.0, (0.01, 0.005), resolution=4)
    wrenches = some_wrenches(60)
    shares = np.tile(patch.loads / patch.total_load, (60, 1))
    directions, levels = slide(patch.points, shares, patch.radii, wrenches)
    for wrench, direction, level in zip(wrenches, directions, levels, strict=True):
        twist = exact_twist_direction(patch, Wrench(*wrench)).moved_to((0.0, 0.0))
        alone = unit(np.array([[twist.vx, twist.vy, LENGTH * twist.w]]))[0]
        assert direction == pytest.approx(alone, abs=1e-6)
        assert level == pytest.approx(
            9.0 * exact_level(patch, 1.0, Wrench(*wrench)), rel=1e-9
        )


def test_pins_slide_as_the_exact_surface_of_points_says() -> None:
    pins = pin_pressure(PINS, (0.0, 0.0), WEIGHT)
    wrenches = some_wrenches(100)
    directions = static_model(pins).directions(wrenches, np.zeros(100))
    alone = []
    for wrench in wrenches:
        twist = exact_twist_direction(pins, Wrench(*wrench))
        alone.append((twist.vx, twist.vy, LENGTH * twist.w))
    error = np.degrees(angles(directions, unit(np.array(alone))))
    assert error.max() < 5.0  # near a facet, the pins' radius counts
    assert np.median(error) < 0.5


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.floats(-0.3, 0.3),
    st.floats(0.0, 0.02),
)
def test_the_load_moves_by_the_height_term_and_keeps_its_sum(
    fx: float, fy: float, tau: float, height: float
) -> None:
    pressures = (
        pin_pressure(PINS, (0.0, 0.0), WEIGHT),
        polygon_pressure(BASE, WEIGHT, resolution=3),
    )
    for pressure in pressures:
        model = static_model(pressure)
        (shares,) = model.pushed_shares(np.array([[fx, fy, tau]]), np.array([height]))
        expected = center_of_pressure(
            WEIGHT, pressure.cop, forces=[(fx, fy)], heights=[height]
        )
        assert shares.sum() == pytest.approx(1.0)
        assert shares @ model.points == pytest.approx(expected, abs=1e-9)


def test_on_pins_the_loads_under_a_push_are_those_of_statics() -> None:
    model = static_model(pin_pressure(PINS, (0.0, 0.0), WEIGHT))
    (shares,) = model.pushed_shares(np.array([[3.0, -2.0, 0.1]]), np.array([0.0125]))
    cop = center_of_pressure(WEIGHT, (0.0, 0.0), forces=[(3.0, -2.0)], heights=[0.0125])
    assert shares == pytest.approx(pin_pressure(PINS, cop).loads, abs=1e-12)


def test_one_parameter_recovers_rho_and_friction_of_an_ellipsoid() -> None:
    fitted = fit_one_parameter(ellipsoid_pairs(EllipsoidLimitSurface(4.2, 0.037), 12))
    assert fitted.rho == pytest.approx(0.037, rel=1e-4)
    assert fitted.max_force == pytest.approx(4.2, rel=1e-4)


def test_the_full_ellipsoid_recovers_a_centre_that_is_not_the_centre_of_mass() -> None:
    surface = EllipsoidLimitSurface(4.2, 0.037, (0.01, -0.006))
    pairs = ellipsoid_pairs(surface, 25)
    twists = np.array(
        [
            surface.twist_direction(Wrench(*w)).moved_to((0.0, 0.0))[:3]
            for w in pairs.wrenches
        ]
    )
    moved = Pairs(pairs.wrenches, twists, pairs.contacts, pairs.heights)
    fitted = fit_full(moved)
    assert (
        np.degrees(
            angles(fitted.directions(moved.wrenches, moved.heights), moved.directions)
        ).max()
        < 0.05
    )
    assert np.linalg.eigvalsh(fitted.matrix).min() > 0.0
    worse = fit_one_parameter(moved)
    assert (
        np.degrees(
            angles(worse.directions(moved.wrenches, moved.heights), moved.directions)
        ).max()
        > 5.0
    )


def test_the_quartic_is_convex_and_holds_the_ellipsoid() -> None:
    pairs = ellipsoid_pairs(EllipsoidLimitSurface(4.2, 0.037), 25)
    fitted = fit_quartic(pairs)
    assert fitted.coefficients.min() >= 0.0
    held_out = ellipsoid_pairs(EllipsoidLimitSurface(4.2, 0.037), 60)
    error = np.degrees(
        angles(
            fitted.directions(held_out.wrenches, held_out.heights), held_out.directions
        )
    )
    assert error.mean() < 1.0


def test_the_quartic_is_nearer_to_an_exact_surface_than_the_ellipsoid(
    sample_pairs,
) -> None:
    pins = pin_pressure(PINS, (0.0, 0.0), WEIGHT)
    to_fit = sample_pairs(pins, 0.3, 60)
    held_out = sample_pairs(pins, 0.3, 100, seed=1)
    errors = [
        angles(
            fit(to_fit).directions(held_out.wrenches, held_out.heights),
            held_out.directions,
        ).mean()
        for fit in (fit_quartic, fit_full)
    ]
    assert errors[0] < 0.8 * errors[1]


def test_fitted_loads_friction_and_rho_are_those_that_made_the_pushes(
    sample_pairs,
) -> None:
    true = PressureSamples(np.array(PINS), WEIGHT * np.array([0.25, 0.45, 0.3]))
    pairs = sample_pairs(true, 0.31, 60)
    fitted = fit_pressure(pairs, pin_pressure(PINS, (0.0, 0.0), WEIGHT))
    assert fitted.shares == pytest.approx([0.25, 0.45, 0.3], abs=0.02)
    assert fitted.friction == pytest.approx(0.31, rel=0.01)
    assert rho_pole(fitted.at_rest) == pytest.approx(rho_pole(true), rel=0.03)
    assert (
        np.degrees(
            angles(fitted.directions(pairs.wrenches, pairs.heights), pairs.directions)
        ).mean()
        < 1.5
    )


def test_a_face_that_presses_at_its_rim_is_found_from_an_even_load(
    sample_pairs,
) -> None:
    even = polygon_pressure(BASE, WEIGHT, resolution=2)
    x, y = (even.points / 0.05).T
    loads = even.loads * np.exp(0.35 * (x * x + y * y) + 0.3 * x * y)
    true = PressureSamples(even.points, loads * WEIGHT / loads.sum(), even.radii)
    pairs = sample_pairs(true, 0.31, 60)
    fitted = fit_pressure(pairs, even)
    errors = [
        np.degrees(
            angles(m.directions(pairs.wrenches, pairs.heights), pairs.directions)
        ).mean()
        for m in (fitted, static_model(even))
    ]
    assert errors[0] < 0.35 * errors[1]
    assert abs(rho_pole(fitted.at_rest) / rho_pole(true) - 1.0) < 0.3 * abs(
        rho_pole(even) / rho_pole(true) - 1.0
    )


def test_the_height_of_the_push_is_taken_into_account(
    sample_pairs, model_pairs
) -> None:
    pins = pin_pressure(PINS, (0.0, 0.0), WEIGHT)
    pairs = model_pairs(pins, sample_pairs(pins, 0.3, 60), 0.03)
    model = static_model(pins)
    aware, unaware = (
        np.degrees(angles(model.directions(pairs.wrenches, h), pairs.directions)).mean()
        for h in (pairs.heights, np.zeros(60))
    )
    assert aware < 1e-3
    assert unaware > 1.0
