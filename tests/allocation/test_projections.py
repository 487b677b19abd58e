"""Projection of wrenches that two side contacts cannot produce (docs/mechanics.md,
section 6).
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import nnls

from pushpressslide.allocation import orthogonal
from pushpressslide.allocation.projections import WrenchCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.pose import cross
from pushpressslide.mechanics.friction import cone_edges

D = 0.1
RHO = 0.08
POINTS = ((-D, 0.0), (0.0, D))
NORMALS = ((1.0, 0.0), (0.0, -1.0))
parts = st.floats(-2.0, 2.0)
frictions = st.floats(0.1, 0.95)
coordinates = st.floats(-0.3, 0.3)
angles = st.floats(-math.pi, math.pi)


def edge_wrenches(points, normals, mu):
    return np.array(
        [
            (*f, cross(p, f))
            for p, n in zip(points, normals, strict=True)
            for f in cone_edges(n, mu)
        ]
    ).T


@given(
    st.tuples(coordinates, coordinates),
    st.tuples(coordinates, coordinates),
    angles,
    angles,
    st.floats(0.1, 1.4),
    st.tuples(parts, parts, st.floats(-0.2, 0.2)),
)
def test_the_nearest_wrench_is_that_of_least_squares(p1, p2, a, b, mu, wrench):
    assume(math.dist(p1, p2) > 0.03)
    normals = ((math.cos(a), math.sin(a)), (math.cos(b), math.sin(b)))
    out = two_contact_allocator((p1, p2), normals, mu, RHO, split="least_force")(
        *wrench
    )
    assume(out.status != "ok")
    weights = np.array([1.0, 1.0, 1.0 / RHO])
    _, least = nnls(
        weights[:, None] * edge_wrenches((p1, p2), normals, mu), weights * wrench
    )
    assert np.linalg.norm(weights * out.residual) == pytest.approx(least, abs=1e-9)


@given(parts, parts, parts, frictions)
def test_the_facets_are_the_inequalities_of_section_6(p, q, t, mu):
    wrench = (p, -q, t * D)
    spare = WrenchCone(POINTS, NORMALS, mu, RHO).margin(*wrench)
    conditions = orthogonal.feasibility(*wrench, D, mu)
    if abs(spare) > 1e-9:
        assert (spare > 0.0) == conditions.feasible


@given(parts, parts, parts, frictions)
def test_priority_of_the_torque_adds_the_least_diagonal_drift(p, q, t, mu):
    wrench = (p, -q, t * D)
    out = two_contact_allocator(POINTS, NORMALS, mu, RHO, projection="torque_priority")(
        *wrench
    )
    drift = orthogonal.least_drift(*wrench, D, mu)
    assert out.residual == pytest.approx((-drift, drift, 0.0), abs=1e-8)
    if drift > 1e-6:
        moved = (wrench[0] + drift, wrench[1] - drift, wrench[2])
        less = (wrench[0] + 0.999 * drift, wrench[1] - 0.999 * drift, wrench[2])
        assert orthogonal.feasibility(*moved, D, mu).spare >= -1e-9
        assert not orthogonal.feasibility(*less, D, mu).feasible


@given(st.floats(0.0, 2.0), st.floats(0.0, 2.0), parts, frictions)
def test_priority_of_the_force_clamps_the_moment(p, q, t, mu):
    assume(p + q > 1e-3)
    wrench = (p, -q, t * D)
    out = two_contact_allocator(POINTS, NORMALS, mu, RHO, projection="force_priority")(
        *wrench
    )
    low, high = orthogonal.moment_limits(p, -q, D, mu)
    kept = min(max(wrench[2], low), high)
    assert out.residual == pytest.approx((0.0, 0.0, wrench[2] - kept), abs=1e-8)


@given(parts, parts, parts, frictions)
def test_a_force_that_no_moment_makes_possible_goes_to_the_nearest_wrench(p, q, t, mu):
    wrench = (p, -q, t * D)
    forced = two_contact_allocator(
        POINTS, NORMALS, mu, RHO, projection="force_priority"
    )(*wrench)
    nearest = two_contact_allocator(POINTS, NORMALS, mu, RHO)(*wrench)
    if forced.status == "projected" and max(map(abs, forced.residual[:2])) > 1e-6:
        assert forced == nearest


@given(parts, parts, parts, frictions)
def test_the_nearest_is_no_farther_than_the_others(p, q, t, mu):
    wrench = (p, -q, t * D)

    def distance(projection):
        fx, fy, tau = two_contact_allocator(
            POINTS, NORMALS, mu, RHO, projection=projection
        )(*wrench).residual
        return math.hypot(fx, fy, tau / RHO)

    for other in ("force_priority", "torque_priority"):
        assert distance("nearest") <= distance(other) + 1e-9


def test_scaling_never_makes_a_wrench_possible():
    cone = WrenchCone(POINTS, NORMALS, 0.5, RHO)
    assert all(cone.margin(-k, 0.0, 0.0) < 0.0 for k in (1e-6, 1.0, 1e6))
