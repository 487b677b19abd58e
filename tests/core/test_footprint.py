"""Footprints: depths, distances and overlaps."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.footprint import gaps, overlap_area
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Cylinder, Prism

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
# in steps of 1e-6: a distance below the rounding of a sum has no sign
coordinates = st.integers(-3_000_000, 3_000_000).map(lambda n: 1e-6 * n)


@given(coordinates, coordinates)
def test_a_point_is_inside_or_at_a_distance(x: float, y: float) -> None:
    for shape in (Box((1.0, 1.0, 1.0)), Cylinder(0.5, 1.0), Prism(SQUARE, 1.0)):
        assert (shape.distance((x, y)) > 0.0) == (shape.depth((x, y)) < 0.0)


def test_the_distance_to_a_corner_is_straight() -> None:
    assert Box((2.0, 2.0, 1.0)).distance((4.0, 5.0)) == pytest.approx(5.0)


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


def test_what_stands_in_a_notch_does_not_overlap() -> None:
    corners = ((0.0, 0.0), (0.2, 0.0), (0.2, 0.1), (0.1, 0.1), (0.1, 0.2), (0.0, 0.2))
    hook = Prism(corners, 0.1)
    X_WG = Pose2(0.3, -0.1, 0.7)
    post = Box((0.04, 0.04, 0.1))
    in_notch = X_WG.compose(Pose2(0.13, 0.13))
    assert overlap_area(hook, X_WG, post, in_notch) == 0.0
    assert gaps(hook, [X_WG], [post.placed(in_notch)])[0, 0] == pytest.approx(0.01)
    deeper = X_WG.compose(Pose2(0.11, 0.13))
    assert overlap_area(hook, X_WG, post, deeper) == pytest.approx(0.01 * 0.04)
