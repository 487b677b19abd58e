"""Drag and centre of friction of an object by what the tips that move it feel."""

from __future__ import annotations

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
SPIN = Twist(0.0, 0.0, 0.5)
REST = Twist(0.0, 0.0, 0.0)


def felt(
    wrench: Wrench,
    twist: Twist,
    seconds: float = 2.0,
    center: Point = ORIGIN,
    before: FeltDrag | None = None,
) -> FeltDrag:
    """What tips feel that move an object for some ``seconds``."""
    sums = before or FeltDrag()
    for _ in range(round(seconds / DT)):
        sums = sums.step(wrench, twist, center, RHO, DT)
    return sums


def sliding(
    twist: Twist,
    center: Point = ORIGIN,
    drag: float = 7.0,
    seconds: float = 2.0,
    before: FeltDrag | None = None,
) -> FeltDrag:
    """What tips feel of an object that slides with a ``twist``."""
    surface = DraggedSurface(drag, RHO, 0.0, center)
    wrench = surface.wrench(twist).moved_to(ORIGIN)
    return felt(wrench, twist, seconds, center, before)


@pytest.mark.parametrize("twist", [FORWARD, CURVED, SPIN])
@pytest.mark.parametrize("center", [ORIGIN, (0.02, -0.03)])
def test_a_sliding_object_tells_its_drag_however_it_turns(
    twist: Twist, center: Point
) -> None:
    assert sliding(twist, center).drag == pytest.approx(7.0)


@pytest.mark.parametrize("twist", [Twist(-0.05, 0.0, 0.0), CURVED, SPIN])
@pytest.mark.parametrize("after", [0.1, 0.5, 1.0, 1.5])
def test_an_object_that_is_moved_another_way_tells_the_same_drag(
    twist: Twist, after: float
) -> None:
    before = sliding(FORWARD)
    assert sliding(twist, seconds=after, before=before).drag == pytest.approx(7.0)


@pytest.mark.parametrize("twist", [REST, Twist(1e-3, 0.0, 0.01)])
@pytest.mark.parametrize("wrench", [Wrench(7.0, 0.0, 0.1), Wrench(0.0, 0.0, 0.2)])
def test_an_object_at_rest_tells_nothing(wrench: Wrench, twist: Twist) -> None:
    assert felt(wrench, twist, 5.0) == FeltDrag()


def test_tips_that_feel_no_force_tell_nothing() -> None:
    sums = felt(Wrench(0.0, 0.0, 0.0), FORWARD)
    assert sums.drag is None
    assert sums.line(DraggedSurface(7.0, RHO), 0.0, 0.2, 0.0) is None


def test_a_drag_is_known_after_a_while_and_follows_another_support() -> None:
    assert sliding(FORWARD, seconds=0.5 * ENOUGH).drag is None
    smooth = sliding(FORWARD, drag=3.0, seconds=10.0, before=sliding(FORWARD))
    assert smooth.drag == pytest.approx(3.0, rel=0.01)


def test_noise_of_the_forces_does_not_look_like_drag() -> None:
    sums = FeltDrag()
    for i in range(400):
        noise = 3.0 * (-1) ** i
        wrench = Wrench(4.0 + noise, noise, 0.0)
        sums = sums.step(wrench, FORWARD, ORIGIN, RHO, DT)
    assert sums.drag == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("twist", [FORWARD, CURVED, Twist(0.0, -0.05, -0.4)])
@pytest.mark.parametrize("center", [(0.02, -0.03), (-0.01, 0.04)])
def test_the_line_of_a_force_tells_the_centre_across_it(
    twist: Twist, center: Point
) -> None:
    sums = sliding(twist, center)
    line = sums.line(DraggedSurface(7.0, RHO, 0.0, center), 0.05, 0.2, 0.0)
    assert line is not None
    x, y = line.across
    assert line.value == pytest.approx(center[0] * x + center[1] * y)
    assert abs(x * sums.fx + y * sums.fy) < 1e-9


def test_a_force_that_turns_about_has_another_line() -> None:
    back = Twist(-0.05, 0.0, 0.0)
    sums = sliding(back, seconds=0.5, before=sliding(CURVED))
    alone = sliding(back, seconds=0.5)
    surface = DraggedSurface(7.0, RHO)
    assert sums.line(surface, 0.0, 0.2, 0.0) == alone.line(surface, 0.0, 0.2, 0.0)


def test_a_line_is_the_less_sure_the_more_it_turns_and_the_weaker_the_force() -> None:
    surface = DraggedSurface(7.0, RHO)
    straight, curved, weak = (
        sums.line(surface, 0.05, 0.2, 0.0)
        for sums in (sliding(FORWARD), sliding(CURVED), sliding(FORWARD, drag=1.0))
    )
    assert straight is not None
    assert curved is not None
    assert weak is not None
    assert straight.deviation < min(curved.deviation, weak.deviation)
    assert sliding(FORWARD, drag=0.1).line(surface, 0.05, 0.2, 0.0) is None
