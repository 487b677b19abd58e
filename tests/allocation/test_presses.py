"""Laws of the allocation to two presses (docs/mechanics.md, section 7)."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.presses import (
    largest_scale,
    least_press,
    least_presses,
    two_press_allocator,
)
from pushpressslide.mechanics.contacts import wrench_of_forces

coordinates = st.floats(-0.3, 0.3)
points_of_two = st.tuples(
    st.tuples(coordinates, coordinates), st.tuples(coordinates, coordinates)
).filter(lambda p: math.dist(*p) > 0.03)
frictions = st.floats(0.1, 1.4)
normal_forces = st.just(0.0) | st.floats(1e-3, 20.0)
presses = st.tuples(normal_forces, normal_forces)
shares = st.just(0.0) | st.floats(1e-6, 0.999)
angles = st.floats(-math.pi, math.pi)
wrenches = st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-1.0, 1.0))
anything = st.floats(-1e50, 1e50) | st.sampled_from([math.nan, math.inf, -math.inf])


@given(
    points_of_two,
    frictions,
    presses,
    st.tuples(coordinates, coordinates),
    st.tuples(shares, shares),
    st.tuples(angles, angles),
)
def test_a_wrench_of_the_discs_is_realised_inside_them(
    points, mu, normals, cop, parts, turns
):
    forces = [
        (mu * n * k * math.cos(a), mu * n * k * math.sin(a))
        for n, k, a in zip(normals, parts, turns, strict=True)
    ]
    wanted = wrench_of_forces(points, forces, cop)
    out = two_press_allocator(points, mu)(*wanted[:3], normals, cop)
    scale = max(1.0, *normals)
    assert out.status == "ok"
    assert out.normals == normals
    assert wrench_of_forces(points, out.forces, cop)[:3] == pytest.approx(
        wanted[:3], abs=1e-9 * scale
    )
    margins = [
        mu * n - math.hypot(*f) for n, f in zip(normals, out.forces, strict=True)
    ]
    assert min(margins) >= -1e-9 * scale
    assert out.margin == pytest.approx(min(margins), abs=1e-9 * scale)


@given(points_of_two, frictions, presses, wrenches)
def test_along_the_line_the_contacts_never_pull_against_each_other(
    points, mu, normals, wrench
):
    e = ContactLine(*points).e
    out = two_press_allocator(points, mu)(*wrench, normals)
    along = [f[0] * e[0] + f[1] * e[1] for f in out.forces]
    assert sum(map(abs, along)) == pytest.approx(
        abs(sum(along)), abs=1e-9 * (1.0 + sum(normals))
    )


@given(
    points_of_two,
    frictions,
    st.tuples(st.floats(0.1, 20.0), st.floats(0.1, 20.0)),
    wrenches,
)
def test_a_wrench_beyond_the_discs_is_scaled_onto_them(points, mu, normals, wrench):
    assume(math.hypot(*wrench) > 1e-3)
    out = two_press_allocator(points, mu)(*wrench, normals)
    parts = ContactLine(*points).components(*wrench)
    scale = min(largest_scale(parts, (mu * normals[0], mu * normals[1])), 1.0)
    realised = wrench_of_forces(points, out.forces)
    size = 1e-9 * (10.0 + sum(normals))
    assert realised[:3] == pytest.approx([scale * w for w in wrench], abs=size)
    assert out.residual == pytest.approx([(1.0 - scale) * w for w in wrench], abs=size)
    assert out.margin >= -size
    if abs(scale - 1.0) > 1e-8:
        assert out.status == "projected"
        assert abs(out.margin) <= 1e-6 * (1.0 + sum(normals))


@given(points_of_two, frictions, wrenches, st.floats(0.01, 0.99))
def test_the_least_press_in_a_ratio_is_just_enough(points, mu, wrench, share):
    assume(math.hypot(*wrench) > 1e-2)
    total = least_press(ContactLine(*points).components(*wrench), mu, share)
    allocate = two_press_allocator(points, mu)

    def status(press):
        return allocate(*wrench, ((1.0 - share) * press, share * press)).status

    assert status((1.0 + 1e-7) * total) == "ok"
    assert status((1.0 - 1e-7) * total) == "projected"


@given(points_of_two, frictions, wrenches, st.floats(0.0, 1.0))
def test_no_ratio_needs_less_than_the_least_presses(points, mu, wrench, share):
    parts = ContactLine(*points).components(*wrench)
    normals = least_presses(parts, mu)
    assert sum(normals) <= least_press(parts, mu, share) + 1e-9
    enough = tuple(n * (1.0 + 1e-9) + 1e-12 for n in normals)
    assert two_press_allocator(points, mu)(*wrench, enough).status == "ok"


@given(
    points_of_two,
    frictions,
    st.tuples(anything, anything, anything),
    st.tuples(anything, anything),
)
def test_nothing_raises_and_what_is_no_number_is_not_ok(points, mu, wrench, normals):
    out = two_press_allocator(points, mu)(*wrench, normals)
    assert out.status in ("ok", "projected", "infeasible")
    if not all(math.isfinite(w) for w in wrench) or not all(
        n < math.inf for n in normals
    ):
        assert out.status != "ok"


def test_a_contact_that_does_not_press_gives_nothing():
    allocate = two_press_allocator(((0.0, 0.2), (0.0, -0.2)), 0.6)
    assert allocate(1.0, 0.0, 0.0, (10.0, 0.0)).status == "infeasible"
    assert allocate(1.0, 0.0, -0.2, (10.0, 0.0)).status == "ok"
    assert allocate(1.0, 0.0, 0.0, (10.0, -1.0)).status == "infeasible"


def test_contacts_in_one_place_are_refused():
    with pytest.raises(ValueError, match="distinct"):
        two_press_allocator(((0.1, 0.0), (0.1, 0.0)), 0.6)


def test_a_wrench_of_nothing_can_be_scaled_without_end():
    assert largest_scale((0.0, 0.0, 0.0), (1.0, 2.0)) == math.inf
    assert largest_scale((3.0, 0.0, 0.0), (1.0, 2.0)) == pytest.approx(1.0)
    assert largest_scale((0.0, 1.0, 0.0), (1.0, 2.0)) == pytest.approx(1.0)
