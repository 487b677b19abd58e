"""Laws of the allocation to a press and a push from the side."""

import math

import numpy as np
import pytest

from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.core.pose import cross
from pushpressslide.mechanics.contacts import wrench_of_forces

PRESS = (-0.11, 0.2)
PUSH = (-0.3, -0.2)
COP = (-0.05, 0.1)


def drawn(count: int, seed: int):
    """Contacts anywhere with a lever, and a wrench of the size that they can give."""
    rng = np.random.default_rng(seed)
    while count:
        press = tuple(rng.uniform(-0.3, 0.3, 2).tolist())
        push = tuple(rng.uniform(-0.3, 0.3, 2).tolist())
        angle = rng.uniform(-math.pi, math.pi)
        friction = rng.uniform(0.2, 1.2)
        load = rng.uniform(3.0, 60.0)
        normal = (math.cos(angle), math.sin(angle))
        if abs(cross((push[0] - press[0], push[1] - press[1]), normal)) < 0.02:
            continue
        count -= 1
        size = friction * load
        wrench = (
            *(0.8 * size * rng.normal(size=2)).tolist(),
            float(0.15 * size * rng.normal()),
        )
        cop = tuple(rng.uniform(-0.1, 0.1, 2).tolist())
        yield press, load, push, normal, friction, cop, wrench


def possible(press, load, push, normal, friction, cop, wrench) -> tuple[bool, bool]:
    """Whether some share of the force along the line of contacts is inside cone and
    disc, on a fine grid, and whether that verdict has a clear margin.
    """
    fx, fy, tau = wrench
    r = np.array(push) - np.array(press)
    e = r / np.linalg.norm(r)
    n = np.array(normal)
    a = (tau - cross((press[0] - cop[0], press[1] - cop[1]), (fx, fy))) / cross(
        tuple(r), normal
    )
    reach = abs(a) + math.hypot(fx, fy) + friction * load
    s = np.linspace(-8.0 * reach, 8.0 * reach, 80_001)[:, None]
    f2 = a * n + s * e
    f1 = np.array((fx, fy)) - f2
    slack = np.minimum(
        friction * (f2 @ n) - np.abs(f2 @ np.array((-n[1], n[0]))),
        friction * load - np.hypot(f1[:, 0], f1[:, 1]),
    )
    best = float(slack.max())
    return best > 0.0, abs(best) > 2e-3 * reach


def test_a_wrench_is_realised_exactly_whenever_some_forces_can() -> None:
    found = {True: 0, False: 0}
    for case in drawn(300, seed=0):
        *contacts, wrench = case
        can, clear = possible(*case)
        if not clear:
            continue
        out = press_and_push_allocator(*contacts)(*wrench)
        assert (out.status == "ok") == can
        found[can] += 1
    assert min(found.values()) > 60


def test_forces_and_residual_add_up_and_are_inside_cone_and_disc() -> None:
    for press, load, push, normal, friction, cop, wrench in drawn(2000, seed=1):
        out = press_and_push_allocator(press, load, push, normal, friction, cop)(
            *wrench
        )
        total = wrench_of_forces((press, push), out.forces, cop)
        given = (total.fx, total.fy, total.tau)
        for asked, got, missing in zip(wrench, given, out.residual, strict=True):
            assert got + missing == pytest.approx(
                asked, abs=1e-9 * (1.0 + friction * load)
            )
        assert out.margin >= -1e-9 * friction * load
        assert out.normals[0] == load
        if out.status == "ok":
            assert out.residual == (0.0, 0.0, 0.0)


def test_the_push_is_along_its_normal_where_the_press_can_hold_the_rest() -> None:
    allocate = press_and_push_allocator(PRESS, 60.0, PUSH, (1.0, 0.0), 0.7, COP)
    out = allocate(11.0, 6.0, 6.0)
    assert out.status == "ok"
    assert out.forces[1][1] == 0.0
    lever = cross((PUSH[0] - PRESS[0], PUSH[1] - PRESS[1]), (1.0, 0.0))
    about_press = 6.0 - cross((PRESS[0] - COP[0], PRESS[1] - COP[1]), (11.0, 6.0))
    assert out.normals[1] == pytest.approx(about_press / lever)


def test_friction_of_the_push_relieves_a_press_that_would_slip() -> None:
    wrench = (11.0, 6.0, 6.0)
    strong = press_and_push_allocator(PRESS, 60.0, PUSH, (1.0, 0.0), 0.7, COP)(*wrench)
    alone = math.hypot(*strong.forces[0])
    weak = press_and_push_allocator(
        PRESS, 0.985 * alone / 0.7, PUSH, (1.0, 0.0), 0.7, COP
    )(*wrench)
    assert weak.status == "ok"
    assert weak.forces[1][1] != 0.0
    assert math.hypot(*weak.forces[0]) == pytest.approx(0.985 * alone)


def test_a_push_never_pulls() -> None:
    out = press_and_push_allocator(PRESS, 60.0, PUSH, (1.0, 0.0), 0.7, COP)(
        0.0, 0.0, -3.0
    )
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0), (0.0, 0.0))
    assert out.residual == (0.0, 0.0, -3.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_push_never_pulls_where_an_edge_of_its_cone_is_along_the_line(
    side: float,
) -> None:
    """The line of contacts is at 45 degrees to the normal, the friction is 1."""
    allocate = press_and_push_allocator(
        (0.0, 0.0), 2.0, (0.1, side * 0.1), (1.0, 0.0), 1.0
    )
    pulled = allocate(0.5, 0.1, side * 0.02)
    assert pulled.forces == ((0.5, 0.1), (0.0, 0.0))
    assert pulled.status == "projected"
    assert allocate(0.5, 0.1, -side * 0.02).status == "ok"


@pytest.mark.parametrize(
    ("load", "normal", "field"),
    [(0.0, (1.0, 0.0), "load 0.0 N"), (5.0, (0.19, 0.40), "lever")],
)
def test_a_press_without_load_or_a_push_without_lever_is_refused(
    load: float, normal, field
) -> None:
    size = math.hypot(*normal)
    with pytest.raises(ValueError, match=field):
        press_and_push_allocator(
            PRESS, load, PUSH, (normal[0] / size, normal[1] / size), 0.7
        )


def test_the_margin_is_that_of_the_contact_nearer_to_slipping():
    pushed_nearer = 0
    for press, load, push, normal, friction, cop, wrench in drawn(400, 11):
        allocate = press_and_push_allocator(press, load, push, normal, friction, cop)
        out = allocate(*wrench)
        if out.status != "ok":
            continue
        (gx, gy), (hx, hy) = out.forces
        nx, ny = normal
        of_press = friction * load - math.hypot(gx, gy)
        of_push = friction * (hx * nx + hy * ny) - abs(nx * hy - ny * hx)
        assert out.margin == pytest.approx(min(of_press, of_push), abs=1e-9)
        pushed_nearer += of_push < of_press
    assert pushed_nearer > 20
