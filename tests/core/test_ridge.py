"""Ridges on a support."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import pushpressslide as pps
from pushpressslide.core.pose import Pose2
from pushpressslide.core.ridge import WIDTH, Ridge
from pushpressslide.core.truth import Truth

TASK = replace(
    pps.load_task("rear-push-rear"),
    start=Pose2(0.4, -0.1, 0.3),
    goal=Pose2(0.4, 0.3, 1.0),
)


def test_a_ridge_crosses_the_line_from_start_to_goal() -> None:
    assert Ridge.of_task(TASK) is None
    truth = Truth(ridge=0.001, ridge_place=0.25, ridge_angle=0.2)
    ridge = Ridge.of_task(replace(TASK, truth=truth))
    assert ridge is not None
    assert ridge.pose.position == pytest.approx((0.4, 0.0))
    assert ridge.pose.yaw == pytest.approx(math.pi + 0.2)


@pytest.mark.parametrize("height", [0.0005, 0.002])
def test_its_profile_stands_on_the_support(height: float) -> None:
    ridge = Ridge(Pose2(), height)
    profile = ridge.profile(8)
    assert profile[0] == pytest.approx((-0.5 * WIDTH, 0.0), abs=1e-9)
    assert profile[-1] == pytest.approx((0.5 * WIDTH, 0.0), abs=1e-9)
    assert max(profile, key=lambda point: point[1]) == pytest.approx((0.0, height))
