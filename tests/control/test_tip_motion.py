"""What counts as a lost contact on the way."""

from __future__ import annotations

import pytest

from pushpressslide.control.tip_motion import (
    HEIGHT_EASING,
    HEIGHT_SLACK,
    Felt,
    eased_height,
    missing,
)
from pushpressslide.core import margins
from pushpressslide.core.plan import Contact

SIDES = tuple(
    Contact(i, "side", (-0.1, y), (1.0, 0.0), 0.05) for i, y in enumerate((0.1, -0.1))
)
TOPS = tuple(
    Contact(i, "top", (0.0, y), (0.0, 0.0), 0.1, 5.0) for i, y in enumerate((0.1, -0.1))
)
GONE = Felt(True, 0.0)
THERE = Felt(False, 0.5)


@pytest.mark.parametrize(
    ("share", "lost"),
    [
        (0.0, False),
        (margins.LEAST_SHARE - 0.01, False),
        (margins.LEAST_SHARE + 0.01, True),
        (0.5, True),
    ],
)
def test_a_push_is_missed_by_its_share(share: float, lost: bool) -> None:
    assert missing((GONE, THERE), SIDES, (3.0 * share, 3.0 * (1.0 - share))) is lost
    assert not missing((THERE, THERE), SIDES, (3.0 * share, 3.0 * (1.0 - share)))


def test_a_push_alone_and_any_press_are_missed() -> None:
    assert missing((GONE,), SIDES[:1], (0.2,))
    assert missing((THERE, GONE), TOPS, (20.0, 2.0))


def test_a_tip_that_sticks_off_its_height_is_left_there() -> None:
    """It is held where it is at first, and again after it has stuck elsewhere."""
    wanted, dt = 0.04, 0.004
    height = eased_height(None, 0.0401, wanted, dt)
    assert height == pytest.approx(0.0401)
    for _ in range(round(5.0 * HEIGHT_EASING / dt)):
        height = eased_height(height, 0.0395, wanted, dt)
    assert height == pytest.approx(0.0395, abs=1e-5)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tip_is_not_led_far_from_its_height(side: float) -> None:
    height = None
    for i in range(1000):
        height = eased_height(height, 0.04 + side * 1e-5 * i, 0.04, 0.004)
    assert height == pytest.approx(0.04 + side * HEIGHT_SLACK)


@pytest.mark.long
def test_a_push_that_is_asked_for_little_does_not_stop_the_other() -> None:
    """One of two pushes has 8 % of the force: its contact fades, and taking it again
    would shake the box.
    """
    from pushpressslide.jobs.run import simulate
    from pushpressslide.jobs.sampling import random_task
    from pushpressslide.report.metrics import result
    from pushpressslide.taskfile.load import load_task

    task = random_task(load_task("parallel-push"), 36, 1)
    plan, record, _ = simulate(task)
    found = result(task, plan, record, {})
    assert found["success"]
    assert found["final_position_error"] < 0.003
