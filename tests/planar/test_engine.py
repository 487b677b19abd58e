"""Whole runs on the planar engine: shipped tasks, idle arms, repeats, and the page that
shows them.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

import pushpressslide as pps
from pushpressslide.control.run_loop import RunLoop, RunOptions, run_loop
from pushpressslide.core.plan import Contact
from pushpressslide.core.record import Ending
from pushpressslide.planar.cell import planar_cell
from pushpressslide.planar.engine import run
from pushpressslide.view.planar.replay import replay_data, write_replay


@pytest.mark.parametrize("name", ["rear-push-rear", "rear-push-left"])
def test_shipped_pushes_end_at_their_goal_within_a_millimetre(name):
    task = pps.load_task(name)
    record = run(pps.plan(task))
    x, y, yaw = record.arrays["object_pose"][-1]
    assert record.reason == "goal_reached"
    assert math.dist((x, y), task.goal.position) < 1e-3
    assert abs(yaw - task.goal.yaw) < math.radians(0.3)
    # a push slides the object with mu_s m g, less in a turn, and never lets go
    pushing = record.arrays["measured_force"][record.arrays["phase"] == 2.0, 0]
    size = np.linalg.norm(pushing[50:-50, :2], axis=1)
    assert size.max() < 1.001 * task.support.friction * task.object.mass * 9.81
    assert size.min() > 0.5 * size.max()


@pytest.fixture(scope="module")
def idle():
    """A run with a second arm that has no contact, cut short."""
    task = pps.load_task("rear-push-rear")
    plan = pps.plan(task)
    second = replace(task.robots[0], base=(0.9, 0.0, 0.1))
    task = replace(task, robots=(*task.robots, second))
    plan = replace(plan, task=replace(task, limits=replace(task.limits, time=6.0)))
    return task, plan, run(plan, RunOptions(seed=3))


def test_an_arm_without_a_contact_stays_where_it_is(idle):
    _, _, record = idle
    assert record.arrays["tip_position"].shape[1:] == (2, 3)
    assert (record.arrays["tip_position"][:, 1] == (0.9, 0.0, 0.1)).all()
    assert (record.arrays["measured_force"][:, 1] == 0.0).all()
    assert np.isnan(record.arrays["command_force"][:, 1]).all()
    assert (record.arrays["measured_force"][:, 0] != 0.0).any()


def test_the_same_run_again_is_identical_to_the_last_bit(idle):
    _, plan, record = idle
    again = run(plan, RunOptions(seed=3))
    for name, values in record.arrays.items():
        if not name.startswith("tick_"):
            assert np.array_equal(values, again.arrays[name], equal_nan=True), name


def test_the_recorded_twist_is_the_motion_of_the_shapes_frame(idle):
    _, _, record = idle
    pose, twist, time = (
        record.arrays[n] for n in ("object_pose", "object_twist", "time")
    )
    moved = np.diff(pose, axis=0) / np.diff(time)[:, None]
    assert twist[:-1] == pytest.approx(moved, abs=1e-4)


def test_a_run_can_be_stopped_and_says_so(idle):
    _, plan, _ = idle
    record = run(plan, RunOptions(stop=lambda: True))
    assert record.reason == "interrupted"
    assert len(record.arrays["time"]) == 1


def test_the_page_shows_every_tip_and_the_load_of_presses(idle, tmp_path):
    _, plan, record = idle
    press = Contact(1, "top", (0.0, 0.0), (0.0, 0.0), 0.15, 5.0)
    (segment,) = plan.segments
    segment = replace(segment, contacts=(*segment.contacts, press))
    plan = replace(plan, segments=(segment,))
    force = record.arrays["measured_force"].copy()
    force[:, 1, 2] = -5.0
    record = replace(record, arrays={**record.arrays, "measured_force": force})
    data = replay_data(plan, record)
    assert set(data["contacts"][1]) == {"top"}
    assert "top" not in data["contacts"][0]
    assert set(data["loads"][1]) == {5.0}
    assert set(data["loads"][0]) == {0.0}
    assert len(data["tips"]) == len(data["forces"]) == 2
    assert "NaN" not in write_replay(plan, record, tmp_path).read_text()


def test_a_run_is_a_loop_over_steps() -> None:
    """Stepped by hand, in one piece, and stopped half-way."""
    plan = pps.plan(pps.load_task("rear-push-rear"))
    whole = run_loop(planar_cell(plan), plan)
    loop = RunLoop(planar_cell(plan), plan)
    ending = None
    half = None
    while ending is None:
        if half is None and loop.cell.clock.time > 5.0:
            half = loop.record(Ending("interrupted", "looked at"))
        ending = loop.step()
    stepped = loop.record(ending)
    assert (stepped.reason, stepped.reason_text) == (whole.reason, whole.reason_text)
    assert half is not None
    for name, values in whole.arrays.items():
        if name.startswith("tick_"):
            continue
        assert np.array_equal(values, stepped.arrays[name], equal_nan=True), name
        if not name.startswith("plan_"):
            part = half.arrays[name]
            assert np.array_equal(values[: len(part)], part, equal_nan=True), name
