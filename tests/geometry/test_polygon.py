"""Polygons: areas, centroids and convexity."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.geometry.polygon import border_fault, centroid, signed_area

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
# in steps of 1e-6: a distance below the rounding of a sum has no sign
coordinates = st.integers(-3_000_000, 3_000_000).map(lambda n: 1e-6 * n)


def test_area_is_positive_counter_clockwise_and_negative_clockwise() -> None:
    assert signed_area(SQUARE) == 1.0
    assert signed_area(SQUARE[::-1]) == -1.0


@given(coordinates, coordinates)
def test_the_centroid_moves_with_the_polygon(x: float, y: float) -> None:
    moved = tuple((a + x, b + y) for a, b in SQUARE)
    assert centroid(moved) == pytest.approx((0.5 + x, 0.5 + y))


@given(
    st.integers(3, 40), st.floats(0.01, 3), st.floats(0, 6), st.sampled_from([1, -1])
)
def test_a_regular_polygon_has_no_fault_in_either_sense(
    n: int, radius: float, turn: float, sense: int
) -> None:
    angles = [turn + sense * 2 * math.pi * i / n for i in range(n)]
    assert (
        border_fault(
            tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles)
        )
        is None
    )
