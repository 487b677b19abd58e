"""A goal that is another body's."""

import math

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.pipeline.planner import plan
from pushpressslide.pipeline.task_file import load_task
from pushpressslide.planar.engine import run
from pushpressslide.report.metrics import result


def test_the_tools_goal_is_behind_the_bodys() -> None:
    task = load_task("tool-use")
    assert task.tool is not None
    assert (task.tool.goal.x, task.tool.goal.y) == (0.45, 0.53)
    # half a cube and half a bar behind
    assert (task.goal.x, task.goal.y) == pytest.approx((0.45, 0.53 - 0.04 - 0.3))
    assert math.degrees(task.goal.yaw) == pytest.approx(90.0)


def test_a_sidewards_start_is_shared_between_place_and_yaw() -> None:
    task = load_task("tool-use", ["obstacles.0.pose.x=0.46"])
    turn = task.goal.yaw - 0.5 * math.pi
    assert 0.0 < math.degrees(turn) < 3.0
    end = task.goal.apply((0.34, 0.0))
    assert 0.0 < end[0] - 0.45 < 0.01


@pytest.mark.parametrize(
    ("override", "field"),
    [
        ("goal.body=nothing", "goal.body"),
        ("obstacles.0.movable=false", "goal.body"),
        ("tool.face=4", "tool.face"),
        ("goal.yaw_deg=30", "goal.yaw_deg"),
        ("obstacles.0.pose.yaw_deg=40", "obstacles"),
    ],
)
def test_what_cannot_be_pushed_so_is_refused(override: str, field: str) -> None:
    with pytest.raises(TaskError, match=field.replace(".", r"\.")):
        load_task("tool-use", [override])


def test_an_engine_without_other_bodies_says_that_the_bodys_end_is_not_known() -> None:
    task = load_task("tool-use")
    made = plan(task)
    found = result(task, made, run(made))
    assert not found["success"]
    assert found["reason"]["text"] == "engine planar does not move 'cube': where it ends is not known"
