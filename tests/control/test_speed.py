"""Track and allocate stay closed form: a fixed, small number of function calls,
whatever the machine does.
"""

import sys

import pytest

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.modes import MODES

MOST_CALLS = 40  # Python functions that one track plus allocate may enter


def functions_entered(work) -> int:
    """Return how many Python functions a call of ``work`` enters, itself left out."""
    entered = 0

    def count(frame: object, event: str, argument: object) -> None:
        nonlocal entered
        entered += event == "call"

    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(None)
    return entered - 1


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
@pytest.mark.parametrize("off", [0.0, 0.002, 0.02])
def test_track_and_allocate_enter_at_most_forty_functions(
    name: str, off: float
) -> None:
    task = pps.load_task(name)
    plan = pps.plan(task)
    mode = MODES[plan.choice.mode]
    choice = plan.choice
    tracker = mode.tracker(plan)
    allocate = mode.allocator(
        choice.contacts, task.believed.contact_friction, choice.parameters.get("rho")
    )
    s = 0.3 * plan.path.length
    X_WB = (
        plan.path.pose(s)
        .compose(Pose2(0.0, off, 10.0 * off))
        .compose(plan.X_BV.inverse())
    )

    def tick() -> None:
        wrench = tracker.step(plan.path, X_WB, s, 0.05, 1.0).wrench
        allocate(wrench.fx, wrench.fy, wrench.tau)

    assert 0 < functions_entered(tick) <= MOST_CALLS
