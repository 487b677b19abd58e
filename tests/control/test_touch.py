"""The touch of an object that slides before its force is felt."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from pushpressslide.control.state import TipContext, TipMemory, tip_position
from pushpressslide.control.touch import TipTouch
from pushpressslide.core import margins
from pushpressslide.core.control import TipState, Vector3
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
