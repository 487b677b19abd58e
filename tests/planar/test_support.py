"""The support's friction: within a percent of the exact surface for any load position,
its slope, its edge.
"""

import math

import numpy as np
import pytest

from pushpressslide.core.task import Box, Cylinder, Prism
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.limit_surface import exact_wrench
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.planar.support import TIPPING, Support

SHAPES = {
    "box": (Box((0.15, 0.1, 0.1)), (0.01, -0.005)),
    "bar": (Box((0.6, 0.1, 0.1)), (0.0, 0.0)),
    "triangle": (Prism(((-0.1, -0.08), (0.12, -0.06), (0.0, 0.11)), 0.1), (0.0, 0.0)),
    "disc": (Cylinder(0.08, 0.1), (0.0, 0.01)),
}
LIMIT = 3.0  # [N]


def places(support, rng, count, furthest):
    """Centres of pressure in B, up to a share of the way to the outline."""
    while count:
        cop = tuple(rng.uniform(-0.3, 0.3, size=2).tolist())
        if support.outwards(cop) < furthest:
            yield cop
            count -= 1


@pytest.mark.parametrize("name", SHAPES)
def test_the_wrench_is_the_exact_surfaces_within_a_percent_wherever_the_load_is(name):
    shape, com = SHAPES[name]
    support = Support(shape, com)
    rng = np.random.default_rng(5)
    for cop in places(support, rng, 12, 0.8):
        held, friction, tipping = support.under(cop)
        assert held == cop
        assert not tipping
        samples = support_pressure(shape, 10.0, com, cop, 16)
        for _ in range(6):
            vx, vy, turn = (0.05 * rng.normal(size=3)).tolist()
            twist = (vx, vy, turn / friction.rho)
            exact = exact_wrench(samples, LIMIT / 10.0, Twist(*twist, cop))
            fx, fy, tau = friction.wrench(twist, LIMIT)
            assert (fx, fy) == pytest.approx((exact.fx, exact.fy), abs=0.01 * LIMIT)
            assert tau == pytest.approx(exact.tau, abs=0.01 * LIMIT * friction.rho)


@pytest.mark.parametrize("name", SHAPES)
def test_the_slope_is_the_derivative_of_the_wrench(name):
    shape, com = SHAPES[name]
    friction = Support(shape, com).under((0.005, 0.003))[1]
    rng = np.random.default_rng(6)
    for _ in range(10):
        twist = (rng.normal(size=3) * (0.05, 0.05, 1.0)).tolist()
        wrench, slope = friction.wrench_and_slope(tuple(twist), LIMIT)
        assert wrench == friction.wrench(tuple(twist), LIMIT)
        columns = []
        for i in range(3):
            ends = []
            for sign in (1.0, -1.0):
                near = list(twist)
                near[i] += sign * 1e-6
                ends.append(np.array(friction.wrench(tuple(near), LIMIT)))
            columns.append((ends[0] - ends[1]) / 2e-6)
        assert np.array(slope) == pytest.approx(np.array(columns).T, abs=1e-3)
        assert np.linalg.eigvalsh(np.array(slope)).min() > -1e-9


@pytest.mark.parametrize("name", SHAPES)
def test_a_load_off_the_base_is_held_at_its_edge_and_tips_the_object(name):
    support = Support(*SHAPES[name])
    for angle in np.linspace(0.0, 2.0 * math.pi, 17):
        cop, friction, tipping = support.under(
            (0.5 * math.cos(angle), 0.5 * math.sin(angle))
        )
        assert tipping
        assert support.outwards(cop) == pytest.approx(TIPPING)
        assert np.isfinite(friction.wrench((0.05, 0.0, 0.3), LIMIT)).all()
