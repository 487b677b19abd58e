"""Laws of the limit surface: the ellipsoid, and the exact surface by quadrature
(docs/mechanics.md, 1).
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_level,
    exact_twist_direction,
    exact_wrench,
    exact_wrenches,
)
from pushpressslide.mechanics.pressure import (
    PressureSamples,
    disc_pressure,
    pin_pressure,
    rectangle_pressure,
)
from pushpressslide.mechanics.rho import rho_fit, rho_pole

component = st.floats(-1.0, 1.0)
points = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
surfaces = st.builds(
    EllipsoidLimitSurface, st.floats(0.1, 50.0), st.floats(0.02, 0.3), points
)
unit_twists = st.tuples(component, component, component).filter(
    lambda t: math.hypot(*t) > 0.05
)
PATCHES = {
    "square": rectangle_pressure(0.15, 0.15, 9.0),
    "long": rectangle_pressure(0.6, 0.2, 3.0),
    "pressed": rectangle_pressure(0.6, 0.2, 10.9, (0.1462, 0.0)),
    "disc": disc_pressure(0.1),
}


def on_the_sphere(n: int, rho: float) -> np.ndarray:
    generator = np.random.default_rng(3)
    nu = generator.normal(size=(n, 3))
    nu /= np.linalg.norm(nu, axis=1)[:, None]
    return nu / [1.0, 1.0, rho]


@given(surfaces, unit_twists, points)
def test_the_wrench_of_a_twist_lies_on_the_surface_and_gives_that_twist_back(
    surface, nu, of
):
    twist = Twist(nu[0], nu[1], nu[2] / surface.rho, of)
    wrench = surface.wrench(twist)
    back = surface.twist_direction(wrench).moved_to(of)
    scale = math.hypot(back.vx, back.vy, back.w) / math.hypot(
        twist.vx, twist.vy, twist.w
    )
    assert surface.level(wrench) == pytest.approx(1.0, abs=1e-12)
    assert (back.vx, back.vy, back.w) == pytest.approx(
        (scale * twist.vx, scale * twist.vy, scale * twist.w),
        abs=1e-9 * (1.0 + scale * abs(twist.w)),
    )


@given(surfaces, unit_twists, points)
def test_level_and_twist_do_not_depend_on_the_point_of_the_moment(surface, nu, point):
    wrench = Wrench(nu[0], nu[1], nu[2] * surface.rho, surface.center)
    moved = wrench.moved_to(point)
    assert surface.level(moved) == pytest.approx(surface.level(wrench), rel=1e-9)
    a = surface.twist_direction(moved)
    b = surface.twist_direction(wrench)
    assert (a.vx, a.vy, a.w) == pytest.approx(
        (b.vx, b.vy, b.w), rel=1e-7, abs=1e-9 / surface.rho
    )


@given(surfaces, unit_twists)
def test_the_twist_is_normal_to_the_ellipsoid(surface, nu):
    wrench = Wrench(
        nu[0] * surface.max_force,
        nu[1] * surface.max_force,
        nu[2] * surface.max_force * surface.rho,
    )
    wrench = Wrench(wrench.fx, wrench.fy, wrench.tau, surface.center)
    steps = (
        surface.max_force * 1e-5,
        surface.max_force * 1e-5,
        surface.max_force * surface.rho * 1e-5,
    )
    gradient = []
    for i, h in enumerate(steps):
        ahead = [wrench.fx, wrench.fy, wrench.tau]
        behind = [wrench.fx, wrench.fy, wrench.tau]
        ahead[i] += h
        behind[i] -= h
        rise = surface.level(Wrench(*ahead, surface.center)) - surface.level(
            Wrench(*behind, surface.center)
        )
        gradient.append(rise / (2.0 * h))
    twist = surface.twist_direction(wrench)
    scale = math.hypot(gradient[0], gradient[1], gradient[2] * surface.rho)
    scaled = [g / scale for g in gradient]
    assert scaled[:2] == pytest.approx([twist.vx, twist.vy], abs=1e-6)
    assert scaled[2] * surface.rho == pytest.approx(twist.w * surface.rho, abs=1e-6)


def test_tripling_the_load_triples_the_wrench_of_the_same_twist():
    twist = Twist(0.1, 0.05, 0.7)
    light = EllipsoidLimitSurface(3.0, 0.06).wrench(twist)
    heavy = EllipsoidLimitSurface(9.0, 0.06).wrench(twist)
    assert (heavy.fx, heavy.fy, heavy.tau) == pytest.approx(
        (3 * light.fx, 3 * light.fy, 3 * light.tau)
    )


def test_a_zero_wrench_moves_nothing_and_a_zero_twist_needs_nothing():
    surface = EllipsoidLimitSurface(3.0, 0.06)
    assert surface.twist_direction(Wrench(0.0, 0.0, 0.0)).w == 0.0
    assert surface.wrench(Twist(0.0, 0.0, 0.0)).fx == 0.0


@pytest.mark.parametrize(
    ("force", "rho"), [(0.0, 0.1), (1.0, 0.0), (math.nan, 0.1), (1.0, math.inf)]
)
def test_a_surface_without_extent_is_refused(force, rho):
    with pytest.raises(ValueError, match="must be finite and > 0"):
        EllipsoidLimitSurface(force, rho)


@pytest.mark.parametrize("patch", PATCHES.values(), ids=PATCHES)
@settings(max_examples=30, deadline=None)
@given(nu=unit_twists, of=points)
def test_exact_twist_and_exact_wrench_are_inverse(patch, nu, of):
    rho = rho_pole(patch)
    twist = Twist(nu[0], nu[1], nu[2] / rho, patch.cop).moved_to(of)
    wrench = exact_wrench(patch, 0.3, twist)
    back = exact_twist_direction(patch, wrench.moved_to((0.1, 0.2)))
    length = math.hypot(*nu)
    assert (back.vx, back.vy, back.w * rho) == pytest.approx(
        [c / length for c in nu], abs=1e-6
    )
    assert exact_level(patch, 0.3, wrench) == pytest.approx(1.0, abs=1e-9)


def test_no_wrench_of_the_exact_surface_has_more_power_than_that_of_the_twist_itself():
    patch = PATCHES["pressed"]
    nu = on_the_sphere(300, rho_pole(patch))
    wrenches = exact_wrenches(patch, 0.3, nu)
    power = nu @ wrenches.T
    assert (power <= np.diag(power)[:, None] + 1e-9).all()


def test_the_batch_agrees_with_single_calls():
    patch = PATCHES["pressed"]
    nu = on_the_sphere(700, rho_pole(patch))
    batch = exact_wrenches(patch, 0.3, nu)
    for i in (0, 300, 699):
        one = exact_wrench(patch, 0.3, Twist(*nu[i], patch.cop))
        assert (one.fx, one.fy, one.tau) == pytest.approx(tuple(batch[i]), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "low", "high", "median", "worst"),
    [
        ("square", -0.05, 0.05, 5.5, 9.5),
        ("disc", -0.05, 0.052, 6.0, 9.5),
        ("long", -0.11, 0.03, 6.0, 18.0),
        ("pressed", -0.11, 0.045, 5.0, 14.5),
    ],
)
def test_the_ellipsoid_errs_as_much_as_the_notes_say_and_no_more(
    name, low, high, median, worst
):
    patch = PATCHES[name]
    rho = rho_fit(patch)
    nu = on_the_sphere(2000, rho)
    scaled = exact_wrenches(patch, 1.0 / patch.total_load, nu) / [1.0, 1.0, rho]
    radius = np.linalg.norm(scaled, axis=1)
    cosine = (scaled * nu * [1.0, 1.0, rho]).sum(1) / radius
    angle = np.degrees(np.arccos(np.minimum(cosine, 1.0)))
    assert low < radius.min() - 1.0 < 0.9 * low
    assert 0.9 * high < radius.max() - 1.0 < high
    assert 0.9 * median < np.median(angle) < median
    assert 0.9 * worst < angle.max() < worst


def test_the_exact_surface_of_a_uniform_disc_lies_inside_the_ellipsoid_with_its_poles():
    patch = PATCHES["disc"]
    rho = rho_pole(patch)
    scaled = exact_wrenches(patch, 1.0 / patch.total_load, on_the_sphere(2000, rho)) / [
        1.0,
        1.0,
        rho,
    ]
    assert np.linalg.norm(scaled, axis=1).max() <= 1.0 + 1e-9


def test_pure_rotation_of_the_pressed_box_about_its_cop_needs_a_lateral_force():
    patch = PATCHES["pressed"]
    force = exact_wrench(patch, 1.0 / patch.total_load, Twist(0.0, 0.0, 1.0, patch.cop))
    assert math.hypot(force.fx, force.fy) == pytest.approx(0.083, abs=5e-4)


def test_three_pins_turn_about_one_of_them_under_a_range_of_forces():
    pins = pin_pressure(((0.1, 0.0), (-0.05, 0.08), (-0.05, -0.08)), (0.0, 0.0), 9.0)
    still = Twist(0.0, 0.0, 1.0, (0.1, 0.0))
    base = exact_wrench(pins, 0.3, still)
    hold = 0.5 * 0.3 * pins.loads[0]
    for angle in np.linspace(0.0, 6.0, 7):
        at_pin = Wrench(
            hold * math.cos(angle), hold * math.sin(angle), 0.0, (0.1, 0.0)
        ).moved_to(pins.cop)
        wrench = Wrench(
            base.fx + at_pin.fx, base.fy + at_pin.fy, base.tau + at_pin.tau, pins.cop
        )
        twist = exact_twist_direction(pins, wrench)
        pin = twist.moved_to((0.1, 0.0))
        assert math.hypot(pin.vx, pin.vy) < 1e-5
        assert twist.w > 0.0
        assert exact_level(pins, 0.3, wrench) == pytest.approx(1.0, abs=1e-6)


def test_without_extent_or_without_wrench_there_is_no_direction():
    with pytest.raises(ValueError, match="no extent"):
        exact_twist_direction(
            PressureSamples([[0.0, 0.0]], [1.0]), Wrench(1.0, 0.0, 0.0)
        )
    with pytest.raises(ValueError, match="zero wrench"):
        exact_twist_direction(PATCHES["disc"], Wrench(0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="twists"):
        exact_wrenches(PATCHES["disc"], 0.3, np.zeros(3))


@given(surfaces)
def test_at_rest_there_is_no_wrench_and_without_a_wrench_no_twist(surface):
    at_rest = surface.wrench(Twist(0.0, 0.0, 0.0, surface.center))
    assert at_rest == Wrench(0.0, 0.0, 0.0, surface.center)
    still = surface.twist_direction(Wrench(0.0, 0.0, 0.0, surface.center))
    assert still == Twist(0.0, 0.0, 0.0, surface.center)
