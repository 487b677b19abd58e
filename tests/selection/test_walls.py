"""Walls in the task file: their fields, consistency checks, and a dumped wall that
loads to the same.
"""

import re

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.selection.select import FALLS, placements, select
from pushpressslide.taskfile.load import dump_task, load_task, task_from_data
from pushpressslide.taskfile.yaml_text import read_yaml


def test_the_shipped_wall_is_where_its_file_says_and_loads_again(tmp_path) -> None:
    task = load_task("press-fit")
    support = task.support
    assert support.frame == SupportFrame.of_wall((0.86, 0.0, 0.81), 3.141592653589793)
    assert support.opening is not None
    assert (support.opening.size, support.opening.depth) == ((0.83, 0.28), 0.15)
    # the left arm: to the left, below, in front
    assert task.scene.bases[0] == pytest.approx((0.5, -0.61, 0.86))
    path = tmp_path / "again.yaml"
    path.write_text(dump_task(task))
    data = read_yaml(path)
    assert task_from_data(data, "again") == task


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("support.pose=null", r"support\.pose.*it is missing"),
        (
            "support.opening.depth=0.25",
            r"support\.opening\.depth.*less than the object's height",
        ),
        ("support.opening.size=[0.79, 0.28]", r"goal.*outline is within it"),
        ("obstacles=[]", r"start.*it would fall before the arms press it"),
        ("start.y=-0.02", r"start.*on a ledge"),
        ("obstacles.0.movable=true", r"obstacles\[0\]\.movable.*it would fall"),
        ("start={x: 0, y: 0, yaw_deg: 90}", r"start.*lies in support\.opening"),
        ("support.opening.depth=-1", r"support\.opening\.depth"),
    ],
)
def test_what_does_not_fit_is_refused(override, says) -> None:
    with pytest.raises(TaskError, match=says):
        load_task("press-fit", [override])


CRATE = {
    "name": "crate",
    "support": {
        "kind": "wall",
        "friction": 0.2,
        "pose": {"x": 0.8, "y": 0, "z": 0.5, "yaw_deg": 180},
        "opening": {
            "size": [0.22, 0.22],
            "depth": 0.15,
            "pose": {"x": 0.08, "y": 0.12},
        },
    },
    "object": {"shape": {"box": [0.2, 0.2, 0.3]}, "mass": 1.0},
    "contact": {"friction": 0.9},
    "start": {"x": -0.1, "y": 0.0},
    "obstacles": [
        {"name": "ledge", "box": [0.2, 0.04, 0.3], "pose": {"x": -0.1, "y": -0.12}}
    ],
    "robots": [
        {"model": "iiwa7", "base": {"y": 0.5}},
        {"model": "iiwa7", "base": {"y": -0.5}},
    ],
    "limits": {"normal_force": 100},
}


def test_an_object_that_would_tip_into_the_opening_half_way_is_refused() -> None:
    task = task_from_data({**CRATE, "goal": {"x": 0.08, "y": 0.12}}, "crate")
    reasons = [choice.reason for choice in select(task)]
    assert any(
        re.search(r"tips into support\.opening at .* \d+ mm beyond", reason)
        for reason in reasons
    )
    assert not any(choice.feasible for choice in select(task))


def test_beside_the_opening_it_is_carried() -> None:
    task = task_from_data({**CRATE, "goal": {"x": -0.14, "y": 0.12}}, "crate")
    assert select(task)[0].feasible


def test_arms_that_let_go_between_two_legs_must_leave_the_object_on_something() -> None:
    other = "legs.2.motion={contacts: [[0.02, 0.2], [0.02, -0.2]]}"
    first, second, *_ = placements(load_task("press-fit", [other]).queries())
    assert any(choice.feasible for choice in first)
    assert not any(choice.feasible for choice in second)
    assert any("falls when the arms let go" in choice.reason for choice in second)
    assert any(choice.refusal == FALLS for choice in second)
