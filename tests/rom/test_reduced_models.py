"""Reduced models against the limit surface that they represent (docs/mechanics.md, 2 to
5).
"""

import math
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2, cross, turned_left
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.contacts import velocity_of_force, wrench_of_forces
from pushpressslide.mechanics.friction import cone_margin
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.rom.differential_car import DifferentialCar
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.rom.rear_steer_car import STEERING_LIMIT, RearSteerCar
from pushpressslide.rom.unicycle import Unicycle

small = st.floats(-0.1, 0.1)
bearings = st.floats(-math.pi, math.pi)
shares = st.floats(0.0, 1.0)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


@st.composite
def rear_cars(draw):
    bearing = draw(bearings)
    d = draw(st.floats(0.03, 0.2))
    normal = (math.cos(bearing), math.sin(bearing))
    side = turned_left(normal)
    cop = (draw(small), draw(small))
    offset = d * draw(st.floats(-0.9, 0.9))
    contact = tuple(cop[i] - d * normal[i] + offset * side[i] for i in range(2))
    return RearSteerCar(
        contact, normal, cop, draw(st.floats(0.02, 0.2)), draw(st.floats(0.05, 1.5))
    )


def moved(car, force):
    """Return the twist at the vehicle frame's origin under a contact force, in B."""
    surface = EllipsoidLimitSurface(2.0, car.rho, car.cop)
    return surface.twist_direction(
        wrench_of_forces([car.contact], [force], car.cop)
    ).moved_to(car.X_BV.position)


@given(rear_cars(), shares)
def test_no_force_in_the_cone_makes_the_front_axle_slip_sideways(car, share):
    half = math.atan(car.mu) * (2.0 * share - 1.0)
    n = car.normal
    force = (
        math.cos(half) * n[0] - math.sin(half) * n[1],
        math.sin(half) * n[0] + math.cos(half) * n[1],
    )
    twist = moved(car, force)
    e = car.axis
    assert abs(cross(e, (twist.vx, twist.vy))) < 1e-9 * (1.0 + abs(twist.w))
    steering = math.atan2(cross(e, force), dot(e, force))
    assume(abs(steering) < STEERING_LIMIT)
    low, high = car.steering_limits
    assert low - 1e-9 <= steering <= high + 1e-9
    k_low, k_high = car.curvature_limits
    curvature = twist.w / dot(e, (twist.vx, twist.vy))
    assert curvature == pytest.approx(car.curvature(steering), rel=1e-6, abs=1e-9)
    slack = 1e-9 + 1e-6 * abs(curvature)
    assert k_low - slack <= curvature <= k_high + slack


@given(rear_cars(), shares)
def test_steering_within_its_limits_is_a_force_on_the_surface_and_in_the_cone(
    car, share
):
    low, high = car.steering_limits
    steering = low + share * (high - low)
    force = car.force(steering, 2.0)
    surface = EllipsoidLimitSurface(2.0, car.rho, car.cop)
    assert surface.level(wrench_of_forces([car.contact], [force])) == pytest.approx(
        1.0, abs=1e-9
    )
    assert cone_margin(force, car.normal, car.mu) > -1e-9
    assert car.steering(car.curvature(steering)) == pytest.approx(steering, abs=1e-9)


@given(rear_cars(), shares)
def test_the_contact_moves_as_its_mobility_says(car, share):
    low, high = car.steering_limits
    steering = low + share * (high - low)
    lever = (car.contact[0] - car.cop[0], car.contact[1] - car.cop[1])
    expected = velocity_of_force(lever, car.rho, car.force(steering, 1.0))
    velocity = car.contact_velocity(0.07, steering)
    size = math.hypot(*expected) * math.hypot(*velocity)
    assert cross(expected, velocity) == pytest.approx(0.0, abs=1e-9 * size)
    assert dot(velocity, car.axis) == pytest.approx(0.07)
    twist = moved(car, car.force(steering, 1.0))
    scale = 0.07 / dot((twist.vx, twist.vy), car.axis)
    at_contact = twist.moved_to(car.contact)
    assert velocity == pytest.approx(
        (scale * at_contact.vx, scale * at_contact.vy), rel=1e-6, abs=1e-9
    )


@given(rear_cars(), shares, shares)
def test_bounds_of_curvature_narrow_the_steering_and_nothing_else(car, left, right):
    low, high = car.curvature_limits
    assume(low < -1e-3 and high > 1e-3)
    assume(left > 1e-3 and right > 1e-3)
    bounded = replace(car, bounds=(right * low, left * high))
    assert bounded.curvature_limits == pytest.approx((right * low, left * high))
    assert bounded.X_BV == car.X_BV
    wide = replace(car, bounds=(2.0 * low, 2.0 * high))
    assert wide.steering_limits == car.steering_limits


@pytest.mark.parametrize(
    "bounds", [(0.0, 1.0), (-1.0, 0.0), (1.0, 2.0), (math.nan, 1.0)]
)
def test_bounds_without_a_straight_path_between_them_are_refused(bounds):
    with pytest.raises(ValueError, match="must have 0 between them"):
        RearSteerCar((-0.1, 0.0), (1.0, 0.0), (0.0, 0.0), 0.05, 0.3, bounds)


@given(rear_cars(), shares)
def test_a_mirrored_push_has_the_mirrored_car(car, share):
    mirror = RearSteerCar(
        (car.contact[0], -car.contact[1]),
        (car.normal[0], -car.normal[1]),
        (car.cop[0], -car.cop[1]),
        car.rho,
        car.mu,
    )
    low, high = car.steering_limits
    assert mirror.steering_limits == pytest.approx((-high, -low))
    assert mirror.curvature_limits == pytest.approx(
        tuple(-k for k in reversed(car.curvature_limits))
    )
    assert mirror.X_BV.y == pytest.approx(-car.X_BV.y)
    assert mirror.minimum_turning_radius == pytest.approx(car.minimum_turning_radius)


def test_the_centred_push_of_the_cube_is_the_car_of_the_notes():
    car = RearSteerCar((-0.075, 0.0), (1.0, 0.0), (0.0, 0.0), 0.0574, 0.5)
    assert car.eta == 0.0
    assert car.effective_wheelbase == pytest.approx(0.0439, abs=5e-5)
    assert car.X_BV.position == pytest.approx((0.0439, 0.0), abs=5e-5)
    assert car.curvature_limits[1] == pytest.approx(0.5 * 0.075 / 0.0574**2)
    assert car.curvature_limits[0] == -car.curvature_limits[1]
    assert car.minimum_turning_radius == pytest.approx(0.0574**2 / (0.5 * 0.075))
    assert car.curvature(0.1) < 0.0  # pushing to the left turns to the right
    psi = math.atan2(*reversed(car.contact_velocity(1.0, math.atan(0.4))))
    assert math.degrees(psi) == pytest.approx(47.3, abs=0.1)


@given(st.floats(-0.12, 0.12), st.floats(0.05, 1.0))
def test_an_offset_push_has_the_shifted_curvature_interval_of_the_notes(y_c, mu):
    d = 0.075
    rho = 0.0574
    car = RearSteerCar((-d, y_c), (1.0, 0.0), (0.0, 0.0), rho, mu)
    assert car.eta == pytest.approx(math.atan2(-y_c, d))
    # With v_x at the centre of mass: kappa in [-(mu d + y_c)/rho^2, (mu d -
    # y_c)/rho^2].
    surface = EllipsoidLimitSurface(1.0, rho)
    for tangential, kappa in (
        (mu, -(mu * d + y_c) / rho**2),
        (-mu, (mu * d - y_c) / rho**2),
    ):
        twist = surface.twist_direction(
            wrench_of_forces([(-d, y_c)], [(1.0, tangential)])
        )
        assert twist.w / twist.vx == pytest.approx(kappa, abs=1e-9)
    if (
        abs(car.steering_limits[0]) < STEERING_LIMIT
        and abs(car.steering_limits[1]) < STEERING_LIMIT
    ):
        low, high = car.curvature_limits
        assume(abs(abs(y_c) - mu * d) > 1e-6)
        assert (low < 0.0 < high) == (abs(y_c) < mu * d)


def test_a_contact_that_cannot_push_is_refused():
    with pytest.raises(ValueError, match="centre of pressure"):
        RearSteerCar((0.0, 0.0), (1.0, 0.0), (0.0, 0.0), 0.05, 0.3)
    with pytest.raises(ValueError, match="off the inward normal"):
        RearSteerCar((0.1, 0.0), (1.0, 0.0), (0.0, 0.0), 0.05, 0.3)
    with pytest.raises(ValueError, match="unit"):
        RearSteerCar((-0.1, 0.0), (2.0, 0.0), (0.0, 0.0), 0.05, 0.3)
    with pytest.raises(ValueError, match="rho > 0"):
        RearSteerCar((-0.1, 0.0), (1.0, 0.0), (0.0, 0.0), 0.0, 0.3)


def test_a_frictionless_centred_push_only_goes_straight():
    car = RearSteerCar((-0.1, 0.0), (1.0, 0.0), (0.0, 0.0), 0.05, 0.0)
    assert car.minimum_turning_radius == math.inf


@st.composite
def unicycles(draw):
    cop = (draw(small), draw(small))
    bearing = draw(bearings)
    d = draw(st.floats(0.02, 0.3))
    contact = (cop[0] + d * math.cos(bearing), cop[1] + d * math.sin(bearing))
    return Unicycle(contact, cop, draw(st.floats(0.02, 0.2)), draw(st.booleans()))


@given(unicycles(), st.floats(-1.0, 1.0), st.floats(-5.0, 5.0))
def test_the_force_of_the_unicycle_moves_its_axle_as_wanted(car, speed, rate):
    assume(math.hypot(speed, rate * car.rho) > 1e-3)
    force = car.force(speed, rate, 2.0)
    surface = EllipsoidLimitSurface(2.0, car.rho, car.cop)
    wrench = wrench_of_forces([car.contact], [force], car.cop)
    assert surface.level(wrench) == pytest.approx(1.0, abs=1e-9)
    twist = surface.twist_direction(wrench).moved_to(car.X_BV.position)
    wanted = (speed * car.axis[0], speed * car.axis[1], rate * car.rho)
    got = (twist.vx, twist.vy, twist.w * car.rho)
    k = math.hypot(*got) / math.hypot(*wanted)
    assert got == pytest.approx(
        tuple(k * c for c in wanted), abs=1e-7 * (1 + car.rho / abs(car.lever))
    )
    at_contact = twist.moved_to(car.contact)
    velocity = car.contact_velocity(speed, rate)
    assert (at_contact.vx, at_contact.vy) == pytest.approx(
        (k * velocity[0], k * velocity[1]), abs=1e-7 * (1 + k * math.hypot(*velocity))
    )
    angle = math.atan2(cross(car.axis, force), dot(car.axis, force))
    across = car.lever * math.sin(angle) / car.rho
    assert math.hypot(*force) == pytest.approx(2.0 / math.hypot(1.0, across))


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize(("axle", "wheelbase"), [(-0.05, 0.08), (0.02, 0.3)])
def test_a_unicycle_with_another_axle_has_it_there_and_that_wheelbase(
    backward: bool, axle: float, wheelbase: float
) -> None:
    car = Unicycle((0.1, 0.05), (0.02, 0.01), 0.08, backward).with_axle(axle, wheelbase)
    assert car.axle == pytest.approx(axle)
    assert abs(car.effective_wheelbase) == pytest.approx(wheelbase)
    x, y = car.X_BV.position
    assert (x, y) == pytest.approx((axle * car.axis[0], axle * car.axis[1]))


def test_the_unicycle_turned_backward_keeps_its_axle_and_turns_its_heading():
    forward = Unicycle((0.2, 0.1), (0.1, 0.05), 0.1)
    backward = Unicycle((0.2, 0.1), (0.1, 0.05), 0.1, backward=True)
    assert backward.X_BV.position == pytest.approx(forward.X_BV.position)
    assert math.cos(backward.X_BV.yaw - forward.X_BV.yaw) == pytest.approx(-1.0)
    assert backward.lever == -forward.lever
    assert forward.force(0.0, 0.0, 1.0) == (0.0, 0.0)
    with pytest.raises(ValueError, match="only translates"):
        Unicycle((0.1, 0.0), (0.1, 0.0), 0.1)
    with pytest.raises(ValueError, match="rho"):
        Unicycle((0.1, 0.0), (0.0, 0.0), 0.0)


@given(
    st.floats(0.02, 0.2),
    st.floats(0.02, 0.2),
    st.floats(0.03, 0.2),
    st.floats(-40.0, 40.0),
    bearings,
)
def test_the_normals_of_the_differential_car_give_the_curvature_and_push_within_its_limits(
    left, right, rho, curvature, heading
):
    car = DifferentialCar((0.03, 0.01), heading, left, right, rho)
    f_left, f_right = car.normals(curvature, 3.0)
    low, high = car.curvature_limits
    assume(min(abs(curvature - low), abs(curvature - high)) > 1e-6)
    assert (min(f_left, f_right) >= 0.0) == (low <= curvature <= high)
    wrench = Wrench(f_left + f_right, 0.0, right * f_right - left * f_left)
    surface = EllipsoidLimitSurface(3.0, rho)
    assert surface.level(wrench) == pytest.approx(1.0, abs=1e-9)
    twist = surface.twist_direction(wrench)
    assert twist.vy == 0.0
    assert twist.w / twist.vx == pytest.approx(curvature, rel=1e-6, abs=1e-9)


def test_the_differential_car_only_goes_forward_and_needs_a_width():
    car = DifferentialCar((0.0, 0.0), 0.5, 0.1, 0.05, 0.06)
    assert car.minimum_turning_radius == pytest.approx(0.036)
    assert Pose2(0.0, 0.0, 0.5) == car.X_BV
    with pytest.raises(ValueError, match="must be > 0"):
        DifferentialCar((0.0, 0.0), 0.5, 0.0, 0.05, 0.06)


@given(unicycles())
def test_the_length_of_a_unicycle_is_from_its_axle_to_its_contact_either_way(car):
    assert car.length == pytest.approx(math.dist(car.X_BV.position, car.contact))


def test_a_pushed_car_turns_both_ways_with_the_lesser_of_its_curvatures():
    assert PushedCar(0.0, 0.05, 0.05, 0.08, 3.0, 4.0).tightest == 3.0
    assert PushedCar(0.0, 0.05, 0.05, 0.08, 5.0, 4.0).tightest == 4.0


@given(unicycles())
def test_the_contact_of_a_unicycle_is_ahead_unless_it_is_driven_backward(car):
    assert (car.lever < 0.0) == car.backward
    ahead = (car.contact[0] - car.cop[0], car.contact[1] - car.cop[1])
    assert dot(car.axis, ahead) == pytest.approx(car.lever)


@given(unicycles())
def test_a_unicycle_further_on_has_all_that_it_had_further_on(car):
    there = car.shifted((0.03, -0.02))
    x, y = car.X_BV.position
    assert there.X_BV.position == pytest.approx((x + 0.03, y - 0.02))
    assert math.cos(there.X_BV.yaw - car.X_BV.yaw) == pytest.approx(1.0)
    assert there.contact == pytest.approx(
        (car.contact[0] + 0.03, car.contact[1] - 0.02)
    )


def test_a_differential_car_needs_a_length():
    with pytest.raises(ValueError, match="must be > 0"):
        DifferentialCar((0.0, 0.0), 0.5, 0.1, 0.05, 0.0)
