"""Another body pushes the object aside in mid-contact, and the goal is reached."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide import load_task
from pushpressslide.control.run_loop import RunOptions
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.knock import Ball, Knock, Push, Side
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.jobs.engines import ArmOptions, engine_named
from pushpressslide.jobs.run import simulate
from pushpressslide.jobs.sweep import SweepOptions, sweep
from pushpressslide.modes.base import ENOUGH
from pushpressslide.report.metrics import result
from pushpressslide.selection.stages import plan_stages


def knocked(task: Task, side: Side) -> tuple[bool, Record]:
    """Return whether a run reached its goal all the same, and its record."""
    knock = Knock(share=0.4, ball=Ball(side))
    plan, record, _ = simulate(replace(task, disturbances=(knock,)))
    return bool(result(task, plan, record)["success"]), record


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "side"),
    [("press-slide", "right"), ("bimanual-slide", "left"), ("parallel-push", "left")],
)
def test_a_knocked_object_reaches_its_goal(name: str, side: Side) -> None:
    reached, record = knocked(load_task(name), side)
    knock = record.meta["knocked"]
    assert knock["moved"] > 0.015
    assert reached


@pytest.mark.long
def test_the_object_is_moved_by_the_ball_and_by_nothing_before() -> None:
    """Up to the touch the run is the same as one without the ball; after it, it is not."""
    task = load_task("rear-push-rear")
    reached, record = knocked(task, "left")
    assert reached
    _, plain, _ = simulate(task)
    touch = record.meta["knocked"]["time"]
    before = np.flatnonzero(record.arrays["time"] < touch)
    apart = record.arrays["object_pose"][before] - plain.arrays["object_pose"][before]
    assert np.abs(apart).max() < 1e-3
    after = np.searchsorted(record.arrays["time"], touch + 0.5)
    gone = record.arrays["object_pose"][after] - plain.arrays["object_pose"][after]
    assert math.hypot(*gone[:2]) > 0.005


@pytest.mark.parametrize("engine", ["drake", "mujoco"])
def test_a_force_moves_a_free_object_as_newton_says(engine: str) -> None:
    """While the arms are on their way, with nothing at the object but its support."""
    force, lasts, begins = 9.0, 0.3, 0.4
    knock = Knock(time=begins, push=Push((0.0, force), lasts))
    task = replace(load_task("rear-push-rear"), disturbances=(knock,))
    ticks = iter(range(round(1.5 / task.motion.control_period)))
    made = engine_named(engine)
    (planned,) = plan_stages(task, made.placement_planner(False), ENOUGH, force=False)
    record = made.run(
        planned.solution.plan,
        RunOptions(stop=lambda: next(ticks, None) is None),
        ArmOptions(paths=planned.planner.paths),
    )
    friction = task.support.friction * GRAVITY
    gained = force / task.object.mass - friction
    speed = gained * lasts
    way = 0.5 * speed * lasts + 0.5 * speed**2 / friction
    moved = record.arrays["object_pose"] - record.arrays["object_pose"][0]
    assert moved[-1, 1] == pytest.approx(way, rel=2e-3)
    before = record.arrays["time"] <= begins + 1e-6
    assert np.abs(moved[before]).max() < 1e-6
    assert record.meta["pushed"] == [pytest.approx(begins)]


def test_knocks_need_an_engine_with_bodies(tmp_path) -> None:
    options = SweepOptions(samples=1, vary="knocks", engine="planar")
    with pytest.raises(PushPressSlideError, match="engine"):
        sweep(load_task("rear-push-rear"), options, tmp_path)
