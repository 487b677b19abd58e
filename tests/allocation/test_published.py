"""The paper's own formulas for two contacts, and their errors (docs/mechanics.md, 5 to
7).
"""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.allocation import orthogonal, published
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_margin

D = 0.1
POINTS = ((-D, 0.0), (0.0, D))
NORMALS = ((1.0, 0.0), (0.0, -1.0))
parts = st.floats(-2.0, 2.0)
frictions = st.floats(0.1, 0.95)


def margin(forces, mu):
    return min(cone_margin(f, n, mu) for f, n in zip(forces, NORMALS, strict=True))


@given(parts, parts, parts, st.floats(0.0, 3.0))
def test_the_bias_is_not_internal_but_pushes_the_object_along_the_diagonal(
    fx, fy, t, bias
):
    forces = published.orthogonal_pushes(fx, fy, t * D, D, bias)
    realised = wrench_of_forces(POINTS, forces)
    assert realised[:3] == pytest.approx((fx + bias, fy - bias, t * D), abs=1e-12)


@given(parts, parts, parts, frictions)
def test_the_least_bias_just_brings_the_even_split_into_the_cones(fx, fy, t, mu):
    bias = published.least_bias(fx, fy, t * D, D, mu)
    assert margin(published.orthogonal_pushes(fx, fy, t * D, D, bias), mu) >= -1e-9
    if bias > 1e-6:
        assert (
            margin(published.orthogonal_pushes(fx, fy, t * D, D, 0.999 * bias), mu)
            < 0.0
        )


@given(parts, parts, parts, frictions)
def test_the_least_drift_is_never_more_than_the_papers_bias(fx, fy, t, mu):
    wrench = (fx, fy, t * D)
    assert (
        orthogonal.least_drift(*wrench, D, mu)
        <= published.least_bias(*wrench, D, mu) + 1e-9
    )


@given(st.floats(0.05, 2.0), frictions)
def test_a_moment_beside_a_force_along_one_normal_is_out_of_the_even_splits_reach(
    fx, mu
):
    low, high = orthogonal.moment_limits(fx, 0.0, D, mu)
    for tau in (0.5 * low, 0.5 * high):
        assert orthogonal.feasibility(fx, 0.0, tau, D, mu).spare >= -1e-12
        if abs(tau) > 1e-9:
            assert margin(published.orthogonal_pushes(fx, 0.0, tau, D), mu) < 0.0
            assert margin(orthogonal.forces(fx, 0.0, tau, D, mu), mu) >= -1e-9


@given(st.floats(0.1, 2.0), st.floats(-1.0, 1.0))
def test_synchronised_pushes_have_the_moment_that_they_have(fx, fy):
    points = ((-0.1, 0.06), (-0.1, -0.06))
    realised = wrench_of_forces(points, published.synchronised_pushes(fx, fy))
    assert realised[:3] == pytest.approx((fx, fy, -0.1 * fy), abs=1e-12)


def test_a_differential_drive_by_pushes_cannot_turn_in_place_nor_reverse():
    points = ((-0.1, 0.06), (-0.1, -0.06))
    w = 0.06
    for fx, tau in ((0.0, 0.1), (-1.0, 0.0)):
        forces = published.differential_pushes(fx, tau, w)
        assert wrench_of_forces(points, forces)[:3] == pytest.approx(
            (fx, 0.0, tau), abs=1e-12
        )
        assert min(f[0] for f in forces) < 0.0


@given(parts, parts, parts)
def test_pressed_forces_give_the_wrench_about_the_com(fx, fy, tau):
    points = ((0.0, 0.3), (0.1, -0.3))
    forces = published.pressed_forces(points, fx, fy, tau)
    assert wrench_of_forces(points, forces)[:3] == pytest.approx(
        (fx, fy, tau), abs=1e-9
    )
