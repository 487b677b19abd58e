"""State and inputs of the controller: tip positions, ramps, and new phases."""

from __future__ import annotations

import math
from functools import cache

import pytest

import pushpressslide as pps
from pushpressslide.control.controller import Controller
from pushpressslide.control.state import (
    ALIGN_SPEED,
    ControllerState,
    Failure,
    PhaseState,
    StallWatch,
    TipMemory,
    between,
    by_arm,
    contact_yaw,
    enter_phase,
    estimates,
    pressed,
    ramp_time,
    smooth,
    smooth_change,
    smooth_rate,
    sunk,
    tip_position,
)
from pushpressslide.core.control import Measurement, TipCommand, TipState, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.execution.normal_force import NormalForceState

ZERO = (0.0, 0.0, 0.0)
RADIUS = 0.02
SIDE = Contact(0, "side", (-0.1, 0.03), (1.0, 0.0), 0.05)
TOP = Contact(0, "top", (0.02, -0.01), (0.0, 0.0), 0.12, 20.0)
POSE = Pose2(0.4, -0.2, 0.7)


def test_a_ramp_goes_from_rest_to_rest_and_no_farther() -> None:
    assert [smooth(u) for u in (-1.0, 0.0, 0.5, 1.0, 3.0)] == [0.0, 0.0, 0.5, 1.0, 1.0]
    for rate in (smooth_rate, smooth_change):
        assert [rate(u) for u in (-1.0, 0.0, 1.0, 3.0)] == [0.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("u", [0.1, 0.3, 0.5, 0.77])
def test_rate_and_change_of_a_ramp_are_its_derivatives(u: float) -> None:
    h = 1e-5
    rate = (smooth(u + h) - smooth(u - h)) / (2.0 * h)
    assert smooth_rate(u) == pytest.approx(rate, rel=1e-6)
    change = (smooth_rate(u + h) - smooth_rate(u - h)) / (2.0 * h)
    assert smooth_change(u) == pytest.approx(change, rel=1e-6, abs=1e-6)
    assert smooth(u) + smooth(1.0 - u) == pytest.approx(1.0)


def test_a_ramp_is_as_fast_as_it_may_be_in_its_middle() -> None:
    for way in (0.3, -0.3):
        duration = ramp_time(way, 0.25)
        assert 0.3 * smooth_rate(0.5) / duration == pytest.approx(0.25)
    assert ramp_time(0.1) == ramp_time(0.1, ALIGN_SPEED)


def test_a_share_of_the_way_is_on_the_line() -> None:
    a = (1.0, 2.0, 3.0)
    b = (2.0, 0.0, 7.0)
    assert between(a, b, 0.0) == a
    assert between(a, b, 1.0) == b
    assert between(a, b, 0.25) == pytest.approx((1.25, 1.5, 4.0))


def test_a_tip_touches_its_contact_with_its_surface() -> None:
    x, y, height = tip_position(SIDE, POSE, RADIUS)
    assert height == SIDE.height
    assert math.dist((x, y), POSE.apply(SIDE.point)) == pytest.approx(RADIUS)
    assert POSE.unapply((x, y)) == pytest.approx((-0.1 - RADIUS, 0.03))
    x, y, height = tip_position(SIDE, POSE, RADIUS, 0.05)
    assert POSE.unapply((x, y)) == pytest.approx((-0.1 - RADIUS - 0.05, 0.03))
    x, y, height = tip_position(TOP, POSE, RADIUS, 0.01)
    assert (x, y) == pytest.approx(POSE.apply(TOP.point))
    assert height == pytest.approx(TOP.height + RADIUS + 0.01)


@pytest.mark.parametrize("normal", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.6, -0.8)])
def test_the_contact_frame_looks_along_the_normal_of_its_face(
    normal: tuple[float, float],
) -> None:
    yaw = contact_yaw(Contact(0, "side", (0.0, 0.0), normal, 0.05), POSE)
    x, y = POSE.rotate(normal)
    assert (math.cos(yaw), math.sin(yaw)) == pytest.approx((x, y))
    assert contact_yaw(TOP, POSE) == POSE.yaw


def test_a_normal_force_is_what_a_force_has_along_the_direction() -> None:
    direction = (0.48, 0.6, 0.64)
    force = tuple(3.0 * d for d in direction)
    assert pressed(force, direction) == pytest.approx(3.0)
    across = (0.6, -0.48, 0.0)
    assert pressed(across, direction) == pytest.approx(0.0)
    assert pressed((0.0, 0.0, -5.0), (0.0, 0.0, -1.0)) == 5.0


def test_a_press_has_sunk_that_is_lower_than_it_rests_on_top() -> None:
    rests = TOP.height + RADIUS
    for height, low in ((rests - 0.006, True), (rests - 0.004, False), (0.5, False)):
        tip = TipState((0.0, 0.0, height), ZERO, ZERO)
        assert sunk(TOP, tip, RADIUS, 0.005) == low
    edge = TipState((0.0, 0.0, rests - 0.005), ZERO, ZERO)
    assert not sunk(TOP, edge, RADIUS, 0.005)
    assert not sunk(SIDE, TipState((0.0, 0.0, -1.0), ZERO, ZERO), RADIUS, 0.005)


def test_each_arm_has_the_command_of_its_contact() -> None:
    first, second = (
        TipCommand((f, 0.0, 0.0), ZERO, ZERO, ZERO, ZERO, 0.0, 0.0, 0.0, 5.0, 0.0)
        for f in (1.0, 2.0)
    )
    contacts = (
        Contact(2, "top", (0.0, 0.0), (0.0, 0.0), 0.1),
        Contact(0, "top", (0.0, 0.0), (0.0, 0.0), 0.1),
    )
    assert by_arm((first, second), contacts, 3) == (second, None, first)


@cache
def controller() -> Controller:
    return Controller(pps.plan(pps.load_task("press-slide")))


def pressing(name: str) -> ControllerState:
    """Return the state of a press in its phase, half a second after it began."""
    made = controller()
    start = made.placement.query.start
    tip = TipState((0.1, 0.2, 0.3), ZERO, ZERO)
    state = made.init(Measurement(0.0, start, (tip,)))
    (memory,) = state.phase.tips
    memory = memory._replace(
        felt=0.2, regulator=NormalForceState(1.5, 20.0), velocity=(0.1, 0.0), turn=0.2
    )
    phase = state.phase._replace(
        name=name, tips=(memory,), retreat_fraction=0.4, align=False
    )
    watches = state.watches._replace(lost=0.3, retouches=2)
    return state._replace(phase=phase, watches=watches)


@pytest.mark.parametrize("name", ["touch", "move", "release"])
def test_a_phase_begins_where_the_tips_are_and_remembers_no_touch(name: str) -> None:
    tip = TipState((0.5, 0.6, 0.7), ZERO, ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    before = pressing("touch")
    state = enter_phase(before, name, now, ("contact_lost", "it is gone"))
    phase = state.phase
    (memory,) = phase.tips
    assert (phase.name, phase.since, phase.align, phase.retreat_fraction) == (
        name,
        3.0,
        True,
        1.0,
    )
    assert phase.failure == ("contact_lost", "it is gone")
    assert memory.start == tip.position
    assert (memory.felt, memory.velocity, memory.turn) == (None, None, 0.0)
    assert state.watches.retouches == 2
    assert state.following == before.following


def carried(
    name: str,
    failure: Failure | None = None,
    *,
    at_once: bool = False,
    velocity: Vector3 = (0.1, 0.0, 0.0),
) -> tuple[Point, float]:
    """Return the motion that a tip of a ``velocity`` [m/s] has as a phase begins."""
    tip = TipState((0.5, 0.6, 0.7), velocity, ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    state = enter_phase(pressing("move"), name, now, failure, at_once=at_once)
    (memory,) = state.phase.tips
    return memory.carried, memory.spin


def test_tips_slow_down_before_a_touch_or_a_failure() -> None:
    moves = ((0.1, 0.0), 0.2)
    rests = ((0.0, 0.0), 0.0)
    lost: Failure = ("contact_lost", "it is gone")
    assert carried("touch") == moves
    assert carried("release", lost) == moves
    assert carried("release", lost, at_once=True) == rests
    # the goal is reached: the tip creeps, and goes no farther
    assert carried("release") == rests


@pytest.mark.parametrize(
    ("velocity", "share"), [(0.2, 1.0), (0.05, 0.5), (0.0, 0.0), (-0.1, 0.0)]
)
def test_a_tip_that_something_holds_back_is_not_pushed_on(
    velocity: float, share: float
) -> None:
    moves, _ = carried("touch", velocity=(velocity, 0.3, 0.1))
    assert moves == pytest.approx((0.1 * share, 0.0))


def test_a_tip_that_has_been_held_still_does_not_slow_down() -> None:
    tip = TipState((0.5, 0.6, 0.7), (0.1, 0.0, 0.0), ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    state = enter_phase(pressing("move"), "touch", now)
    assert state.phase.slows
    assert not state.delayed(0.5).phase.slows


def test_a_press_that_goes_on_keeps_what_its_regulator_knows() -> None:
    tip = TipState((0.5, 0.6, 0.7), ZERO, ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    kept = {
        name: enter_phase(pressing("touch"), name, now).phase.tips[0].regulator
        for name in ("touch", "move", "release")
    }
    none = NormalForceState()
    assert kept == {
        "touch": none,
        "move": NormalForceState(1.5, 20.0),
        "release": none,
    }


def test_a_contact_that_is_touched_again_is_missing_since_it_was_lost() -> None:
    tip = TipState((0.5, 0.6, 0.7), ZERO, ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    lost = {
        name: enter_phase(pressing("move"), name, now).watches.lost
        for name in ("touch", "move", "release")
    }
    assert lost == {"touch": 0.3, "move": None, "release": None}


def test_a_turn_that_no_path_led_on_from_is_not_counted_while_the_tips_touch() -> None:
    tip = TipState((0.5, 0.6, 0.7), ZERO, ZERO)
    now = Measurement(3.0, controller().placement.query.start, (tip,))
    before = pressing("move")
    before = before._replace(watches=before.watches._replace(mistaken=0.3))
    assert enter_phase(before, "touch", now).watches.mistaken is None


def test_a_rho_that_is_not_identified_now_is_as_it_was_last() -> None:
    state = pressing("move")
    assert estimates(state).rho is None
    told = state._replace(following=state.following._replace(rho=0.08))
    assert estimates(told).rho == 0.08
    found = told.estimate.parameters._replace(rho=0.05)
    now = told._replace(estimate=told.estimate._replace(parameters=found))
    assert estimates(now).rho == 0.05
    assert estimates(now._replace(following=state.following)).rho == 0.05


def test_a_state_that_took_two_seconds_to_plan_begins_two_seconds_later() -> None:
    state = pressing("touch")
    still = StallWatch(POSE, 0.25)
    state = state._replace(watches=state.watches._replace(still=still, replanned=0.5))
    later = state.delayed(2.0)
    assert later.phase.since == state.phase.since + 2.0
    assert later.watches.lost == pytest.approx(2.3)
    assert later.watches.still == StallWatch(POSE, 2.25)
    assert later.watches.replanned == 2.5
    assert later.following.clock_start == state.following.clock_start + 2.0


def test_a_phase_that_is_delayed_goes_on_later() -> None:
    """A tip that advances again from where it was does so later, too."""
    tips = (TipMemory((0.0, 0.0, 0.0)), TipMemory((0.0, 0.0, 0.0), resumed=3.0))
    phase = PhaseState("touch", 2.0, tips).delayed(0.5)
    assert phase.since == 2.5
    assert [tip.resumed for tip in phase.tips] == [None, 3.5]
