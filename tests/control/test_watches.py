"""What ends a run: a force that is too large for too long."""

import pytest

from pushpressslide.control.plant import PlantRow
from pushpressslide.control.recording import Tick
from pushpressslide.control.watches import FORCE_OVERRUN, FORCE_TIME, ForceWatch
from pushpressslide.core.control import ControlLog, Measurement, Phase, TipState
from pushpressslide.core.pose import Pose2

LIMIT = 20.0  # [N]
ZERO = (0.0, 0.0, 0.0)


def tick(force: float, phase: Phase = "move") -> Tick:
    """A tick in which the second of two tips feels ``force`` [N]."""
    tips = (TipState(ZERO, ZERO, ZERO), TipState(ZERO, ZERO, (0.0, -force, 0.0)))
    log = ControlLog(phase, 0.0, Pose2(), ZERO, ZERO, ZERO, 0.0, "ok")
    row = PlantRow(ZERO, (ZERO, ZERO))
    truth = Measurement(0.0, Pose2(), tips)
    return Tick(truth, (None, None), log, None, row, (0.0, 0.0, 0.0))


def ticks_to_the_end(period: float, force: float, phase: Phase = "move") -> int | None:
    watch = ForceWatch(LIMIT, period)
    for i in range(200):
        if watch(tick(force, phase)) is not None:
            return i + 1
    return None


@pytest.mark.parametrize("period", [0.001, 0.002, 0.005])
def test_an_overrun_may_last_its_time_whatever_the_period(period: float) -> None:
    count = ticks_to_the_end(period, 1.01 * FORCE_OVERRUN * LIMIT)
    assert count is not None
    assert count * period == pytest.approx(FORCE_TIME, abs=1.01 * period)


def test_a_force_below_the_overrun_may_last_for_ever() -> None:
    assert ticks_to_the_end(0.002, 0.99 * FORCE_OVERRUN * LIMIT) is None


def test_the_approach_is_not_watched() -> None:
    assert ticks_to_the_end(0.002, 10.0 * LIMIT, "approach") is None


def test_a_moment_below_the_overrun_starts_the_time_anew() -> None:
    watch = ForceWatch(LIMIT, 0.6 * FORCE_TIME)
    large = tick(2.0 * FORCE_OVERRUN * LIMIT)
    assert watch(large) is None
    assert watch(tick(0.0)) is None
    assert watch(large) is None
    assert watch(large) is not None


def test_the_ending_holds_the_force_and_what_is_allowed() -> None:
    watch = ForceWatch(LIMIT, 1.0)
    ending = watch(tick(87.65))
    assert ending is not None
    assert ending.code == "force_limit"
    assert ending.text == "87.7 N measured, limits.normal_force is 20 N"
