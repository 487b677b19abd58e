"""What counts as a lost contact on the way."""

from __future__ import annotations

import pytest

from pushpressslide.control.tip_motion import Felt, missing
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
