"""Normal loads of two presses (docs/mechanics.md, section 7)."""

import math
import random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.allocation.press_loads import TwoPresses, wall_hold, wall_press
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

components = st.floats(-1.0, 1.0)
twists = st.tuples(components, components, st.floats(-5.0, 5.0)).filter(
    lambda t: math.hypot(*t) > 0.05
)
coordinates = st.floats(0.1, 0.35)


def pair(**changes):
    """Two presses on a 0.6 x 0.8 m box of 3 kg."""
    given_ = {
        "left": (0.0, 0.3),
        "right": (0.0, -0.3),
        "weight": 29.43,
        "support_friction": 0.3,
        "contact_friction": 0.8,
        "rho": 0.27,
        "cap": 200.0,
    }
    return TwoPresses(**{**given_, **changes})


pairs = st.builds(
    lambda left, right, x, mu_s, extra, rho: pair(
        left=(x, left),
        right=(-x, -right),
        support_friction=mu_s,
        contact_friction=mu_s * extra,
        rho=rho,
    ),
    coordinates,
    coordinates,
    st.floats(-0.05, 0.05),
    st.floats(0.1, 0.4),
    st.floats(1.2, 4.0),
    st.floats(0.1, 0.3),
)


def assert_drives(presses, loads, twist):
    """The loads give the wrench on the limit surface that goes with their own centre of
    pressure.
    """
    total = presses.weight + sum(loads.normals)
    cop = [
        sum(
            n * p[i]
            for n, p in zip(loads.normals, (presses.left, presses.right), strict=True)
        )
        / total
        for i in (0, 1)
    ]
    assert loads.cop == pytest.approx(cop, abs=1e-12)
    surface = EllipsoidLimitSurface(
        presses.support_friction * total, presses.rho, loads.cop
    )
    realised = wrench_of_forces((presses.left, presses.right), loads.forces, loads.cop)
    assert realised[:3] == pytest.approx(surface.wrench(twist)[:3], abs=1e-7 * total)
    for force, normal in zip(loads.forces, loads.normals, strict=True):
        assert math.hypot(*force) <= presses.contact_friction * normal + 1e-9 * total


@given(pairs, twists, st.floats(0.05, 0.95))
def test_loads_in_a_ratio_drive_the_twist_and_nothing_less_does(presses, nu, share):
    twist = Twist(*nu)
    loads = presses.for_share(share, twist)
    assume(loads.status == "ok")
    assert_drives(presses, loads, twist)
    assert loads.normals[1] == pytest.approx(share * sum(loads.normals))
    assert max(loads.normals) <= presses.cap * (1.0 + 1e-12)
    assert (
        presses.loads_for(tuple(0.999 * n for n in loads.normals), twist).status
        == "infeasible"
    )


@given(twists, st.floats(0.33, 1.2), st.floats(1.0, 5.0))
def test_more_press_never_hurts_where_the_centre_of_pressure_stays(nu, mu_a, more):
    presses = pair(contact_friction=mu_a)
    twist = Twist(*nu)
    loads = presses.for_share("balanced", twist)
    assume(loads.status == "ok")
    assert (
        presses.loads_for(tuple(more * n for n in loads.normals), twist).status == "ok"
    )


def test_more_press_can_hurt_where_it_moves_the_centre_of_pressure_and_enough_is_found_all_the_same():
    presses = TwoPresses(
        (0.03125, 0.35), (-0.03125, -0.156), 29.43, 0.25, 0.29, 0.2, 400.0
    )
    twist = Twist(0.0, 0.0, 1.0)
    share = 0.1
    loads = presses.for_share(share, twist)
    assert loads.status == "ok"
    assert loads.normals[1] == pytest.approx(share * sum(loads.normals))
    assert (
        presses.loads_for(tuple(1.01 * n for n in loads.normals), twist).status == "ok"
    )
    assert (
        presses.loads_for(tuple(2.0 * n for n in loads.normals), twist).status
        == "infeasible"
    )


@given(pairs, twists, st.floats(0.1, 0.9))
def test_the_centre_of_pressure_goes_where_it_is_asked_for(presses, nu, fraction):
    twist = Twist(*nu)
    loads = presses.for_cop(fraction, twist)
    assume(loads.status == "ok")
    assert_drives(presses, loads, twist)
    lx, ly = presses.left
    rx, ry = presses.right
    along = (loads.cop[0] - lx) * (rx - lx) + (loads.cop[1] - ly) * (ry - ly)
    assert along / math.dist(presses.left, presses.right) ** 2 == pytest.approx(
        fraction, abs=1e-9
    )


@given(twists, st.floats(0.1, 0.9))
def test_for_a_centre_of_pressure_on_the_line_through_the_com_nothing_less_does(
    nu, fraction
):
    presses = pair()
    twist = Twist(*nu)
    loads = presses.for_cop(fraction, twist)
    assume(loads.status == "ok")
    total = presses.weight + sum(loads.normals)
    less = 0.99 * total  # with the same centre of pressure
    right = fraction * less - 0.5 * presses.weight
    assume(0.0 < right < less - presses.weight)
    lighter = presses.loads_for((less - presses.weight - right, right), twist)
    assert lighter.cop == pytest.approx(loads.cop, abs=1e-9)
    assert lighter.status == "infeasible"


@given(pairs, twists)
def test_the_least_press_needs_no_more_than_an_even_one(presses, nu):
    twist = Twist(*nu)
    least = presses.for_least_press(twist)
    even = presses.for_share("balanced", twist)
    if even.status == "ok":
        assert least.status == "ok"
        assert_drives(presses, least, twist)
        assert sum(least.normals) <= 1.02 * sum(even.normals)


def test_no_ratio_of_many_needs_less_than_the_least_press():
    rng = random.Random(3)
    for _ in range(25):
        presses = pair(
            left=(0.02, rng.uniform(0.1, 0.35)),
            right=(-0.02, -rng.uniform(0.1, 0.35)),
            rho=rng.uniform(0.1, 0.3),
        )
        twist = Twist(
            rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-5.0, 5.0)
        )
        least = sum(presses.for_least_press(twist).normals)
        found = [presses.for_share(share / 60, twist) for share in range(1, 60)]
        assert least <= 1.005 * min(
            sum(loads.normals) for loads in found if loads.status == "ok"
        )


@given(pairs, twists, st.sampled_from(["left", "right"]))
def test_a_side_moves_the_centre_of_pressure_there(presses, nu, side):
    twist = Twist(*nu)
    loads = presses.for_share(side, twist)
    assume(loads.status == "ok")
    assert_drives(presses, loads, twist)
    lighter, heavier = loads.normals if side == "right" else loads.normals[::-1]
    assert lighter <= heavier + 1e-9


@given(st.floats(0.3, 0.9), st.floats(0.05, 0.3))
def test_turning_on_the_spot_needs_its_part_of_the_load_on_each_contact(mu_a, rho):
    presses = pair(contact_friction=mu_a, rho=rho)
    r = presses.least_fraction
    assume(r < 0.45)
    left = (1.0 - r) * 80.0 - presses.weight  # N_R = r N, N_L the rest
    assume(left > 1.0)

    def status(part):
        normals = (80.0 * (1.0 - part) - presses.weight, 80.0 * part)
        cop = (0.0, (0.3 * normals[0] - 0.3 * normals[1]) / 80.0)
        return presses.loads_for(normals, Twist(0.0, 0.0, 1.0, cop)).status

    assume(r * 80.0 < 80.0 * (1.0 - r) - presses.weight)
    assert status(1.0001 * r) == "ok"
    assert status(0.9999 * r) == "infeasible"


@given(twists, st.floats(0.45, 1.5), st.floats(0.05, 0.3))
def test_the_press_for_every_twist_drives_every_twist(nu, mu_a, rho):
    presses = pair(contact_friction=mu_a, rho=rho)
    total = presses.press_for_every_twist()
    assume(math.isfinite(total) and total > 1e-3)
    assert presses.loads_for((0.5 * total, 0.5 * total), Twist(*nu)).status == "ok"


def test_the_press_for_every_twist_is_tight():
    presses = pair()
    total = 0.999 * presses.press_for_every_twist()
    fan = [
        Twist(math.cos(a), 0.0, math.sin(a) / presses.rho)
        for a in (i * math.pi / 500 for i in range(500))
    ]
    assert any(
        presses.loads_for((0.5 * total, 0.5 * total), twist).status == "infeasible"
        for twist in fan
    )


def test_no_press_is_enough_where_the_support_grips_more_than_the_tips():
    presses = pair(contact_friction=0.29)
    assert presses.press_for_every_twist() == math.inf
    for loads in (
        presses.for_share("balanced", Twist(1.0, 0.0, 0.0)),
        presses.for_cop(0.5, Twist(1.0, 0.0, 0.0)),
    ):
        assert loads.status == "infeasible"
        assert loads.needed > sum(loads.normals)


def test_a_centre_of_pressure_out_of_reach_gives_the_least_press_instead():
    loads = pair().for_cop(0.02, Twist(1.0, 0.0, 0.0))
    assert loads.status == "projected"
    assert loads == pair().for_least_press(Twist(1.0, 0.0, 0.0))._replace(
        status="projected"
    )


def test_pressing_only_one_contact_cannot_pivot_about_it():
    """The paper drops N_R to zero for this; a contact that does not press transmits no
    force.
    """
    presses = pair()
    assert (
        presses.loads_for((60.0, 0.0), Twist(0.0, 0.0, 1.0, presses.left)).status
        == "infeasible"
    )


WALL = {"left": (-0.2, 0.0), "right": (0.2, 0.0), "weight": 0.0}


@given(st.floats(0.2, 1.2), st.floats(0.1, 1.2), st.floats(-1.0, 1.0))
def test_on_a_wall_the_least_press_slides_the_object_and_nothing_less_does(
    mu_a, mu_w, up
):
    weight = 4.0
    total = wall_press(weight, mu_a, mu_w, up)
    assume(total < 100.0)
    presses = pair(**WALL, contact_friction=mu_a, support_friction=mu_w)
    twist = Twist(math.sqrt(1.0 - up * up), up, 0.0)

    def status(press):
        return presses.loads_for(
            (0.5 * press, 0.5 * press), twist, gravity=(0.0, -weight)
        ).status

    assert status((1.0 + 1e-3) * total) == "ok"
    assert status((1.0 - 1e-3) * total) == "infeasible"


def test_press_on_a_wall_up_sideways_down_and_at_rest():
    mg = 4.0
    mu_a = 0.8
    mu_w = 0.3
    assert wall_press(mg, mu_a, mu_w, 1.0) == pytest.approx(mg / (mu_a - mu_w))
    assert wall_press(mg, mu_a, mu_w, 0.0) == pytest.approx(
        mg / math.sqrt(mu_a**2 - mu_w**2)
    )
    assert wall_press(mg, mu_a, mu_w, -1.0) == pytest.approx(wall_hold(mg, mu_a, mu_w))
    assert wall_hold(mg, mu_a, mu_w) == pytest.approx(mg / (mu_a + mu_w))
    assert wall_press(mg, 0.3, 0.3, 1.0) == wall_press(mg, 0.2, 0.3, 0.0) == math.inf


@given(st.floats(-1.0, 1.0), components, st.floats(-3.0, 3.0))
def test_on_a_wall_the_loads_carry_the_weight_too(vx, vy, w):
    assume(math.hypot(vx, vy, w) > 0.05)
    presses = pair(**WALL)
    weight = 4.0
    twist = Twist(vx, vy, w)
    loads = presses.for_share("balanced", twist, gravity=(0.0, -weight))
    assert loads.status == "ok"
    assert loads.cop == pytest.approx((0.0, 0.0), abs=1e-12)
    slide = EllipsoidLimitSurface(
        presses.support_friction * sum(loads.normals), presses.rho
    ).wrench(twist)
    realised = wrench_of_forces((presses.left, presses.right), loads.forces)
    assert realised[:3] == pytest.approx(
        (slide.fx, slide.fy + weight, slide.tau), abs=1e-6
    )


def test_moments_about_the_com_turn_an_object_that_was_meant_to_translate():
    """Section 7: CoP (0, 0.1875) m, rho 0.2 m, a force of 1 N along x without moment
    about the CoM.
    """
    surface = EllipsoidLimitSurface(1.0, 0.2, (0.0, 0.1875))
    meant = Wrench(1.0, 0.0, 0.0)
    twist = surface.twist_direction(meant)
    assert twist.w / twist.vx == pytest.approx(4.6875)
    correct = surface.wrench(Twist(1.0, 0.0, 0.0)).moved_to((0.0, 0.0))
    assert surface.twist_direction(correct).w == pytest.approx(0.0, abs=1e-12)
    points = ((0.0, 0.3), (0.0, -0.3))
    out = two_press_allocator(points, 0.8)(1.0, 0.0, 0.0, (10.0, 10.0), (0.0, 0.1875))
    assert wrench_of_forces(points, out.forces, (0.0, 0.1875)).tau == pytest.approx(
        0.0, abs=1e-12
    )
