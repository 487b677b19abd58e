"""The touch of an object that slides before its force is felt."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from pushpressslide.control.state import (
    SLOWING_TIME,
    TipContext,
    TipMemory,
    lowered,
    ramp_time,
    smooth,
    smooth_change,
    smooth_rate,
    sunk,
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


@pytest.mark.parametrize(("noisy", "depth"), [(False, 0.0), (True, 0.035)])
def test_noise_is_not_felt_as_the_object_far_before_it(
    noisy: bool, depth: float
) -> None:
    """A force far before the contact is felt where forces have no noise."""
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator(), noisy=noisy)
    x, y, _ = BEHIND.direction(START)
    before = tip_position(BEHIND, START, RADIUS, GAP)
    memory = TipMemory(before)
    tip = before
    time = 0.0
    while memory.felt is None:
        state = TipState(tip, (0.0, 0.0, 0.0), (x, y, 0.0))
        context = TipContext(BEHIND, state, START, time, DT, 0.0, START.yaw)
        step = touch.step(memory, context, time, 0.0)
        memory = step.memory
        tip = step.command.position
        time += DT
    advance = (tip[0] - before[0]) * x + (tip[1] - before[1]) * y
    assert advance == pytest.approx(depth, abs=1e-3)


def test_a_light_object_is_touched_slowly() -> None:
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator(), light=True)
    near = (GAP - margins.ARM.felt_near) / margins.ARM.touch_speed
    depths = [touch._depth(BEHIND, near + late) for late in (-0.1, 0.0, 0.1)]
    steps = [after - before for before, after in pairwise(depths)]
    assert steps[0] == pytest.approx(0.1 * margins.ARM.touch_speed)
    assert steps[1] == pytest.approx(0.1 * margins.ARM.light_speed)


def test_a_tip_touches_again_from_where_it_is() -> None:
    """Also deep behind where the object is seen: the reference does not jump."""
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator())
    x, y, _ = BEHIND.direction(START)
    before = tip_position(BEHIND, START, RADIUS, GAP)
    tip = (before[0] + 0.08 * x, before[1] + 0.08 * y, before[2])
    memory = TipMemory(tip, advance_start=START, resumed=1.0)
    state = TipState(tip, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    context = TipContext(BEHIND, state, START, 1.0 + DT, DT, 0.0, START.yaw)
    step = touch.step(memory, context, 1.0 + DT, 0.5)
    assert math.dist(step.command.position, tip) < 2.0 * touch.speed(BEHIND) * DT


def test_a_push_that_touches_again_starts_nearer_and_looks_while_it_lines_up() -> None:
    touch = TipTouch(RADIUS, GAP, 0.1, 0.25, SEEN, NormalForceRegulator(), look=1.0)
    again = touch.once_more(BEHIND)
    assert again.gap == margins.ARM.gap_again < touch.gap
    assert replace(touch, gap=0.01).once_more(BEHIND).gap == 0.01
    assert touch.once_more(ABOVE).gap == touch.gap
    near = TipMemory(tip_position(BEHIND, START, RADIUS, again.gap))
    assert again.align_time(near, BEHIND, START) == pytest.approx(1.1)
    far = TipMemory(tip_position(BEHIND, START, RADIUS, 0.2))
    moving = ramp_time(0.2 - again.gap)
    assert again.align_time(far, BEHIND, START) == pytest.approx(moving + 0.1)
    moving = ramp_time(0.2 - touch.gap)
    assert touch.align_time(far, BEHIND, START) == pytest.approx(moving + 1.1)


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
    memory = TipMemory((x, y, z), advance_start=START, felt=felt)
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
    """Pose of a weightless object that a tip has pushed, ``advance`` [m] into its
    touch.
    """
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
    noisy = Sensing(yaw_noise=0.02)
    assert noisy.seen_turn(0.1) == pytest.approx(0.08)
    assert noisy.seen_turn(0.01) == pytest.approx(margins.ARM.slid / 0.01)
    rare = replace(noisy, pose_rate=16.0)
    assert rare.seen_turn(1.0) == pytest.approx(0.02)


def test_a_tip_that_is_drawn_back_is_told_how_its_reference_moves() -> None:
    """Otherwise its arm's inertia would turn the tool."""
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


ZERO = (0.0, 0.0, 0.0)


def made(gap: float = GAP) -> TipTouch:
    return TipTouch(RADIUS, gap, 0.4, 0.25, SEEN, NormalForceRegulator())


def at(
    place: Vector3,
    force: Vector3 = ZERO,
    contact: Contact = BEHIND,
    time: float = 1.0,
    progress: float = 0.0,
    X_WB: Pose2 = START,
) -> TipContext:
    tip = TipState(place, ZERO, force)
    return TipContext(contact, tip, X_WB, time, DT, progress, X_WB.yaw)


@pytest.mark.parametrize("contact", [BEHIND, ABOVE])
def test_a_tip_lines_up_before_its_contact_and_then_advances(
    contact: Contact,
) -> None:
    touch = made()
    before = tip_position(contact, START, RADIUS, GAP)
    begin = (before[0] + 0.03, before[1] - 0.02, before[2] + 0.01)
    memory = TipMemory(begin)
    aligned = touch.align_time(memory, contact, START)
    # a minimum-jerk way at no more than 0.1 m/s, and a little to settle
    assert aligned == pytest.approx(1.875 * math.dist(begin, before) / 0.1, abs=0.2)
    first = touch.step(memory, at(begin, contact=contact), 0.0, aligned)
    half = touch.step(memory, at(begin, contact=contact), 0.5 * aligned, aligned)
    last = touch.step(memory, at(begin, contact=contact), 0.999 * aligned, aligned)
    assert first.command.position == pytest.approx(begin)
    middle = [0.5 * (a + b) for a, b in zip(begin, before, strict=True)]
    assert half.command.position == pytest.approx(middle)
    assert last.command.position == pytest.approx(before, abs=1e-6)
    assert last.command.velocity == ZERO
    after = touch.step(memory, at(before, contact=contact), aligned + 1.0, aligned)
    n = contact.direction(START)
    speed = margins.ARM.touch_speed
    ahead = [b + speed * d for b, d in zip(before, n, strict=True)]
    assert after.command.position == pytest.approx(ahead)
    assert after.command.velocity == pytest.approx([speed * d for d in n])
    assert not first.done
    assert not after.done


def test_a_tip_that_moved_slows_down_before_it_lines_up() -> None:
    touch = made()
    before = tip_position(BEHIND, START, RADIUS, GAP)
    memory = TipMemory(before, carried=(0.1, -0.2), spin=-1.0)
    aligned = 1e6  # it stays where it is

    def command(elapsed: float) -> TipCommand:
        return touch.step(memory, at(before), elapsed, aligned).command

    first = command(0.0)
    assert first.position == pytest.approx(before)
    assert first.velocity == (0.1, -0.2, 0.0)
    assert first.tool_yaw_rate == -1.0
    h = 1e-5
    for share in (0.1, 0.5, 0.9):
        elapsed = share * SLOWING_TIME
        one, now, other = (command(elapsed + late) for late in (-h, 0.0, h))
        change = np.subtract(other.position, one.position) / (2.0 * h)
        assert now.velocity == pytest.approx(change, abs=1e-6)
        change = np.subtract(other.velocity, one.velocity) / (2.0 * h)
        assert now.acceleration == pytest.approx(change, abs=1e-6)
        rate = (other.tool_yaw_rate - one.tool_yaw_rate) / (2.0 * h)
        assert now.tool_yaw_acceleration == pytest.approx(rate, abs=1e-6)
    last = command(SLOWING_TIME)
    assert (last.velocity, last.acceleration, last.tool_yaw_rate) == (ZERO, ZERO, 0.0)
    moved = np.subtract(last.position, before)
    assert moved == pytest.approx([0.05 * SLOWING_TIME, -0.1 * SLOWING_TIME, 0.0])
    assert command(1.0).position == pytest.approx(last.position)


def test_joints_are_led_by_what_is_left_to_the_touch() -> None:
    touch = made()
    before = tip_position(BEHIND, START, RADIUS, GAP)
    memory = TipMemory(before)
    speed = margins.ARM.touch_speed
    assert touch.step(memory, at(before), 0.1, 1.0).command.progress == -GAP
    for after in (0.0, 1.0, 9.0):
        step = touch.step(memory, at(before), 1.0 + after, 1.0)
        left = max(GAP - speed * after, 0.0)
        assert step.command.progress == pytest.approx(-left)
    # once it is felt, by where it was felt
    felt = memory._replace(felt=0.9, advance_start=START, touch_depth=0.03)
    step = touch.step(felt, at(before, time=1.0), 9.0, 1.0)
    assert step.command.progress == pytest.approx(0.03 - GAP)
    # on the way the joints are where the object is
    step = touch.step(memory, at(before, progress=0.2), 2.0, 1.0)
    assert step.command.progress == 0.2


def test_an_arm_that_holds_its_contact_goes_on_with_its_command() -> None:
    command = made().step(TipMemory(ZERO), at(ZERO), 0.1, 1.0).command
    memory = TipMemory(ZERO, held_command=command)
    step = made().step(memory, at((9.0, 9.0, 9.0)), 3.0, 1.0)
    assert step.command is command
    assert step.done
    assert step.memory is memory


@pytest.mark.parametrize(("share", "here"), [(0.99, False), (1.01, True)])
def test_a_contact_is_felt_above_the_threshold_along_its_normal(
    share: float, here: bool
) -> None:
    before = tip_position(BEHIND, START, RADIUS, GAP)
    x, y, _ = BEHIND.direction(START)
    size = share * 0.25
    # what lies across the normal, and along the height, is no touch
    force = (size * x - 3.0 * y, size * y + 3.0 * x, -5.0)
    step = made().step(TipMemory(before), at(before, force), 2.0, 1.0)
    assert (step.memory.felt is not None) == here
    assert step.memory.advance_start == START
    if here:
        depth = margins.ARM.touch_speed * 1.0
        assert step.memory.felt == 1.0
        assert step.memory.touch_depth == pytest.approx(depth)


@pytest.mark.parametrize(("share", "kept"), [(0.45, False), (0.55, True)])
def test_a_contact_that_was_felt_is_kept_at_half_the_threshold(
    share: float, kept: bool
) -> None:
    before = tip_position(BEHIND, START, RADIUS, GAP)
    x, y, _ = BEHIND.direction(START)
    force = (share * 0.25 * x, share * 0.25 * y, 0.0)
    memory = TipMemory(before, advance_start=START, felt=0.5, touch_depth=GAP)
    step = made().step(memory, at(before, force), 2.0, 1.0)
    assert (step.memory.absent is None) == kept
    assert step.memory.felt == 0.5


def test_a_knock_is_no_touch_and_a_loss_takes_its_time() -> None:
    before = tip_position(BEHIND, START, RADIUS, GAP)
    arm = margins.ARM
    memory = TipMemory(before, advance_start=START, felt=1.0, touch_depth=GAP)
    knock = made().step(memory, at(before, time=1.0 + 0.9 * arm.felt_time), 3.0, 1.0)
    assert knock.memory.felt is None
    gone = made().step(memory, at(before, time=1.5), 3.0, 1.0)
    assert (gone.memory.felt, gone.memory.absent) == (1.0, 1.5)
    soon = at(before, time=1.5 + 0.9 * arm.push_loss_time)
    waiting = made().step(gone.memory, soon, 3.0, 1.0).memory
    assert (waiting.felt, waiting.absent, waiting.resumed) == (1.0, 1.5, None)
    late = at((1.0, 2.0, 3.0), time=1.5 + 1.1 * arm.push_loss_time, X_WB=Pose2())
    again = made().step(gone.memory, late, 3.0, 1.0)
    assert again.memory.felt is None
    assert again.memory.absent is None
    assert again.memory.resumed == late.time
    assert again.memory.start == (1.0, 2.0, 3.0)
    assert again.memory.advance_start == Pose2()
    assert again.command.position == (1.0, 2.0, 3.0)
    assert again.command.velocity == ZERO
    x, y, _ = BEHIND.direction(START)
    felt = made().step(gone.memory, at(before, (x, y, 0.0), time=1.55), 3.0, 1.0)
    assert (felt.memory.felt, felt.memory.absent) == (1.0, None)


@pytest.mark.parametrize("contact", [BEHIND, ABOVE])
def test_a_touch_is_done_once_its_force_has_been_reached_and_held(
    contact: Contact,
) -> None:
    touch = made()
    before = tip_position(contact, START, RADIUS, GAP)
    n = contact.direction(START)
    force: Vector3 = (5.0 * n[0], 5.0 * n[1], 5.0 * n[2])
    memory = TipMemory(before, advance_start=START, felt=1.0, touch_depth=GAP)
    arm = margins.ARM
    wanted = touch.force_of(contact)
    settled = arm.felt_time + arm.settle_time + wanted / touch.regulator.ramp
    for after, done in ((0.99 * settled, False), (1.01 * settled, True)):
        context = at(before, force, contact, time=1.0 + after)
        assert touch.step(memory, context, 3.0, 1.0).done == done
    # but not while the object is not there
    away = at(before, ZERO, contact, time=1.0 + 2.0 * settled)
    missing = memory._replace(absent=1.0 + 2.0 * settled - 0.01)
    assert not touch.step(missing, away, 3.0, 1.0).done


@pytest.mark.parametrize("contact", [BEHIND, ABOVE])
def test_a_touching_tip_presses_along_its_normal_and_is_held_across(
    contact: Contact,
) -> None:
    touch = made()
    before = tip_position(contact, START, RADIUS, GAP)
    n = contact.direction(START)
    force: Vector3 = (5.0 * n[0], 5.0 * n[1], 5.0 * n[2])
    memory = TipMemory(before, advance_start=START, felt=0.0, touch_depth=0.02)
    step = touch.step(memory, at(before, force, contact), 3.0, 1.0)
    push, state = touch.regulator.step(
        memory.regulator, touch.force_of(contact), 5.0, DT
    )
    assert step.command.force == pytest.approx([push * d for d in n])
    assert step.memory.regulator == state
    place = [b + 0.02 * d for b, d in zip(before, n, strict=True)]
    assert step.command.position == pytest.approx(place)
    along, across, up = step.command.stiffness
    assert across > 0.0
    assert (along == 0.0) == (contact is BEHIND)
    assert (up == 0.0) == (contact is ABOVE)
    assert min(step.command.damping) > 0.0
    assert step.command.tool_yaw_rate == 0.0


def test_a_tip_that_nothing_pushes_is_held_along_all_axes() -> None:
    command = made().step(TipMemory(ZERO), at(ZERO), 0.1, 1.0).command
    assert min(command.stiffness) > 0.0
    assert command.force == ZERO


def test_a_contact_is_looked_for_no_farther_than_so_deep() -> None:
    before = tip_position(BEHIND, START, RADIUS, GAP)
    arm = margins.ARM
    most = (GAP + arm.touch_depth) / arm.touch_speed
    near = made().step(TipMemory(before), at(before), 1.0 + 0.999 * most, 1.0)
    far = made().step(TipMemory(before), at(before), 1.0 + 1.001 * most, 1.0)
    assert near.problem is None
    assert far.problem is not None
    assert "no contact felt 50 mm beyond" in far.problem


def test_a_touch_tried_again_and_again_is_given_up() -> None:
    before = tip_position(BEHIND, START, RADIUS, GAP)
    arm = margins.ARM
    most = (GAP + arm.touch_depth) / arm.touch_speed + arm.longest_touch
    memory = TipMemory(before, advance_start=START, resumed=0.99)
    for elapsed, over in ((0.999 * most, False), (1.001 * most, True)):
        step = made().step(memory, at(before), 1.0 + elapsed, 1.0)
        assert (step.problem is not None) == over
    assert step.problem is not None
    assert "lost again" in step.problem
    # from that time on, at the tick itself
    assert made().step(memory, at(before), most, 0.0).problem is not None


@pytest.mark.parametrize("aligned", [0.0, 1.0])
def test_a_tip_that_goes_on_from_where_it_is_advances_from_there(
    aligned: float,
) -> None:
    """Into its face, beside the place where the touch was planned."""
    contact_place = tip_position(BEHIND, START, RADIUS, GAP)
    x, y, _ = BEHIND.direction(START)
    ahead, aside = 0.03, 0.004
    start = (
        contact_place[0] + ahead * x - aside * y,
        contact_place[1] + ahead * y + aside * x,
        contact_place[2],
    )
    memory = TipMemory(start, advance_start=START, resumed=1.0 if aligned else None)
    duration = 0.2
    context = at(start, time=1.0 + duration)
    step = made().step(memory, context, aligned + duration, aligned)
    way = margins.ARM.touch_speed * duration
    assert step.command.position == pytest.approx(
        (start[0] + way * x, start[1] + way * y, start[2])
    )
    assert step.command.progress == pytest.approx(-(GAP - ahead - way))


def test_a_tip_that_begins_beyond_the_contact_counts_from_the_contact() -> None:
    """It may push the object on by as much as one that comes from before it."""
    before = tip_position(BEHIND, START, RADIUS, GAP)
    x, y, _ = BEHIND.direction(START)
    start = (before[0] + 2.0 * GAP * x, before[1] + 2.0 * GAP * y, before[2])
    memory = TipMemory(start, advance_start=START)
    arm = margins.ARM
    most = arm.touch_depth / arm.touch_speed
    for elapsed, over in ((0.99 * most, False), (1.01 * most, True)):
        step = made().step(memory, at(start), elapsed, 0.0)
        assert (step.problem is not None) == over


@pytest.mark.parametrize(
    ("moved", "apart", "pushes"),
    [(1.1, 0.9, True), (0.9, 0.9, False), (1.1, 1.1, False), (-1.1, 0.9, False)],
)
def test_an_object_that_moved_before_its_tip_is_pushed(
    moved: float, apart: float, pushes: bool
) -> None:
    n = BEHIND.direction(START)
    on = moved * SEEN
    # turned a little, and beside: what counts lies along the push
    X_WB = Pose2(
        START.x + on * n[0] - 0.01 * n[1], START.y + on * n[1] + 0.01 * n[0], START.yaw
    )
    touching = tip_position(BEHIND, X_WB, RADIUS)
    place = tuple(t - apart * SEEN * d for t, d in zip(touching, n, strict=True))
    memory = TipMemory(place, advance_start=START)
    step = made().step(memory, at(place, X_WB=X_WB), 2.0, 1.0)
    assert (step.memory.felt is not None) == pushes


@pytest.mark.parametrize(
    ("moved", "turned", "apart", "pushes"),
    [
        (1.1, 0.0, 0.014, True),
        (1.1, 0.0, 0.016, False),
        (0.0, 0.11, 0.0, True),
        (0.0, -0.11, 0.0, True),
        (0.0, 0.09, 0.0, False),
        (0.0, 0.11, 0.016, False),
    ],
)
def test_a_light_object_that_moves_or_turns_before_a_near_tip_is_pushed(
    moved: float, turned: float, apart: float, pushes: bool
) -> None:
    """Nothing but the tip moves it, though the tip may be seen elsewhere."""
    touch = replace(made(), light=True, min_turn=0.1)
    n = BEHIND.direction(START)
    on = moved * SEEN
    yaw = START.yaw + turned
    X_WB = Pose2(START.x + on * n[0], START.y + on * n[1], yaw)
    touching = tip_position(BEHIND, X_WB, RADIUS)
    place = tuple(t - apart * d for t, d in zip(touching, n, strict=True))
    memory = TipMemory(place, advance_start=START)
    step = touch.step(memory, at(place, X_WB=X_WB), 2.0, 1.0)
    assert (step.memory.felt is not None) == pushes


def test_an_object_pressed_from_above_is_not_seen_pushed() -> None:
    moved = Pose2(START.x + 1.0, START.y, START.yaw)
    memory = TipMemory(ZERO, advance_start=START)
    place = tip_position(ABOVE, moved, RADIUS)
    step = made().step(memory, at(place, contact=ABOVE, X_WB=moved), 2.0, 1.0)
    assert step.memory.felt is None


def test_a_tip_on_top_that_lost_its_touch_looks_where_it_is() -> None:
    """One that goes on from where it is may have slid off, too."""
    rests = tip_position(ABOVE, START, RADIUS)
    low = (rests[0], rests[1], rests[2] - 1.1 * margins.ARM.sunk)
    step = made().step(
        TipMemory(low, advance_start=START), at(low, contact=ABOVE), 0.1, 0.0
    )
    assert step.problem is not None
    assert not step.done
    assert step.command.position == low
    # while it lines up nothing is wrong
    step = made().step(TipMemory(low), at(low, contact=ABOVE), 0.1, 1.0)
    assert step.problem is None


def test_a_tip_that_lines_up_does_so_where_the_object_was_found() -> None:
    there = Pose2(0.0, 0.0, 0.0)
    memory = TipMemory(ZERO, advance_start=there)
    before = tip_position(BEHIND, there, RADIUS, GAP)
    wanted = 1.875 * math.hypot(*before) / 0.1
    assert made().align_time(memory, BEHIND, START) == pytest.approx(wanted, abs=0.2)
    assert made().align_time(memory, BEHIND, START) > wanted


def test_a_touch_is_believed_from_its_time_on() -> None:
    """And given up from its time on, at the tick itself."""
    before = tip_position(BEHIND, START, RADIUS, GAP)
    x, y, _ = BEHIND.direction(START)
    arm = margins.ARM
    memory = TipMemory(before, advance_start=START, felt=0.0, touch_depth=GAP)
    force: Vector3 = (x, y, 0.0)
    pressing = made().step(memory, at(before, force, time=arm.felt_time), 3.0, 1.0)
    assert pressing.command.velocity == ZERO
    assert pressing.command.stiffness[0] == 0.0
    gone = memory._replace(absent=0.0, felt=-1.0)
    late = made().step(gone, at(before, time=arm.push_loss_time), 3.0, 1.0)
    assert late.memory.resumed == arm.push_loss_time
    kept = made().step(memory, at(before, time=arm.felt_time), 3.0, 1.0)
    assert kept.memory.felt == 0.0
    assert kept.memory.absent == arm.felt_time


def test_an_object_has_to_move_by_more_than_what_is_seen() -> None:
    """And to be nearer to its tip than that."""
    first = Pose2(0.0, 0.0, 0.0)
    moved = Pose2(SEEN, 0.0, 0.0)
    contact = Contact(0, "side", (0.0, 0.0), (1.0, 0.0), 0.03)
    touching = tip_position(contact, moved, 0.0)
    touch = TipTouch(0.0, GAP, 0.4, 0.25, SEEN, NormalForceRegulator())
    memory = TipMemory(touching, advance_start=first)
    step = touch.step(memory, at(touching, contact=contact, X_WB=moved), 2.0, 1.0)
    assert step.memory.felt is None
    farther = Pose2(2.0 * SEEN, 0.0, 0.0)
    behind = (SEEN, 0.0, 0.03)
    step = touch.step(memory, at(behind, contact=contact, X_WB=farther), 2.0, 1.0)
    assert step.memory.felt is None
    near = (1.1 * SEEN, 0.0, 0.03)
    step = touch.step(memory, at(near, contact=contact, X_WB=farther), 2.0, 1.0)
    assert step.memory.felt is not None


def test_a_press_is_lost_below_where_it_touched() -> None:
    """An arm that is wrong by millimetres touches a top below its planned height."""
    rests = tip_position(ABOVE, START, RADIUS)
    touched_at = (rests[0], rests[1], rests[2] - 0.8 * margins.ARM.sunk)
    memory = TipMemory(touched_at, advance_start=START)
    feels = at(touched_at, (0.0, 0.0, -5.0), contact=ABOVE)
    memory = made().step(memory, feels, 0.1, 0.0).memory
    assert memory.felt is not None
    assert memory.lowered == pytest.approx(0.8 * margins.ARM.sunk)
    for deeper, lost in ((1.7, False), (1.9, True)):
        low = (rests[0], rests[1], rests[2] - deeper * margins.ARM.sunk)
        step = made().step(memory, at(low, contact=ABOVE), 0.1, 0.0)
        assert (step.problem is not None) == lost


def test_a_tip_beside_its_object_presses_on_no_top() -> None:
    """What it touches is the support."""
    low = replace(ABOVE, height=0.008)
    rests = tip_position(low, START, RADIUS)
    table = TipState((rests[0], rests[1], RADIUS), ZERO, ZERO)
    depth = lowered(low, table, RADIUS, margins.ARM.sunk)
    assert sunk(low, table, RADIUS, margins.ARM.sunk + depth)
    assert lowered(BEHIND, table, RADIUS, margins.ARM.sunk) == 0.0
