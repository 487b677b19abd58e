"""Footprints: areas, centroids, convexity, depths and overlaps."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.footprint import (
    centroid,
    convexity_fault,
    depth_inside,
    distance_outside,
    overlap_area,
    signed_area,
)
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, Prism

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
        convexity_fault(
            tuple((radius * math.cos(a), radius * math.sin(a)) for a in angles)
        )
        is None
    )


@given(coordinates, coordinates)
def test_a_point_is_inside_or_at_a_distance(x: float, y: float) -> None:
    for shape in (Box((1.0, 1.0, 1.0)), Cylinder(0.5, 1.0), Prism(SQUARE, 1.0)):
        assert (distance_outside(shape, (x, y)) > 0.0) == (
            depth_inside(shape, (x, y)) < 0.0
        )


def test_the_distance_to_a_corner_is_straight() -> None:
    assert distance_outside(Box((2.0, 2.0, 1.0)), (4.0, 5.0)) == pytest.approx(5.0)


def test_a_turned_square_overlaps_a_disc_by_the_disc() -> None:
    area = overlap_area(
        Box((1.0, 1.0, 1.0)), Pose2(1.0, 2.0, 0.7), Cylinder(0.2, 1.0), Pose2(1.1, 2.0)
    )
    assert area == pytest.approx(math.pi * 0.04, rel=1e-3)


def test_bodies_apart_do_not_overlap() -> None:
    assert (
        overlap_area(
            Box((1.0, 1.0, 1.0)), Pose2(), Box((1.0, 1.0, 1.0)), Pose2(1.0, 0.0)
        )
        < 1e-12
    )
