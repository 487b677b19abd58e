"""Allocation to one top contact."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.pose import cross

numbers = st.floats(-20.0, 20.0)


@given(
    numbers, numbers, st.floats(-2.0, 2.0), st.floats(0.5, 40.0), st.floats(0.1, 1.5)
)
def test_what_is_given_plus_what_is_missing_is_what_was_asked(
    fx, fy, tau, load, friction
) -> None:
    point = (0.12, -0.05)
    cop = (0.03, 0.01)
    found = one_press_allocator(point, load, friction, 0.1, cop)(fx, fy, tau)
    (f,) = found.forces
    given_tau = cross((point[0] - cop[0], point[1] - cop[1]), f)
    total = (
        f[0] + found.residual[0],
        f[1] + found.residual[1],
        given_tau + found.residual[2],
    )
    assert total == pytest.approx((fx, fy, tau), abs=1e-9)
    assert f[0] ** 2 + f[1] ** 2 <= (friction * load) ** 2 * (1.0 + 1e-9)
    assert found.margin >= -1e-9


def test_a_force_of_the_contact_is_given_exactly() -> None:
    point = (0.2, 0.03)
    f = (1.0, -2.0)
    found = one_press_allocator(point, 8.0, 0.9, 0.1)(*f, cross(point, f))
    assert found.status == "ok"
    assert found.forces == (f,)
    assert found.margin == pytest.approx(7.2 - 5.0**0.5)


def test_without_a_load_there_is_no_allocator() -> None:
    with pytest.raises(ValueError, match="load"):
        one_press_allocator((0.1, 0.0), 0.0, 0.5, 0.1)


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(1e-6, 1.0))
def test_only_a_moment_that_the_force_has_about_the_centre_of_pressure_is_ok(
    fx, fy, off
) -> None:
    allocate = one_press_allocator((0.12, -0.05), 8.0, 0.9, 0.1, (0.03, 0.01))
    tau = cross((0.09, -0.06), (fx, fy))
    assert allocate(fx, fy, tau).status == "ok"
    assert allocate(fx, fy, tau + off).status == "projected"
    assert allocate(fx, fy, tau - off).status == "projected"


@given(
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.floats(-0.2, 0.2),
    st.floats(0.1, 1.0),
)
def test_what_is_projected_is_the_nearest_in_the_norm_of_the_surface(
    fx, fy, off, rho
) -> None:
    """Of a load so large that the disc does not matter: the least squares of
    (f - F, (r x f - tau) / rho).
    """
    rx, ry = (0.12, -0.05)
    tau = cross((rx, ry), (fx, fy)) + off
    found = one_press_allocator((rx, ry), 50.0, 0.9, rho)(fx, fy, tau)
    rows = np.array([[1.0, 0.0], [0.0, 1.0], [-ry / rho, rx / rho]])
    nearest = np.linalg.lstsq(rows, np.array([fx, fy, tau / rho]), rcond=None)[0]
    assert found.forces[0] == pytest.approx(tuple(nearest), abs=1e-9)
    assert found.margin == pytest.approx(45.0 - math.hypot(*nearest))
