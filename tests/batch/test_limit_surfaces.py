"""Limit surfaces on arrays answer like the single ones, row by row."""

import math
from functools import cache

import numpy as np
import pytest

from pushpressslide.batch.exact_surface import ExactSurface, exact_axle_distances
from pushpressslide.batch.limit_surface import EllipsoidSurface
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_slide,
    exact_wrenches,
)
from pushpressslide.mechanics.pressure import PressureSamples, rectangle_pressure
from pushpressslide.mechanics.virtual_axle import exact_axle_distance

CASES = 10_000
ORIGIN = (0.0, 0.0)
BOX = rectangle_pressure(0.2, 0.12, 10.0, (0.01, -0.005), 2)
PINS = PressureSamples(
    np.array([[0.1, 0.0], [-0.05, 0.08], [-0.05, -0.08]]), np.array([1.0, 2.0, 1.5])
)


def degenerate_rows():
    rows = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    return np.array([*rows, (1e-200, 0.0, 0.0), (-1.0, 1.0, 0.0)])


@pytest.mark.parametrize("lifted", [False, True])
def test_the_ellipsoid(engine, lifted):
    rng = np.random.default_rng(0)
    force = rng.uniform(0.5, 5.0, CASES)
    rho = rng.uniform(0.03, 0.1, CASES)
    center = rng.uniform(-0.05, 0.05, (CASES, 2))
    lift = rng.uniform(0.0, 0.05, CASES) * lifted
    rows = rng.normal(size=(CASES, 3)) * (1.0, 1.0, 5.0)
    degenerate = degenerate_rows()
    rows[: len(degenerate)] = degenerate
    surface = EllipsoidSurface(force, rho, center, lift)
    wrenches = surface.wrenches(rows)
    twists = surface.twist_directions(rows)
    figures = zip(
        force.tolist(), rho.tolist(), lift.tolist(), center.tolist(), strict=True
    )
    single = [DraggedSurface(f, r, h, tuple(c)) for f, r, h, c in figures]
    for got, expected in (
        (wrenches, [s.wrench(Twist(*r)) for s, r in zip(single, rows, strict=True)]),
        (
            twists,
            [s.twist_direction(Wrench(*r)) for s, r in zip(single, rows, strict=True)],
        ),
    ):
        moved = np.array([e.moved_to(ORIGIN)[:3] for e in expected])
        np.testing.assert_allclose(got, moved, rtol=1e-9, atol=1e-12)


def test_the_level_of_an_ellipsoid_and_rows_that_are_no_numbers(engine):
    rows = np.array([(1.0, 0.5, 0.02), (math.nan, 0.0, 0.0), (0.0, math.inf, 0.0)])
    surface = EllipsoidSurface(2.0, 0.08, (0.01, 0.02))
    single = EllipsoidLimitSurface(2.0, 0.08, (0.01, 0.02))
    assert surface.levels(rows)[0] == pytest.approx(single.level(Wrench(*rows[0])))
    for out in (surface.wrenches(rows), surface.twist_directions(rows)):
        assert np.isfinite(out).all(axis=1).tolist() == [True, False, False]


def test_a_wrench_goes_back_to_its_twist(engine):
    rng = np.random.default_rng(1)
    surface = EllipsoidSurface(2.0, 0.08, (0.01, 0.02), 0.03)
    twists = surface.twist_directions(rng.normal(size=(5, 7, 3)) * (1.0, 1.0, 0.1))
    again = surface.twist_directions(surface.wrenches(twists))
    assert again.shape == (5, 7, 3)
    np.testing.assert_allclose(again, twists, atol=1e-12)


@pytest.mark.parametrize("samples", [BOX, PINS])
def test_exact_wrenches_of_twists(engine, samples):
    rng = np.random.default_rng(2)
    twists = rng.normal(size=(CASES, 3)) * (1.0, 1.0, 10.0)
    x, y = samples.points[0] - samples.cop
    twists[0] = (y, -x, 1.0)  # about the first sample
    twists[1:3] = [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    got = ExactSurface(samples, 0.3).wrenches(twists)
    np.testing.assert_allclose(got, exact_wrenches(samples, 0.3, twists), atol=1e-12)


def test_exact_wrenches_for_many_frictions(engine):
    friction = np.array([0.2, 0.4])[:, None]
    twists = np.random.default_rng(3).normal(size=(6, 3))
    got = ExactSurface(BOX, friction).wrenches(twists)
    assert got.shape == (2, 6, 3)
    np.testing.assert_allclose(got[1], 2.0 * got[0])


@cache
def slides_of(samples, cases):
    """Return random wrenches, and how the single form answers them."""
    wrenches = np.random.default_rng(4).normal(size=(cases, 3)) * (1.0, 1.0, 0.08)
    wrenches[:3] = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -2.0, 1e-9)]
    single = [exact_slide(samples, 0.3, Wrench(*w, samples.cop)) for w in wrenches]
    return wrenches, single


@pytest.mark.parametrize(("samples", "cases"), [(BOX, CASES // 4), (PINS, 200)])
def test_exact_twists_of_wrenches(engine, samples, cases):
    cases = cases if engine == "numba" else cases // 20
    wrenches, expected = slides_of(samples, cases)
    twists, levels = ExactSurface(samples, 0.3).slides(wrenches)
    np.testing.assert_allclose(levels, [level for _, level in expected], rtol=1e-10)
    if samples is BOX:
        np.testing.assert_allclose(twists, [t[:3] for t, _ in expected], atol=1e-7)
    # of pins any normal of an edge will do: what it takes to slide decides
    wrench = ExactSurface(samples, 0.3).wrenches(twists)
    power = (wrench * twists).sum(axis=1)
    given = (wrenches * twists).sum(axis=1)
    np.testing.assert_allclose(given / power, levels, rtol=1e-7)


def test_a_wrench_that_drives_a_twist_slides_with_it_at_level_one(engine):
    rng = np.random.default_rng(5)
    surface = ExactSurface(BOX, 0.3)
    cases = CASES if engine == "numba" else CASES // 20
    twists = rng.normal(size=(cases, 3)) * (1.0, 1.0, 15.0)
    found, levels = surface.slides(surface.wrenches(twists))
    np.testing.assert_allclose(levels, 1.0, rtol=1e-10)
    same = (found * twists).sum(1) / np.linalg.norm(found, axis=1)
    np.testing.assert_allclose(same, np.linalg.norm(twists, axis=1), rtol=1e-9)


@pytest.mark.parametrize("bad", [(0.0, 0.0, 0.0), (math.nan, 0.0, 0.0)])
def test_a_wrench_that_drives_nothing_is_named(engine, bad):
    with pytest.raises(ValueError, match=r"size of a wrench .* must be finite and > 0"):
        ExactSurface(BOX, 0.3).slides([(1.0, 0.0, 0.0), bad])


def test_a_pressure_without_extent_has_no_twists():
    point = PressureSamples(np.zeros((1, 2)), np.ones(1))
    with pytest.raises(ValueError, match=r"extent of the pressure 0.0 m; must be > 0"):
        ExactSurface(point, 0.3).slides((1.0, 0.0, 0.0))


def test_exact_axles(engine):
    rng = np.random.default_rng(6)
    levers = rng.uniform(-0.1, 0.1, (300, 2))
    angles = rng.uniform(-math.pi, math.pi, 300)
    angles[:4] = [0.0, math.pi, 1e-5, 0.5 * math.pi]
    got = exact_axle_distances(BOX, levers, angles)
    single = [
        exact_axle_distance(BOX, tuple(lever), angle)
        for lever, angle in zip(levers.tolist(), angles.tolist(), strict=True)
    ]
    np.testing.assert_allclose(got, single, rtol=1e-6, atol=1e-9)
