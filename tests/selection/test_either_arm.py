"""In a cell with two arms a mode that needs one may use either."""

from __future__ import annotations

import math
from typing import Any

import pytest

import pushpressslide as pps
from pushpressslide.core.plan import Choice
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Task
from pushpressslide.modes import MODES
from pushpressslide.modes.base import ENOUGH
from pushpressslide.selection.select import select
from pushpressslide.taskfile.load import task_from_data

ONE_ARM = ["rear_push", "press_slide"]


def cell(**changes: Any) -> Task:
    """Return a task for two arms with modes that need one."""
    data: dict[str, Any] = {
        "name": "cell",
        "object": {"shape": {"box": [0.2, 0.2, 0.1]}, "mass": 1.0},
        "support": {"friction": 0.25},
        "contact": {"friction": 0.7},
        "start": {"x": 0.45, "y": 0.05},
        "goal": {"x": 0.55, "y": 0.03, "yaw_deg": -4},
        "robots": [
            {"model": "panda", "base": {"y": 0.3}},
            {"model": "panda", "base": {"y": -0.3}},
        ],
        "modes": ONE_ARM,
    }
    return task_from_data(data | changes, "cell")


def moved(y: float) -> Task:
    """Return a push straight ahead of an object at ``y`` [m]."""
    return cell(start={"x": 0.45, "y": y}, goal={"x": 0.55, "y": y})


def arm(choice: Choice) -> int:
    (contact,) = choice.contacts
    return contact.arm


def place(choice: Choice) -> tuple[Any, ...]:
    """Position of the contact on the object."""
    (contact,) = choice.contacts
    return contact.point, contact.normal, contact.height


def mirrored(pose: Pose2) -> dict[str, float]:
    return {"x": pose.x, "y": -pose.y, "yaw_deg": -math.degrees(pose.yaw)}


@pytest.mark.parametrize("mode", ONE_ARM)
def test_every_placement_is_offered_to_both_arms_by_name(mode: str) -> None:
    able = [c for c in select(cell(modes=[mode]), ENOUGH) if c.feasible]
    by_place: dict[tuple[Any, ...], dict[int, Choice]] = {}
    for choice in able:
        (contact,) = choice.contacts
        place = (contact.point, contact.load, choice.segments[0].path)
        by_place.setdefault(place, {})[contact.arm] = choice
        assert choice.label.startswith(("left arm, ", "right arm, ")[contact.arm])
        for piece in choice.segments:
            assert piece.contacts == choice.contacts
    both = [choices for choices in by_place.values() if len(choices) == 2]
    assert len(both) >= 2
    for choices in both:
        assert choices[0].time == choices[1].time  # the object's


@pytest.mark.parametrize("mode", ONE_ARM)
@pytest.mark.parametrize(("y", "nearer"), [(0.05, 0), (-0.05, 1)])
def test_of_two_arms_that_do_it_alike_the_nearer_one_does(
    mode: str, y: float, nearer: int
) -> None:
    ends = {"start": {"x": 0.45, "y": y}, "goal": {"x": 0.55, "y": y}}
    first, *_ = select(cell(modes=[mode], **ends))
    assert first.feasible
    assert arm(first) == nearer


@pytest.mark.parametrize("mode", ONE_ARM)
def test_a_task_seen_in_a_mirror_has_the_choice_seen_in_it(mode: str) -> None:
    task = cell(modes=[mode], goal={"x": 0.56, "y": 0.1, "yaw_deg": 9})
    seen = cell(modes=[mode], start=mirrored(task.start), goal=mirrored(task.goal))
    first = select(task)[0]
    other = select(seen)[0]
    assert first.feasible
    assert arm(other) == 1 - arm(first)
    assert other.time == pytest.approx(first.time, abs=1e-6)
    ((x, y),) = [contact.point for contact in first.contacts]
    assert other.contacts[0].point == pytest.approx((x, -y), abs=1e-6)


def test_what_only_one_arm_reaches_is_done_by_that_arm() -> None:
    able = [c for c in select(moved(-0.75), ENOUGH) if c.feasible]
    assert able
    assert {arm(choice) for choice in able} == {1}
    refused = [c for c in select(moved(-0.75), ENOUGH) if "left arm" in c.label]
    assert any(c.refusal and c.refusal.code == "reach" for c in refused)


@pytest.mark.parametrize(("name", "only"), [("left", 0), ("right", 1)])
def test_the_arm_that_is_prescribed_is_the_only_one(name: str, only: int) -> None:
    task = cell(motion={"arm": name}, modes=None)
    choices = select(task, ENOUGH)
    able = [choice for choice in choices if choice.feasible]
    assert able
    assert {arm(choice) for choice in able} == {only}
    two = [c for c in choices if MODES[c.mode].arms == 2]
    assert len(two) == len({c.mode for c in two}) == 4  # one row for each mode
    assert all("motion.arm leaves 1" in c.reason for c in two)


def test_one_arm_is_offered_no_mode_for_two_and_is_told_so_once_for_each() -> None:
    alone = cell(robots=[{"model": "panda"}], modes=None)
    rows = [c for c in select(alone) if c.refusal and c.refusal.code == "arms"]
    assert sorted(c.mode for c in rows) == sorted(
        name for name, mode in MODES.items() if mode.arms == 2
    )


def test_what_the_object_refuses_is_said_once_not_for_each_arm() -> None:
    smooth = cell(contact={"friction": 0.05}, modes=["rear_push"])
    alone = cell(
        contact={"friction": 0.05}, modes=["rear_push"], robots=[{"model": "panda"}]
    )
    refused = [c for c in select(smooth, ENOUGH) if not c.segments]
    assert len(refused) == len([c for c in select(alone, ENOUGH) if not c.segments])


def test_arms_with_unlike_tips_touch_each_as_its_own_tip_can() -> None:
    fine, thick = 0.01, 0.03
    robots = [
        {"model": "panda", "base": {"y": 0.3}, "tip_radius": fine},
        {"model": "panda", "base": {"y": -0.3}, "tip_radius": thick, "tip_length": 0.1},
    ]
    choices = select(cell(robots=robots), ENOUGH)
    for i, robot in enumerate(robots):
        alone = select(cell(robots=[robot]), ENOUGH)
        for mode in ONE_ARM:
            mine = {place(c) for c in choices if c.mode == mode and arm(c) == i}
            assert mine == {place(c) for c in alone if c.mode == mode}
    (low,), (high,) = (
        {c.contacts[0].height for c in choices if c.mode == "rear_push" and arm(c) == i}
        for i in (0, 1)
    )
    assert low < high


@pytest.mark.parametrize(("y", "nearer"), [(0.1, 0), (-0.1, 1)])
def test_of_arms_with_unlike_tips_too_the_nearer_one_comes_first(
    y: float, nearer: int
) -> None:
    robots = [
        {"model": "panda", "base": {"y": 0.3}, "tip_radius": 0.015},
        {"model": "panda", "base": {"y": -0.3}, "tip_radius": 0.02},
    ]
    ends = {"start": {"x": 0.45, "y": y}, "goal": {"x": 0.55, "y": y}}
    first, second, *_ = select(cell(robots=robots, modes=["rear_push"], **ends))
    assert first.time == pytest.approx(second.time, abs=1e-3)
    assert [arm(first), arm(second)] == [nearer, 1 - nearer]


def test_the_legs_of_a_task_may_use_one_arm_the_other_and_both() -> None:
    legs = [
        {
            "mode": "rear_push",
            "pose": {"x": 0.50, "y": 0.05},
            "motion": {"arm": "left"},
        },
        {
            "mode": "rear_push",
            "pose": {"x": 0.50, "y": 0.10},
            "motion": {"arm": "right"},
        },
        {"mode": "bimanual_press_slide"},
    ]
    task = cell(modes=None, legs=legs, goal={"x": 0.52, "y": 0.07, "yaw_deg": 5})
    plan = pps.plan(task)
    used = [tuple(c.arm for c in segment.contacts) for segment in plan.segments]
    assert used == [(0,), (1,), (0, 1)]
