"""Response of every allocator to a wrench of NaN, to zero friction, and to invalid
figures.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import optimize

from pushpressslide.allocation import orthogonal, published
from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.allocation.press_loads import TwoPresses, wall_hold
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.projections import WrenchCone
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.batch import presses as batch
from pushpressslide.batch.allocations import INFEASIBLE
from pushpressslide.batch.press_and_push import PressAndPush
from pushpressslide.batch.presses import OnePress
from pushpressslide.core.errors import InputError
from pushpressslide.core.plan import Contact
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.contacts import wrench_of_forces
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

RHO = 0.1
BEHIND = ((-0.2, 0.1), (-0.2, -0.1))
FORWARD = (1.0, 0.0)
ASIDE = ((-0.2, 0.03), (0.05, 0.2))
ASIDE_NORMALS = (FORWARD, (0.0, -1.0))
OBLIQUE = (math.sqrt(0.5), math.sqrt(0.5))
SIZE = math.inf
BAD = (math.nan, math.inf, -math.inf)


def allocators(friction: float):
    """One of each kind, as a function of a wrench alone."""
    presses = two_press_allocator(BEHIND, friction)
    return {
        "one_contact": one_contact_allocator((-0.2, 0.03), OBLIQUE, friction, RHO),
        "one_press": one_press_allocator((0.1, 0.0), 8.0, friction, RHO),
        "two_contacts": two_contact_allocator(ASIDE, ASIDE_NORMALS, friction, RHO),
        "oblique": two_contact_allocator(
            ASIDE, (OBLIQUE, (-1.0, 0.0)), friction, RHO, split="least_force"
        ),
        "capped": two_contact_allocator(
            ASIDE, ASIDE_NORMALS, friction, RHO, caps=(5.0, 5.0)
        ),
        "force_priority": two_contact_allocator(
            ASIDE, ASIDE_NORMALS, friction, RHO, projection="force_priority"
        ),
        "torque_priority": two_contact_allocator(
            ASIDE, ASIDE_NORMALS, friction, RHO, projection="torque_priority"
        ),
        "parallel": parallel_push_allocator(BEHIND, FORWARD, friction, RHO),
        "press_and_push": press_and_push_allocator(
            (0.1, 0.0), 8.0, (-0.2, 0.05), FORWARD, friction
        ),
        "presses": lambda fx, fy, tau: presses(fx, fy, tau, (4.0, 4.0)),
    }


NAMES = sorted(allocators(0.5))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("place", [0, 1, 2])
@pytest.mark.parametrize("other", [0.0, 1.0, -1.0, math.inf])
def test_a_wrench_that_is_no_number_gives_no_force(name, friction, bad, place, other):
    wrench = [other] * 3
    wrench[place] = bad
    out = allocators(friction)[name](*wrench)
    assert out.status == "infeasible"
    assert all(force == (0.0, 0.0) for force in out.forces)
    assert out.margin == 0.0


@pytest.mark.parametrize("bad", BAD)
def test_a_centre_of_pressure_that_is_no_number_gives_no_force(bad):
    out = two_press_allocator(BEHIND, 0.5)(1.0, 0.0, 0.0, (4.0, 4.0), (bad, 0.0))
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0), (0.0, 0.0))


components = st.floats(-5.0, 5.0)


@given(st.sampled_from(NAMES), components, components, components)
def test_without_friction_every_force_is_along_its_normal(name, fx, fy, tau):
    out = allocators(0.0)[name](fx, fy, tau)
    assert out.margin >= -1e-9
    assert all(math.isfinite(part) for force in out.forces for part in force)
    for force, normal in zip(out.forces, out.normals, strict=True):
        if name in ("one_press", "presses"):
            assert force == pytest.approx((0.0, 0.0), abs=1e-9)
        elif not (name == "press_and_push" and force is out.forces[0]):
            assert math.hypot(*force) == pytest.approx(normal, abs=1e-9)


@given(components, components, components)
def test_without_friction_two_pushes_give_the_nearest_wrench_that_normals_span(
    fx, fy, tau
):
    points = ASIDE
    out = two_contact_allocator(points, ASIDE_NORMALS, 0.0, RHO)(fx, fy, tau)
    columns = [
        wrench_of_forces([p], [n])[:3]
        for p, n in zip(points, ASIDE_NORMALS, strict=True)
    ]
    weights = np.array([1.0, 1.0, 1.0 / RHO])
    edges = np.array(columns).T * weights[:, None]
    _, distance = optimize.nnls(edges, weights * (fx, fy, tau))
    residual = np.linalg.norm(weights * out.residual)
    assert residual == pytest.approx(distance, abs=1e-7 * (1.0 + abs(tau) / RHO))


@given(components, components, components)
def test_the_cone_without_friction_knows_what_is_inside(fx, fy, tau):
    cone = WrenchCone(ASIDE, ASIDE_NORMALS, 0.0, RHO)
    inside = wrench_of_forces(ASIDE, ((abs(fx), 0.0), (0.0, -abs(fy))))
    assert cone.margin(*inside[:3]) == pytest.approx(0.0, abs=1e-9)
    pull = wrench_of_forces(ASIDE, ((-1.0 - abs(fx), 0.0), (0.0, -abs(fy))))
    assert cone.margin(*pull[:3]) < -0.1


def test_contacts_that_face_each_other_without_friction_drive_no_twist():
    contacts = (
        Contact(0, "side", (-0.1, 0.0), FORWARD, 0.05),
        Contact(1, "side", (0.1, 0.0), (-1.0, 0.0), 0.05),
    )
    cone = TwistCone(contacts, 0.0, DraggedSurface(3.0, RHO))
    assert cone.cone_margin(0.0, 1.0, 0.0) < 0.0
    assert cone.cone_margin(1.0, 0.0, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert cone.rays(0.01) == []


def test_presses_without_friction_drive_nothing():
    presses = TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, 0.0, 0.2, 100.0)
    twist = Twist(1.0, 0.0, 0.0)
    assert presses.least_fraction == math.inf
    assert presses.press_for_every_twist() == math.inf
    for loads in (
        presses.for_cop(0.5, twist),
        presses.for_share("balanced", twist),
        presses.for_share("left", twist),
        presses.for_least_press(twist),
    ):
        assert loads.status == "infeasible"
    assert wall_hold(5.0, 0.0, 0.0) == math.inf


def test_two_pushes_at_right_angles_without_friction_never_turn_the_object():
    assert not orthogonal.can_turn_about((0.5, 0.5), True, 0.1, 0.0, RHO)
    assert orthogonal.least_turning_radius(0.1, 0.0, RHO) == math.inf
    assert orthogonal.translation_radii(0.1, 0.0, RHO) == (math.inf, math.inf)
    assert orthogonal.least_drift(1.0, -1.0, 0.1, 0.1, 0.0) == math.inf
    assert orthogonal.least_drift(-1.0, -1.0, 0.0, 0.1, 0.0) == 1.0
    assert not orthogonal.feasibility(1.0, -1.0, 0.1, 0.1, 0.0).feasible
    assert published.least_bias(-1.0, -1.0, 0.0, 0.1, 0.0) == 1.0
    assert published.least_bias(1.0, -1.0, 0.1, 0.1, 0.0) == math.inf
    assert published.unicycle_distances(0.1, 0.0, RHO) == (math.inf, math.inf)


def of_friction(friction: float):
    """Every constructor that is told a friction."""
    return [
        lambda: one_contact_allocator((-0.2, 0.0), FORWARD, friction, RHO),
        lambda: one_press_allocator((0.1, 0.0), 8.0, friction, RHO),
        lambda: two_contact_allocator(ASIDE, ASIDE_NORMALS, friction, RHO),
        lambda: parallel_push_allocator(BEHIND, FORWARD, friction, RHO),
        lambda: press_and_push_allocator(
            (0.1, 0.0), 8.0, (-0.2, 0.05), FORWARD, friction
        ),
        lambda: two_press_allocator(BEHIND, friction),
        lambda: TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, friction, 0.2, 100.0),
        lambda: WrenchCone(ASIDE, ASIDE_NORMALS, friction, RHO),
    ]


@pytest.mark.parametrize("friction", [-0.1, math.nan, math.inf])
@pytest.mark.parametrize("number", range(8))
def test_a_friction_that_cannot_be_is_named_with_its_value(friction, number):
    with pytest.raises(ValueError, match=rf"friction {friction}; must be finite and"):
        of_friction(friction)[number]()


@pytest.mark.parametrize("rho", [0.0, -0.1, math.nan, math.inf])
def test_a_rho_that_cannot_be_is_named_with_its_value(rho):
    for build in (
        lambda: one_contact_allocator((-0.2, 0.0), FORWARD, 0.5, rho),
        lambda: one_press_allocator((0.1, 0.0), 8.0, 0.5, rho),
        lambda: two_contact_allocator(ASIDE, ASIDE_NORMALS, 0.5, rho),
        lambda: parallel_push_allocator(BEHIND, FORWARD, 0.5, rho),
        lambda: TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, 0.5, rho, 100.0),
        lambda: EllipsoidLimitSurface(1.0, rho),
        lambda: DraggedSurface(1.0, rho),
    ):
        with pytest.raises(ValueError, match=rf"rho {rho} m; must be finite and > 0"):
            build()


@pytest.mark.parametrize("cap", [0.0, -1.0, math.nan])
def test_a_cap_that_cannot_be_is_named_with_its_value(cap):
    for build in (
        lambda: two_contact_allocator(ASIDE, ASIDE_NORMALS, 0.5, RHO, caps=(cap, 5.0)),
        lambda: parallel_push_allocator(BEHIND, FORWARD, 0.5, RHO, caps=(5.0, cap)),
        lambda: TwoPresses((0.0, 0.3), (0.0, -0.3), 20.0, 0.3, 0.5, 0.2, cap),
    ):
        with pytest.raises(ValueError, match=rf"cap {cap} N; must be"):
            build()


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("place", [0, 1])
def test_a_point_that_is_nowhere_is_named_with_its_value(bad, place):
    point = [-0.2, 0.03]
    point[place] = bad
    with pytest.raises(ValueError, match=rf"point .*{bad}.* m; must be finite"):
        one_contact_allocator(tuple(point), FORWARD, 0.5, RHO)
    with pytest.raises(ValueError, match=r"need two distinct, finite points"):
        two_press_allocator((tuple(point), (0.1, 0.1)), 0.5)


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("place", [0, 1])
def test_every_place_that_is_nowhere_is_refused(bad, place):
    point = [-0.2, 0.03]
    point[place] = bad
    nowhere = tuple(point)
    for build in (
        lambda: one_press_allocator(nowhere, 8.0, 0.5, RHO),
        lambda: one_press_allocator((0.1, 0.0), 8.0, 0.5, RHO, nowhere),
        lambda: press_and_push_allocator(nowhere, 8.0, (-0.2, 0.05), FORWARD, 0.5),
        lambda: press_and_push_allocator((0.1, 0.0), 8.0, nowhere, FORWARD, 0.5),
        lambda: press_and_push_allocator(
            (0.1, 0.0), 8.0, (-0.2, 0.05), FORWARD, 0.5, nowhere
        ),
        lambda: two_contact_allocator((nowhere, ASIDE[1]), ASIDE_NORMALS, 0.5, RHO),
        lambda: parallel_push_allocator((nowhere, BEHIND[1]), FORWARD, 0.5, RHO),
        lambda: WrenchCone((nowhere, ASIDE[1]), ASIDE_NORMALS, 0.5, RHO),
        lambda: OnePress(nowhere, 8.0, 0.5, RHO),
        lambda: OnePress((0.1, 0.0), 8.0, 0.5, RHO, nowhere),
        lambda: PressAndPush((0.1, 0.0), 8.0, (-0.2, 0.05), FORWARD, 0.5, nowhere),
    ):
        with pytest.raises(InputError, match="finite"):
            build()


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("normals", [(-1.0, 4.0), (4.0, -1.0), (-1e-12, 4.0)])
@pytest.mark.parametrize("wrench", [(0.0, 0.0, 0.0), (1.0, 0.5, 0.1), (50.0, 0.0, 0.0)])
def test_a_press_that_pulls_gives_no_force(friction, normals, wrench):
    out = two_press_allocator(BEHIND, friction)(*wrench, normals)
    assert out.status == "infeasible"
    assert out.forces == ((0.0, 0.0), (0.0, 0.0))
    many = batch.TwoPresses(BEHIND, friction).allocate([wrench], [normals])
    assert many.status.tolist() == [INFEASIBLE]
    assert not np.asarray(many.forces).any()


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("place", [0, 1])
def test_a_press_that_is_no_number_gives_no_force(bad, place):
    normals = [4.0, 4.0]
    normals[place] = bad
    for wrench in ((1.0, 0.5, 0.1), (50.0, 0.0, 0.0), (0.0, 0.0, 9.0)):
        out = two_press_allocator(BEHIND, 0.5)(*wrench, tuple(normals))
        assert out.status == "infeasible"
        assert out.forces == ((0.0, 0.0), (0.0, 0.0))
