"""The motion under any number of compliant tips: balance, the exact surface, the
ellipsoid, dissipation.
"""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pushpressslide.core.pose import cross
from pushpressslide.core.task import Box, Cylinder
from pushpressslide.core.wrench import Wrench
from pushpressslide.kernels.sliding import BALANCE
from pushpressslide.kernels.support_friction import CREEP
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.friction import cone_margin, push_outcome
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_level,
    exact_twist_direction,
    exact_wrenches,
)
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.planar.contact import SideContact, TipLaw, TopContact
from pushpressslide.planar.polygon_friction import PolygonFriction
from pushpressslide.planar.sliding import REST, slide
from pushpressslide.planar.support_friction import SupportFriction

BOX = support_pressure(Box((0.15, 0.1, 0.1)), 10.0, cop=(0.01, 0.005), resolution=6)
BAR = support_pressure(Box((0.6, 0.2, 0.1)), 10.0, cop=(0.14, 0.01), resolution=6)
DISC = support_pressure(Cylinder(0.08, 0.1), 10.0, cop=(0.0, 0.0), resolution=6)
MU = 0.3
LIMIT = 3.0  # [N] MU times the load of 10 N
HOLD = 1e9  # [N] of a press that never slips


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def glued(point, force, damping=500.0):
    """A tip that always sticks."""
    return TopContact(point, TipLaw((1.0, 0.0), force, (damping, damping)), HOLD)


def torque(contact, force):
    return cross(contact.point, force)


def summed(contacts, twist):
    """Wrench of the contacts about the CoP."""
    found = [contact.response(twist).force for contact in contacts]
    tau = sum(torque(c, f) for c, f in zip(contacts, found, strict=True))
    return np.array([sum(f[0] for f in found), sum(f[1] for f in found), tau])


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from((BOX, BAR, DISC)),
    st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
    st.floats(-math.pi, math.pi),
    st.floats(1.2, 10.0),
)
def test_one_sticking_contact_slides_along_the_normal_of_the_exact_surface(
    samples, point, angle, excess
):
    assume(math.hypot(*point) > 0.01)
    friction = SupportFriction(samples)
    direction = (math.cos(angle), math.sin(angle))
    size = excess / exact_level(
        samples, MU, Wrench(*direction, cross(point, direction), samples.cop)
    )
    contact = glued(point, (size * direction[0], size * direction[1]))
    twist = slide(friction, LIMIT, (contact,), REST)
    force = contact.response(twist).force
    expected = exact_twist_direction(
        samples, Wrench(*force, torque(contact, force), samples.cop)
    )
    scaled = np.array([twist[0], twist[1], friction.rho * twist[2]])
    wanted = np.array([expected.vx, expected.vy, friction.rho * expected.w])
    speed = np.linalg.norm(scaled)
    assert speed > 1e-4
    assert scaled / speed == pytest.approx(wanted / np.linalg.norm(wanted), abs=1e-3)


@settings(deadline=None)
@given(
    st.tuples(st.floats(-0.12, -0.04), st.floats(-0.06, 0.06)),
    st.floats(0.02, 0.12),
    st.floats(0.05, 1.2),
    st.floats(-0.5, 0.5),
    st.floats(0.02, 0.2),
    st.floats(-1.2, 1.2),
)
def test_a_very_stiff_tip_on_the_ellipsoid_pushes_like_a_prescribed_velocity(
    point, rho, mu, bearing, speed, angle
):
    # one sample of torsional radius rho is the ellipsoid; a tip without radius acts
    # where it is held
    samples = PressureSamples(np.zeros((1, 2)), np.array([10.0]), np.array([rho]))
    n = (math.cos(bearing), math.sin(bearing))
    along = speed * math.cos(angle)
    across = speed * math.sin(angle)
    velocity = (along * n[0] - across * n[1], along * n[1] + across * n[0])
    expected = push_outcome(EllipsoidLimitSurface(LIMIT, rho), point, n, mu, velocity)
    # near the cone's edge the tip's small give decides
    assume(expected.kind != "stick" or cone_margin(expected.force, n, mu) > 0.02)
    assume(expected.kind == "stick" or abs(expected.slip_velocity) > 1e-3 * speed)
    damping = 1e7
    contact = SideContact(
        point,
        point,
        TipLaw(n, (damping * along, damping * across), (damping, damping)),
        mu,
    )
    twist = slide(SupportFriction(samples), LIMIT, (contact,), REST)
    response = contact.response(twist)
    assert response.status == expected.kind
    assert response.force == pytest.approx(expected.force, rel=1e-3, abs=2e-3)
    wanted = (expected.twist.vx, expected.twist.vy, rho * expected.twist.w)
    assert (twist[0], twist[1], rho * twist[2]) == pytest.approx(
        wanted, rel=1e-3, abs=1e-3 * speed
    )


@pytest.mark.parametrize("seed", range(0, 400, 40))
def test_two_contacts_balance_the_support_on_the_exact_surface(draw, seed):
    """With the friction law of mechanics, which is not softened, wherever the object
    moves.
    """
    moving = 0
    for case in (draw(s, count=2) for s in range(seed, seed + 40)):
        twist = slide(case.friction, case.limit, case.contacts, REST)
        given_by_contacts = summed(case.contacts, twist)
        taken = np.array(case.friction.wrench(twist, case.limit))
        assert given_by_contacts == pytest.approx(taken, abs=1e-6)
        if math.hypot(twist[0], twist[1]) > 1e-3:
            exact = exact_wrenches(case.samples, case.support_mu, np.array([twist]))[0]
            assert given_by_contacts == pytest.approx(exact, abs=1e-6)
            moving += 1
    assert moving > 10


@pytest.mark.parametrize("share", [0.3, 0.9, 0.99])
@pytest.mark.parametrize("samples", [BOX, BAR, DISC])
def test_nothing_moves_below_the_limit_surface_and_everything_above(samples, share):
    friction = SupportFriction(samples)
    rng = np.random.default_rng(3)
    for _ in range(20):
        points = rng.uniform(-0.06, 0.06, size=(2, 2)).tolist()
        forces = rng.normal(size=(2, 2)).tolist()
        tau = sum(cross(p, f) for p, f in zip(points, forces, strict=True))
        wrench = Wrench(
            forces[0][0] + forces[1][0], forces[0][1] + forces[1][1], tau, samples.cop
        )
        level = exact_level(samples, MU, wrench)
        for factor, moves in ((share / level, False), ((2.0 - share) / level, True)):
            contacts = [
                glued(p, (factor * f[0], factor * f[1]))
                for p, f in zip(points, forces, strict=True)
            ]
            twist = slide(friction, LIMIT, contacts, (0.05, 0.0, 0.2))
            speed = math.sqrt(
                twist[0] ** 2 + twist[1] ** 2 + (friction.rho * twist[2]) ** 2
            )
            assert (speed > 100.0 * CREEP) == moves
            if not moves:
                assert speed < 1e-6


@pytest.mark.parametrize("seed", range(0, 200, 50))
def test_support_and_contacts_only_dissipate(draw, seed):
    for case in (draw(s) for s in range(seed, seed + 50)):
        twist = slide(case.friction, case.limit, case.contacts, REST)
        assert np.dot(case.friction.wrench(twist, case.limit), twist) >= 0.0
        for contact in case.contacts:
            response = contact.response(twist)
            x, y = contact.center
            v = contact.law.velocity(response.force)
            slip = (v[0] - twist[0] + twist[2] * y, v[1] - twist[1] - twist[2] * x)
            if isinstance(contact, SideContact):
                n = contact.law.axis
                slip = (
                    slip[0] - contact.approach * n[0],
                    slip[1] - contact.approach * n[1],
                )
            assert dot(response.force, slip) >= -1e-9


@pytest.mark.parametrize("seed", range(0, 120, 30))
def test_presses_move_an_object_in_one_way_whatever_is_guessed(draw, seed):
    """Without side contacts the balance is the least of a convex function."""
    rng = np.random.default_rng(seed)
    for case in (draw(s, presses=1.0) for s in range(seed, seed + 30)):
        first = slide(case.friction, case.limit, case.contacts, REST)
        for _ in range(3):
            guess = (rng.normal(size=3) * (0.1, 0.1, 1.0)).tolist()
            again = slide(case.friction, case.limit, case.contacts, tuple(guess))
            assert again == pytest.approx(first, abs=1e-6)


@pytest.mark.parametrize("seed", range(1000, 1900, 300))
def test_a_balance_is_found_for_every_one_of_many_contacts(draw, seed):
    """For 1177 and 1591 only by letting the object go."""
    for case in (draw(s) for s in range(seed, seed + 300)):
        twist = slide(case.friction, case.limit, case.contacts, REST)
        left = np.array(case.friction.wrench(twist, case.limit)) - summed(
            case.contacts, twist
        )
        assert np.abs(left).max() < 1e-6


def test_two_equal_rear_pushes_move_a_box_straight_and_unequal_ones_turn_it():
    friction = SupportFriction(
        support_pressure(Box((0.15, 0.1, 0.1)), 10.0, cop=(0.01, 0.0), resolution=6)
    )
    for left, right, turning in ((4.0, 4.0, 0), (3.0, 5.0, 1), (5.0, 3.0, -1)):
        contacts = [
            SideContact(
                (-0.085, y),
                (-0.105, y),
                TipLaw((1.0, 0.0), (force, 0.0), (300.0, 300.0)),
                0.5,
            )
            for y, force in ((0.03, left), (-0.03, right))
        ]
        vx, vy, w = slide(friction, LIMIT, contacts, REST)
        if turning == 0:
            # what pushes with 8 N against 3 N of friction is held back by two dampers
            assert vx == pytest.approx((8.0 - 3.0) / 600.0, rel=1e-6)
            assert abs(vy) < 1e-9
            assert abs(w) < 1e-9
        else:
            assert turning * w > 0.01


@pytest.mark.parametrize("seed", range(0, 100, 50))
def test_the_mirrored_problem_has_the_mirrored_motion(draw, seed):
    for s in range(seed, seed + 50):
        case = draw(s, count=2)
        samples = case.samples
        mirrored = PressureSamples(
            samples.points * (1.0, -1.0), samples.loads, samples.radii
        )
        contacts = [flipped(c) for c in case.contacts]
        vx, vy, w = slide(case.friction, case.limit, case.contacts, REST)
        other = slide(SupportFriction(mirrored), case.limit, contacts, REST)
        assert other == pytest.approx((vx, -vy, -w), abs=1e-7)


def flipped(contact):
    law = contact.law
    x, y = contact.point
    nx, ny = law.axis
    fn, ft = law.force
    other = TipLaw((nx, -ny), (fn, -ft), law.damping)
    if isinstance(contact, TopContact):
        return TopContact((x, -y), other, contact.limit)
    cx, cy = contact.center
    return SideContact((x, -y), (cx, -cy), other, contact.friction, contact.approach)


@pytest.mark.parametrize("seed", range(0, 300, 100))
def test_a_second_step_with_the_first_ones_slope_ends_in_balance(draw, seed):
    """From guesses as near as the twist of the tick before."""
    rng = np.random.default_rng(seed)
    for case in (draw(s) for s in range(seed, seed + 100)):
        twist = slide(case.friction, case.limit, case.contacts, REST)
        near = np.array(twist) * (1.0 + 0.01 * rng.normal(size=3))
        again = slide(case.friction, case.limit, case.contacts, tuple(near.tolist()))
        left = np.array(case.friction.wrench(again, case.limit)) - summed(
            case.contacts, again
        )
        left[2] /= case.friction.rho
        assert np.linalg.norm(left) < BALANCE * case.limit * 1.001


@pytest.mark.parametrize("cop", [(0.0, 0.0), (0.01, 0.005), (0.04, 0.01)])
def test_ever_more_samples_lead_to_the_motion_of_the_closed_form(cop):
    box = Box((0.2, 0.12, 0.1))
    law = TipLaw((1.0, 0.0), (2000.0 * 0.05, 0.0), (2000.0, 2000.0))
    contact = SideContact((-0.1 - cop[0], 0.02), (-0.115 - cop[0], 0.02), law, 0.5)
    exact = PolygonFriction(face_pressure(box, (0.0, 0.0), cop))
    wanted = np.array(slide(exact, LIMIT, (contact,), REST))
    errors = []
    for resolution in (6, 12, 24, 48):
        samples = support_pressure(box, 10.0, cop=cop, resolution=resolution)
        twist = slide(SupportFriction(samples), LIMIT, (contact,), REST)
        errors.append(np.abs((twist - wanted) * (1.0, 1.0, exact.rho)).max() / 0.05)
    assert errors[0] < 2e-3
    for coarse, fine in itertools.pairwise(errors):
        assert fine < 0.4 * coarse
    assert errors[-1] < 3e-5
