"""The pose of an object at rest, from many pictures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.control.looking import MOST, RestingPose
from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.pose import Pose2

LAST = StampedPose(7.0, Pose2(9.0, 9.0, 0.9))


def test_without_pictures_the_last_pose_stays() -> None:
    assert RestingPose().middle(LAST) is LAST


def test_the_middle_is_better_than_a_picture_and_a_few_wrong_ones_do_not_move_it() -> (
    None
):
    random = np.random.default_rng(1)
    resting = RestingPose()
    for i in range(MOST):
        x, y, yaw = (1e-3 * random.normal(size=3)).tolist()
        wrong = 0.5 if i % 10 == 3 else 0.0
        pose = Pose2(0.2 + x + wrong, 0.1 + y, math.pi - 1e-4 + yaw + wrong)
        resting.add(StampedPose(0.01 * i, pose))
    middle = resting.middle(LAST)
    assert middle.time == LAST.time
    assert middle.pictures == MOST
    assert middle.X_WG.position == pytest.approx((0.2, 0.1), abs=4e-4)
    assert abs(math.remainder(middle.X_WG.yaw - math.pi, math.tau)) < 6e-4


def test_a_repeated_picture_counts_once() -> None:
    resting = RestingPose()
    for i, x in enumerate((0.0, 1.0, 1.0, 1.0, 2.0)):
        resting.add(StampedPose(0.1 * i, Pose2(x, 0.0, 0.0)))
    middle = resting.middle(LAST)
    assert middle.pictures == 3
    assert middle.X_WG.x == 1.0
