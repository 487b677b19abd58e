"""Laws that every shape keeps, and that a disc is the limit of polygons."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.shapes import Box, Cylinder, Prism, Shape

TRIANGLE = Prism(((-0.05, -0.04), (0.12, -0.02), (0.01, 0.11)), 0.1)
CENTERED = ((0.1 * math.cos(i), 0.1 * math.sin(i)) for i in range(6))
SHAPES: list[Shape] = [
    Box((0.3, 0.2, 0.1)),
    TRIANGLE,
    Prism(tuple(CENTERED), 0.05),
    Cylinder(0.1, 0.2),
]
ORIGIN = (0.01, -0.005)  # in G, of B
CORNERS = 720
NEAR_DISC = Prism(
    tuple(
        (
            0.1 * math.cos(2.0 * math.pi * i / CORNERS),
            0.1 * math.sin(2.0 * math.pi * i / CORNERS),
        )
        for i in range(CORNERS)
    ),
    0.2,
)
DISC = Cylinder(0.1, 0.2)

every_shape = pytest.mark.parametrize(
    "shape", SHAPES, ids=["box", "triangle", "hexagon", "cylinder"]
)
angles = st.floats(0.0, 2.0 * math.pi)
places = st.floats(-0.2, 0.2)


def unit(angle: float) -> tuple[float, float]:
    return (math.cos(angle), math.sin(angle))


def in_g(point: tuple[float, float]) -> tuple[float, float]:
    return (point[0] + ORIGIN[0], point[1] + ORIGIN[1])


@every_shape
@given(places, places)
def test_depth_is_the_largest_margin_that_is_held(
    shape: Shape, x: float, y: float
) -> None:
    depth = shape.depth(in_g((x, y)))
    assert shape.holds((x, y), depth - 1e-9, ORIGIN)
    assert not shape.holds((x, y), depth + 1e-9, ORIGIN)


@every_shape
@given(places, places)
def test_a_point_is_inside_or_at_a_distance(shape: Shape, x: float, y: float) -> None:
    depth = shape.depth((x, y))
    distance = shape.distance((x, y))
    assert distance == 0.0 or depth < 0.0
    assert distance > 0.0 or depth > -1e-12  # on the outline rounding decides
    assert distance >= -depth - 1e-12


@every_shape
@given(angles)
def test_a_ray_ends_at_the_margin(shape: Shape, angle: float) -> None:
    ux, uy = unit(angle)
    ((near, far),) = shape.chords((ux, uy), 0.01, ORIGIN)
    assert near == 0.0
    assert shape.depth(in_g((far * ux, far * uy))) == pytest.approx(0.01, abs=1e-9)


@every_shape
@given(angles)
def test_no_point_of_the_outline_is_beyond_the_extent(
    shape: Shape, angle: float
) -> None:
    ux, uy = unit(angle)
    outline = [(x - ORIGIN[0], y - ORIGIN[1]) for x, y in shape.outline()]
    extent = shape.extent((ux, uy), ORIGIN)
    assert max(x * ux + y * uy for x, y in outline) <= extent + 1e-12
    assert extent <= shape.farthest(ORIGIN) + 1e-12
    back = shape.extent((-ux, -uy), ORIGIN)
    assert extent + back >= 2.0 * shape.half_width - 1e-12


@every_shape
@given(places, places, st.floats(0.1, 10.0))
def test_the_gauge_grows_in_proportion_and_is_one_on_the_outline(
    shape: Shape, x: float, y: float, k: float
) -> None:
    gauge = shape.gauge()
    assert gauge(k * x, k * y) == pytest.approx(k * gauge(x, y), abs=1e-12)
    mx, my = shape.middle
    for px, py in shape.outline():
        assert gauge(px - mx, py - my) == pytest.approx(1.0)


@every_shape
def test_the_middle_is_between_inner_and_outer_radius(shape: Shape) -> None:
    assert shape.depth(shape.middle) == pytest.approx(shape.inner_radius)
    radii = [math.dist(shape.middle, point) for point in shape.outline()]
    assert max(radii) == pytest.approx(shape.circumradius)
    assert min(radii) >= shape.inner_radius - 1e-12


@every_shape
@given(places, places, angles)
def test_bounds_are_those_of_the_placed_footprint(
    shape: Shape, x: float, y: float, yaw: float
) -> None:
    X_WG = Pose2(x, y, yaw)
    x_min, y_min, x_max, y_max = shape.placed(X_WG).bounds
    assert shape.bounds(X_WG) == pytest.approx((x_min, x_max, y_min, y_max), abs=1e-4)


@every_shape
def test_half_widths_are_zero_on_the_outline_and_fall_outwards(shape: Shape) -> None:
    points = np.array(shape.outline()) - np.array(ORIGIN)
    assert shape.depths(points, ORIGIN) == pytest.approx(0.0, abs=1e-9)
    assert (shape.depths(1.1 * points, ORIGIN) < 0.0).all()
    assert (shape.depths(0.9 * points, ORIGIN) > 0.0).all()


@every_shape
def test_side_places_are_on_the_outline_with_inward_normals(shape: Shape) -> None:
    sides = shape.side_places(0.02, 0.02, ORIGIN)
    assert len(sides) >= 3
    for place in sides:
        x, y = place.point
        nx, ny = place.normal
        assert math.hypot(nx, ny) == pytest.approx(1.0)
        assert shape.depth(in_g((x, y))) == pytest.approx(0.0, abs=1e-9)
        inside = in_g((x + 0.002 * nx, y + 0.002 * ny))
        assert shape.depth(inside) == pytest.approx(0.002)


@every_shape
@given(st.floats(-0.0005, 0.05), st.floats(-0.01, 0.01))
def test_a_tip_before_a_side_is_as_far_off_it_as_its_gap_says(
    shape: Shape, gap: float, along: float
) -> None:
    radius = 0.02
    sides = shape.side_places(0.02, 0.02, ORIGIN)
    assert len(sides) >= 3
    for place in sides:
        point = place.point
        nx, ny = place.normal
        side = shape.side(point, (nx, ny), ORIGIN)
        off = radius + gap
        tip = (
            point[0] - off * nx - along * ny,
            point[1] - off * ny + along * nx,
        )
        seen, normal = side.gap(tip, radius)
        foot = side.foot(tip)
        assert seen == pytest.approx(math.dist(tip, foot) - radius, abs=1e-9)
        assert shape.depth(in_g(foot)) == pytest.approx(0.0, abs=1e-9)
        assert side.foot(foot) == pytest.approx(foot, abs=1e-12)
        assert side.normal_at(foot) == pytest.approx(normal)


def test_a_tip_beside_a_flat_side_touches_nothing() -> None:
    box = Box((0.2, 0.2, 0.1))
    side = box.side((-0.1, 0.0), (1.0, 0.0), (0.0, 0.0))
    assert side.gap((-0.12, 0.099), 0.01)[0] == pytest.approx(0.01)
    assert side.gap((-0.12, 0.101), 0.01)[0] == math.inf


@pytest.mark.parametrize("shape", [Box((0.2, 0.2, 0.1)), Cylinder(0.1, 0.1)])
def test_places_along_a_side_are_lengths_to_the_left_of_the_normal(
    shape: Shape,
) -> None:
    side = shape.side((-0.1, 0.0), (1.0, 0.0), (0.0, 0.0))
    x = np.array([-0.1, -0.1, -0.1])
    y = np.array([0.0, 0.001, -0.002])
    assert side.coordinates(x, y) == pytest.approx([0.0, 0.001, -0.002], abs=1e-6)


@every_shape
def test_the_base_rule_has_the_area_and_the_centroid(shape: Shape) -> None:
    points, areas = shape.base_rule(6)
    assert areas.sum() == pytest.approx(shape.placed(Pose2()).area, rel=1e-3)
    assert areas @ points / areas.sum() == pytest.approx(shape.centroid, abs=1e-9)


@every_shape
@pytest.mark.parametrize("share", [0.0, 0.2, 0.6])
def test_the_pressure_has_the_centre_that_was_asked(shape: Shape, share: float) -> None:
    cx, cy = shape.centroid
    cop = (cx + share * shape.inner_radius, cy)
    points, areas, pressures = shape.pressure(cop, 8)
    loads = areas * np.maximum(pressures, 0.0)
    assert loads @ points / loads.sum() == pytest.approx(cop, abs=1e-4)


@given(places, places, angles)
def test_a_disc_answers_as_a_polygon_of_many_corners(
    x: float, y: float, angle: float
) -> None:
    u = unit(angle)
    near = pytest.approx
    assert DISC.distance((x, y)) == near(NEAR_DISC.distance((x, y)), abs=1e-5)
    assert DISC.extent(u, ORIGIN) == near(NEAR_DISC.extent(u, ORIGIN), abs=1e-5)
    (chord,) = NEAR_DISC.chords(u, 0.01, ORIGIN)
    assert DISC.chords(u, 0.01, ORIGIN) == (near(chord, abs=1e-4),)
    assert DISC.gauge()(x, y) == near(NEAR_DISC.gauge()(x, y), abs=1e-4)


def test_a_disc_has_the_measures_of_a_polygon_of_many_corners() -> None:
    near = pytest.approx
    assert DISC.farthest(ORIGIN) == near(NEAR_DISC.farthest(ORIGIN), abs=1e-6)
    assert DISC.half_width == near(NEAR_DISC.half_width, abs=1e-5)
    assert DISC.inner_radius == near(NEAR_DISC.inner_radius, abs=1e-5)
    assert DISC.circumradius == near(NEAR_DISC.circumradius)
    assert DISC.centroid == near(NEAR_DISC.centroid, abs=1e-12)


def test_a_round_footprint_has_no_corners_and_the_others_have() -> None:
    assert [len(shape.corners) for shape in SHAPES] == [4, 3, 6, 0]


def test_a_shape_is_described_in_millimetres() -> None:
    assert Box((0.3, 0.2, 0.1)).description == "box 300 × 200 × 100 mm"
    assert TRIANGLE.description == "prism on 3 corners, height 100 mm"
    assert DISC.description == "cylinder, radius 100 mm, height 200 mm"
