"""The mechanics of concave objects against dense sums that know no polygon code."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import ObjectModel
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.geometry.shapes import Box, Compound, Part, Prism, Shape
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.limit_surface import exact_twist_direction, exact_wrench
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight
from pushpressslide.mechanics.top import inside_top, room_inside, top_places

L_SHAPE = Prism(
    ((0.0, 0.0), (0.16, 0.0), (0.16, 0.06), (0.06, 0.06), (0.06, 0.16), (0.0, 0.16)),
    0.06,
)
T_SHAPE = Compound(
    (
        Part(Box((0.12, 0.03, 0.04)), Pose2(0.0, 0.06)),
        Part(Box((0.03, 0.09, 0.04)), Pose2()),
    )
)
U_SHAPE = Prism(
    (
        (-0.1, -0.05),
        (0.1, -0.05),
        (0.1, 0.1),
        (0.07, 0.1),
        (0.07, -0.02),
        (-0.07, -0.02),
        (-0.07, 0.1),
        (-0.1, 0.1),
    ),
    0.06,
)
SHAPES = [L_SHAPE, T_SHAPE, U_SHAPE]
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=["L", "T", "U"])
CELL = 0.001  # [m] of the dense sums
shares = st.floats(0.0, 0.9)
angles = st.floats(0.0, 2.0 * math.pi)


def body(shape: Shape) -> ObjectModel:
    return ObjectModel(shape, 1.0, shape.centroid)


def dense(shape: Shape) -> np.ndarray:
    """Return the middles (n, 2) in B of the cells whose middle is on the base."""
    area = shape.placed(Pose2())
    x_min, y_min, x_max, y_max = area.bounds
    xs = np.arange(x_min + 0.5 * CELL, x_max, CELL)
    ys = np.arange(y_min + 0.5 * CELL, y_max, CELL)
    x, y = (values.ravel() for values in np.meshgrid(xs, ys))
    on = shapely.contains_xy(area, x, y)
    return np.stack([x[on], y[on]], axis=1) - np.array(shape.centroid)


def towards_hull(shape: Shape, share: float, angle: float) -> tuple[float, float]:
    """Return a point in B at a share of the way from the CoM to the hull's outline."""
    u = (math.cos(angle), math.sin(angle))
    ((_, far),) = shape.hull.chords(u, 0.0, shape.centroid)
    return (share * far * u[0], share * far * u[1])


@every_shape
def test_a_uniform_pressure_has_the_moments_of_a_dense_sum(shape: Shape) -> None:
    points = dense(shape)
    samples = support_pressure(shape, 1.0, shape.centroid, (0.0, 0.0), 6)
    assert samples.cop == pytest.approx((0.0, 0.0), abs=1e-9)
    assert points.mean(axis=0) == pytest.approx(0.0, abs=1e-9)
    second = samples.points.T @ (samples.loads[:, None] * samples.points)
    assert second == pytest.approx(points.T @ points / len(points), rel=1e-3, abs=1e-9)
    area = sum(shape.base_rule(3)[1])
    assert area == pytest.approx(len(points) * CELL**2, rel=1e-6)


@every_shape
@given(shares, angles)
def test_the_pressure_has_its_centre_anywhere_in_the_hull_and_loads_the_base_alone(
    shape: Shape, share: float, angle: float
) -> None:
    cop = towards_hull(shape, share, angle)
    samples = support_pressure(shape, 2.0, shape.centroid, cop, 6)
    assert samples.total_load == pytest.approx(2.0)
    assert samples.cop == pytest.approx(cop, abs=1e-7)
    loaded = samples.points[samples.loads > 0.0] + np.array(shape.centroid)
    on = shape.placed(Pose2()).buffer(1e-9)
    assert shapely.contains_xy(on, loaded[:, 0], loaded[:, 1]).all()


@every_shape
@given(shares, angles)
def test_the_pressure_is_linear_where_there_is_any(
    shape: Shape, share: float, angle: float
) -> None:
    """It agrees with a dense sum over cells under max(0, a + b . r)."""
    cop = towards_hull(shape, share, angle)
    points, areas, pressures = shape.pressure(
        (cop[0] + shape.centroid[0], cop[1] + shape.centroid[1]), 6
    )
    x, y = (points - np.array(shape.centroid)).T
    system = np.column_stack([np.ones_like(x), x, y])
    (a, bx, by), *_ = np.linalg.lstsq(system, pressures, rcond=None)
    assert system @ (a, bx, by) == pytest.approx(pressures, abs=1e-6 * pressures.max())
    cells = dense(shape)
    loads = np.maximum(a + cells @ np.array([bx, by]), 0.0)
    assert loads @ cells / loads.sum() == pytest.approx(cop, abs=1e-3)
    total = loads.sum() * CELL**2
    assert total == pytest.approx(areas @ np.maximum(pressures, 0.0), rel=0.03)


@every_shape
def test_no_pressure_has_its_centre_outside_the_hull(shape: Shape) -> None:
    outside = towards_hull(shape, 1.05, 0.3)
    with pytest.raises(ValueError, match="centre of pressure"):
        support_pressure(shape, 1.0, shape.centroid, outside)


@every_shape
@pytest.mark.parametrize(
    "twist", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.05, 0.02, 1.0)]
)
def test_the_limit_surface_is_that_of_a_dense_sum(
    shape: Shape, twist: tuple[float, float, float]
) -> None:
    samples = support_pressure(shape, 10.0, shape.centroid, (0.0, 0.0), 6)
    points = dense(shape)
    cells = PressureSamples(points, np.full(len(points), 10.0 / len(points)))
    exact = exact_wrench(cells, 0.3, Twist(*twist))
    found = exact_wrench(samples, 0.3, Twist(*twist))
    rho = rho_pole(cells)
    off = (found.fx - exact.fx, found.fy - exact.fy, (found.tau - exact.tau) / rho)
    assert math.hypot(*off) < 2e-3 * 0.3 * 10.0
    assert rho_pole(samples) == pytest.approx(rho, rel=2e-3)


@every_shape
@pytest.mark.parametrize("angle", [0.0, 0.4, 1.3, 2.5])
def test_the_virtual_axle_is_that_of_a_dense_sum(shape: Shape, angle: float) -> None:
    """Without height; a press at a place on the top, dragged at some angles."""
    contact = top_places(body(shape), 0.01)[0]
    press = Press(body(shape), 0.3, contact, 0.3 * GRAVITY)
    axle = press.axle(angle, 0.0)
    x, y, pressures = _pressed_cells(shape, press.cop)
    cells = PressureSamples(np.stack([x, y], axis=1), pressures)
    ex, ey = press.axis
    if angle == 0.0:
        distance = rho_straight(cells, press.axis) ** 2 / press.lever
    else:
        fx, fy = press.along(angle)
        lever = (contact[0] - cells.cop[0], contact[1] - cells.cop[1])
        moment = lever[0] * fy - lever[1] * fx
        twist = exact_twist_direction(cells, Wrench(fx, fy, moment, cells.cop))
        distance = (twist.vy * ex - twist.vx * ey) / twist.w
    from_com = press.cop[0] * ex + press.cop[1] * ey
    assert axle == pytest.approx(from_com - distance, abs=1e-3)


def _pressed_cells(shape: Shape, cop: tuple[float, float]):
    """Return places and loads of cells under the linear pressure with a centre."""
    points, _, pressures = shape.pressure(
        (cop[0] + shape.centroid[0], cop[1] + shape.centroid[1]), 6
    )
    local = points - np.array(shape.centroid)
    system = np.column_stack([np.ones(len(local)), local])
    (a, bx, by), *_ = np.linalg.lstsq(system, pressures, rcond=None)
    cells = dense(shape)
    loads = np.maximum(a + cells @ np.array([bx, by]), 0.0)
    return *cells.T, loads


@every_shape
@pytest.mark.parametrize("angle", [0.3, 1.2, 2.2, 4.0])
def test_a_drag_that_is_planned_with_is_the_exact_one(
    shape: Shape, angle: float
) -> None:
    """The coarse base of planning, with the height of the drag."""
    object_model = body(shape)
    contact = top_places(object_model, 0.01)[3]
    press = Press(object_model, 0.3, contact, 0.3 * GRAVITY)
    exact = press.twist(angle)
    base = DraggedBase(object_model, press.shift)
    slid = base.slide(
        np.array([press.cop]), np.array([contact]), np.array([press.along(angle)])
    )
    vx, vy, w = slid.twists[0]
    size = shape.circumradius
    a = np.array([exact.vx, exact.vy, size * exact.w])
    b = np.array([vx, vy, size * w])
    cosine = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
    assert math.acos(min(1.0, cosine)) < math.radians(2.0)


def test_presses_are_on_the_true_top_and_tipping_is_by_the_hull() -> None:
    for shape in SHAPES:
        object_model = body(shape)
        margin = 0.01
        places = top_places(object_model, margin)
        assert len(places) >= 12
        area = shape.placed(Pose2()).buffer(-margin + 1e-6)
        for x, y in places:
            assert inside_top(object_model, (x, y), margin - 1e-6)
            point = (x + shape.centroid[0], y + shape.centroid[1])
            assert area.contains(shapely.Point(point))
    # the middle of the U is no place to press, but a load may have its centre there
    middle = (0.0 - U_SHAPE.centroid[0], 0.05 - U_SHAPE.centroid[1])
    assert not inside_top(body(U_SHAPE), middle, 0.0)
    assert room_inside(body(U_SHAPE), middle) > 0.5
