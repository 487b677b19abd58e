"""One contact on the ellipsoid, on arrays, answers like the single form."""

import math

import numpy as np
import pytest

from pushpressslide.batch import pushing as batch
from pushpressslide.batch.pushing import (
    SEPARATE,
    SLIP_LEFT,
    SLIP_RIGHT,
    STICK,
    SideContact,
    virtual_axles,
)
from pushpressslide.kernels import pushing as kernel
from pushpressslide.mechanics import friction
from pushpressslide.mechanics.friction import motion_cone, push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.rom.unicycle import Unicycle

CASES = 2_000
KINDS = {
    "stick": STICK,
    "slip_left": SLIP_LEFT,
    "slip_right": SLIP_RIGHT,
    "separate": SEPARATE,
}


@pytest.fixture(scope="module")
def contacts():
    """Levers, normals, frictions, rhos and largest forces of random contacts."""
    rng = np.random.default_rng(0)
    levers = rng.uniform(-0.1, 0.1, (CASES, 2))
    levers[:20] = 0.0
    angles = rng.uniform(-math.pi, math.pi, CASES)
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    normals[20:40] = -levers[20:40] / np.linalg.norm(levers[20:40], axis=1)[:, None]
    friction = rng.uniform(0.0, 1.5, CASES)
    friction[:10] = 0.0
    rho = rng.uniform(0.03, 0.1, CASES)
    return levers, normals, friction, rho, rng.uniform(0.5, 5.0, CASES)


def test_a_batch_compiles_what_single_pushes_call():
    assert friction.pushing.pushed is kernel.pushed
    assert friction.pushing.motion_cone is batch.motion_cone is kernel.motion_cone


def rows_of(contacts):
    return zip(*(array.tolist() for array in contacts), strict=True)


def test_motion_cones(engine, contacts):
    right, left = SideContact(*contacts).motion_cones()
    single = [
        motion_cone(tuple(lever), rho, tuple(normal), mu)
        for lever, normal, mu, rho, _ in rows_of(contacts)
    ]
    np.testing.assert_allclose(right, [edges[0] for edges in single], atol=1e-12)
    np.testing.assert_allclose(left, [edges[1] for edges in single], atol=1e-12)


def test_pushes_with_a_velocity(engine, contacts):
    normals = contacts[1]
    velocities = np.random.default_rng(1).normal(size=(CASES, 2))
    velocities[:3] = 0.0
    velocities[3:6] = normals[3:6]
    velocities[6:9] = -normals[6:9]
    got = SideContact(*contacts).push(velocities)
    single = [
        push_outcome(
            EllipsoidLimitSurface(force, rho), tuple(lever), tuple(normal), mu, v
        )
        for (lever, normal, mu, rho, force), v in zip(
            rows_of(contacts), velocities.tolist(), strict=True
        )
    ]
    assert got.kind.tolist() == [KINDS[outcome.kind] for outcome in single]
    assert set(got.kind.tolist()) == set(KINDS.values())
    for array, expected in (
        (got.force, [outcome.force for outcome in single]),
        (got.twist, [outcome.twist[:3] for outcome in single]),
        (got.slip, [outcome.slip_velocity for outcome in single]),
    ):
        np.testing.assert_allclose(array, expected, rtol=1e-9, atol=1e-9)


def test_the_motion_cone_is_where_a_push_sticks(engine):
    contact = SideContact((-0.1, 0.02), (1.0, 0.0), 0.4, 0.07)
    right, left = contact.motion_cones()
    inside = [right + 1e-9 * (left - right), left + 1e-9 * (right - left)]
    outside = [right - 1e-9 * (left - right), left - 1e-9 * (right - left)]
    kinds = contact.push([*inside, *outside]).kind.tolist()
    assert kinds == [STICK, STICK, SLIP_RIGHT, SLIP_LEFT]


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_velocity_that_is_no_number_moves_nothing(engine, bad):
    contact = SideContact((-0.1, 0.02), (1.0, 0.0), 0.4, 0.07)
    outcome = contact.push([(1.0, 0.0), (bad, 0.0), (1.0, bad)])
    assert outcome.kind.tolist() == [STICK, SEPARATE, SEPARATE]
    assert (outcome.force[1:] == 0.0).all()
    assert (outcome.twist[1:] == 0.0).all()


def test_virtual_axles_are_those_of_the_cars():
    rng = np.random.default_rng(2)
    points = rng.uniform(-0.1, 0.1, (500, 2))
    cops = rng.uniform(-0.02, 0.02, (500, 2))
    rho = rng.uniform(0.03, 0.1, 500)
    shift = rng.uniform(0.0, 0.02, 500)
    rows = list(zip(points.tolist(), cops.tolist(), rho.tolist(), shift, strict=True))
    presses = [Unicycle(tuple(p), tuple(c), r, False, h).X_BV for p, c, r, h in rows]
    got = virtual_axles(points, cops, rho, shift)
    np.testing.assert_allclose(got, [X.position for X in presses], atol=1e-12)
    aims = cops - points
    aims /= np.linalg.norm(aims, axis=1)[:, None]
    pushes = [
        RearSteerCar(tuple(p), tuple(n), tuple(c), r, 0.5).X_BV
        for (p, c, r, _), n in zip(rows, aims.tolist(), strict=True)
    ]
    got = virtual_axles(points, cops, rho)
    np.testing.assert_allclose(got, [X.position for X in pushes], atol=1e-12)


def test_a_contact_at_the_centre_of_pressure_has_no_axle():
    with pytest.raises(ValueError, match=r"lever 0.0 m; must be finite and > 0"):
        virtual_axles([(0.1, 0.0), (0.0, 0.0)], (0.0, 0.0), 0.07)
