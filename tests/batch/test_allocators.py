"""Allocators on arrays answer like the single ones, row by row."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.batch.allocations import INFEASIBLE, OK, PROJECTED
from pushpressslide.batch.one_contact import OneContact
from pushpressslide.batch.parallel import ParallelPushes
from pushpressslide.batch.press_and_push import PressAndPush
from pushpressslide.batch.presses import OnePress, TwoPresses
from pushpressslide.batch.two_contacts import TwoContacts
from pushpressslide.mechanics.contacts import wrench_of_forces

CASES = 400
CODES = {"ok": OK, "projected": PROJECTED, "infeasible": INFEASIBLE}
INF = (math.inf, math.inf)
BEHIND = ((-0.1, 0.06), (-0.1, -0.06))
ORTHOGONAL = ((-0.1, 0.0), (0.0, 0.1))
ORTHOGONAL_NORMALS = ((1.0, 0.0), (0.0, -1.0))
CORNER = ((-0.1, 0.03), (0.04, 0.08))
CORNER_NORMALS = ((1.0, 0.0), (-0.6, -0.8))
RHO = 0.08
NOT_FINITE = (math.nan, math.inf, -math.inf)


def random_wrenches(rng):
    wrenches = rng.normal(size=(CASES, 3)) * (1.0, 1.0, 0.05)
    wrenches[rng.random(CASES) < 0.3, 2] *= 0.05
    return wrenches


def units(angles):
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def degenerate_wrenches():
    rows = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1e-3)]
    rows += [(1.0, 0.5, 0.0), (1.0, -0.5, 0.0), (1.0, 0.5, -0.05), (1e-300, 0.0, 0.0)]
    for bad in NOT_FINITE:
        rows += [(bad, 0.0, 0.0), (0.0, bad, 0.0), (0.0, 0.0, bad), (bad, bad, bad)]
    return np.array(rows)


def assert_alike(batch, single, tolerance=1e-9):
    """Same statuses; same numbers to round-off."""
    assert batch.status.tolist() == [CODES[a.status] for a in single]
    for name in ("forces", "normals", "margin", "residual"):
        got = getattr(batch, name)
        expected = np.array([getattr(a, name) for a in single])
        np.testing.assert_allclose(got, expected, rtol=tolerance, atol=tolerance)


def as_points(rows):
    return [tuple(map(tuple, row)) for row in rows.tolist()]


@pytest.mark.parametrize("split", ["least_friction", "least_force"])
@pytest.mark.parametrize("capped", [False, True])
def test_two_contacts_anywhere(engine, split, capped):
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.1, 0.1, (CASES, 2, 2))
    normals = units(rng.uniform(-math.pi, math.pi, (CASES, 2)))
    normals[:20, 1] = normals[:20, 0]
    friction = rng.uniform(0.1, 1.4, CASES)
    friction[:50] = 0.0
    rho = rng.uniform(0.03, 0.1, CASES)
    caps = (
        rng.uniform(0.2, 1.0, (CASES, 2)) if capped else np.full((CASES, 2), math.inf)
    )
    line = points[:, 1] - points[:, 0]
    line /= np.linalg.norm(line, axis=1)[:, None]
    across = np.abs(
        line[:, None, 0] * normals[..., 1] - line[:, None, 1] * normals[..., 0]
    )
    chosen = np.flatnonzero(across.max(1) > 0.05)
    wrenches = random_wrenches(rng)
    batch = TwoContacts(
        points[chosen],
        normals[chosen],
        friction[chosen],
        rho[chosen],
        caps=caps[chosen],
        split=split,
    ).allocate(wrenches[chosen])
    pairs = as_points(points)
    directions = as_points(normals)
    single = [
        two_contact_allocator(
            pairs[i],
            directions[i],
            float(friction[i]),
            float(rho[i]),
            caps=caps[i].tolist(),
            split=split,
        )(*wrenches[i].tolist())
        for i in chosen.tolist()
    ]
    assert_alike(batch, single, 1e-8)
    assert {OK, PROJECTED} <= set(batch.status.tolist())


@pytest.mark.parametrize("friction", [0.0, 0.5, 1.0, 1.3])
@pytest.mark.parametrize("caps", [INF, (0.4, 0.3)])
@pytest.mark.parametrize(
    ("points", "normals"),
    [
        (ORTHOGONAL, ORTHOGONAL_NORMALS),
        (CORNER, CORNER_NORMALS),
        (BEHIND, ((1.0, 0.0), (1.0, 0.0))),
        (((0.0, 0.0), (0.0, 0.1)), ORTHOGONAL_NORMALS),
    ],
)
def test_two_contacts_where_cases_meet(engine, points, normals, friction, caps):
    wrenches = degenerate_wrenches()
    batch = TwoContacts(points, normals, friction, RHO, caps=caps).allocate(wrenches)
    allocate = two_contact_allocator(points, normals, friction, RHO, caps=caps)
    assert_alike(batch, [allocate(*wrench) for wrench in wrenches.tolist()])


@pytest.mark.parametrize("caps", [INF, (0.4, 0.3)])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_parallel_pushes(engine, caps, friction):
    rng = np.random.default_rng(1)
    wrenches = np.concatenate([random_wrenches(rng), degenerate_wrenches()])
    wrenches[:200, 0] = np.abs(wrenches[:200, 0]) + 1.0
    batch = ParallelPushes(BEHIND, (1.0, 0.0), friction, RHO, caps=caps)
    allocate = parallel_push_allocator(BEHIND, (1.0, 0.0), friction, RHO, caps=caps)
    single = [allocate(*wrench) for wrench in wrenches.tolist()]
    assert_alike(batch.allocate(wrenches), single)


def test_one_contact(engine):
    rng = np.random.default_rng(2)
    points = rng.uniform(-0.1, 0.1, (CASES, 2))
    points[:20] = 0.0
    normals = units(rng.uniform(-math.pi, math.pi, CASES))
    friction = rng.uniform(0.0, 1.4, CASES)
    friction[:50] = 0.0
    rho = rng.uniform(0.03, 0.1, CASES)
    wrenches = random_wrenches(rng)
    given = slice(0, 160)
    wrenches[given, :2] = normals[given] + 0.5 * friction[given, None] * np.stack(
        [-normals[given, 1], normals[given, 0]], axis=-1
    )
    wrenches[given, 2] = (
        points[given, 0] * wrenches[given, 1] - points[given, 1] * wrenches[given, 0]
    )
    batch = OneContact(points, normals, friction, rho).allocate(wrenches)
    rows = zip(
        points.tolist(), normals.tolist(), friction.tolist(), rho.tolist(), strict=True
    )
    single = [
        one_contact_allocator(tuple(p), tuple(n), mu, length)(*wrench)
        for (p, n, mu, length), wrench in zip(rows, wrenches.tolist(), strict=True)
    ]
    assert_alike(batch, single)
    assert set(batch.status.tolist()) == {OK, PROJECTED, INFEASIBLE}


@pytest.mark.parametrize("point", [(-0.1, 0.03), (0.0, 0.0)])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_one_contact_where_cases_meet(engine, point, friction):
    wrenches = degenerate_wrenches()
    allocate = one_contact_allocator(point, (1.0, 0.0), friction, RHO)
    batch = OneContact(point, (1.0, 0.0), friction, RHO).allocate(wrenches)
    assert_alike(batch, [allocate(*wrench) for wrench in wrenches.tolist()])


def test_one_press(engine):
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.1, 0.1, (CASES, 2))
    cops = rng.uniform(-0.05, 0.05, (CASES, 2))
    cops[:20] = points[:20]
    loads = rng.uniform(0.5, 4.0, CASES)
    friction = rng.uniform(0.0, 1.0, CASES)
    friction[:50] = 0.0
    wrenches = random_wrenches(rng)
    arm = points - cops
    wrenches[:160, 2] = (
        arm[:160, 0] * wrenches[:160, 1] - arm[:160, 1] * wrenches[:160, 0]
    )
    batch = OnePress(points, loads, friction, RHO, cops).allocate(wrenches)
    single = [
        one_press_allocator(
            tuple(points[i].tolist()),
            float(loads[i]),
            float(friction[i]),
            RHO,
            tuple(cops[i].tolist()),
        )(*wrenches[i].tolist())
        for i in range(CASES)
    ]
    for name in ("forces", "normals", "margin", "residual"):
        got = getattr(batch, name)
        expected = np.array([getattr(a, name) for a in single])
        np.testing.assert_allclose(got, expected, atol=1e-12)
    # a moment that differs from the force's by a rounding is given or is not
    differ = batch.status != [CODES[a.status] for a in single]
    assert np.abs(batch.residual[differ]).max(initial=0.0) < 1e-15
    assert {OK, PROJECTED} <= set(batch.status.tolist())


@pytest.mark.parametrize("point", [(-0.1, 0.03), (0.0, 0.0)])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_one_press_where_cases_meet(engine, point, friction):
    wrenches = degenerate_wrenches()
    allocate = one_press_allocator(point, 2.0, friction, RHO)
    batch = OnePress(point, 2.0, friction, RHO).allocate(wrenches)
    assert_alike(batch, [allocate(*wrench) for wrench in wrenches.tolist()])


def test_two_presses(engine):
    rng = np.random.default_rng(4)
    points = rng.uniform(-0.2, 0.2, (CASES, 2, 2))
    friction = rng.uniform(0.0, 1.0, CASES)
    friction[:50] = 0.0
    normals = rng.uniform(0.0, 5.0, (CASES, 2))
    normals[50:70, 0] = 0.0
    normals[70:80] = 0.0
    cops = rng.uniform(-0.1, 0.1, (CASES, 2))
    wrenches = random_wrenches(rng)
    batch = TwoPresses(points, friction).allocate(wrenches, normals, cops)
    pairs = as_points(points)
    single = [
        two_press_allocator(pairs[i], float(friction[i]))(
            *wrenches[i].tolist(), tuple(normals[i].tolist()), tuple(cops[i].tolist())
        )
        for i in range(CASES)
    ]
    # at the edge of a disc the share along the line is the root of a rounding
    assert_alike(batch, single, 1e-7)
    assert set(batch.status.tolist()) == {OK, PROJECTED, INFEASIBLE}


@pytest.mark.parametrize("normals", [(2.0, 3.0), (0.0, 3.0), (0.0, 0.0), (2.0, 1e-12)])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_two_presses_where_cases_meet(engine, normals, friction):
    wrenches = degenerate_wrenches()
    allocate = two_press_allocator(BEHIND, friction)
    batch = TwoPresses(BEHIND, friction).allocate(wrenches, normals)
    assert_alike(batch, [allocate(*wrench, normals) for wrench in wrenches.tolist()])


@pytest.mark.parametrize("bad", NOT_FINITE)
def test_two_presses_at_no_place_or_of_no_load_give_nothing(engine, bad):
    pair = TwoPresses(BEHIND, 0.5)
    nowhere = pair.allocate((1.0, 0.0, 0.0), (4.0, 4.0), (bad, 0.0))
    assert nowhere.status == INFEASIBLE
    assert (nowhere.forces == 0.0).all()
    if bad > 0.0:
        assert pair.allocate((1.0, 0.0, 0.0), (bad, 4.0)).status == INFEASIBLE


def test_press_and_push(engine):
    rng = np.random.default_rng(5)
    press = rng.uniform(-0.1, 0.1, (CASES, 2))
    push = rng.uniform(-0.1, 0.1, (CASES, 2))
    normals = units(rng.uniform(-math.pi, math.pi, CASES))
    lever = (push[:, 0] - press[:, 0]) * normals[:, 1]
    lever -= (push[:, 1] - press[:, 1]) * normals[:, 0]
    chosen = np.flatnonzero(np.abs(lever) > 1e-3)
    loads = rng.uniform(0.5, 4.0, CASES)
    friction = rng.uniform(0.0, 1.0, CASES)
    friction[:50] = 0.0
    cops = rng.uniform(-0.05, 0.05, (CASES, 2))
    wrenches = random_wrenches(rng)
    batch = PressAndPush(
        press[chosen],
        loads[chosen],
        push[chosen],
        normals[chosen],
        friction[chosen],
        cops[chosen],
    ).allocate(wrenches[chosen])
    single = [
        press_and_push_allocator(
            tuple(press[i].tolist()),
            float(loads[i]),
            tuple(push[i].tolist()),
            tuple(normals[i].tolist()),
            float(friction[i]),
            tuple(cops[i].tolist()),
        )(*wrenches[i].tolist())
        for i in chosen.tolist()
    ]
    assert_alike(batch, single)
    assert {OK, PROJECTED} <= set(batch.status.tolist())


@pytest.mark.parametrize("friction", [0.0, 0.5, 1.0])
def test_press_and_push_where_cases_meet(engine, friction):
    wrenches = degenerate_wrenches()
    contacts = ((0.05, 0.0), 2.0, (-0.1, 0.05), (1.0, 0.0), friction)
    allocate = press_and_push_allocator(*contacts)
    batch = PressAndPush(*contacts).allocate(wrenches)
    assert_alike(batch, [allocate(*wrench) for wrench in wrenches.tolist()])


def test_any_leading_shape_and_one_row_are_the_same_rows(engine):
    wrenches = np.random.default_rng(6).normal(size=(4, 3, 3)) * (1.0, 1.0, 0.05)
    pair = TwoContacts(CORNER, CORNER_NORMALS, 0.5, RHO)
    whole = pair.allocate(wrenches)
    assert whole.forces.shape == (4, 3, 2, 2)
    assert whole.ok.shape == (4, 3)
    one = pair.allocate(wrenches[2, 1])
    assert one.margin.shape == ()
    np.testing.assert_allclose(one.forces, whole.forces[2, 1])
    none = pair.allocate(np.zeros((0, 3)))
    assert none.forces.shape == (0, 2, 2)


def test_contacts_of_each_row_meet_wrenches_of_each_column(engine):
    friction = np.array([0.2, 0.5, 0.8])[:, None]
    wrenches = np.random.default_rng(7).normal(size=(5, 3)) * (1.0, 1.0, 0.05)
    table = TwoContacts(CORNER, CORNER_NORMALS, friction, RHO).allocate(wrenches)
    assert table.status.shape == (3, 5)
    for row, mu in enumerate(friction[:, 0].tolist()):
        alone = TwoContacts(CORNER, CORNER_NORMALS, mu, RHO).allocate(wrenches)
        np.testing.assert_allclose(table.forces[row], alone.forces)


milli = st.integers(-5000, 5000).map(lambda part: 1e-3 * part)


@given(st.lists(st.tuples(milli, milli, milli), min_size=1))
def test_without_friction_rows_are_possible_where_one_call_is(rows):
    spanned = [
        wrench_of_forces(ORTHOGONAL, ((a, 0.0), (0.0, -b)))[:3] for a, b, _ in rows
    ]
    wrenches = np.array(rows + spanned)
    batch = TwoContacts(ORTHOGONAL, ORTHOGONAL_NORMALS, 0.0, RHO).allocate(wrenches)
    allocate = two_contact_allocator(ORTHOGONAL, ORTHOGONAL_NORMALS, 0.0, RHO)
    single = [allocate(*wrench).status == "ok" for wrench in wrenches.tolist()]
    assert batch.ok.tolist() == single


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: OneContact((0.1, 0.0), (1.0, 0.0), -0.1, RHO), "friction -0.1; must"),
        (lambda: OneContact((math.nan, 0.0), (1.0, 0.0), 0.1, RHO), "point nan; must"),
        (lambda: OneContact((0.1, 0.0), (2.0, 0.0), 0.1, RHO), "normal 2.0; must be 1"),
        (
            lambda: OneContact((0.1, 0.0), (1.0, 0.0), 0.1, [RHO, 0.0]),
            "rho 0.0 m; must",
        ),
        (
            lambda: TwoContacts(BEHIND[:1], ORTHOGONAL_NORMALS, 0.5, RHO),
            "points .* must",
        ),
        (
            lambda: TwoContacts((BEHIND[0],) * 2, ORTHOGONAL_NORMALS, 0.5, RHO),
            "contacts 0.0 m; must",
        ),
        (
            lambda: TwoContacts(BEHIND, ORTHOGONAL_NORMALS, 0.5, RHO, caps=(0.0, 1.0)),
            "cap 0.0 N; must be > 0",
        ),
        (
            lambda: TwoContacts(BEHIND, ((0.0, -1.0), (0.0, 1.0)), 0.5, RHO),
            "'least_force'",
        ),
        (lambda: ParallelPushes(CORNER, (1.0, 0.0), 0.5, RHO), "cosine .* must be 0"),
        (lambda: OnePress((0.0, 0.0), 0.0, 0.5, RHO), "load 0.0 N; must be finite"),
        (lambda: TwoPresses(BEHIND, math.inf), "friction inf; must be finite and"),
        (
            lambda: PressAndPush((0.0, 0.0), 1.0, (-0.1, 0.0), (1.0, 0.0), 0.5),
            "lever of the push .* must be not 0",
        ),
        (
            lambda: TwoPresses(BEHIND, 0.5).allocate(np.zeros((4, 2)), (1.0, 1.0)),
            r"wrenches \(4, 2\); must be \(..., 3\)",
        ),
    ],
)
def test_what_cannot_be_is_named(make, text):
    with pytest.raises(ValueError, match=text):
        make()
