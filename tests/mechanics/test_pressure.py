"""Load, centre of pressure and rho of pressure distributions (docs/mechanics.md, 1.1
and 1.2).
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pushpressslide.core.task import Box, Cylinder, Prism
from pushpressslide.core.wrench import Twist
from pushpressslide.geometry import quadrature
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import (
    PressureSamples,
    center_of_pressure,
    disc_pressure,
    pin_pressure,
    polygon_pressure,
    rectangle_pressure,
    support_pressure,
    total_load,
)
from pushpressslide.mechanics.rho import rho_fit, rho_pole, rho_straight

L = 0.6
W = 0.2
TRIANGLE = ((-0.1, -0.05), (0.2, -0.1), (0.0, 0.15))


@pytest.mark.parametrize(
    ("patch", "r0", "pole", "straight_x", "straight_y"),
    [
        (disc_pressure(0.2), 0.2, 2 / 3, 0.5, 0.5),
        (rectangle_pressure(0.3, 0.3), 0.3 / math.sqrt(2), 0.541, 0.408, 0.408),
        (rectangle_pressure(0.6, 0.2), math.sqrt(0.1), 0.521, 0.548, 0.183),
        (rectangle_pressure(0.6, 0.8), 0.5, 0.539, 0.346, 0.462),
    ],
)
def test_rho_of_uniform_patches_is_the_tabled_share_of_r0(
    patch, r0, pole, straight_x, straight_y
):
    assert rho_pole(patch) / r0 == pytest.approx(pole, abs=6e-4)
    assert rho_straight(patch) / r0 == pytest.approx(straight_x, abs=6e-4)
    assert rho_straight(patch, (0.0, 2.0)) / r0 == pytest.approx(straight_y, abs=6e-4)
    assert 0.945 < rho_fit(patch) / rho_pole(patch) < 0.975


@given(st.floats(0.05, 1.0), st.floats(0.05, 1.0))
@settings(max_examples=25, deadline=None)
def test_rho_of_a_rectangle_is_the_closed_form(length, width):
    a = 0.5 * length
    b = 0.5 * width
    d = math.hypot(a, b)
    closed = (
        d
        + a * a / (2 * b) * math.log((b + d) / a)
        + b * b / (2 * a) * math.log((a + d) / b)
    ) / 3
    patch = rectangle_pressure(length, width)
    assert rho_pole(patch) == pytest.approx(closed, rel=1e-3)
    assert rho_straight(patch) == pytest.approx(length / math.sqrt(12), rel=1e-9)


@given(st.floats(-0.28, 0.28))
@settings(max_examples=40, deadline=None)
def test_the_pressed_rectangle_has_the_variance_of_full_or_lifted_contact(x_c):
    patch = rectangle_pressure(L, W, 7.0, (x_c, 0.0))
    lifted = abs(x_c) > L / 6
    variance = (L / 2 - abs(x_c)) ** 2 / 2 if lifted else L**2 / 12 - x_c**2
    assert patch.cop == pytest.approx((x_c, 0.0), abs=1e-9)
    assert patch.total_load == pytest.approx(7.0)
    assert rho_straight(patch) ** 2 == pytest.approx(variance, rel=1e-6)
    assert rho_straight(patch, (0.0, 1.0)) ** 2 == pytest.approx(W**2 / 12, rel=1e-6)
    length_in_contact = 3 * (L / 2 - abs(x_c)) if lifted else L
    assert np.ptp(patch.points[:, 0]) <= length_in_contact + 1e-9


def test_the_operating_point_of_the_paper_has_the_rho_of_the_notes():
    r0 = math.sqrt(0.1)
    patch = rectangle_pressure(L, W, 10.943, (0.1462, 0.0))
    assert rho_straight(patch) / r0 == pytest.approx(0.344, abs=5e-4)
    assert rho_pole(patch) / r0 == pytest.approx(0.352, abs=5e-4)
    assert patch.points[:, 0].min() == pytest.approx(-0.16, abs=0.005)
    balanced = rho_straight(rectangle_pressure(L, W)) ** 2
    assert 1.0 - rho_straight(patch) ** 2 / balanced == pytest.approx(0.61, abs=5e-3)
    assert 1.0 - rho_straight(
        rectangle_pressure(L, W, 1.0, (L / 6, 0.0))
    ) ** 2 / balanced == pytest.approx(1 / 3, abs=1e-6)


@given(st.floats(0.02, 0.96), st.floats(0.02, 0.96))
@settings(max_examples=60, deadline=None)
def test_any_cop_inside_a_polygon_is_reached_by_pressure_that_only_pushes(s, t):
    assume(s + t < 0.98)
    a, b, c = (np.array(p) for p in TRIANGLE)
    cop = a + s * (b - a) + t * (c - a)
    patch = polygon_pressure(
        TRIANGLE, 2.0, (float(cop[0]), float(cop[1])), resolution=6
    )
    assert patch.cop == pytest.approx(tuple(cop), abs=1e-8)
    assert patch.total_load == pytest.approx(2.0)
    assert (patch.loads >= 0.0).all()


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_where_the_whole_base_is_pressed_the_closed_form_is_what_is_iterated_to(s, t):
    base = tuple(
        Prism(((-0.1, -0.1), (0.2, -0.05), (0.1, 0.1), (-0.05, 0.12)), 0.1).corners
    )
    cop = (0.04 * s + 0.03, 0.03 * t)
    found = quadrature.whole_pressure(base, cop)
    a, b = quadrature.linear_pressure(quadrature.as_polygon(base), np.array(cop))
    pressed = min(a + x * b[0] + y * b[1] for x, y in base)
    assume(abs(pressed) > 1e-9)
    assert (found is not None) == (pressed > 0.0)
    if found is not None:
        assert found[0] == pytest.approx(a, rel=1e-9)
        assert found[1] == pytest.approx(b, rel=1e-7, abs=1e-7)


@given(st.floats(0.0, 0.9), st.floats(0.0, 6.28))
@settings(max_examples=40, deadline=None)
def test_any_cop_inside_a_disc_is_reached(share, angle):
    cop = (0.1 * share * math.cos(angle), 0.1 * share * math.sin(angle))
    patch = disc_pressure(0.1, 3.0, cop, resolution=6)
    assert patch.cop == pytest.approx(cop, abs=1e-8)
    assert np.hypot(*patch.points.T).max() < 0.1005


def test_the_disc_with_a_lifted_side_goes_over_into_the_one_without():
    near = disc_pressure(0.1, 1.0, (0.02499, 0.0))
    beyond = disc_pressure(0.1, 1.0, (0.02501, 0.0))
    assert rho_straight(beyond) == pytest.approx(rho_straight(near), rel=3e-3)
    assert rho_pole(beyond) == pytest.approx(rho_pole(near), rel=3e-3)


@given(st.floats(0.0, 6.28), st.sampled_from([(0.0, 0.0), (0.05, 0.02), (0.146, 0.0)]))
@settings(max_examples=30, deadline=None)
def test_near_straight_motion_rho_squared_is_the_variance_along_it(angle, cop):
    patch = rectangle_pressure(L, W, 1.0, cop)
    u = (math.cos(angle), math.sin(angle))
    w = 1e-3
    wrench = exact_wrench(patch, 1.0, Twist(u[0], u[1], w, patch.cop))
    assert wrench.tau / w == pytest.approx(rho_straight(patch, u) ** 2, rel=2e-3)


def test_the_pole_is_the_torque_of_pure_rotation():
    patch = rectangle_pressure(L, W, 5.0, (0.03, 0.01))
    torque = exact_wrench(patch, 0.4, Twist(0.0, 0.0, 2.0, patch.cop)).tau
    assert torque == pytest.approx(0.4 * 5.0 * rho_pole(patch), rel=1e-9)


def test_a_shape_gives_its_pressure_about_the_centre_of_mass():
    box = support_pressure(Box((0.2, 0.1, 0.3)), 5.0, (0.02, -0.01), (0.0, 0.0))
    assert box.cop == pytest.approx((0.0, 0.0), abs=1e-10)
    corners = box.points.min(0), box.points.max(0)
    assert corners[0] == pytest.approx((-0.12, -0.04), abs=2e-3)
    assert corners[1] == pytest.approx((0.08, 0.06), abs=2e-3)
    can = support_pressure(Cylinder(0.05, 0.1), 2.0, cop=(0.005, 0.0))
    assert can.cop == pytest.approx((0.005, 0.0), abs=1e-10)
    mean = tuple(np.mean(TRIANGLE, axis=0))
    wedge = support_pressure(Prism(TRIANGLE, 0.1), 2.0, mean)
    assert wedge.cop == pytest.approx((0.0, 0.0), abs=1e-10)
    assert wedge.loads / wedge.radii**2 == pytest.approx(
        np.full(len(wedge.loads), 24.0 / 0.0325), rel=1e-6
    )


def test_the_centre_of_pressure_is_the_mean_of_where_the_loads_act():
    assert center_of_pressure(2.0, (0.3, -0.1)) == pytest.approx((0.3, -0.1))
    between = center_of_pressure(2.0, (0.3, -0.1), (6.0,), ((-0.1, 0.5),))
    assert between == pytest.approx((0.0, 0.35))


def test_presses_and_forces_at_a_height_move_the_centre_of_pressure():
    assert total_load(3.0, (8.0,)) == 11.0
    n_o = 2.943
    n_a = 8.0
    lever = 0.2
    pressed = center_of_pressure(n_o, (0.0, 0.0), (n_a,), ((lever, 0.0),))
    assert pressed == pytest.approx((0.1462, 0.0), abs=5e-5)
    pushed = center_of_pressure(
        n_o, (0.0, 0.0), (n_a,), ((lever, 0.0),), ((-3.0, 0.0),), (0.1,)
    )
    assert pushed[0] - pressed[0] == pytest.approx(-0.3 / 10.943)
    tall = center_of_pressure(10.0, (0.0, 0.0), forces=((3.0, 0.0),), heights=(0.7,))
    assert tall == pytest.approx((0.21, 0.0))


@given(
    st.floats(0.5, 10.0),
    st.floats(0.5, 10.0),
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
)
def test_two_presses_put_the_centre_of_pressure_into_the_triangle(n_l, n_r, x, y):
    p_l = (x, 0.2)
    p_r = (y, -0.2)
    cop = center_of_pressure(3.0, (0.0, 0.0), (n_l, n_r), (p_l, p_r))
    shares = (
        pin_pressure(((0.0, 0.0), p_l, p_r), cop, 3.0 + n_l + n_r)
        if abs(x + y) > 1e-3
        else None
    )
    if shares is not None:
        assert shares.loads == pytest.approx([3.0, n_l, n_r], rel=1e-6)


def test_samples_are_checked_and_cannot_be_changed():
    pins = PressureSamples([[0.0, 0.0], [1.0, 0.0]], [1.0, 3.0])
    assert pins.cop == (0.75, 0.0)
    assert pins.scaled_to(8.0).loads.tolist() == [2.0, 6.0]
    assert pins.translated((1.0, 2.0)).cop == (1.75, 2.0)
    with pytest.raises(ValueError, match="read-only"):
        pins.loads[0] = 2.0
    with pytest.raises(ValueError, match="need"):
        PressureSamples([[0.0, 0.0]], [1.0, 2.0])
    for loads in ([-1.0, 2.0], [0.0, 0.0], [math.nan, 1.0]):
        with pytest.raises(ValueError, match="loads >= 0"):
            PressureSamples([[0.0, 0.0], [1.0, 0.0]], loads)
    for points, radii in (
        ([[0.0, 0.0], [1.0, math.nan]], [0.1, 0.1]),
        ([[0.0, 0.0], [1.0, 0.0]], [0.1, math.inf]),
    ):
        with pytest.raises(ValueError, match="must be finite"):
            PressureSamples(points, [1.0, 1.0], radii)


def test_a_centre_of_pressure_outside_the_base_is_refused():
    with pytest.raises(ValueError, match="inside the outline"):
        rectangle_pressure(L, W, 1.0, (0.31, 0.0))
    with pytest.raises(ValueError, match="inside the outline"):
        disc_pressure(0.1, 1.0, (0.11, 0.0))
    with pytest.raises(ValueError, match="outside the triangle"):
        pin_pressure(TRIANGLE, (0.5, 0.5))
    with pytest.raises(ValueError, match="one line"):
        pin_pressure(((0.0, 0.0), (1.0, 0.0), (2.0, 0.0)), (0.5, 0.0))
    with pytest.raises(ValueError, match="exactly 3"):
        pin_pressure(((0.0, 0.0), (1.0, 0.0)), (0.5, 0.0))
    with pytest.raises(ValueError, match="counter-clockwise"):
        polygon_pressure(TRIANGLE[::-1])
    with pytest.raises(ValueError, match="at least 3"):
        polygon_pressure(TRIANGLE[:2])
    with pytest.raises(ValueError, match="radius"):
        disc_pressure(0.0)
    with pytest.raises(ValueError, match="total load"):
        center_of_pressure(0.0, (0.0, 0.0))
    with pytest.raises(ValueError, match="one point per normal"):
        center_of_pressure(1.0, (0.0, 0.0), (1.0,))
    with pytest.raises(ValueError, match="direction"):
        rho_straight(disc_pressure(0.1), (0.0, 0.0))
    with pytest.raises(ValueError, match="no extent"):
        rho_fit(PressureSamples([[0.0, 0.0]], [1.0]))
