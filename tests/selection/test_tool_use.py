"""A goal of another body."""

import math

import pytest

from pushpressslide.core.errors import TaskError
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box, Obstacle
from pushpressslide.planar.engine import run
from pushpressslide.report.metrics import result
from pushpressslide.selection.select import select
from pushpressslide.selection.solve import plan
from pushpressslide.selection.tool_use import StraightPush
from pushpressslide.taskfile.load import load_task


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
        (
            "obstacles.0={name: cube, cylinder: {radius: 0.04, height: 0.08}, movable: true, "
            "pose: {x: 0.45, y: 0.38}}",
            "80 mm; allowed: a box",
        ),
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
    assert (
        found["reason"]["text"]
        == "engine planar does not move 'cube': where it ends is not known"
    )


def test_a_mode_that_would_not_push_straight_with_the_tools_face_is_refused() -> None:
    short = [
        "modes=[rear_push]",
        "start={x: 0.45, y: -0.35, yaw_deg: 90}",
        "motion={}",
        "robots.0.base.y=-0.2",
    ]
    # from behind, all the way in the face's normal
    assert select(load_task("tool-use", short))[0].feasible
    curved = load_task("tool-use", [*short, "start.x=0.5", "motion.run_in=0.02"])
    assert all(not choice.feasible for choice in select(curved))
    assert any(
        "off the straight push by tool.face" in choice.reason
        for choice in select(curved)
    )


TRIANGLE = ((0.1, -0.05), (0.1, 0.05), (-0.1, 0.0))
BODY = Obstacle("block", Box((0.08, 0.04, 0.05)), Pose2(0.3, -0.2, 0.1), movable=True)


@pytest.mark.parametrize("face", range(3))
@pytest.mark.parametrize("direction", [-2.0, 0.1, 0.1 + 0.5 * math.pi, 3.0])
def test_every_face_ends_square_to_the_push_and_against_the_body(
    face: int, direction: float
) -> None:
    edge = (TRIANGLE[face], TRIANGLE[(face + 1) % 3])
    X_WG = StraightPush(BODY, direction, 0.25).tool_goal(edge)
    first = X_WG.apply(TRIANGLE[face])
    second = X_WG.apply(TRIANGLE[(face + 1) % 3])
    along = (second[0] - first[0], second[1] - first[1])
    ahead = (math.cos(direction), math.sin(direction))
    assert along[0] * ahead[0] + along[1] * ahead[1] == pytest.approx(0.0, abs=1e-12)
    lengthwise = abs(math.sin(direction - BODY.pose.yaw)) < 0.7
    half = 0.5 * BODY.shape.size[0 if lengthwise else 1]
    middle = (0.5 * (first[0] + second[0]), 0.5 * (first[1] + second[1]))
    assert middle == pytest.approx(
        (
            BODY.pose.x + (0.25 - half) * ahead[0],
            BODY.pose.y + (0.25 - half) * ahead[1],
        )
    )


def test_a_tool_pushes_with_a_face_that_nothing_stands_out_beyond() -> None:
    """The inner faces of an L are no faces to push a box with."""
    corners = "[[0, 0], [0.2, 0], [0.2, 0.06], [0.06, 0.06], [0.06, 0.2], [0, 0.2]]"
    shape = f"object.shape={{prism: {{polygon: {corners}, height: 0.1}}}}"
    with pytest.raises(TaskError, match=r"tool\.face.*allowed: 0, 1, 4, 5"):
        load_task("tool-use", [shape, "tool.face=2", "object.center_of_mass=null"])
