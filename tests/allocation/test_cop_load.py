"""Minimum load for a centre of pressure, against a dense search over loads."""

import math
import random

import numpy as np
import pytest
from scipy import optimize

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.cop_load import cop_friction
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.core.wrench import Twist

GRID = 2001
EXCESS = 1e-6


def drawn(rng: random.Random) -> tuple[TwoPresses, float, Twist]:
    """Two presses anywhere on either side of the CoM, a fraction, and a twist."""
    mu_s = rng.uniform(0.1, 0.6)
    presses = TwoPresses(
        left=(rng.uniform(-0.15, 0.15), rng.uniform(0.05, 0.4)),
        right=(rng.uniform(-0.15, 0.15), -rng.uniform(0.05, 0.4)),
        weight=rng.uniform(2.0, 60.0),
        support_friction=mu_s,
        contact_friction=mu_s * rng.uniform(1.02, 4.0),
        rho=rng.uniform(0.03, 0.35),
        cap=rng.choice([40.0, 100.0, 400.0]),
    )
    velocity = (rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0))
    twist = Twist(*velocity, rng.uniform(-6.0, 6.0))
    return presses, rng.uniform(0.03, 0.97), twist


def slack(presses: TwoPresses, fraction: float, twist: Twist, loads):
    """Force [N] along the line that the contacts have left at each of ``loads``;
    negative where they cannot drive the twist within the cap. Written anew from
    section 7.
    """
    left = np.array(presses.left)
    right = np.array(presses.right)
    length = np.linalg.norm(right - left)
    e = (right - left) / length
    loads = np.asarray(loads, dtype=float)
    com = -(left @ e) / length
    n_right = fraction * loads - com * presses.weight
    n_left = loads - presses.weight - n_right
    cop = (n_left[..., None] * left + n_right[..., None] * right) / loads[..., None]
    v = np.stack(
        [twist.vx - twist.w * cop[..., 1], twist.vy + twist.w * cop[..., 0]], axis=-1
    )
    speed = np.sqrt((v**2).sum(-1) + (presses.rho * twist.w) ** 2)
    size = presses.support_friction * loads / speed
    force = size[..., None] * v
    torque = size * presses.rho**2 * twist.w

    def moment(point):
        arm = point - cop
        return torque - (arm[..., 0] * force[..., 1] - arm[..., 1] * force[..., 0])

    mu = presses.contact_friction
    rest_right = (mu * n_right) ** 2 - (moment(left) / length) ** 2
    rest_left = (mu * n_left) ** 2 - (moment(right) / length) ** 2
    rest = np.minimum(rest_right, rest_left)
    room = np.sqrt(np.maximum(rest_right, 0.0)) + np.sqrt(np.maximum(rest_left, 0.0))
    allowed = (np.minimum(n_left, n_right) >= 0.0) & (
        np.maximum(n_left, n_right) <= presses.cap
    )
    return np.where(allowed & (rest >= 0.0), room - np.abs(force @ e), -1.0)


def least_by_search(presses: TwoPresses, fraction: float, twist: Twist) -> float | None:
    """Return the least load [N] of a dense grid, refined; None if none is enough."""
    most = presses.weight + 2.0 * presses.cap
    loads = presses.weight / np.linspace(1.0, presses.weight / most, GRID)
    enough = np.flatnonzero(slack(presses, fraction, twist, loads) >= 0.0)
    if not len(enough):
        return None
    first = enough[0]
    if first == 0:
        return float(loads[0])

    def sign(load: float) -> float:
        return 1.0 if slack(presses, fraction, twist, load) >= 0.0 else -1.0

    return float(optimize.bisect(sign, loads[first - 1], loads[first], rtol=1e-12))


def assert_least(cases: int, seed: int) -> None:
    rng = random.Random(seed)
    feasible = 0
    while feasible < cases:
        presses, fraction, twist = drawn(rng)
        wanted = least_by_search(presses, fraction, twist)
        if wanted is None:
            continue
        feasible += 1
        loads = presses.for_cop(fraction, twist)
        case = (presses, fraction, twist)
        assert loads.status == "ok", case
        load = presses.weight + sum(loads.normals)
        assert load == pytest.approx(wanted, rel=EXCESS), case


def test_no_load_below_the_least_holds_the_centre_of_pressure_and_drives_the_twist():
    assert_least(300, seed=1)


@pytest.mark.long
def test_the_least_load_is_exact_in_5000_feasible_cases():
    assert_least(5000, seed=2)


def test_the_least_load_is_found_where_the_com_is_beside_both_contacts():
    presses = TwoPresses((0.1, 0.3), (0.1, 0.1), 20.0, 0.3, 0.9, 0.1, 200.0)
    twist = Twist(0.3, 0.2, 1.0)
    wanted = least_by_search(presses, 0.6, twist)
    loads = presses.for_cop(0.6, twist)
    assert loads.status == "ok"
    assert presses.weight + sum(loads.normals) == pytest.approx(wanted, rel=EXCESS)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_twist_that_is_no_number_is_infeasible(bad):
    presses = TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, 0.9, 0.2, 200.0)
    loads = presses.for_cop(0.5, Twist(bad, 0.0, 0.0))
    assert loads.status == "infeasible"


def test_an_object_at_rest_needs_only_the_presses_that_shift_its_load():
    presses = TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, 0.9, 0.2, 200.0)
    loads = presses.for_cop(0.5, Twist(0.0, 0.0, 0.0))
    assert loads.normals == (0.0, 0.0)
    assert loads.status == "ok"


@pytest.mark.parametrize("speed", [1.0, 1e-3])
def test_between_two_edges_the_surplus_does_not_change_its_sign(speed):
    rng = random.Random(5)
    changes = 0
    for _ in range(200):
        presses, fraction, (vx, vy, w, _) = drawn(rng)
        twist = Twist(speed * vx, speed * vy, speed * w)
        line = ContactLine(presses.left, presses.right)
        frictions = (presses.support_friction, presses.contact_friction)
        friction = cop_friction(
            line, presses.left, fraction, twist, presses.rho, frictions
        )
        edges = friction.edges()
        grid = np.linspace(0.02, 1.0, 200).tolist()
        signs = [friction.surplus(u) >= 0.0 for u in grid]
        for i in range(1, len(grid)):
            if signs[i] != signs[i - 1]:
                changes += 1
                slack = 1e-6
                inside = (edges > grid[i - 1] - slack) & (edges < grid[i] + slack)
                assert inside.any(), (presses, fraction, twist, grid[i])
    assert changes > 30
