"""Two parallel pushes on one face (docs/mechanics.md, section 5)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.allocation import parallel
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_margin

D_X = 0.1
W = 0.06
RHO = 0.08
REAR = ((-D_X, W), (-D_X, -W))
FORWARD = (1.0, 0.0)
frictions = st.floats(0.1, 1.4)


def turned(v, angle):
    c = math.cos(angle)
    s = math.sin(angle)
    return (c * v[0] - s * v[1], s * v[0] + c * v[1])


@given(st.floats(-1.0, 2.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), frictions)
def test_what_is_possible_is_allocated_in_the_ratio_of_the_normal_forces(fx, fy, m, mu):
    tau = W * m - D_X * fy
    out = parallel_push_allocator(REAR, FORWARD, mu, RHO)(fx, fy, tau)
    condition = parallel.feasibility(fx, fy, tau, D_X, W, mu)
    if abs(condition.spare) > 1e-9:
        assert (out.status == "ok") == condition.feasible
    if condition.spare > 1e-9:
        assert out.normals == pytest.approx((0.5 * (fx - m), 0.5 * (fx + m)), abs=1e-9)
        for force, push in zip(out.forces, out.normals, strict=True):
            assert force == pytest.approx((push, fy * push / fx), abs=1e-9)
        assert wrench_of_forces(REAR, out.forces)[:3] == pytest.approx(
            (fx, fy, tau), abs=1e-9
        )
        assert out.margin == pytest.approx(
            min(cone_margin(f, FORWARD, mu) for f in out.forces), abs=1e-9
        )


@given(
    st.floats(-math.pi, math.pi),
    st.floats(0.1, 2.0),
    st.floats(-0.9, 0.9),
    st.floats(-0.9, 0.9),
    frictions,
)
def test_any_face_in_either_order(angle, fx, slide, turn, mu):
    fy = slide * mu * fx
    tau = W * turn * fx - D_X * fy
    fx_B, fy_B = turned((fx, fy), angle)
    points = tuple(turned(p, angle) for p in REAR)
    left, right = parallel_push_allocator(points, turned(FORWARD, angle), mu, RHO)(
        fx_B, fy_B, tau
    ).forces
    again = parallel_push_allocator(points[::-1], turned(FORWARD, angle), mu, RHO)(
        fx_B, fy_B, tau
    ).forces
    expected = parallel_push_allocator(REAR, FORWARD, mu, RHO)(fx, fy, tau).forces
    assert left == pytest.approx(turned(expected[0], angle), abs=1e-9)
    assert right == pytest.approx(turned(expected[1], angle), abs=1e-9)
    assert again[1] == pytest.approx(left, abs=1e-9)


@given(
    st.floats(0.1, 2.0),
    st.floats(-0.95, 0.95),
    st.floats(-0.95, 0.95),
    st.floats(0.2, 1.4),
)
def test_neither_contact_is_nearer_to_slipping_than_the_other(fx, slide, turn, mu):
    fy = slide * mu * fx
    wrench = (fx, fy, W * turn * fx - D_X * fy)
    out = parallel_push_allocator(REAR, FORWARD, mu, RHO)(*wrench)
    even = two_contact_allocator(REAR, (FORWARD, FORWARD), mu, RHO)(*wrench)

    def steepest(allocation):
        return max(abs(f[1]) / f[0] for f in allocation.forces)

    assert steepest(out) == pytest.approx(abs(fy) / fx)
    assert steepest(out) <= steepest(even) + 1e-9


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-0.3, 0.3), frictions)
def test_what_is_not_possible_is_moved_as_for_any_two_contacts(fx, fy, tau, mu):
    out = parallel_push_allocator(REAR, FORWARD, mu, RHO)(fx, fy, tau)
    if out.status != "ok":
        assert out == two_contact_allocator(REAR, (FORWARD, FORWARD), mu, RHO)(
            fx, fy, tau
        )


def test_caps_are_kept():
    out = parallel_push_allocator(REAR, FORWARD, 0.5, RHO, caps=(3.0, 3.0))(
        10.0, 0.0, 0.0
    )
    assert out.status == "projected"
    assert out.normals == pytest.approx((3.0, 3.0))


def test_contacts_that_are_not_on_one_face_are_refused():
    with pytest.raises(ValueError, match="right angles"):
        parallel_push_allocator(((-0.1, 0.05), (-0.08, -0.05)), FORWARD, 0.5, RHO)
