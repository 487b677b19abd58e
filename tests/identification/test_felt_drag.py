"""The drag of an object by what the tips that move it feel."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.felt_drag import ENOUGH, FeltDrag
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

DT = 0.01


def felt(wrench: Wrench, power: float, seconds: float) -> FeltDrag:
    """What tips feel that exert a ``wrench`` for some ``seconds``."""
    sums = FeltDrag()
    for _ in range(round(seconds / DT)):
        sums = sums.step(wrench, power, DT)
    return sums


@pytest.mark.parametrize("twist", [Twist(0.05, 0.0, 0.0), Twist(0.03, 0.02, 0.6)])
def test_a_sliding_object_tells_its_drag_however_it_turns(twist: Twist) -> None:
    wrench = EllipsoidLimitSurface(max_force=7.0, rho=0.08).wrench(twist)
    power = wrench.fx * twist.vx + wrench.fy * twist.vy + wrench.tau * twist.w
    assert felt(wrench, power, 2.0).drag(0.08) == pytest.approx(7.0)


def test_an_object_at_rest_tells_nothing() -> None:
    pushed = Wrench(7.0, 0.0, 0.0)
    assert felt(pushed, 0.0, 5.0).drag(0.08) is None


def test_a_drag_is_known_after_a_while_and_follows_another_support() -> None:
    pushed = Wrench(7.0, 0.0, 0.0)
    assert felt(pushed, 0.35, 0.5 * ENOUGH).drag(0.08) is None
    sums = felt(pushed, 0.35, 2.0)
    for _ in range(1000):
        sums = sums.step(Wrench(3.0, 0.0, 0.0), 0.15, DT)
    assert sums.drag(0.08) == pytest.approx(3.0, rel=0.01)


def test_noise_of_the_forces_does_not_look_like_drag() -> None:
    sums = FeltDrag()
    for i in range(400):
        noise = 5.0 * (-1) ** i
        sums = sums.step(Wrench(4.0 + noise, noise, 0.0), 0.4, DT)
    drag = sums.drag(0.08)
    assert drag is not None
    assert math.isclose(drag, 4.0, rel_tol=0.02)
