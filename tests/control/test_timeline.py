"""The first plan of a placement over time."""

from __future__ import annotations

import pytest

import pushpressslide as pps
from pushpressslide.control.timeline import Timeline

PLAN = pps.plan(pps.load_task("press-slide-car"))
FIRST, LAST = PLAN.segments
TIMELINE = Timeline(PLAN.segments)


def test_segments_follow_each_other_without_a_pause() -> None:
    over = FIRST.profile.duration
    for time in (0.0, 0.3 * over, 0.99 * over):
        way = FIRST.profile.state_at(time)[0]
        assert TIMELINE.body_pose(time) == FIRST.body_pose(way)
    assert TIMELINE.body_pose(over) == LAST.body_pose(0.0)
    way = LAST.profile.state_at(1.0)[0]
    assert way > 0.0
    here = TIMELINE.body_pose(over + 1.0)
    assert here.position == pytest.approx(LAST.body_pose(way).position)


def test_once_all_is_over_the_object_is_at_its_goal() -> None:
    end = LAST.body_pose(LAST.path.length)
    over = FIRST.profile.duration + LAST.profile.duration
    assert TIMELINE.body_pose(over + 100.0).position == pytest.approx(end.position)


def test_a_single_segment_goes_on_to_its_end() -> None:
    alone = Timeline((FIRST,))
    end = FIRST.body_pose(FIRST.path.length)
    assert alone.body_pose(1e3).position == pytest.approx(end.position)
    assert alone.body_pose(0.0) == FIRST.body_pose(0.0)
