"""Friction cones, motion cones, sliding contacts and contact forces (docs/mechanics.md,
2 and 3).
"""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.core.pose import cross, turned_left
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.contacts import (
    contact_mobility,
    force_of_velocity,
    least_norm_forces,
    velocity_of_force,
    wrench_of_forces,
)
from pushpressslide.mechanics.friction import (
    cone_edges,
    cone_margin,
    force_angle,
    motion_cone,
    press_margin,
    push_outcome,
)
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

vectors = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
bearings = st.floats(-math.pi, math.pi)
rhos = st.floats(0.02, 0.3)
frictions = st.floats(0.05, 1.5)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


@given(bearings, frictions, st.floats(-1.4, 1.4))
def test_the_margin_is_positive_exactly_inside_the_cone(bearing, mu, angle):
    assume(abs(abs(math.tan(angle)) - mu) > 1e-6)
    normal = (math.cos(bearing), math.sin(bearing))
    force = (math.cos(bearing + angle), math.sin(bearing + angle))
    right, left = cone_edges(normal, mu)
    assert (cone_margin(force, normal, mu) > 0.0) == (abs(math.tan(angle)) < mu)
    assert cone_margin(right, normal, mu) == pytest.approx(0.0, abs=1e-12)
    assert force_angle(left, normal) == pytest.approx(math.atan(mu))
    assert force_angle(right, normal) == pytest.approx(-math.atan(mu))
    assert cone_margin((-force[0], -force[1]), normal, mu) < 0.0


def test_a_press_sticks_within_its_disc():
    assert press_margin((3.0, 4.0), 10.0, 0.6) == pytest.approx(1.0)
    assert press_margin((3.0, 4.0), 5.0, 0.6) == pytest.approx(-2.0)


@given(vectors, rhos, vectors)
def test_mobility_and_its_inverse_agree_with_the_matrix_and_the_surface(lever, rho, f):
    (a, b), (c, d) = contact_mobility(lever, rho)
    v = velocity_of_force(lever, rho, f)
    size = 1.0 + math.hypot(*v)
    assert v == pytest.approx(
        (a * f[0] + b * f[1], c * f[0] + d * f[1]), abs=1e-12 * size
    )
    assert force_of_velocity(lever, rho, v) == pytest.approx(f, abs=1e-9 * size)
    if math.hypot(*f) > 1e-3:
        cop = (0.1, -0.2)
        point = (cop[0] + lever[0], cop[1] + lever[1])
        surface = EllipsoidLimitSurface(2.0, rho, cop)
        twist = surface.twist_direction(wrench_of_forces([point], [f], cop)).moved_to(
            point
        )
        assert cross((twist.vx, twist.vy), v) == pytest.approx(0.0, abs=1e-9 * size**2)
        assert dot((twist.vx, twist.vy), v) > 0.0


@given(st.floats(0.01, 0.3), rhos, frictions)
def test_the_motion_cone_of_a_centred_push_is_wider_than_the_friction_cone(d, rho, mu):
    right, left = motion_cone((-d, 0.0), rho, (1.0, 0.0), mu)
    assert math.tan(force_angle(left, (1.0, 0.0))) == pytest.approx(
        (1 + d**2 / rho**2) * mu
    )
    assert right == pytest.approx((left[0], -left[1]))


def test_the_motion_cone_of_the_cube_is_47_degrees_and_its_friction_cone_22():
    _, left = motion_cone((-0.075, 0.0), 0.0574, (1.0, 0.0), 0.4)
    assert math.degrees(force_angle(left, (1.0, 0.0))) == pytest.approx(47.3, abs=0.1)
    assert math.degrees(math.atan(0.4)) == pytest.approx(21.8, abs=0.1)


@given(vectors, bearings, rhos, frictions, vectors)
def test_a_pusher_sticks_slips_or_leaves_and_keeps_coulombs_law(
    point, bearing, rho, mu, velocity
):
    normal = (math.cos(bearing), math.sin(bearing))
    surface = EllipsoidLimitSurface(3.0, rho, (0.05, 0.02))
    approach = dot(velocity, normal)
    assume(abs(approach) > 1e-3)
    out = push_outcome(surface, point, normal, mu, velocity)
    moved = out.twist.moved_to(point)
    if approach < 0.0:
        assert out.kind == "separate"
        assert out.force == (0.0, 0.0)
        return
    wrench = wrench_of_forces([point], [out.force], surface.center)
    scale = 1.0 + math.hypot(point[0], point[1]) / rho
    assert surface.level(wrench) == pytest.approx(1.0, abs=1e-7)
    assert dot((moved.vx, moved.vy), normal) == pytest.approx(
        approach, abs=1e-8 * scale**2
    )
    relative = (velocity[0] - moved.vx, velocity[1] - moved.vy)
    tangent = turned_left(normal)
    assert dot(relative, tangent) == pytest.approx(
        out.slip_velocity, abs=1e-7 * scale**2
    )
    friction = dot(out.force, tangent)
    assert dot(out.force, normal) > 0.0
    if out.kind == "stick":
        assert cone_margin(out.force, normal, mu) >= -1e-9
        assert abs(out.slip_velocity) == 0.0
    else:
        assert cone_margin(out.force, normal, mu) == pytest.approx(0.0, abs=1e-9)
        sign = 1.0 if out.kind == "slip_left" else -1.0
        assert sign * friction > 0.0
        assert sign * out.slip_velocity > -1e-9 * scale**2


@given(vectors, bearings, frictions, st.floats(0.02, 0.98), st.floats(0.01, 1.0))
def test_velocities_inside_the_motion_cone_stick(point, bearing, mu, share, size):
    normal = (math.cos(bearing), math.sin(bearing))
    surface = EllipsoidLimitSurface(3.0, 0.06, (0.05, 0.02))
    lever = (point[0] - 0.05, point[1] - 0.02)
    right, left = motion_cone(lever, 0.06, normal, mu)
    velocity = tuple(
        size * ((1.0 - share) * r + share * m) for r, m in zip(right, left, strict=True)
    )
    assume(dot(velocity, normal) > 1e-6)
    assert push_outcome(surface, point, normal, mu, velocity).kind == "stick"


@given(
    st.lists(vectors, min_size=2, max_size=4), vectors, st.floats(-1.0, 1.0), vectors
)
def test_least_norm_forces_add_up_and_no_internal_force_makes_them_smaller(
    points, force, tau, about
):
    spread = max(math.dist(points[0], p) for p in points)
    assume(spread > 0.05)
    wrench = Wrench(force[0], force[1], tau, about)
    forces = least_norm_forces(points, wrench)
    total = wrench_of_forces(points, forces, about)
    assert (total.fx, total.fy, total.tau) == pytest.approx(
        (force[0], force[1], tau), abs=1e-9
    )
    e = (points[1][0] - points[0][0], points[1][1] - points[0][1])
    assert dot(forces[1], e) - dot(forces[0], e) == pytest.approx(0.0, abs=1e-9)


def test_contact_points_that_cannot_give_every_moment_are_refused():
    with pytest.raises(ValueError, match="at least two"):
        least_norm_forces([], Wrench(1.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="coincide"):
        least_norm_forces([(0.1, 0.0), (0.1, 0.0)], Wrench(1.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="one force per point"):
        wrench_of_forces([(0.0, 0.0)], [])
