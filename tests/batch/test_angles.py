"""The arithmetic of angles gives what NumPy's functions give."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.batch.angles import quick_arctan2, quick_cos, quick_sin

numbers = st.floats(-1e100, 1e100)


@given(numbers, numbers)
def test_arctan2(y, x):
    with np.errstate(all="ignore"):
        got = quick_arctan2(np.float64(y), np.float64(x))
    exact = math.atan2(y, x)
    # a zero has no sign here
    assert abs(math.remainder(got - exact, 2.0 * math.pi)) < 1e-15 or x == y == 0.0


def test_arctan2_on_the_axes_and_beyond():
    y = np.array([0.0, 1.0, 0.0, -1.0, 0.0, math.inf, -1.0, math.nan, 1.0])
    x = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 1.0, -math.inf, 1.0, math.nan])
    with np.errstate(all="ignore"):
        got = quick_arctan2(y, x)
    np.testing.assert_allclose(got, np.arctan2(y, x), atol=1e-15)


@given(st.floats(-1e6, 1e6))
def test_sine_and_cosine(angle):
    assert abs(quick_sin(np.float64(angle)) - math.sin(angle)) < 1e-15
    assert abs(quick_cos(np.float64(angle)) - math.cos(angle)) < 1e-15
