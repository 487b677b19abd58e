"""Workspace of the object's frame."""

from dataclasses import replace

import pytest

from pushpressslide import load_task
from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Limits
from pushpressslide.planning.segments import describe_points
from pushpressslide.planning.workspace import STEP, poses_along, workspace_refusal
from pushpressslide.selection.solve import plan

TASK = load_task("rear-push-rear")
PIECE = plan(TASK).segments[0]
TIGHT = Limits(workspace=(0.0, 1.0, -0.5, 0.5))


def test_the_poses_of_a_segment_lead_from_start_to_goal_in_steps() -> None:
    poses = poses_along(PIECE)
    start, goal = TASK.query.body_ends
    for pose, wanted in ((poses[0], start), (poses[-1], goal)):
        assert (pose.x, pose.y) == pytest.approx((wanted.x, wanted.y), abs=1e-7)
    assert len(poses) >= PIECE.path.length / STEP


def test_the_frame_of_the_shape_is_bounded_not_that_of_the_body() -> None:
    body = replace(TASK.object, center_of_mass=(0.02, 0.0))
    inside = [Pose2(1.015, 0.0, 0.0)]  # the CoM is outside, the shape's frame is not
    assert workspace_refusal(body, TIGHT, inside) is None
    refusal = workspace_refusal(body, TIGHT, [Pose2(1.03, 0.0, 0.0)])
    assert refusal is not None
    assert refusal.code == "workspace"
    assert "(1.010, 0.000)" in str(refusal)


def test_without_a_workspace_every_place_is_allowed() -> None:
    assert workspace_refusal(TASK.object, Limits(), [Pose2(9.0, 9.0, 0.0)]) is None


def test_a_point_in_words_has_no_negative_zero() -> None:
    assert describe_points([(-1e-6, 0.1)]) == "(0.000, 0.100)"
