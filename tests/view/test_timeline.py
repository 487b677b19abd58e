"""The play bar shows the run's time, phases, legs, forces and distance to the goal."""

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.view.timeline import (
    GOAL_ERROR,
    MOST_FRAMES,
    Mark,
    frames,
    run_timeline,
)


def test_frames_are_thirty_a_second_with_both_ends():
    time = 0.001 * np.arange(2001)
    ticks = frames(time)
    assert ticks[0] == 0
    assert ticks[-1] == 2000
    assert len(ticks) == 60


def test_a_long_run_has_no_more_frames_than_a_page_holds():
    ticks = frames(np.arange(0.0, 600.0, 0.01))
    assert len(ticks) == MOST_FRAMES
    assert ticks[-1] == 59999


def test_the_course_ends_at_the_goal_with_the_measured_force(run):
    arrays = run.record.arrays
    ticks = frames(arrays["time"])
    told = run_timeline(run.plan, run.record, ticks)
    assert [span.name for span in told.phases] == ["touch", "move", "release"]
    for before, after in zip(told.phases, told.phases[1:], strict=False):
        assert before.end == after.start
    assert told.distance[-1] == pytest.approx(0.0, abs=0.1)
    start, goal = run.task.start, run.task.goal
    apart = np.hypot(start.x - goal.x, start.y - goal.y)
    assert told.distance[0] == pytest.approx(1e3 * apart, abs=0.1)
    pushed = np.linalg.norm(arrays["measured_force"][ticks, 0], axis=1)
    assert told.force[0] == pytest.approx(pushed, abs=0.01)
    assert told.arms == ("arm",)
    assert told.ending == "goal reached"


def test_legs_and_placements_are_marked_once_by_the_larger_part(run):
    leg = np.zeros_like(run.record.arrays["time"])
    leg[200:] = 1.0
    placement = leg.copy()
    placement[300:] = 2.0
    record = run.with_arrays(leg=leg, placement=placement).record
    marks = run_timeline(run.plan, record, frames(record.arrays["time"])).marks
    assert [(mark.name, mark.time) for mark in marks] == [
        ("leg 2", 2.0),
        ("placement 3", 3.0),
    ]


def test_a_broken_limit_is_marked_when_it_broke_and_not_when_the_run_ended(run):
    breach = {"time": 2.5, "code": "joint_limit", "text": "joint 5 at 3.40 rad/s"}
    record = replace(
        run.record,
        reason="joint_limit",
        reason_text="joint 5",
        meta={**run.record.meta, "breaches": [breach]},
    )
    marks = run_timeline(run.plan, record, frames(record.arrays["time"])).marks
    start = float(record.arrays["time"][0])
    assert marks == (Mark("joint limit", 2.5 - start, "joint 5 at 3.40 rad/s"),)


def test_a_lost_contact_is_marked_where_the_arms_let_go(run):
    record = replace(run.record, reason="contact_lost", reason_text="arm 1 lost it")
    told = run_timeline(run.plan, record, frames(record.arrays["time"]))
    (mark,) = told.marks
    assert (mark.name, mark.text) == ("contact lost", "arm 1 lost it")
    assert mark.time == told.phases[-1].start


def test_a_failure_that_the_run_recovered_from_is_marked_too(run):
    event = {"time": 5.0, "code": "contact_lost", "text": "slid off"}
    record = replace(run.record, meta={**run.record.meta, "events": [event]})
    told = run_timeline(run.plan, record, frames(record.arrays["time"]))
    assert [(m.name, m.time) for m in told.marks] == [
        ("contact lost", told.phases[-1].start)
    ]


def test_a_run_that_reaches_or_misses_its_goal_has_no_failure_marked(run):
    for reason in ("goal_reached", "goal_missed"):
        record = replace(run.record, reason=reason)
        assert not run_timeline(
            run.plan, record, frames(run.record.arrays["time"])
        ).marks


def test_a_joined_record_brings_the_errors_of_the_body_that_is_moved(run):
    errors = np.tile([0.25, 0.5], (len(run.record.arrays["time"]), 1))
    record = run.with_arrays(**{GOAL_ERROR: errors}).record
    told = run_timeline(run.plan, record, frames(record.arrays["time"]))
    assert set(told.distance) == {250.0}
    assert set(told.turn) == {28.6}
