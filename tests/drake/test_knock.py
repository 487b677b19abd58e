"""Another body pushes the object aside in mid-contact, and the goal is reached."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.knock import Knock
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.run import simulate
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.report.metrics import result


def knocked(task: Task, knock: Knock) -> tuple[bool, Record]:
    """Return whether a run reached its goal all the same, and its record."""
    plan, record, _ = simulate(task, knock=knock)
    return bool(result(task, plan, record)["success"]), record


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "side"),
    [("press-slide", -1), ("bimanual-slide", 1)],
)
def test_a_knocked_object_reaches_its_goal(name: str, side: int) -> None:
    reached, record = knocked(load_task(name), Knock(0.4, side))
    knock = record.meta["knocked"]
    assert knock["moved"] > 0.015
    assert reached


@pytest.mark.long
def test_the_object_is_moved_by_the_ball_and_by_nothing_before() -> None:
    """Up to the touch the run is the same as one without the ball; after it, it is not."""
    task = load_task("rear-push-rear")
    reached, record = knocked(task, Knock(0.4, 1))
    assert reached
    _, plain, _ = simulate(task)
    touch = record.meta["knocked"]["time"]
    before = np.flatnonzero(record.arrays["time"] < touch)
    apart = record.arrays["object_pose"][before] - plain.arrays["object_pose"][before]
    assert np.abs(apart).max() < 1e-3
    after = np.searchsorted(record.arrays["time"], touch + 0.5)
    gone = record.arrays["object_pose"][after] - plain.arrays["object_pose"][after]
    assert math.hypot(*gone[:2]) > 0.005


def test_knocks_need_an_engine_with_bodies(tmp_path) -> None:
    options = SweepOptions(samples=1, vary="knocks", engine="planar")
    with pytest.raises(PushPressSlideError, match="engine"):
        sweep(load_task("rear-push-rear"), options, tmp_path)
