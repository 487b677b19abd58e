"""Drag and centre of friction of an object by what the tips that move it feel."""

from __future__ import annotations

import math

import pytest

from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.felt_drag import ENOUGH, FeltDrag
from pushpressslide.mechanics.height_term import DraggedSurface

DT = 0.01
RHO = 0.08
ORIGIN = (0.0, 0.0)
FORWARD = Twist(0.05, 0.0, 0.0)
CURVED = Twist(0.04, 0.01, 0.3)


def felt(wrench: Wrench, twist: Twist, seconds: float = 2.0) -> FeltDrag:
    """What tips feel that move an object for some ``seconds``."""
    sums = FeltDrag()
    for _ in range(round(seconds / DT)):
        sums = sums.step(wrench, twist, DT)
    return sums


def sliding(twist: Twist, center: Point = ORIGIN, drag: float = 7.0) -> FeltDrag:
    """What tips feel of an object that slides with a ``twist``."""
    surface = DraggedSurface(drag, RHO, 0.01, center)
    return felt(surface.wrench(twist).moved_to(ORIGIN), twist)


@pytest.mark.parametrize("twist", [FORWARD, CURVED])
@pytest.mark.parametrize("center", [ORIGIN, (0.02, -0.03)])
def test_a_sliding_object_tells_its_drag_however_it_turns(
    twist: Twist, center: Point
) -> None:
    assert sliding(twist, center).drag(center, RHO) == pytest.approx(7.0)


def test_an_object_at_rest_tells_nothing() -> None:
    sums = felt(Wrench(7.0, 0.0, 0.1), Twist(0.0, 0.0, 0.0), 5.0)
    assert sums.drag(ORIGIN, RHO) is None
    assert sums.line(DraggedSurface(7.0, RHO), 0.1, 0.2, 0.0) is None


def test_a_drag_is_known_after_a_while_and_follows_another_support() -> None:
    pushed = Wrench(7.0, 0.0, 0.0)
    assert felt(pushed, FORWARD, 0.5 * ENOUGH).drag(ORIGIN, RHO) is None
    sums = felt(pushed, FORWARD)
    for _ in range(1000):
        sums = sums.step(Wrench(3.0, 0.0, 0.0), FORWARD, DT)
    assert sums.drag(ORIGIN, RHO) == pytest.approx(3.0, rel=0.01)


def test_noise_of_the_forces_does_not_look_like_drag() -> None:
    sums = FeltDrag()
    for i in range(400):
        noise = 3.0 * (-1) ** i
        sums = sums.step(Wrench(4.0 + noise, noise, 0.0), FORWARD, DT)
    drag = sums.drag(ORIGIN, RHO)
    assert drag is not None
    assert math.isclose(drag, 4.0, rel_tol=0.02)


@pytest.mark.parametrize("twist", [FORWARD, CURVED, Twist(0.0, -0.05, -0.4)])
def test_the_line_of_a_force_tells_the_centre_across_it(twist: Twist) -> None:
    center = (0.02, -0.03)
    sums = sliding(twist, center)
    line = sums.line(DraggedSurface(7.0, RHO, 0.01, center), 0.05, 0.2, 0.0)
    assert line is not None
    x, y = line.across
    assert line.value == pytest.approx(center[0] * x + center[1] * y)
    assert abs(x * sums.fx + y * sums.fy) < 1e-9


def test_a_line_is_the_less_sure_the_more_the_object_turns_and_the_weaker_it_is() -> (
    None
):
    surface = DraggedSurface(7.0, RHO, 0.01)
    straight, curved = (
        sliding(twist).line(surface, 0.05, 0.2, 0.0)
        for twist in (
            FORWARD,
            CURVED,
        )
    )
    weak = sliding(FORWARD, drag=1.0).line(surface, 0.05, 0.2, 0.0)
    assert straight is not None
    assert curved is not None
    assert weak is not None
    assert straight.deviation < min(curved.deviation, weak.deviation)
    assert sliding(FORWARD, drag=0.1).line(surface, 0.05, 0.2, 0.0) is None
