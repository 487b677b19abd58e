"""Track and allocate stay closed form and cheap: a fixed multiple of an empty function call, timed here."""

import statistics
from time import perf_counter

import pytest

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.modes import MODES

MOST_CALLS = 40.0  # empty function calls that one track plus allocate may cost
CALLS, ROUNDS = 2000, 9


def empty() -> None:
    """Do nothing."""


def median_time(work) -> float:
    """Return the median time of one call [s], each timed by itself, as the ticks of a run are."""
    times = []
    for _ in range(CALLS):
        started = perf_counter()
        work()
        times.append(perf_counter() - started)
    return statistics.median(times)


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
def test_track_and_allocate_cost_at_most_forty_empty_calls(name: str) -> None:
    task = pps.load_task(name)
    plan = pps.plan(task)
    mode, choice = MODES[plan.choice.mode], plan.choice
    tracker = mode.tracker(plan)
    allocate = mode.allocator(choice.contacts, task.believed.contact_friction, choice.parameters.get("rho"))
    s = 0.3 * plan.path.length
    X_WB = plan.path.pose(s).compose(Pose2(0.0, 0.002, 0.02)).compose(plan.X_BV.inverse())

    def tick() -> None:
        wrench = tracker.step(plan.path, X_WB, s, 0.05, 1.0).wrench
        allocate(wrench.fx, wrench.fy, wrench.tau)

    # both in turn, several times: what else the machine does must not decide
    ratio = min(median_time(tick) / median_time(empty) for _ in range(ROUNDS))
    assert ratio <= MOST_CALLS, f"track and allocate cost {ratio:.0f} empty function calls"
