"""Track and allocate stay closed form: a fixed, small number of function calls on any
machine.
"""

import sys

import pytest

import pushpressslide as pps
from pushpressslide.control.execution import USUAL
from pushpressslide.control.following import bind_laws
from pushpressslide.core.pose import Pose2

MOST_CALLS = 40  # Python functions that one track plus allocate may enter


def functions_entered(work) -> int:
    """Number of Python functions that a call of ``work`` enters, without ``work``
    itself.
    """
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
    (segment,) = plan.segments
    path = segment.path
    binding = bind_laws(task.scene, segment, USUAL.tracker(task.query, segment))
    s = 0.3 * path.length
    X_WV = path.pose(s).compose(Pose2(0.0, off, 10.0 * off))
    X_WB = X_WV.compose(segment.X_BV.inverse())

    def tick() -> None:
        wrench = binding.tracker.step(path, X_WB, s, 0.05, 1.0).wrench
        binding.allocate(wrench.fx, wrench.fy, wrench.tau)

    assert 0 < functions_entered(tick) <= MOST_CALLS
