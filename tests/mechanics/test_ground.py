"""Friction of a support by place, speed and time."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.truth import EXACT, Truth
from pushpressslide.mechanics.ground import Ground, is_uneven, speed_factors

POINTS = np.array([(0.01, 0.02), (-0.3, 0.4), (0.7, -0.2)])


def test_friction_at_rest_is_the_static_one_and_falls_within_millimetres_a_second() -> (
    None
):
    truth = Truth(static_friction=1.5)
    factors = speed_factors(truth, np.array([0.0, 1e-3, 0.02]))
    np.testing.assert_allclose(factors, [1.5, 1.0 + 0.5 / math.e, 1.0], atol=1e-8)


@pytest.mark.parametrize("share", [0.4, -0.4])
def test_friction_changes_with_the_speed_by_the_stated_share(share: float) -> None:
    truth = Truth(friction_speed=share)
    factors = speed_factors(truth, np.array([0.0, 0.05, 10.0]))
    expected = [1.0, 1.0 - share * (1.0 - 1.0 / math.e), 1.0 - share]
    np.testing.assert_allclose(factors, expected)


def test_friction_drifts_by_the_stated_share_in_a_minute() -> None:
    ground = Ground.of_truth(Truth(friction_drift=-0.2), 0)
    at_rest = np.zeros(len(POINTS))
    for time, factor in ((0.0, 1.0), (60.0, 0.8), (120.0, 0.64)):
        np.testing.assert_allclose(ground.factors(POINTS, at_rest, time), factor)


def test_patches_have_the_stated_size_and_spread() -> None:
    truth = Truth(friction_patches=0.3, patch_size=0.02)
    ground = Ground.of_truth(truth, 5)
    cells = 0.02 * (np.stack(np.meshgrid(range(40), range(40)), -1).reshape(-1, 2))
    middles = ground.factors(cells + 0.01, np.zeros(1600), 0.0)
    assert middles.mean() == pytest.approx(1.0, abs=0.03)
    assert middles.std() == pytest.approx(0.3, abs=0.02)
    assert len(np.unique(middles)) == 1600
    corners = ground.factors(cells + np.array((0.0199, 0.0001)), np.zeros(1600), 0.0)
    np.testing.assert_array_equal(corners, middles)
    same = Ground.of_truth(truth, 5).factors(POINTS, np.zeros(3), 0.0)
    np.testing.assert_array_equal(same, ground.factors(POINTS, np.zeros(3), 0.0))
    other = Ground.of_truth(truth, 6).factors(POINTS, np.zeros(3), 0.0)
    assert (same != other).all()


def test_points_of_a_turning_body_slide_with_their_own_speeds() -> None:
    ground = Ground.of_truth(Truth(friction_speed=0.5), 0)
    points = np.array([(0.1, 0.0), (0.0, 0.0), (-0.1, 0.0)])
    pose = Pose2(0.4, 0.2, math.pi / 2)
    # (0.1, 0) is at (0.4, 0.3), where the turn cancels the motion along x
    factors = ground.under(points, pose, (0.02, 0.0, 0.2), 0.0)
    expected = speed_factors(ground.truth, np.array([0.0, 0.02, 0.04]))
    np.testing.assert_allclose(factors, expected)


def test_only_what_differs_with_place_speed_or_time_is_uneven() -> None:
    assert not is_uneven(EXACT)
    assert not is_uneven(Truth(tilt=0.1, size=(0.01, 0.0), friction_direction=0.5))
    for field in ("friction_speed", "friction_patches", "friction_drift"):
        assert is_uneven(Truth(**{field: 0.1}))
    assert is_uneven(Truth(static_friction=1.1))
