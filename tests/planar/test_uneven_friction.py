"""Limit surfaces of supports that are not even."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide.core.task import Box
from pushpressslide.core.truth import Truth
from pushpressslide.core.wrench import Twist
from pushpressslide.planar.support import Support
from pushpressslide.planar.support_friction import SupportFriction
from pushpressslide.planar.uneven_friction import UnevenFriction, UnevenGround

SUPPORT = Support(Box((0.15, 0.1, 0.1)), (0.0, 0.0))
COP = (0.005, 0.002)
REST = Twist(0.0, 0.0, 0.0)
TWISTS = [(0.02, 0.01, 0.0), (0.0, 0.0, 0.3), (-0.01, 0.03, -0.8)]
LIMIT = 3.0


def friction(truth: Truth, pose: Pose2 | None = None, twist: Twist = REST):
    ground = UnevenGround(truth, 2)
    return ground.under(SUPPORT, COP, pose or Pose2(0.4, 0.2, 0.7), twist, 0.0)


@pytest.mark.parametrize("twist", TWISTS)
def test_an_even_support_has_the_exact_limit_surface(
    twist: tuple[float, float, float],
) -> None:
    even = SupportFriction(SUPPORT.samples(COP))
    uneven = friction(Truth())
    assert uneven.rho == pytest.approx(even.rho)
    np.testing.assert_allclose(
        uneven.wrench(twist, LIMIT), even.wrench(twist, LIMIT), rtol=1e-9, atol=1e-9
    )
    wrench, slope = uneven.wrench_and_slope(twist, LIMIT)
    own, other = even.wrench_and_slope(twist, LIMIT)
    np.testing.assert_allclose(wrench, own, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(slope, other, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("twist", TWISTS)
def test_the_slope_is_the_derivative(twist: tuple[float, float, float]) -> None:
    surface = friction(Truth(friction_direction=0.6, friction_patches=0.4))
    _, slope = surface.wrench_and_slope(twist, LIMIT)
    step = 1e-6
    for i in range(3):
        ahead, behind = (
            tuple(v + sign * step * (i == j) for j, v in enumerate(twist))
            for sign in (1.0, -1.0)
        )
        forces = [np.array(surface.wrench(end, LIMIT)) for end in (ahead, behind)]
        change = (forces[0] - forces[1]) / (2.0 * step)
        np.testing.assert_allclose(np.array(slope)[:, i], change, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("yaw", [0.0, 0.9])
def test_friction_differs_along_and_across_the_grain_of_the_support(
    yaw: float,
) -> None:
    grain = 0.4
    surface = friction(
        Truth(friction_direction=0.5, grain_yaw=grain), Pose2(0.0, 0.0, yaw)
    )
    for turn, factor in ((0.0, 0.75), (0.5 * math.pi, 1.25)):
        direction = grain - yaw + turn
        ex, ey = math.cos(direction), math.sin(direction)
        fx, fy, _ = surface.wrench((0.01 * ex, 0.01 * ey, 0.0), LIMIT)
        assert (fx, fy) == pytest.approx((factor * LIMIT * ex, factor * LIMIT * ey))


def test_a_rough_side_turns_an_object_that_is_dragged() -> None:
    """The moment is that of the patches' frictions about the centre of pressure."""
    truth = Truth(friction_patches=0.5, patch_size=0.05)
    pose = Pose2(0.4, 0.2)
    surface = friction(truth, pose)
    samples = SUPPORT.samples(COP)
    arms = samples.points - np.array(samples.cop)
    ground = UnevenGround(truth, 2)._ground
    places = arms + COP + pose.position
    factors = ground.factors(places, np.zeros(len(arms)), 0.0)
    loads = LIMIT * factors * samples.loads
    fx, fy, tau = surface.wrench((0.01, 0.0, 0.0), LIMIT)
    assert fx == pytest.approx(loads.sum())
    assert fy == pytest.approx(0.0, abs=1e-9)
    assert tau == pytest.approx(-loads @ arms[:, 1])
    assert abs(tau) > 0.01 * LIMIT * surface.rho


def test_the_shares_are_those_of_the_last_speed() -> None:
    truth = Truth(friction_speed=0.4)
    slow = friction(truth)
    fast = friction(truth, twist=Twist(0.3, 0.4, 0.0))
    push = (0.01, 0.0, 0.0)
    assert slow.wrench(push, LIMIT)[0] == pytest.approx(LIMIT)
    left = 1.0 - 0.4 * (1.0 - math.exp(-10.0))
    assert fast.wrench(push, LIMIT)[0] == pytest.approx(left * LIMIT)


def test_coulomb_friction_needs_no_ground() -> None:
    assert UnevenGround.if_uneven(Truth(tilt=0.1, bow=0.5), 0) is None
    assert isinstance(
        UnevenGround.if_uneven(Truth(friction_direction=0.1), 0), UnevenGround
    )
    assert isinstance(friction(Truth()), UnevenFriction)
