"""Laws of the allocation to two side contacts."""

import math

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from pushpressslide.allocation import orthogonal
from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.projections import WrenchCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.pose import cross
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.friction import cone_edges, cone_margin

RHO = 0.08
angles = st.floats(-math.pi, math.pi)
coordinates = st.floats(-0.3, 0.3)
frictions = st.floats(0.1, 1.4)
splits = st.sampled_from(["least_friction", "least_force"])
projections = st.sampled_from(["nearest", "force_priority", "torque_priority"])
sizes = st.just(0.0) | st.floats(1e-6, 10.0)  # [N]
wrenches = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-0.1, 0.1))
anything = st.floats(-1e50, 1e50) | st.sampled_from([math.nan, math.inf, -math.inf])


@st.composite
def side_contacts(draw):
    """Points, normals and friction of two contacts that do not face each other."""
    points = tuple((draw(coordinates), draw(coordinates)) for _ in range(2))
    assume(math.dist(*points) > 0.03)
    normals = tuple((math.cos(a), math.sin(a)) for a in (draw(angles), draw(angles)))
    line = ContactLine(*points)
    assume(max(abs(line.in_axes(n)[1]) for n in normals) > 0.05)
    return points, normals, draw(frictions)


def in_cones(contacts, k):
    """Forces with normal force k_i along each of the four cone edges."""
    _, normals, mu = contacts
    forces = []
    for i, normal in enumerate(normals):
        right, left = cone_edges(normal, mu)
        a = k[2 * i]
        b = k[2 * i + 1]
        forces.append((a * right[0] + b * left[0], a * right[1] + b * left[1]))
    return forces


@given(side_contacts(), st.tuples(sizes, sizes, sizes, sizes), splits)
def test_a_wrench_of_the_cones_is_realised_exactly_inside_them(contacts, k, split):
    points, normals, mu = contacts
    wanted = wrench_of_forces(points, in_cones(contacts, k))
    out = two_contact_allocator(*contacts, RHO, split=split)(*wanted[:3])
    largest = max(1.0, *(math.hypot(*f) for f in out.forces))
    assert out.status == "ok"
    assert wrench_of_forces(points, out.forces)[:3] == pytest.approx(
        wanted[:3], abs=1e-9 * largest
    )
    margins = [cone_margin(f, n, mu) for f, n in zip(out.forces, normals, strict=True)]
    assert min(margins) >= -1e-9 * largest
    assert out.margin == pytest.approx(min(margins), abs=1e-9 * largest)
    assert out.normals == pytest.approx(
        [f[0] * n[0] + f[1] * n[1] for f, n in zip(out.forces, normals, strict=True)],
        abs=1e-9 * largest,
    )


@given(side_contacts(), wrenches, projections, splits)
def test_any_wrench_gets_forces_inside_the_cones_and_an_honest_residual(
    contacts, wrench, projection, split
):
    points, normals, mu = contacts
    out = two_contact_allocator(*contacts, RHO, projection=projection, split=split)(
        *wrench
    )
    largest = max(1.0, *(math.hypot(*f) for f in out.forces))
    margins = [cone_margin(f, n, mu) for f, n in zip(out.forces, normals, strict=True)]
    assert min(margins) >= -1e-9 * largest
    assert out.margin == pytest.approx(min(margins), abs=1e-9 * largest)
    realised = wrench_of_forces(points, out.forces)
    for wanted, got, missing in zip(wrench, realised[:3], out.residual, strict=True):
        assert wanted - got == pytest.approx(missing, abs=1e-9 * largest)
    error, size = (abs(x) + abs(y) + abs(t) / RHO for x, y, t in (out.residual, wrench))
    if not 0.5e-9 * size < error < 2e-9 * size:
        assert (out.status == "ok") == (error <= 1e-9 * size)


@given(side_contacts(), st.tuples(sizes, sizes, sizes, sizes), st.floats(-1.0, 1.0))
def test_no_other_split_has_less_friction(contacts, k, step):
    points, normals, mu = contacts
    wanted = wrench_of_forces(points, in_cones(contacts, k))
    f1, f2 = two_contact_allocator(*contacts, RHO)(*wanted[:3]).forces

    def friction(a, b):
        return cross(normals[0], a) ** 2 + cross(normals[1], b) ** 2

    ex, ey = ContactLine(*points).e
    other = (
        (f1[0] + step * ex, f1[1] + step * ey),
        (f2[0] - step * ex, f2[1] - step * ey),
    )
    if all(cone_margin(f, n, mu) >= 0.0 for f, n in zip(other, normals, strict=True)):
        assert friction(f1, f2) <= friction(*other) + 1e-9 * (
            1.0 + math.hypot(*f1) ** 2
        )


@pytest.mark.parametrize("split", ["least_friction", "least_force"])
@given(
    contacts=side_contacts(),
    k=st.tuples(sizes, sizes, sizes, sizes),
    scale=st.floats(0.1, 10.0),
)
def test_forces_scale_with_the_wrench(split, contacts, k, scale):
    wanted = wrench_of_forces(contacts[0], in_cones(contacts, k))
    allocate = two_contact_allocator(*contacts, RHO, split=split)
    one = allocate(*wanted[:3])
    many = allocate(*(scale * w for w in wanted[:3]))
    for a, b in zip(one.forces, many.forces, strict=True):
        largest = max(1.0, *(math.hypot(*f) for f in one.forces))
        assert b == pytest.approx(
            (scale * a[0], scale * a[1]), abs=1e-8 * largest * max(1.0, scale)
        )


@pytest.mark.parametrize("mu", [0.2, 0.5, 0.9, 1.0, 1.3])
@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_orthogonal_pushes_are_those_of_section_6(mu, p, q, t):
    d = 0.1
    wrench = (p, -q, t * d)
    out = two_contact_allocator(
        ((-d, 0.0), (0.0, d)), ((1.0, 0.0), (0.0, -1.0)), mu, RHO
    )(*wrench)
    conditions = orthogonal.feasibility(*wrench, d, mu)
    if abs(conditions.spare) > 1e-9:
        assert (out.status == "ok") == conditions.feasible
    if conditions.spare > 1e-9:
        low, high = orthogonal.friction_interval(*wrench, d, mu)
        u = min(max(-0.5 * t, low), high)
        assert out.forces[0] == pytest.approx((p + t + u, u), abs=1e-9)
        for ours, closed in zip(
            out.forces, orthogonal.forces(*wrench, d, mu), strict=True
        ):
            assert ours == pytest.approx(closed, abs=1e-9)


@given(st.floats(0.0, 2.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), frictions)
def test_parallel_pushes_are_those_of_section_5(fx, fy, m, mu):
    d_x = 0.1
    w = 0.06
    tau = w * m - d_x * fy
    points = ((-d_x, w), (-d_x, -w))
    out = two_contact_allocator(points, ((1.0, 0.0), (1.0, 0.0)), mu, RHO)(fx, fy, tau)
    spare = min(fx - abs(m), mu * fx - abs(fy))
    if abs(spare) > 1e-9:
        assert (out.status == "ok") == (spare > 0.0)
    if spare > 1e-9:
        assert out.normals == pytest.approx((0.5 * (fx - m), 0.5 * (fx + m)), abs=1e-9)
        bounds = (
            max(-mu * out.normals[0], fy - mu * out.normals[1]),
            min(mu * out.normals[0], fy + mu * out.normals[1]),
        )
        assert out.forces[0][1] == pytest.approx(
            min(max(0.5 * fy, bounds[0]), bounds[1]), abs=1e-9
        )


@given(
    side_contacts(),
    st.tuples(sizes, sizes, sizes, sizes),
    st.tuples(st.floats(0.1, 5.0), st.floats(0.1, 5.0)),
)
def test_caps_are_kept_and_only_scale_a_wrench_that_needs_more(contacts, k, caps):
    wanted = wrench_of_forces(contacts[0], in_cones(contacts, k))
    free = two_contact_allocator(*contacts, RHO)(*wanted[:3])
    out = two_contact_allocator(*contacts, RHO, caps=caps)(*wanted[:3])
    slack = 1e-9 * max(1.0, *(math.hypot(*f) for f in free.forces))
    assert all(n <= cap + slack for n, cap in zip(out.normals, caps, strict=True))
    if all(n <= cap for n, cap in zip(free.normals, caps, strict=True)):
        assert out == free
    kept = [
        1.0 - r / w
        for r, w in zip(out.residual, wanted[:3], strict=True)
        if abs(w) > 1e-3
    ]
    assert max(kept, default=1.0) - min(kept, default=1.0) < 1e-5
    assert all(-1e-9 <= part <= 1.0 + 1e-6 for part in kept)


@given(
    side_contacts(),
    st.tuples(sizes, sizes, sizes, sizes),
    st.tuples(st.floats(0.1, 5.0), st.floats(0.1, 5.0)),
)
def test_no_larger_part_of_a_wrench_keeps_the_caps(contacts, k, caps):
    wanted = wrench_of_forces(contacts[0], in_cones(contacts, k))
    assume(math.hypot(*wanted[:2]) > 0.1)
    allocate = two_contact_allocator(*contacts, RHO, caps=caps)
    out = allocate(*wanted[:3])
    assume(out.status == "projected")
    part = 1.0 - math.hypot(*out.residual[:2]) / math.hypot(*wanted[:2])
    assert allocate(*(1.001 * part * w for w in wanted[:3])).status == "projected"
    assert allocate(*(0.999 * part * w for w in wanted[:3])).status == "ok"


def test_a_cap_on_one_contact_is_met_by_the_other_where_friction_allows():
    points = ((-0.1, 0.0), (0.0, 0.1))
    normals = ((1.0, 0.0), (0.0, -1.0))
    free = two_contact_allocator(points, normals, 0.6, RHO)(5.0, -3.0, 0.0)
    capped = two_contact_allocator(points, normals, 0.6, RHO, caps=(4.5, 10.0))(
        5.0, -3.0, 0.0
    )
    assert free.normals[0] > 4.5
    assert capped.status == "ok"
    assert capped.normals[0] == pytest.approx(4.5)


@example(
    contacts=(((-0.1, 0.0), (0.0, 0.1)), ((1.0, 0.0), (0.0, -1.0)), 1.0),
    wrench=(1.0, 0.0, 0.0),
)
@given(side_contacts(), st.tuples(anything, anything, anything))
def test_nothing_raises_and_what_is_no_number_is_not_ok(contacts, wrench):
    for projection in ("nearest", "force_priority", "torque_priority"):
        for caps in ((math.inf, math.inf), (1.0, 2.0)):
            out = two_contact_allocator(
                *contacts, RHO, projection=projection, caps=caps
            )(*wrench)
            assert out.status in ("ok", "projected", "infeasible")
            if not all(math.isfinite(w) for w in wrench):
                assert out.status != "ok"


@pytest.mark.parametrize(
    ("points", "normal"),
    [
        (((-0.1, 0.05), (-0.1, -0.05)), (1.0, 0.0)),
        (((0.05, 0.1), (-0.05, 0.1)), (0.0, -1.0)),
    ],
)
def test_a_pull_is_infeasible_and_gets_no_force(points, normal):
    x, y = normal
    allocate = two_contact_allocator(points, (normal, normal), 0.5, RHO)
    out = allocate(-x, -y, 0.0)
    assert out.status == "infeasible"
    assert out.normals == (0.0, 0.0)
    assert out.residual == (-x, -y, 0.0)


@pytest.mark.parametrize("tau", [math.inf, -math.inf])
def test_a_moment_without_end_gets_no_force_though_its_force_could_be_kept(tau):
    allocate = two_contact_allocator(
        ((-0.1, 0.05), (-0.1, -0.05)),
        ((1.0, 0.0), (1.0, 0.0)),
        0.5,
        RHO,
        projection="force_priority",
    )
    assert allocate(1.0, 0.0, 0.0).status == "ok"
    out = allocate(1.0, 0.0, tau)
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0), (0.0, 0.0))


def test_no_wrench_needs_no_force():
    out = two_contact_allocator(
        ((-0.1, 0.0), (0.0, 0.1)), ((1.0, 0.0), (0.0, -1.0)), 0.5, RHO
    )(0.0, 0.0, 0.0)
    assert out.status == "ok"
    assert out.normals == (0.0, 0.0)


def test_the_split_of_least_force_squeezes_less_and_is_nearer_to_slipping():
    points = ((-0.1, 0.0), (0.0, 0.1))
    normals = ((1.0, 0.0), (0.0, -1.0))
    away = two_contact_allocator(points, normals, 0.5, RHO)(1.0, -1.0, 0.0)
    least = two_contact_allocator(points, normals, 0.5, RHO, split="least_force")(
        1.0, -1.0, 0.0
    )
    assert sum(least.normals) < sum(away.normals)
    assert least.margin == pytest.approx(0.0, abs=1e-12)
    assert away.margin == pytest.approx(0.5)


def test_contacts_that_face_each_other_can_squeeze_but_not_choose_by_friction():
    points = ((-0.1, 0.0), (0.1, 0.0))
    normals = ((1.0, 0.0), (-1.0, 0.0))
    with pytest.raises(ValueError, match="face each other"):
        two_contact_allocator(points, normals, 0.5, RHO)
    out = two_contact_allocator(points, normals, 0.5, RHO, split="least_force")(
        0.0, 3.0, 0.0
    )
    assert out.status == "ok"
    assert out.normals == pytest.approx((3.0, 3.0))
    assert WrenchCone(points, normals, 0.5, RHO).margin(0.3, -7.0, 0.2) == math.inf


@pytest.mark.parametrize("friction", [-0.1, math.nan, math.inf])
def test_a_friction_that_cannot_be_is_refused(friction):
    with pytest.raises(ValueError, match="friction"):
        two_contact_allocator(
            ((-0.1, 0.0), (0.0, 0.1)), ((1.0, 0.0), (0.0, -1.0)), friction, RHO
        )


def test_contacts_in_one_place_are_refused():
    with pytest.raises(ValueError, match="distinct"):
        two_contact_allocator(
            ((0.1, 0.0), (0.1, 0.0)), ((1.0, 0.0), (0.0, -1.0)), 0.5, RHO
        )


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("size", [math.inf, -math.inf, math.nan])
@pytest.mark.parametrize("projection", ["nearest", "force_priority", "torque_priority"])
def test_a_wrench_without_end_gets_no_force(axis, size, projection):
    allocate = two_contact_allocator(
        ((-0.1, 0.05), (-0.1, -0.05)),
        ((1.0, 0.0), (1.0, 0.0)),
        0.5,
        RHO,
        projection=projection,
    )
    wrench = [1.0, 0.0, 0.0]
    wrench[axis] = size
    out = allocate(*wrench)
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0), (0.0, 0.0))
