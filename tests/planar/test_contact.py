"""Laws of one compliant tip: the force law, Coulomb's cone and disc, unilateral
contact, slopes.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.core.pose import cross
from pushpressslide.planar.contact import SideContact, TipLaw, TopContact

bearings = st.floats(-math.pi, math.pi)
forces = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
dampings = st.tuples(st.floats(50.0, 2000.0), st.floats(50.0, 2000.0))
twists = st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-1.0, 1.0))
points = st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
frictions = st.floats(0.05, 1.2)
approaches = st.one_of(st.just(0.0), st.floats(0.0, 0.05))
RADIUS = 0.02


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def side(bearing, force, damping, point, friction, approach):
    n = (math.cos(bearing), math.sin(bearing))
    center = (point[0] - RADIUS * n[0], point[1] - RADIUS * n[1])
    return SideContact(point, center, TipLaw(n, force, damping), friction, approach)


def carried(contact, twist):
    """Velocity that the object gives to the tip's centre."""
    x, y = contact.center
    return (twist[0] - twist[2] * y, twist[1] + twist[2] * x)


def in_frame(law, v):
    """Components of a vector in B along the law's axes."""
    return (dot(law.axis, v), cross(law.axis, v))


def consistent_states(contact, twist):
    """Brute force over the contact's states: the forces (n, t) of those that keep all
    of its laws.
    """
    fn, ft = contact.law.force
    bn, bt = contact.law.damping
    mu = contact.friction
    un, ut = in_frame(contact.law, carried(contact, twist))
    free_vn = fn / bn
    found = []
    if free_vn <= un + contact.approach:
        found.append(("free", (0.0, 0.0)))
    # the tip goes as far as the face lets it
    normal = fn - bn * (un + contact.approach)
    holding = ft - bt * ut
    if normal > 0.0 and abs(holding) <= mu * normal:
        found.append(("stick", (normal, holding)))
    for status, sign in (("slip_left", 1.0), ("slip_right", -1.0)):
        slip = (ft - sign * mu * normal) / bt - ut
        if normal > 0.0 and sign * slip > 0.0:
            found.append((status, (normal, sign * mu * normal)))
    return found


@given(bearings, forces, dampings, points, frictions, approaches, twists)
def test_exactly_one_state_of_a_side_contact_keeps_all_laws_and_it_is_found(
    bearing, force, damping, point, friction, approach, twist
):
    contact = side(bearing, force, damping, point, friction, approach)
    states = consistent_states(contact, twist)
    response = contact.response(twist)
    normal, tangential = in_frame(contact.law, response.force)
    assume(
        all(
            abs(friction * f[0] - abs(f[1])) > 1e-9 or s.startswith("slip")
            for s, f in states
        )
    )
    assume(
        abs(
            force[0] / damping[0]
            - in_frame(contact.law, carried(contact, twist))[0]
            - approach
        )
        > 1e-9
    )
    assert len(states) == 1
    status, expected = states[0]
    assert response.status == status
    assert (normal, tangential) == pytest.approx(expected, abs=1e-9)


@given(bearings, forces, dampings, points, frictions, approaches, twists)
def test_a_tip_at_a_side_never_passes_its_face_and_its_friction_dissipates(
    bearing, force, damping, point, friction, approach, twist
):
    contact = side(bearing, force, damping, point, friction, approach)
    response = contact.response(twist)
    vn, vt = in_frame(contact.law, contact.law.velocity(response.force))
    un, ut = in_frame(contact.law, carried(contact, twist))
    assert vn <= un + approach + 1e-9
    normal, tangential = in_frame(contact.law, response.force)
    assert normal >= 0.0
    assert tangential * (vt - ut) >= -1e-9


@given(bearings, forces, dampings, points, st.floats(0.1, 10.0), twists)
def test_a_pressed_tip_sticks_inside_the_disc_and_slips_along_its_force_on_the_rim(
    bearing, force, damping, point, limit, twist
):
    axis = (math.cos(bearing), math.sin(bearing))
    contact = TopContact(point, TipLaw(axis, force, damping), limit)
    response = contact.response(twist)
    v = contact.law.velocity(response.force)
    u = carried(contact, twist)
    slip = (v[0] - u[0], v[1] - u[1])
    size = math.hypot(*response.force)
    if response.status == "stick":
        assert size <= limit * (1.0 + 1e-12)
        assert slip == pytest.approx((0.0, 0.0), abs=1e-12)
        return
    assert response.status == "slip"
    assert size == pytest.approx(limit, rel=1e-9)
    assert dot(response.force, slip) >= 0.0
    assert cross(response.force, slip) == pytest.approx(0.0, abs=1e-9 * limit)


def slopes(contact, twist):
    """Loss of force per velocity of the tip's centre: by the law's own answer, and by
    differences.
    """
    h = 1e-7
    x, y = contact.center
    columns = []
    for dx, dy in ((h, 0.0), (0.0, h)):
        ends = [
            contact.response((twist[0] + s * dx, twist[1] + s * dy, twist[2])).force
            for s in (1.0, -1.0)
        ]
        columns.append([(b - a) / (2.0 * h) for a, b in zip(*ends, strict=True)])
    assert (x, y) == contact.center
    return np.reshape(contact.response(twist).slope, (2, 2)), np.array(columns).T


def test_slopes_are_the_derivatives_of_the_force(draw):
    checked = 0
    for seed in range(300):
        rng = np.random.default_rng(seed)
        twist = (rng.normal(size=3) * (0.02, 0.02, 0.2)).tolist()
        for contact in draw(seed).contacts:
            near = {
                contact.response([v + s * 1e-6 for v in twist]).status
                for s in (-1.0, 0.0, 1.0)
            }
            if len(near) == 1:  # away from a change of state
                own, measured = slopes(contact, twist)
                assert own == pytest.approx(
                    measured, abs=1e-4 * max(contact.law.damping)
                )
                checked += 1
    assert checked > 400
