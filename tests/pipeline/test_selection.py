"""What the object's path keeps clear of."""

import re
from importlib import resources

import pytest

import pushpressslide as pps
from pushpressslide.core.errors import TaskError
from pushpressslide.pipeline.selection import grasps

TASKS = sorted(
    p.name.removesuffix(".yaml")
    for p in resources.files("pushpressslide.tasks").iterdir()
    if p.name.endswith(".yaml")
)
POST = "{name: post, box: [0.04, 0.04, 0.1], pose: {x: %g, y: %g}, movable: true, mass: 0.2}"
NEAR = re.compile(r"the object comes within \d+ mm of obstacle 'post' at \(.*\), allowed from 10 mm")


@pytest.mark.parametrize("name", TASKS)
def test_every_shipped_task_still_has_a_way(name: str) -> None:
    assert all(found[0].feasible for found in grasps(pps.load_task(name)))


def test_a_loose_body_on_the_way_is_refused_by_name_and_distance() -> None:
    blocked = pps.load_task("rear-push-rear", [f"obstacles=[{POST % (0.47, -0.05)}]"])
    choices = pps.select(blocked)
    assert not any(choice.feasible for choice in choices)
    assert any(NEAR.search(choice.reason) for choice in choices)


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
    wanted = "but 'cube' comes within 0 mm of obstacle 'post'"
    assert any(wanted in choice.reason for choice in pps.select(beside))
    with pytest.raises(TaskError, match=r"goal: .* no overlap with obstacle 'post'"):
        pps.load_task("tool-use", [f"obstacles=[{plank}, {POST % (0.62, 0.55)}]"])
