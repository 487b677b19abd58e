"""Quadrature over footprints, and the linear unilateral pressure on them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.geometry import quadrature

TRIANGLE = quadrature.as_polygon(((0.0, 0.0), (0.3, 0.0), (0.1, 0.25)))
SQUARE = quadrature.as_polygon(((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)))


@given(st.floats(0.05, 0.9), st.floats(0.05, 0.9))
def test_a_linear_pressure_has_its_load_and_its_centre(u: float, v: float) -> None:
    weights = np.array([u, v, 1.0]) / (u + v + 1.0)
    cop = weights @ TRIANGLE
    a, b = quadrature.linear_pressure(TRIANGLE, cop)
    area, first, second = quadrature.moments(quadrature.clipped(TRIANGLE, a, b))
    assert a * area + b @ first == pytest.approx(1.0)
    assert a * first + second @ b == pytest.approx(cop, abs=1e-9)


@pytest.mark.parametrize("cop", [(1.2, 0.0), (1.0, 0.0), (0.0, -3.0)])
def test_no_pressure_has_its_centre_outside(cop: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="inside the outline"):
        quadrature.linear_pressure(SQUARE, np.array(cop))


def test_clipping_at_a_line_through_the_middle_leaves_half() -> None:
    half = quadrature.clipped(SQUARE, 0.0, np.array([1.0, 0.3]))
    assert quadrature.moments(half)[0] == pytest.approx(2.0)
    assert len(quadrature.clipped(SQUARE, -2.0, np.array([1.0, 0.0]))) == 0


@given(st.integers(0, 4), st.integers(0, 4))
def test_the_rule_over_a_polygon_is_exact_to_degree_four(i: int, j: int) -> None:
    points, areas = quadrature.polygon_rule(SQUARE, 1)
    if i + j > 4:
        return
    exact = (
        0.0 if i % 2 or j % 2 else (2.0 / (i + 1)) * (2.0 / (j + 1))
    )  # of x^i y^j over the square
    assert areas @ (points[:, 0] ** i * points[:, 1] ** j) == pytest.approx(
        exact, abs=1e-12
    )


def test_the_rule_over_a_disc_has_its_area_and_its_second_moment() -> None:
    points, areas = quadrature.disc_rule(0.2, 3)
    assert areas.sum() == pytest.approx(math.pi * 0.04)
    assert areas @ points[:, 0] ** 2 == pytest.approx(math.pi * 0.2**4 / 4.0)


def test_a_disc_lifts_off_where_its_centre_of_pressure_leaves_the_core() -> None:
    for radius_share, lifts in ((0.24, False), (0.3, True)):
        _, _, pressures = quadrature.disc_pressure(1.0, (radius_share, 0.0), 6)
        points, _, _ = quadrature.disc_pressure(1.0, (radius_share, 0.0), 6)
        assert (points[:, 0].min() > -0.9) == lifts
        assert (pressures >= -1e-12).all()
