"""Compiled sines, arctangents and the like agree with those of ``math``."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.batch.rows import answers, columns_of, spread
from pushpressslide.kernels import elementary
from pushpressslide.kernels.kernel import COMPILED

ALL = [
    elementary.arctangent2,
    elementary.arctangent,
    elementary.arccosine,
    elementary.sine,
    elementary.cosine,
    elementary.tangent,
    elementary.hypotenuse,
    elementary.turn_part,
    elementary.rounded_down,
    elementary.square,
]
TWO = (elementary.arctangent2, elementary.hypotenuse)
numbers = st.floats(-1e100, 1e100)
angles = st.floats(-1e6, 1e6)


def quick(function, *arguments):
    """What compiled code runs, of NumPy's numbers, which divide by zero."""
    with np.errstate(all="ignore"):
        return COMPILED[function](*map(np.float64, arguments))


@given(numbers, numbers)
def test_arctangent2(y, x):
    off = quick(elementary.arctangent2, y, x) - math.atan2(y, x)
    # a zero has no sign here
    assert abs(math.remainder(off, 2.0 * math.pi)) < 1e-15 or x == y == 0.0


@pytest.mark.parametrize(
    ("y", "x"),
    [(0, 1), (1, 0), (0, -1), (-1, 0), (0, 0), (math.inf, 1), (-1, -math.inf)],
)
def test_arctangent2_on_the_axes_and_far_away(y, x):
    found = quick(elementary.arctangent2, y, x)
    assert found == pytest.approx(math.atan2(y, x), abs=1e-15)


@given(angles)
def test_sine_cosine_and_tangent(angle):
    assert abs(quick(elementary.sine, angle) - math.sin(angle)) < 1e-15
    assert abs(quick(elementary.cosine, angle) - math.cos(angle)) < 1e-15
    exact = math.tan(angle)
    error = abs(quick(elementary.tangent, angle) - exact)
    assert error < 2e-15 * (1.0 + exact * exact)


@given(st.floats(-1.0, 1.0))
def test_arccosine(cosine):
    assert abs(quick(elementary.arccosine, cosine) - math.acos(cosine)) < 1e-15


@given(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300))
def test_hypotenuse(x, y):
    found = quick(elementary.hypotenuse, x, y)
    assert found == pytest.approx(math.hypot(x, y), rel=1e-15)


@given(angles)
def test_turn_part_to_the_rounding_of_the_angle(angle):
    off = quick(elementary.turn_part, angle) - elementary.turn_part(angle)
    assert abs(math.remainder(off, 2.0 * math.pi)) < 1e-15 * (10.0 + abs(angle))


@pytest.mark.parametrize("function", ALL, ids=lambda function: function.__name__)
def test_a_compiled_loop_runs_them(engine, function):
    rows = np.random.default_rng(0).uniform(-0.99, 0.99, (300, 2))
    if function in TWO:
        found = answers(function, spread(rows), columns=1)
        wanted = [function(*row) for row in rows.tolist()]
    else:
        found = answers(function, columns_of(rows[:, 0]), columns=1)
        wanted = [function(number) for number in rows[:, 0].tolist()]
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-14, atol=2e-15)
