"""Position of the virtual axle, against the figures of docs/mechanics.md, 3, 4 and 4.1."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pushpressslide.core.pose import cross
from pushpressslide.core.task import Box
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_twist_direction,
)
from pushpressslide.mechanics.pressure import disc_pressure, rectangle_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight
from pushpressslide.mechanics.virtual_axle import (
    axle_distance,
    axle_with_height,
    exact_axle_distance,
)

CUBE = rectangle_pressure(0.15, 0.15)
PRESSED = rectangle_pressure(0.6, 0.2, 10.943, (0.1462, 0.0))


def bar(cop):
    """The pressure under the pressed bar."""
    return face_pressure(Box((0.6, 0.2, 0.1)), (0.0, 0.0), cop)


@pytest.mark.parametrize(
    ("mu", "distance"), [(0.1, 0.0261), (0.3, 0.0319), (0.5, 0.0380), (0.8, 0.0438)]
)
def test_the_axle_of_the_pushed_cube_depends_on_the_force_angle(mu, distance):
    exact = exact_axle_distance(CUBE, (-0.075, 0.0), math.atan(mu))
    assert exact == pytest.approx(distance, abs=6e-5)
    assert axle_distance(rho_pole(CUBE), 0.075) == pytest.approx(0.0439, abs=5e-5)


@pytest.mark.parametrize(
    ("mu", "factor"), [(0.1, 1.69), (0.3, 1.44), (0.5, 1.23), (0.8, 1.02)]
)
def test_the_exact_curvature_limit_of_the_cube_exceeds_the_ellipsoids(mu, factor):
    force = (1.0, mu)
    twist = exact_twist_direction(CUBE, Wrench(1.0, mu, cross((-0.075, 0.0), force)))
    ellipsoid = mu * 0.075 / rho_pole(CUBE) ** 2
    assert abs(twist.w / twist.vx) / ellipsoid == pytest.approx(factor, abs=0.012)


@pytest.mark.parametrize(
    ("patch", "lever", "figures"),
    [
        (PRESSED, 0.0538, (0.220, 0.196, 0.203)),
        (rectangle_pressure(0.6, 0.2), 0.0538, (0.557, None, 0.277)),
    ],
)
def test_the_axle_of_a_press_is_not_strictly_force_invariant(patch, lever, figures):
    for angle, figure in zip((1.0, 60.0, 90.0), figures, strict=True):
        if figure is not None:
            exact = exact_axle_distance(patch, (lever, 0.0), math.radians(angle))
            assert exact == pytest.approx(figure, abs=2e-3)


def test_the_disc_pressed_at_half_its_radius_has_rho_squared_between_the_tabled_ends():
    disc = disc_pressure(1.0)
    straight, across = (
        0.5 * exact_axle_distance(disc, (0.5, 0.0), a) for a in (0.0, 0.5 * math.pi)
    )
    assert straight == pytest.approx(0.25, abs=1e-3)
    assert across == pytest.approx(0.41, abs=5e-3)


@given(st.floats(0.0, 6.28), st.floats(0.01, 0.3), st.floats(-3.0, 3.0))
@settings(max_examples=50, deadline=None)
def test_force_and_opposite_force_have_the_same_axle_and_the_disc_has_no_preferred_side(
    bearing, d, angle
):
    disc = disc_pressure(0.1, resolution=8)
    lever = (d * math.cos(bearing), d * math.sin(bearing))
    distance = exact_axle_distance(disc, lever, angle)
    assert exact_axle_distance(disc, lever, angle + math.pi) == pytest.approx(
        distance, rel=1e-6
    )
    assert exact_axle_distance(disc, (d, 0.0), -angle) == pytest.approx(
        distance, rel=2e-2
    )
    # From R^2/4 (straight) to 2 R^2/3 (pure turning under a far contact): beyond the 4
    # R^2/9 of the pole.
    assert 0.249 * 0.01 / d < distance < 0.667 * 0.01 / d


def test_a_nearly_straight_push_has_the_axle_of_the_straight_one():
    for lever in ((-0.075, 0.0), (-0.05, 0.04)):
        straight = exact_axle_distance(CUBE, lever, 0.0)
        assert exact_axle_distance(CUBE, lever, 0.002) == pytest.approx(
            straight, rel=2e-3
        )
        assert straight == pytest.approx(
            rho_straight(CUBE, lever) ** 2 / math.hypot(*lever)
        )


@given(
    st.floats(-1.5, 1.5),
    st.floats(0.02, 0.2),
    st.floats(0.02, 0.3),
    st.floats(0.0, 6.28),
)
def test_on_the_ellipsoid_the_axle_has_no_velocity_across_for_any_force(
    angle, rho, d, bearing
):
    e = (math.cos(bearing), math.sin(bearing))
    f = (math.cos(bearing + angle), math.sin(bearing + angle))
    cop = (0.03, -0.02)
    wrench = Wrench(f[0], f[1], cross((d * e[0], d * e[1]), f), cop)
    reach = axle_distance(rho, d)
    axle = (cop[0] - reach * e[0], cop[1] - reach * e[1])
    velocity = (
        EllipsoidLimitSurface(1.0, rho, cop).twist_direction(wrench).moved_to(axle)
    )
    size = math.hypot(velocity.vx, velocity.vy) + abs(velocity.w) * reach
    assert abs(cross(e, (velocity.vx, velocity.vy))) < 1e-9 * max(1.0, size)


@pytest.mark.parametrize(
    ("mu", "forward", "backward"),
    [(0.2, 0.000, -0.154), (0.3, 0.034, -0.198), (0.4, 0.066, -0.243)],
)
@pytest.mark.parametrize("angle", [0.0, 0.02])
def test_the_height_of_the_press_moves_the_axle_apart_for_forward_and_backward(
    mu, forward, backward, angle
):
    ahead = axle_with_height(bar, mu, (0.1462, 0.0), (0.2, 0.0), 0.1, angle)
    back = axle_with_height(bar, mu, (0.1462, 0.0), (0.2, 0.0), 0.1, math.pi - angle)
    assert ahead[0] == pytest.approx(forward, abs=6e-4)
    assert back[0] == pytest.approx(backward, abs=6e-4)
    d = 0.2 - 0.1462
    for sign, axle in ((1.0, ahead), (-1.0, back)):
        x = 0.1462 + sign * 0.1 * mu
        variance = (0.3 - x) ** 2 / 2 if x > 0.1 else 0.03 - x * x
        assert axle[0] == pytest.approx(x - variance / d, abs=5e-4)


def test_at_no_height_it_is_the_axle_of_the_unmoved_pressure():
    for angle in (0.0, 0.5, 1.5):
        axle = axle_with_height(bar, 0.3, PRESSED.cop, (0.2, 0.0), 0.0, angle)
        assert PRESSED.cop[0] - axle[0] == pytest.approx(
            exact_axle_distance(PRESSED, (0.0538, 0.0), angle), abs=2e-4
        )


def test_the_axle_of_the_papers_experiment_is_behind_the_centre_of_mass():
    # docs/mechanics.md, 4.1: the paper's own rho gives -0.52 m, not 0.82 m; the lifted
    # face -0.074 m.
    assert 0.1462 - axle_distance(math.sqrt(0.036), 0.0538) == pytest.approx(
        -0.523, abs=1e-3
    )
    assert 0.1462 - exact_axle_distance(PRESSED, (0.0538, 0.0), 0.0) == pytest.approx(
        -0.074, abs=1e-3
    )


def test_a_contact_at_the_centre_of_pressure_has_no_axle_and_a_tipping_object_is_refused():
    with pytest.raises(ValueError, match="lever"):
        exact_axle_distance(CUBE, (0.0, 0.0), 0.1)
    with pytest.raises(ValueError, match="inside the outline"):
        axle_with_height(
            lambda cop: face_pressure(Box((0.15, 0.15, 0.2)), (0.0, 0.0), cop),
            0.5,
            (0.0, 0.0),
            (-0.075, 0.0),
            0.2,
            0.0,
        )
