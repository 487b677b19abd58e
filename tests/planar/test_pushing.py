"""Laws of one quasi-static push: limit surface, normality, Coulomb, agreement of its forms, mirror
symmetry.
"""

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pushpressslide.core.pose import cross
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.planar.pushing import push_with_compliance, push_with_velocity

LIMIT = 3.0  # [N]
levers = st.tuples(st.floats(-0.12, -0.04), st.floats(-0.06, 0.06))
rhos = st.floats(0.02, 0.12)
frictions = st.floats(0.05, 1.2)
bearings = st.floats(-0.5, 0.5)  # of the inward normal: towards +x
vectors = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
dampings = st.tuples(st.floats(50.0, 2000.0), st.floats(50.0, 2000.0))


def unit(bearing: float):
    return (math.cos(bearing), math.sin(bearing))


def dot(a, b) -> float:
    return a[0] * b[0] + a[1] * b[1]


def left_of(n):
    return (-n[1], n[0])


def level(force, r, rho) -> float:
    """Return the size of a contact force relative to the limit surface."""
    return math.sqrt(EllipsoidLimitSurface(LIMIT, rho).level(Wrench(*force, cross(r, force))))


def contact_velocity(twist: Twist, r):
    moved = twist.moved_to(r)
    return (moved.vx, moved.vy)


def check_sliding_law(outcome, r, rho) -> None:
    """The force is on the surface and the twist along its normal."""
    assert level(outcome.force, r, rho) == pytest.approx(1.0, rel=1e-6)
    direction = EllipsoidLimitSurface(LIMIT, rho).twist_direction(
        Wrench(*outcome.force, cross(r, outcome.force))
    )
    twist = outcome.twist
    size = math.sqrt(twist.vx**2 + twist.vy**2 + (rho * twist.w) ** 2)
    assert (twist.vx, twist.vy, rho * twist.w) == pytest.approx(
        (size * direction.vx, size * direction.vy, size * rho * direction.w), abs=1e-6 * size + 1e-15
    )


@given(levers, rhos, frictions, bearings, vectors)
def test_a_velocity_controlled_tip_does_what_the_motion_cone_says(r, rho, mu, bearing, velocity) -> None:
    n = unit(bearing)
    assume(abs(dot(velocity, n)) > 1e-3)
    outcome = push_with_velocity(velocity, r, n, mu, rho, LIMIT)
    expected = push_outcome(EllipsoidLimitSurface(LIMIT, rho), r, n, mu, velocity)
    if expected.kind == "separate":
        assert outcome.status == "free"
        assert outcome.force == (0.0, 0.0)
        return
    t = left_of(n)
    margin = mu * dot(expected.force, n) - abs(dot(expected.force, t))
    assume(expected.kind != "stick" or margin > 1e-6)
    assert outcome.status == expected.kind
    assert outcome.force == pytest.approx(expected.force, rel=1e-6, abs=1e-9)
    assert (outcome.twist.vx, outcome.twist.vy, outcome.twist.w) == pytest.approx(
        (expected.twist.vx, expected.twist.vy, expected.twist.w), rel=1e-6, abs=1e-9
    )
    check_sliding_law(outcome, r, rho)


@given(levers, rhos, frictions, bearings, vectors)
def test_a_pushed_contact_keeps_the_normal_velocity_and_sticks_or_is_on_the_edge(
    r, rho, mu, bearing, velocity
) -> None:
    n = unit(bearing)
    assume(dot(velocity, n) > 1e-3)
    outcome = push_with_velocity(velocity, r, n, mu, rho, LIMIT)
    moved = contact_velocity(outcome.twist, r)
    assert dot(moved, n) == pytest.approx(dot(velocity, n), rel=1e-9)
    tangential, normal = dot(outcome.force, left_of(n)), dot(outcome.force, n)
    assert abs(tangential) <= mu * normal * (1.0 + 1e-9)
    if outcome.status == "stick":
        assert moved == pytest.approx(velocity, abs=1e-9)
    else:
        assert abs(tangential) == pytest.approx(mu * normal, rel=1e-9)


@given(levers, rhos, frictions, bearings, vectors, dampings)
def test_a_compliant_tip_keeps_the_force_law_the_cone_and_the_surface(
    r, rho, mu, bearing, pull, damping
) -> None:
    n, radius = unit(bearing), 0.02
    t = left_of(n)
    force = (6.0 * pull[0], 6.0 * pull[1])
    assume(abs(dot(force, n)) > 1e-3)
    outcome = push_with_compliance(force, damping, r, n, mu, rho, LIMIT, radius)
    # the tip's own law: what is left of the force drives it
    for axis, b in ((n, damping[0]), (t, damping[1])):
        left = dot(force, axis) - dot(outcome.force, axis)
        assert b * dot(outcome.tip_velocity, axis) == pytest.approx(left, abs=1e-6)
    if outcome.status == "free":
        assert dot(force, n) <= 0.0
        return
    normal, tangential = dot(outcome.force, n), dot(outcome.force, t)
    assert normal >= 0.0
    assert abs(tangential) <= mu * normal * (1.0 + 1e-9)
    moving = outcome.twist != Twist(0.0, 0.0, 0.0)
    if moving:
        check_sliding_law(outcome, r, rho)
    else:
        assert level(outcome.force, r, rho) <= 1.0 + 1e-9
    centre = (r[0] - radius * n[0], r[1] - radius * n[1])
    carried = contact_velocity(outcome.twist, centre)
    if outcome.status == "stick":
        assert outcome.tip_velocity == pytest.approx(carried, rel=1e-5, abs=1e-7)
    elif outcome.status != "rest":
        assert abs(tangential) == pytest.approx(mu * normal, rel=1e-9)
        slip = dot(outcome.tip_velocity, t) - dot(carried, t)
        sign = 1.0 if outcome.status == "slip_left" else -1.0
        assert sign * slip >= -1e-7  # friction on the object is along the slip of the tip


@given(levers, rhos, frictions, bearings, st.floats(0.05, 0.9), st.floats(-0.9, 0.9))
def test_a_weak_force_inside_the_cone_moves_nothing(r, rho, mu, bearing, share, steering) -> None:
    n = unit(bearing)
    t = left_of(n)
    f = (n[0] + steering * mu * t[0], n[1] + steering * mu * t[1])
    size = share / level(f, r, rho)
    force = (size * f[0], size * f[1])
    outcome = push_with_compliance(force, (300.0, 300.0), r, n, mu, rho, LIMIT)
    assert outcome.status == "rest"
    assert outcome.force == pytest.approx(force)
    assert outcome.tip_velocity == pytest.approx((0.0, 0.0), abs=1e-12)


@settings(max_examples=60)
@given(levers, rhos, frictions, bearings, st.floats(0.02, 0.2), st.floats(-1.2, 1.2))
def test_a_very_stiff_servo_pushes_like_a_prescribed_velocity(r, rho, mu, bearing, speed, angle) -> None:
    n = unit(bearing)
    t = left_of(n)
    velocity = (
        speed * (math.cos(angle) * n[0] + math.sin(angle) * t[0]),
        speed * (math.cos(angle) * n[1] + math.sin(angle) * t[1]),
    )
    expected = push_with_velocity(velocity, r, n, mu, rho, LIMIT)
    margin = abs(mu * dot(expected.force, n) - abs(dot(expected.force, left_of(n))))
    assume(expected.status != "stick" or margin > 0.02)
    damping = 1e7
    outcome = push_with_compliance(
        (damping * velocity[0], damping * velocity[1]), (damping, damping), r, n, mu, rho, LIMIT
    )
    assert outcome.status == expected.status
    assert outcome.force == pytest.approx(expected.force, rel=1e-3, abs=1e-3)
    assert (outcome.twist.vx, outcome.twist.vy, rho * outcome.twist.w) == pytest.approx(
        (expected.twist.vx, expected.twist.vy, rho * expected.twist.w), rel=1e-3, abs=1e-4 * speed
    )


OTHER_SIDE = {"slip_left": "slip_right", "slip_right": "slip_left"}


@given(levers, rhos, frictions, bearings, vectors, dampings)
def test_the_mirrored_push_has_the_mirrored_outcome(r, rho, mu, bearing, pull, damping) -> None:
    def flip(v):
        return (v[0], -v[1])

    force = (6.0 * pull[0], 6.0 * pull[1])
    own = push_with_compliance(force, damping, r, unit(bearing), mu, rho, LIMIT, 0.02)
    other = push_with_compliance(flip(force), damping, flip(r), unit(-bearing), mu, rho, LIMIT, 0.02)
    assume(own.status not in OTHER_SIDE or abs(own.force[0]) + abs(own.force[1]) > 1e-9)
    assert other.status == OTHER_SIDE.get(own.status, own.status)
    assert other.force == pytest.approx(flip(own.force), abs=1e-9)
    assert other.tip_velocity == pytest.approx(flip(own.tip_velocity), abs=1e-9)
    assert (other.twist.vx, other.twist.vy, other.twist.w) == pytest.approx(
        (own.twist.vx, -own.twist.vy, -own.twist.w), abs=1e-9
    )


def test_a_tip_that_is_drawn_back_lets_go() -> None:
    outcome = push_with_compliance((-1.0, 0.5), (100.0, 50.0), (-0.07, 0.0), (1.0, 0.0), 0.5, 0.05, LIMIT)
    assert outcome.status == "free"
    assert outcome.tip_velocity == pytest.approx((-0.01, 0.01))
    assert outcome.force == (0.0, 0.0)
