"""Laws of the allocation to one side contact."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.core.pose import cross
from pushpressslide.mechanics.contacts import wrench_of_forces

angles = st.floats(-math.pi, math.pi)
frictions = st.floats(0.1, 1.5)


def contact(angle, offset):
    """A contact on a face with inward normal at ``angle``, 7 cm from the CoM."""
    n = (math.cos(angle), math.sin(angle))
    return (-0.07 * n[0] - offset * n[1], -0.07 * n[1] + offset * n[0]), n


@given(
    angles,
    st.floats(-0.05, 0.05),
    frictions,
    st.floats(0.1, 50.0),
    st.floats(-0.999, 0.999),
)
def test_a_wrench_of_the_cone_is_realised_exactly(angle, offset, mu, fn, share):
    point, n = contact(angle, offset)
    f = (fn * (n[0] - share * mu * n[1]), fn * (n[1] + share * mu * n[0]))
    out = one_contact_allocator(point, n, mu, 0.05)(*f, cross(point, f))
    assert out.status == "ok"
    assert math.dist(out.forces[0], f) < 1e-9 * (1.0 + fn)
    assert out.margin > 0.0


@given(
    angles, st.floats(-0.05, 0.05), frictions, st.tuples(*[st.floats(-1.0, 1.0)] * 3)
)
def test_any_wrench_gets_a_force_inside_the_cone_and_an_honest_residual(
    angle, offset, mu, wrench
):
    point, n = contact(angle, offset)
    out = one_contact_allocator(point, n, mu, 0.05)(*wrench)
    f = out.forces[0]
    fn = f[0] * n[0] + f[1] * n[1]
    ft = -f[0] * n[1] + f[1] * n[0]
    assert fn >= -1e-12
    assert abs(ft) <= mu * fn + 1e-9
    realised = (*f, cross(point, f))
    assert all(
        abs(w - r - e) < 1e-12
        for w, r, e in zip(wrench, realised, out.residual, strict=True)
    )
    if max(map(abs, out.residual)) > 1e-6:
        assert out.status != "ok"


@given(
    angles,
    st.floats(-0.05, 0.05),
    frictions,
    st.tuples(*[st.floats(-1.0, 1.0)] * 2),
    st.floats(-0.05, 0.05),
)
def test_no_force_of_the_cone_is_nearer(angle, offset, mu, force, tau):
    point, n = contact(angle, offset)
    rho = 0.05

    def cost(f):
        return (
            (f[0] - force[0]) ** 2
            + (f[1] - force[1]) ** 2
            + ((cross(point, f) - tau) / rho) ** 2
        )

    def of_edges(k):
        return [
            (k[0] + k[1]) * n[0] - mu * (k[0] - k[1]) * n[1],
            (k[0] + k[1]) * n[1] + mu * (k[0] - k[1]) * n[0],
        ]

    out = one_contact_allocator(point, n, mu, rho)(*force, tau)
    best = minimize(
        lambda k: cost(of_edges(k)),
        [0.3, 0.3],
        bounds=[(0, None)] * 2,
        method="L-BFGS-B",
        tol=1e-14,
    )
    assert cost(out.forces[0]) <= best.fun + 1e-7


@pytest.mark.parametrize(
    "normal", [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.6, 0.8)]
)
def test_a_pull_is_infeasible_and_says_so(normal):
    x, y = normal
    allocate = one_contact_allocator((-0.07 * x, -0.07 * y), normal, 0.5, 0.05)
    out = allocate(-x, -y, 0.0)
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0),)
    assert allocate(x, y, 0.0).normals == pytest.approx((1.0,))


@pytest.mark.parametrize("rho", [0.02, 0.1, 0.5])
def test_a_billionth_of_the_wrench_in_the_norm_of_the_surface_decides_what_is_ok(rho):
    point = (-0.2, 0.03)
    allocate = one_contact_allocator(point, (1.0, 0.0), 0.5, rho)
    wrench = wrench_of_forces([point], [(1.0, 0.2)])
    size = 1.2 + abs(wrench.tau) / rho
    lever = 1.0 + math.hypot(*point) / rho  # the error may go into force or moment
    for error, status in ((20e-9 * lever, "projected"), (0.1e-9, "ok")):
        tau = wrench.tau + error * size * rho
        assert allocate(wrench.fx, wrench.fy, tau).status == status
