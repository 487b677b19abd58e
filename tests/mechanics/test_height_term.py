"""The ellipsoid under a load that the drag shifts (docs/mechanics.md, 1 and 1.2)."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Belief, Box, ObjectModel, Task
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface, exact_wrench
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.push_surface import push_surface

number = st.floats(-1.0, 1.0)
place = st.floats(-0.1, 0.1)
surfaces = st.builds(
    DraggedSurface,
    st.floats(0.5, 50.0),
    st.floats(0.03, 0.3),
    st.floats(0.0, 0.05),
    st.tuples(place, place),
)
twists = st.builds(
    Twist, number, number, st.floats(-10.0, 10.0), st.tuples(place, place)
)


@given(surface=surfaces, twist=twists)
def test_the_wrench_of_a_twist_drives_that_twist(
    surface: DraggedSurface, twist: Twist
) -> None:
    at = twist.moved_to(surface.center)
    size = math.hypot(at.vx, at.vy, surface.rho * at.w)
    assume(size > 1e-3)
    driven = surface.twist_direction(surface.wrench(twist))
    k = size / math.hypot(driven.vx, driven.vy, surface.rho * driven.w)
    assert (k * driven.vx, k * driven.vy, k * driven.w) == pytest.approx(
        at[:3], abs=1e-9 * k
    )


@given(surface=surfaces, twist=twists)
def test_the_cop_is_moved_along_the_force_and_the_rest_is_the_ellipsoid_about_it(
    surface: DraggedSurface, twist: Twist
) -> None:
    assume(math.hypot(twist.vx, twist.vy, surface.rho * twist.w) > 1e-3)
    wrench = surface.wrench(twist)
    x, y = surface.center
    share = surface.lift / surface.max_force
    moved = (x + share * wrench.fx, y + share * wrench.fy)
    plain = EllipsoidLimitSurface(surface.max_force, surface.rho, moved)
    assert plain.wrench(twist).moved_to(surface.center)[:3] == pytest.approx(
        wrench[:3], abs=1e-9
    )


def test_nothing_is_asked_for_at_rest() -> None:
    surface = DraggedSurface(6.0, 0.1, 0.02)
    assert surface.wrench(Twist(0.0, 0.0, 0.0))[:3] == (0.0, 0.0, 0.0)
    assert surface.twist_direction(Wrench(0.0, 0.0, 0.0))[:3] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("turn", [-6.0, -0.5, 0.0, 2.0])
def test_the_surface_of_a_push_gives_the_exact_wrench_of_its_twist(turn: float) -> None:
    height = 0.09
    mu = 0.3
    mass = 2.0
    body = ObjectModel(Box((0.42, 0.22, 0.2)), mass, (0.02, 0.0))
    task = Task("t", body, Pose2(), Pose2(), (), belief=Belief(mu, 0.6, mass))
    twist = Twist(0.8, -0.5, turn)
    wrench = push_surface(task.scene, height, twist).wrench(twist).moved_to((0.0, 0.0))
    load = mass * 9.81
    cop = (height * wrench.fx / load, height * wrench.fy / load)
    samples = support_pressure(body.shape, load, body.center_of_mass, cop)
    exact = exact_wrench(samples, mu, twist).moved_to((0.0, 0.0))
    assert wrench[:2] == pytest.approx(exact[:2], abs=0.01 * mu * load)
    assert wrench.tau == pytest.approx(exact.tau, abs=0.01 * mu * load * 0.13)


@pytest.mark.parametrize("lift", [0.0, 0.03, 0.2])
def test_many_twists_have_the_wrenches_of_each(lift: float) -> None:
    surface = DraggedSurface(6.0, 0.08, lift, (0.02, -0.01))
    twists = np.random.default_rng(7).normal(size=(50, 3)) * (1.0, 1.0, 10.0)
    many = surface.wrenches(twists)
    for twist, wrench in zip(twists.tolist(), many, strict=True):
        assert surface.wrench(Twist(*twist, surface.center))[:3] == pytest.approx(
            wrench
        )


@pytest.mark.parametrize(("force", "rho"), [(0.0, 0.1), (-1.0, 0.1), (1.0, 0.0)])
def test_a_surface_needs_a_force_and_a_length(force: float, rho: float) -> None:
    with pytest.raises(ValueError, match="must be finite and > 0"):
        DraggedSurface(force, rho)


def test_by_default_forces_act_at_the_support_and_the_centre_of_mass() -> None:
    told = DraggedSurface(6.0, 0.1)
    assert told == DraggedSurface(6.0, 0.1, 0.0, (0.0, 0.0))
    twist = told.twist_direction(Wrench(1.0, 0.0, 0.2))
    assert twist.vy == 0.0
