"""Clearances of the object's path."""

import re
from collections.abc import Callable
from importlib import resources

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.core.plan import Plan
from pushpressslide.selection.stages import plan_stages

TASKS = sorted(
    p.name.removesuffix(".yaml")
    for p in resources.files("pushpressslide.tasks").iterdir()
    if p.name.endswith(".yaml")
)
POST = "{name: post, box: [0.04, 0.04, 0.1], pose: {x: %g, y: %g}, movable: true, mass: 0.2}"
NEAR = re.compile(
    r"the object comes within \d+ mm of obstacle 'post' at \(.*\), allowed from 10 mm"
)


@pytest.mark.parametrize("name", TASKS)
def test_every_shipped_task_still_has_a_way(
    shipped_plan: Callable[[str], Plan], name: str
) -> None:
    task = pps.load_task(name)
    if task.goals:
        assert plan_stages(task)
    else:
        assert shipped_plan(name).segments


def test_a_loose_body_on_the_way_is_refused_by_name_and_distance() -> None:
    blocked = pps.load_task("rear-push-rear", [f"obstacles=[{POST % (0.47, -0.05)}]"])
    choices = pps.select(blocked)
    assert not any(choice.feasible for choice in choices)
    assert any(NEAR.search(choice.reason) for choice in choices)


def test_presses_behind_many_blocked_ones_are_skipped_for_that_and_none_is_feasible() -> (
    None
):
    """A slow push is taken beside them, and no press is at least as fast as they are."""
    changes = [
        "object={shape: {box: [0.24, 0.16, 0.1]}, mass: 1.5}",
        "start={x: 0.42, y: -0.25, yaw_deg: 30}",
        "goal={x: 0.52, y: 0.22, yaw_deg: -45}",
        "robots=[{model: panda}]",
        "obstacles=[{name: post, box: [0.06, 0.06, 0.2], pose: {x: 0.47, y: 0}}]",
        "modes=[rear_push, press_slide]",
    ]
    choices = pps.select(pps.load_task("post", changes))
    assert choices[0].mode == "rear_push"
    presses = [choice for choice in choices if choice.mode == "press_slide"]
    assert not any(choice.feasible for choice in presses)
    skipped = [choice for choice in presses if not choice.evaluated]
    assert skipped
    assert min(choice.time or 0.0 for choice in skipped) < (choices[0].time or 0.0)
    for choice in skipped:
        assert "24 choices of this mode are blocked" in choice.reason


def test_a_tool_may_touch_what_it_is_to_push_and_nothing_else() -> None:
    cube = "{name: cube, box: [0.08, 0.08, 0.08], pose: {x: 0.45, y: 0.38}, movable: true, mass: 0.5}"
    alone = pps.load_task("tool-use", [f"obstacles=[{cube}]"])
    assert pps.select(alone)[0].feasible
    beside = pps.load_task("tool-use", [f"obstacles=[{cube}, {POST % (0.28, 0.0)}]"])
    assert any(NEAR.search(choice.reason) for choice in pps.select(beside))
    assert not any("'cube'" in choice.reason for choice in pps.select(beside))


def test_what_a_tool_pushes_is_kept_clear_of_the_others_too() -> None:
    plank = "{name: cube, box: [0.4, 0.08, 0.08], pose: {x: 0.45, y: 0.38}, movable: true, mass: 0.5}"
    beside = pps.load_task("tool-use", [f"obstacles=[{plank}, {POST % (0.62, 0.455)}]"])
    wanted = "'cube' comes within 0 mm of obstacle 'post'"
    assert any(wanted in choice.reason for choice in pps.select(beside))
    with pytest.raises(TaskError, match=r"goal: .* no overlap with obstacle 'post'"):
        pps.load_task("tool-use", [f"obstacles=[{plank}, {POST % (0.62, 0.55)}]"])


@pytest.mark.parametrize(("y", "possible"), [(0.22, False), (-0.02, True)])
def test_beside_an_obstacle_it_may_start_but_not_go_through_it(
    y: float, possible: bool
) -> None:
    post = f"obstacles=[{{name: post, box: [0.04, 0.04, 0.1], pose: {{x: 0.475, y: {y}}}}}]"
    straight = ["start={x: 0.38, y: 0.22}", "goal={x: 0.66, y: 0.22}", "motion.face=3"]
    found = pps.select(pps.load_task("rear-push-rear", [post, *straight]))
    assert found[0].feasible == possible
    assert possible or re.search(
        r"the object runs into obstacle 'post' at", found[0].reason
    )


def test_where_an_obstacle_is_in_the_way_of_one_manoeuvre_others_are_judged() -> None:
    tile = [
        "object={shape: {box: [0.3, 0.2, 0.04]}, mass: 0.4}",
        "support.friction=0.2",
        "contact.friction=0.8",
        "modes=[press_slide]",
        "start={x: 0.5, y: 0.2}",
        "goal={x: 0.5, y: -0.2, yaw_deg: 180}",
        "motion={}",
    ]
    first, *others = pps.select(pps.load_task("rear-push-rear", tile), 8)
    assert sum(choice.feasible for choice in others) > 4
    assert len({choice.contacts for choice in (first, *others)}) == 1 + len(others)
