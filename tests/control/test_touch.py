"""The touch of an object that slides before its force is felt."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from pushpressslide.control.state import (
    TipContext,
    TipMemory,
    smooth,
    smooth_change,
    smooth_rate,
    tip_position,
)
from pushpressslide.control.touch import TipTouch, WayBack, drawn_back
from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Sensing
from pushpressslide.execution.normal_force import NormalForceRegulator

RADIUS = 0.02
GAP = 0.05
DT = 0.004
BEHIND = Contact(0, "side", (-0.05, 0.0), (1.0, 0.0), 0.03)
START = Pose2(0.5, 0.1, 0.4)
SEEN = Sensing().seen_motion


def touched(
    pose_at: Callable[[float], Pose2], felt_force: float = 0.0
) -> tuple[float | None, str | None]:
    """Return at which advance [m] a tip that is where it is led to believes its touch,
    and its problem; ``pose_at`` the tip's place along the push [m], X_WB.
    """
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator())
    x, y, _ = BEHIND.direction(START)
    before = tip_position(BEHIND, START, RADIUS, GAP)
    memory = TipMemory(before)
    tip = before
    time = 0.0
    while time < 10.0:
        advance = (tip[0] - before[0]) * x + (tip[1] - before[1]) * y
        X_WB = pose_at(advance)
        force: Vector3 = (felt_force * x, felt_force * y, 0.0)
        state = TipState(tip, (0.0, 0.0, 0.0), force if advance > GAP else (0.0,) * 3)
        context = TipContext(BEHIND, state, X_WB, time, DT, 0.0, X_WB.yaw)
        step = touch.step(memory, context, time, 0.0)
        memory = step.memory
        if step.problem is not None or step.done:
            return (memory.touch_depth if step.done else None), step.problem
        tip = step.command.position
        time += DT
    return None, None


def test_a_press_is_as_hard_as_its_contact_asks_for() -> None:
    """Also where it is asked to press harder than when the touch was made ready."""
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator())
    above = Contact(0, "top", (0.0, 0.0), (0.0, 0.0), 0.06, 7.5)
    assert touch.force_of(above) == 7.5
    assert touch.force_of(BEHIND) == 0.1


ABOVE = Contact(0, "top", (0.0, 0.0), (0.0, 0.0), 0.06, 40.0)


def pressed_at(
    height: float,
    aligned: float,
    felt: float | None,
    sunk: float = margins.ARM.sunk,
) -> str | None:
    """Return the problem of a press whose tip is ``height`` [m] off its place on top,
    and feels the side of the object beside it; ``sunk`` [m] as of ``TipTouch``.
    """
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator(), sunk)
    x, y, z = tip_position(ABOVE, START, RADIUS, 0.0)
    tip = TipState((x, y, z + height), (0.0, 0.0, 0.0), (0.6, 0.0, -0.5))
    context = TipContext(ABOVE, tip, START, 1.0, DT, 0.0, 0.4)
    memory = TipMemory((x, y, z), found=START, felt=felt)
    return touch.step(memory, context, 1.0, aligned).problem


@pytest.mark.parametrize(("aligned", "felt"), [(0.0, None), (0.5, 0.8)])
def test_a_tip_that_slid_off_the_top_is_pressed_no_further(
    aligned: float, felt: float | None
) -> None:
    """It would fall beside the object, as fast as the press lets it."""
    problem = pressed_at(-1.1 * margins.ARM.sunk, aligned, felt)
    assert problem is not None
    assert "slid off the top" in problem
    assert pressed_at(-0.9 * margins.ARM.sunk, aligned, felt) is None


def test_a_tip_goes_down_with_an_object_that_drops_into_an_opening() -> None:
    assert pressed_at(-0.1, 0.0, None, math.inf) is None


def test_a_tip_on_its_way_down_looks_for_an_object_that_is_lower() -> None:
    assert pressed_at(-2.0 * margins.ARM.sunk, 0.5, None) is None


def test_a_contact_that_fades_is_advanced_to_again() -> None:
    """A touch is complete only while the object is felt; a tip that lost it goes on from
    where it is, and its reference does not jump.
    """
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator())
    x, y, _ = BEHIND.direction(START)
    before = tip_position(BEHIND, START, RADIUS, GAP)
    tip = before
    memory = TipMemory(before)
    felt = lost = again = False
    for i in range(2000):
        time = i * DT
        advance = (tip[0] - before[0]) * x + (tip[1] - before[1]) * y
        lost = lost or (memory.felt is not None and time - memory.felt > 0.1)
        there = GAP + 0.004 if lost else GAP  # it yields a little
        force: Vector3 = (0.0, 0.0, 0.0)
        if advance > there:
            force = (0.4 * x, 0.4 * y, 0.0)
        context = TipContext(
            BEHIND, TipState(tip, (0.0, 0.0, 0.0), force), START, time, DT, 0.0, 0.4
        )
        step = touch.step(memory, context, time, 0.0)
        assert math.dist(step.command.position, tip) < 0.003
        felt = felt or step.memory.felt is not None
        again = again or step.memory.resumed is not None
        memory = step.memory
        if step.done:
            break
        assert step.problem is None
        tip = step.command.position
    assert felt
    assert lost
    assert again
    assert step.done
    assert advance > GAP + 0.004


def test_a_touch_that_never_lasts_ends_with_a_problem() -> None:
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator())
    x, y, _ = BEHIND.direction(START)
    before = tip_position(BEHIND, START, RADIUS, GAP)
    memory = TipMemory(before)
    for i in range(5000):
        time = i * DT
        felt = (time % 0.3) < 0.05 and time > 1.0
        force: Vector3 = (0.4 * x, 0.4 * y, 0.0) if felt else (0.0, 0.0, 0.0)
        state = TipState(before, (0.0, 0.0, 0.0), force)
        context = TipContext(BEHIND, state, START, time, DT, 0.0, 0.4)
        step = touch.step(memory, context, time, 0.0)
        memory = step.memory
        if step.problem is not None:
            break
        assert not step.done
    assert step.problem is not None
    assert "lost again" in step.problem


def pushed(advance: float) -> Pose2:
    """Return where a tip that is ``advance`` [m] on has an object that weighs nothing."""
    x, y, _ = BEHIND.direction(START)
    on = max(0.0, advance - GAP)
    return Pose2(START.x + on * x, START.y + on * y, START.yaw)


def test_a_light_object_is_seen_to_be_pushed() -> None:
    depth, problem = touched(pushed)
    assert problem is None
    assert depth == pytest.approx(GAP + SEEN, abs=2.0 * margins.ARM.touch_speed * DT)


def test_a_force_is_felt_before() -> None:
    depth, _ = touched(pushed, felt_force=0.3)
    assert depth == pytest.approx(GAP, abs=2.0 * margins.ARM.touch_speed * DT)


def test_an_object_that_moves_away_untouched_is_not_followed() -> None:
    """It is not where it was found, and the tip stops beyond that place."""

    def fleeing(advance: float) -> Pose2:
        x, y, _ = BEHIND.direction(START)
        return Pose2(START.x + 2.0 * advance * x, START.y + 2.0 * advance * y, 0.4)

    depth, problem = touched(fleeing)
    assert depth is None
    assert problem is not None
    assert "50 mm beyond" in problem


def test_an_object_that_stands_still_is_not_seen_to_be_pushed() -> None:
    depth, problem = touched(lambda _: START)
    assert depth is None
    assert problem is not None


def test_what_is_seen_grows_with_the_noise() -> None:
    assert Sensing(position_noise=0.002).seen_motion == pytest.approx(0.008)
    assert Sensing().seen_motion == margins.ARM.slid
    assert math.isclose(SEEN, margins.ARM.slid)


def test_a_tip_that_is_drawn_back_is_told_how_its_reference_moves() -> None:
    """Its arm's inertia would turn the tool else."""
    room = 0.06
    dt = 1e-5

    def at(u: float) -> TipCommand:
        way = WayBack(room * smooth(u), room * smooth_rate(u), room * smooth_change(u))
        state = TipState((0.1, 0.2, 0.03), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        context = TipContext(BEHIND, state, START, 0.0, DT, 0.0, START.yaw)
        return drawn_back(context, state.position, way)

    n = BEHIND.direction(START)
    for u in (0.1, 0.35, 0.5, 0.8):
        before, now, after = at(u - dt), at(u), at(u + dt)
        for i in range(3):
            x = before.position[i], now.position[i], after.position[i]
            assert now.velocity[i] == pytest.approx((x[2] - x[0]) / (2 * dt), abs=1e-9)
            v = before.velocity[i], after.velocity[i]
            change = (v[1] - v[0]) / (2 * dt)
            assert now.acceleration[i] == pytest.approx(change, abs=1e-8)
    assert math.dist(at(1.0).position, at(0.0).position) == pytest.approx(room)
    off = [a - b for a, b in zip(at(1.0).position, at(0.0).position, strict=True)]
    assert sum(a * b for a, b in zip(off, n, strict=True)) == pytest.approx(-room)
    for u in (0.0, 1.0):
        assert at(u).velocity == pytest.approx((0.0, 0.0, 0.0))
        assert at(u).acceleration == pytest.approx((0.0, 0.0, 0.0))
