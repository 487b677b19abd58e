"""Approaches: their end points, their speed, and how they come to rest when stopped."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.control.approach import (
    HALT,
    SETTLE,
    TRAVEL_SPEED,
    JointApproach,
    TipApproach,
    tip_path,
)
from pushpressslide.core.control import JointCommand, TipCommand
from pushpressslide.core.plan import JointPath
from pushpressslide.core.pose import Pose2

BEGIN = (0.1, 0.2, 0.05)
END = (0.4, -0.1, 0.08)
ABOVE = 0.3  # [m]
STEP = 0.002  # [s]
ARM = JointPath(
    approach_time=np.array([0.0, 1.0]),
    approach=np.array([[0.0, 0.0], [1.0, -2.0]]),
    arc_length=np.array([0.0, 1.0]),
    move=np.array([[1.0, -2.0], [1.0, -2.0]]),
    tool_yaw_offset=0.0,
    joint_margin=1.0,
    condition=1.0,
    clearance=1.0,
    gap=0.001,
)


def places(path, duration):
    times = np.arange(0.0, duration, STEP)
    return times, np.array([path.state_at(t)[0] for t in times])


def test_a_tip_travels_over_the_object_at_a_finite_speed() -> None:
    path = tip_path(BEGIN, END, ABOVE)
    _, p = places(path, path.duration + STEP)
    assert p[0] == pytest.approx(BEGIN)
    assert p[-1] == pytest.approx(END)
    speed = np.linalg.norm(np.diff(p, axis=0), axis=1) / STEP
    assert speed.max() == pytest.approx(TRAVEL_SPEED, rel=0.01)
    aside = np.hypot(p[:, 0] - BEGIN[0], p[:, 1] - BEGIN[1]) > 1e-6
    across = aside & (np.hypot(p[:, 0] - END[0], p[:, 1] - END[1]) > 1e-6)
    assert p[across, 2].min() == pytest.approx(ABOVE)


def test_the_velocity_of_a_travel_is_the_derivative_of_its_place() -> None:
    path = tip_path(BEGIN, END, ABOVE)
    for t in np.linspace(0.05, path.duration - 0.05, 17):
        before = np.array(path.state_at(t - 1e-5)[0])
        after = np.array(path.state_at(t + 1e-5)[0])
        assert np.array(path.state_at(t)[1]) == pytest.approx(
            (after - before) / 2e-5, abs=1e-4
        )


def test_tips_that_stay_take_no_time() -> None:
    approach = TipApproach(Pose2(), [None, None], (None, None), 3.0)
    assert approach.arrival == 3.0


def approaches():
    joints = JointApproach(Pose2(), (ARM,), (None,), 2.0)
    tips = TipApproach(Pose2(), [tip_path(BEGIN, END, ABOVE)], (None,), 2.0)
    return [joints, tips]


def place(command) -> np.ndarray:
    assert isinstance(command, JointCommand | TipCommand)
    return np.array(command.position)


@pytest.mark.parametrize("kind", [0, 1])
def test_an_approach_that_is_halted_comes_to_rest_on_its_path(kind: int) -> None:
    halted = approaches()[kind]
    free = approaches()[kind]
    at = 2.0 + 0.4
    halted.halt(at)
    assert not halted.at_rest(at + HALT)
    assert halted.at_rest(at + HALT + SETTLE + STEP)
    assert halted.arrival == math.inf
    times = np.arange(at, at + HALT + 0.1, STEP)
    p = np.array([place(halted.step(t)[0][0]) for t in times])
    end = place(free.step(at + 0.5 * HALT)[0][0])
    assert p[-1] == pytest.approx(end, abs=1e-9)
    steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
    assert steps[-1] == 0.0
    assert np.diff(steps).max() < 1e-4  # it never speeds up noticeably
    assert np.array(halted.step(times[-1])[0][0].velocity) == pytest.approx(0.0)


def test_a_tip_goes_up_across_and_down_each_by_itself() -> None:
    path = tip_path(BEGIN, END, ABOVE)
    up = (BEGIN[0], BEGIN[1], ABOVE)
    over = (END[0], END[1], ABOVE)
    assert path.corners == (BEGIN, up, over, END)
    ways = (ABOVE - BEGIN[2], math.hypot(0.3, 0.3), ABOVE - END[2])
    # a minimum-jerk ramp is 1.875 times as fast at its fastest as on average
    assert path.duration == pytest.approx(1.875 * sum(ways) / TRAVEL_SPEED)
    assert 0.05 < TRAVEL_SPEED < 1.0


@pytest.mark.parametrize("high", [0, 1])
def test_a_tip_that_begins_or_ends_higher_travels_there(high: int) -> None:
    ends = [BEGIN, END]
    x, y, _ = ends[high]
    ends[high] = (x, y, 0.5)
    path = tip_path(ends[0], ends[1], ABOVE)
    assert max(corner[2] for corner in path.corners) == 0.5
    assert len(path.corners) == 3
    _, p = places(path, path.duration)
    assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 1.01 * TRAVEL_SPEED * STEP


def test_a_tip_that_is_there_already_needs_no_time() -> None:
    path = tip_path(BEGIN, BEGIN, 0.0)
    assert path.duration == 0.0
    assert path.state_at(0.0) == (BEGIN, (0.0, 0.0, 0.0))
    assert path.state_at(9.0) == (BEGIN, (0.0, 0.0, 0.0))


def test_a_travel_passes_its_corners_at_rest() -> None:
    path = tip_path(BEGIN, END, ABOVE)
    first = 1.875 * (ABOVE - BEGIN[2]) / TRAVEL_SPEED
    place_, velocity = path.state_at(first)
    assert place_ == pytest.approx(path.corners[1])
    assert velocity == pytest.approx((0.0, 0.0, 0.0))
    middle, velocity = path.state_at(0.5 * first)
    assert middle[2] == pytest.approx(0.5 * (BEGIN[2] + ABOVE))
    assert velocity == pytest.approx((0.0, 0.0, TRAVEL_SPEED))


@pytest.mark.parametrize("kind", [0, 1])
def test_an_approach_begins_at_its_time_and_rests_at_its_end(
    kind: int,
) -> None:
    approach = approaches()[kind]
    path = tip_path(BEGIN, END, ABOVE)
    begin, duration = ((0.0, 0.0), 1.0) if kind == 0 else (BEGIN, path.duration)
    end = (1.0, -2.0) if kind == 0 else END
    assert approach.arrival == pytest.approx(2.0 + duration + SETTLE)
    assert 0.0 < SETTLE < 1.0
    assert place(approach.step(2.0)[0][0]) == pytest.approx(begin)
    (last,), log = approach.step(approach.arrival)
    assert place(last) == pytest.approx(end)
    assert np.array(last.velocity) == pytest.approx(0.0)
    assert (log.phase, log.progress, log.thought().reference) == (
        "approach",
        0.0,
        Pose2(),
    )
    assert not approach.at_rest(1e9)


@pytest.mark.parametrize("kind", [0, 1])
@pytest.mark.parametrize("halt", [None, 2.35])
def test_the_velocity_that_is_commanded_is_that_of_the_place(
    kind: int, halt: float | None
) -> None:
    approach = approaches()[kind]
    if halt is not None:
        approach.halt(halt)
    h = 1e-5
    for time in (2.2, 2.4, 2.5, 2.6):
        if halt is not None and time < halt:
            continue
        before, now, after = (
            approach.step(time + k * h)[0][0] for k in (-1.0, 0.0, 1.0)
        )
        slope = (place(after) - place(before)) / (2.0 * h)
        assert np.array(now.velocity) == pytest.approx(slope, abs=1e-4)


def test_an_approach_takes_as_long_as_its_longest_path() -> None:
    slow = replace(
        ARM,
        approach_time=np.array([0.0, 1.5, 3.0]),
        approach=np.array([[0.0, 0.0], [0.2, 0.0], [1.0, -2.0]]),
    )
    both = JointApproach(Pose2(), (ARM, slow), (None, None), 1.0)
    assert both.arrival == pytest.approx(1.0 + 3.0 + SETTLE)
    long = tip_path(BEGIN, (2.0, 2.0, 0.05), ABOVE)
    short = tip_path(BEGIN, END, ABOVE)
    tips = TipApproach(Pose2(), [short, None, long], (None,) * 3, 1.0)
    assert tips.arrival == pytest.approx(1.0 + long.duration + SETTLE)


def test_arms_that_hold_a_contact_are_led_by_their_posture_alone() -> None:
    zero = (0.0, 0.0, 0.0)
    held = TipCommand((3.0, 0.0, 0.0), zero, zero, zero, zero, 0.0, 0.0, 0.0, 5.0, 0.7)
    joints = JointApproach(Pose2(), (ARM, ARM), (None, held), 0.0)
    free, same = joints.step(0.5)[0]
    assert isinstance(free, JointCommand)
    assert free.velocity == pytest.approx(np.array([1.0, -2.0]))
    assert same == held
    assert isinstance(same, TipCommand)
    assert same.posture == pytest.approx(np.array([0.5, -1.0]))
    tips = TipApproach(Pose2(), [tip_path(BEGIN, END, ABOVE), None], (held, None), 0.0)
    assert tips.step(0.5)[0] == (held, None)


def test_a_tip_that_travels_touches_nothing_and_is_held_along_all_axes() -> None:
    (command,), _ = approaches()[1].step(2.5)
    assert isinstance(command, TipCommand)
    assert command.force == (0.0, 0.0, 0.0)
    assert min(command.stiffness) > 0.0
    assert min(command.damping) > 0.0
    assert command.servo_cap > 0.0
    turns = (command.normal_yaw, command.tool_yaw, command.tool_yaw_rate)
    assert turns == (0.0, 0.0, 0.0)
    assert command.progress == 0.0


@pytest.mark.parametrize("kind", [0, 1])
def test_a_halt_takes_a_third_of_a_second_and_a_pause(kind: int) -> None:
    approach = approaches()[kind]
    approach.halt(2.4)
    moving = place(approach.step(2.4 + 0.9 * HALT)[0][0])
    still = place(approach.step(2.4 + HALT)[0][0])
    assert (moving != still).any()
    assert place(approach.step(1e6)[0][0]) == pytest.approx(still)
    assert 0.1 < HALT < 1.0
    assert not approach.at_rest(2.4 + 0.99 * (HALT + SETTLE))
    assert approach.at_rest(2.4 + 1.01 * (HALT + SETTLE))
