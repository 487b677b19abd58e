"""A servo follows its commands after a delay, with a lag, at its rate."""

import math

import numpy as np
import pytest

from pushpressslide.arms.lag import LaggingServo

DT = 0.004
TICKS = 1000


def response(
    commands: np.ndarray, rate: float, delay: float, lag: float, dt: float = DT
) -> np.ndarray:
    servo = LaggingServo(np.zeros(1), rate, delay, lag, dt)
    return np.array([servo.step(np.array([one]))[0] for one in commands])


def late(values: np.ndarray) -> int:
    """Ticks that pass before the first answer."""
    return int(np.argmax(values != 0.0))


@pytest.mark.parametrize("lag", [0.02, 0.1])
@pytest.mark.parametrize("delay", [0.0, 0.008, 0.1])
@pytest.mark.parametrize("rate", [250.0, 125.0, 20.0])
def test_a_step_is_followed_with_the_lag_after_the_delay(
    rate: float, delay: float, lag: float
) -> None:
    values = response(np.ones(TICKS), rate, delay, lag)
    first = late(values)
    assert first == round(delay / DT)
    times = DT * np.arange(1, TICKS - first + 1)
    exact = 1.0 - np.exp(-times / lag)
    np.testing.assert_allclose(values[first:], exact, atol=1e-9)
    # a time constant after it begins to obey, 63 % are reached
    reached = np.interp(lag, times, values[first:])
    assert reached == pytest.approx(1.0 - math.exp(-1.0), abs=0.01)


def test_without_a_lag_it_obeys_at_once() -> None:
    values = response(np.ones(10), 250.0, 0.008, 0.0)
    np.testing.assert_array_equal(values, [0.0, 0.0] + 8 * [1.0])


@pytest.mark.parametrize(("rate", "every"), [(250.0, 1), (125.0, 2), (50.0, 5)])
def test_commands_between_those_that_it_takes_are_ignored(
    rate: float, every: int
) -> None:
    ramp = np.arange(1.0, 41.0)
    values = response(ramp, rate, 0.0, 0.0)
    taken = ramp[::every]
    np.testing.assert_array_equal(values, np.repeat(taken, every))


def test_a_ramp_is_followed_behind_by_delay_and_lag() -> None:
    lag, delay, speed = 0.04, 0.02, 0.3
    ramp = speed * DT * np.arange(TICKS)
    values = response(ramp, 250.0, delay, lag)
    behind = (ramp[-1] - values[-1]) / speed
    # what a tick's command is obeyed during the tick
    assert behind == pytest.approx(delay + lag, abs=DT)


def test_the_answer_does_not_depend_on_the_tick() -> None:
    coarse = response(np.ones(100), 50.0, 0.04, 0.05, 0.004)
    fine = response(np.ones(400), 50.0, 0.04, 0.05, 0.001)
    np.testing.assert_allclose(coarse, fine[3::4], atol=1e-12)


def test_it_rests_where_it_starts() -> None:
    start = np.array([0.3, -0.2])
    servo = LaggingServo(start, 100.0, 0.01, 0.02, DT)
    for _ in range(20):
        np.testing.assert_array_equal(servo.step(start), start)
    start[0] = 9.0  # the caller's array is the caller's
    assert servo.output[0] == 0.3
