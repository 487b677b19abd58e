"""Admittance of a tip: its force decides how fast it moves."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, TipState, Vector3
from pushpressslide.execution.admittance import Admittance

LATE = 0.03  # [s]
NOTHING = (0.0, 0.0, 0.0)
PLACE = (0.4, 0.1, 0.02)
PUSH = TipCommand(
    force=(3.0, -1.0, 0.0),
    position=PLACE,
    velocity=(0.02, 0.01, -0.03),
    stiffness=NOTHING,
    damping=NOTHING,
    normal_yaw=0.0,
    tool_yaw=0.0,
    tool_yaw_rate=0.0,
    servo_cap=0.0,
    progress=0.0,
)


def velocity(command: TipCommand, tip: TipState, reaction: float = LATE) -> Vector3:
    return Admittance(reaction).velocity(command, tip)


def added(
    command: TipCommand, tip: TipState, reaction: float = LATE
) -> tuple[float, ...]:
    """Velocity besides that of the reference."""
    out = velocity(command, tip, reaction)
    return tuple(v - r for v, r in zip(out, command.velocity, strict=True))


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("reaction", [0.004, 0.1])
def test_a_tip_with_its_force_follows_its_reference(
    yaw: float, reaction: float
) -> None:
    command = replace(PUSH, normal_yaw=yaw)
    tip = TipState((0.1, 0.2, 0.3), NOTHING, PUSH.force)
    assert velocity(command, tip, reaction) == pytest.approx(PUSH.velocity)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_the_missing_force_moves_the_tip_along_it(yaw: float) -> None:
    missing = np.array([0.5, -0.2, 0.3])
    tip = TipState(PLACE, NOTHING, tuple((np.array(PUSH.force) - missing).tolist()))
    extra = added(replace(PUSH, normal_yaw=yaw), tip)
    assert extra == pytest.approx(missing / Admittance(LATE).damping)


def test_the_later_an_arm_the_more_its_tip_is_damped() -> None:
    tip = TipState(PLACE, NOTHING, (2.5, -1.0, 0.0))
    one, other = (added(PUSH, tip, reaction)[0] for reaction in (LATE, 3.0 * LATE))
    assert one == pytest.approx(3.0 * other)
    # in a tip's spring, the loop's time constant is a multiple of the reaction time
    time = Admittance(LATE).damping / margins.ARM.contact_stiffness
    assert time == pytest.approx(margins.ARM.loop_share * LATE)
    assert margins.ARM.loop_share > 2.0 / math.pi  # a dead time less is unstable


def test_a_larger_damping_of_the_command_is_kept() -> None:
    tip = TipState(PLACE, NOTHING, (2.0, -2.0, 0.0))
    heavy = 2.0 * Admittance(LATE).damping
    extra = added(replace(PUSH, damping=(heavy, 0.0, 0.0)), tip)
    assert extra[0] == pytest.approx(1.0 / heavy)
    assert extra[1] == pytest.approx(1.0 / Admittance(LATE).damping)


def test_an_axis_with_a_spring_goes_to_its_place() -> None:
    off = (0.39, 0.096, 0.025)
    yaw = 0.5 * math.pi  # n is y, t is -x
    command = replace(PUSH, normal_yaw=yaw, stiffness=(0.0, 400.0, 400.0))
    extra = added(command, TipState(off, NOTHING, PUSH.force))
    rate = margins.ARM.position_rate
    assert extra == pytest.approx((rate * 0.01, 0.0, -rate * 0.005))


@pytest.mark.parametrize("force", [(1e4, -2e3, 0.0), (-1e4, 0.0, 1e4)])
def test_corrections_are_slow_and_keep_their_direction(force: Vector3) -> None:
    extra = np.array(added(PUSH, TipState(PLACE, NOTHING, force)))
    assert np.linalg.norm(extra) == pytest.approx(margins.ARM.correction_speed)
    missing = np.array(PUSH.force) - force
    assert np.cross(extra, missing) == pytest.approx(0.0, abs=1e-9)
    assert extra @ missing > 0.0


def pressed(reaction: float, dead: float) -> np.ndarray:
    """Forces of a tip on a spring whose arm obeys a velocity after ``dead`` [s]."""
    dt = dead / 50.0
    stiffness = margins.ARM.contact_stiffness
    press = replace(PUSH, force=(0.0, 0.0, -10.0), velocity=NOTHING)
    waiting = [0.0] * 50
    force, forces = 0.0, []
    for _ in range(round(3.0 / dt)):
        tip = TipState(PLACE, NOTHING, (0.0, 0.0, -force))
        waiting.append(velocity(press, tip, reaction)[2])
        force = max(0.0, force - stiffness * dt * waiting.pop(0))
        forces.append(force)
    return np.array(forces)


@pytest.mark.parametrize("reaction", [0.004, 0.03, 0.12])
def test_a_press_by_a_late_arm_settles_without_overshoot(reaction: float) -> None:
    forces = pressed(reaction, reaction)
    assert forces[-1] == pytest.approx(10.0, rel=1e-3)
    assert forces.max() < 10.5


def test_a_press_by_an_arm_later_than_stated_swings() -> None:
    """The law above can fail."""
    forces = pressed(0.03, 0.12)
    assert forces[len(forces) // 2 :].max() > 12.0
