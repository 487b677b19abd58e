"""The ellipsoid that touches the exact limit surface at one twist."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.osculating import (
    dragged_ellipsoid,
    pressures,
    touching_ellipsoid,
)
from pushpressslide.mechanics.pressure import polygon_pressure, rectangle_pressure
from pushpressslide.mechanics.rho import rho_pole, rho_straight

MU = 0.3


def cases(count: int, seed: int = 0):
    """Pressures of rectangles whose CoP is off centre, lifted on one side or not, with
    a twist each.
    """
    rng = np.random.default_rng(seed)
    for _ in range(count):
        length, width = rng.uniform(0.1, 0.6, 2)
        cop = (rng.uniform(-0.3, 0.3) * length, rng.uniform(-0.3, 0.3) * width)
        samples = rectangle_pressure(length, width, rng.uniform(2.0, 60.0), cop, 5)
        v = rng.uniform(0.0, 1.0)
        angle = rng.uniform(-math.pi, math.pi)
        w = rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(-1.2, 1.0) / rho_pole(samples)
        yield samples, Twist(v * math.cos(angle), v * math.sin(angle), w, samples.cop)


def test_it_gives_the_exact_wrench_for_its_twist() -> None:
    for samples, twist in cases(200):
        got = touching_ellipsoid(samples, MU, twist).wrench(twist)
        exact = exact_wrench(samples, MU, twist)
        size = MU * samples.total_load
        assert got.moved_to((0.0, 0.0))[:3] == pytest.approx(
            exact.moved_to((0.0, 0.0))[:3], abs=1e-9 * size
        )


def test_it_touches_the_exact_surface_so_that_beside_its_twist_it_errs_in_second_order() -> (
    None
):
    rng = np.random.default_rng(1)
    for samples, twist in cases(50, seed=2):
        surface = touching_ellipsoid(samples, MU, twist)
        scale = rho_pole(samples)
        errors = []
        directions = rng.normal(size=(40, 3))
        for step in (0.002, 0.001):
            worst = 0.0
            for dx, dy, dw in directions:
                speed = step * math.hypot(twist.vx, twist.vy, scale * twist.w)
                near = Twist(
                    twist.vx + speed * dx,
                    twist.vy + speed * dy,
                    twist.w + speed * dw / scale,
                    twist.point,
                )
                fx, fy, tau, _ = exact_wrench(samples, MU, near).moved_to(
                    surface.center
                )
                level = math.hypot(fx, fy, tau / surface.rho) / surface.max_force
                worst = max(worst, abs(level - 1.0))
            errors.append(worst)
        assert errors[1] < 0.3 * errors[0]


def test_its_rho_is_the_pressures_deviation_for_straight_sliding_and_the_mean_distance_for_a_turn() -> (
    None
):
    samples = rectangle_pressure(0.4, 0.2, 20.0, (0.0, 0.0), 8)
    for direction in ((1.0, 0.0), (0.0, 1.0), (1.0, -2.0)):
        rho = touching_ellipsoid(samples, MU, Twist(*direction, 0.0)).rho
        assert rho == pytest.approx(rho_straight(samples, direction), rel=2e-3)
    assert touching_ellipsoid(samples, MU, Twist(0.0, 0.0, -2.0)).rho == pytest.approx(
        rho_pole(samples)
    )


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_straight_sliding_is_the_same_whichever_way_the_base_is_pointed(
    side: float,
) -> None:
    corners = ((0.2, 0.0), (-0.1, 0.15), (-0.1, -0.15))
    samples = polygon_pressure(tuple((side * x, side * y) for x, y in corners))
    rho = touching_ellipsoid(samples, MU, Twist(1.0, 0.0, 0.0, samples.cop)).rho
    assert rho == pytest.approx(rho_straight(samples, (1.0, 0.0)), rel=2e-3)


def test_a_zero_twist_has_no_ellipsoid() -> None:
    with pytest.raises(ValueError, match="zero twist"):
        touching_ellipsoid(rectangle_pressure(0.4, 0.2), MU, Twist(0.0, 0.0, 0.0))


def test_with_a_believed_rho_and_forces_at_one_height_it_is_the_closed_form_of_the_dragged_surface() -> (
    None
):
    task = load_task("bimanual-slide")
    task = replace(task, belief=replace(task.full_belief, rho=0.12))
    height = 0.3
    load = 50.0
    cop = (0.02, -0.01)
    for twist in (Twist(1.0, 0.3, 2.0), Twist(-0.2, 0.1, -4.0), Twist(0.1, 1.0, 0.5)):
        surface, moved = dragged_ellipsoid(
            pressures(task.scene),
            MU,
            load,
            cop,
            twist,
            lambda f: (height * f.fx / load, height * f.fy / load),
        )
        closed = DraggedSurface(MU * load, 0.12, height * MU, cop).wrench(twist)
        got = surface.wrench(twist)
        assert got.moved_to(cop)[:3] == pytest.approx(closed[:3], abs=1e-4)
        assert moved == pytest.approx(
            (cop[0] + height * got.fx / load, cop[1] + height * got.fy / load), abs=1e-5
        )
