"""Approaches: where they lead, how fast, and how they come to rest when stopped."""

from __future__ import annotations

import math

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
    return times, np.array([path.at(t)[0] for t in times])


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
        before = np.array(path.at(t - 1e-5)[0])
        after = np.array(path.at(t + 1e-5)[0])
        assert np.array(path.at(t)[1]) == pytest.approx(
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
