"""Tracking laws on arrays answer like the single ones."""

import math

import numpy as np
import pytest

from pushpressslide.batch import tracking
from pushpressslide.batch.tracking import (
    holonomic,
    lookahead_curvature,
    rear_push,
    rear_stanley,
)
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking import holonomic as holonomic_tracker
from pushpressslide.tracking import lookahead_alignment, rear_car
from pushpressslide.tracking import rear_stanley as single_stanley
from pushpressslide.tracking.holonomic import HolonomicTracker
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

CASES = 500


@pytest.fixture(scope="module")
def errors():
    """Left and heading errors, and curvatures of the path."""
    rng = np.random.default_rng(0)
    left = rng.normal(size=CASES) * 0.1
    heading = rng.uniform(-math.pi, math.pi, CASES)
    curvature = rng.normal(size=CASES) * 2.0
    left[:10] = heading[:10] = curvature[:10] = 0.0
    left[10] = heading[11] = curvature[12] = math.nan
    left[13] = math.inf
    return left, heading, curvature


@pytest.mark.parametrize("feed_forward", [False, True])
def test_rear_stanley(engine, errors, feed_forward):
    bounds = (-0.5, 0.3)
    steering_scale = np.random.default_rng(1).uniform(0.1, 1.0, CASES)
    delta, clipped = rear_stanley(
        *errors,
        wheelbase=0.07,
        steering_bounds=bounds,
        gain=0.8,
        feed_forward=feed_forward,
        steering_scale=steering_scale,
    )
    steer = single_stanley.rear_stanley(0.07, bounds, 0.8, feed_forward)
    rows = zip(*(array.tolist() for array in (*errors, steering_scale)), strict=True)
    single = [steer(*row) for row in rows]
    numbers = ~np.isnan(delta)
    assert np.flatnonzero(~numbers).tolist()[:2] == [10, 11]
    expected = np.array([angle for angle, _ in single])
    np.testing.assert_allclose(delta[numbers], expected[numbers], atol=1e-15)
    assert clipped.tolist() == [flag for _, flag in single]


def test_look_ahead_alignment(engine, errors):
    turn, clipped = lookahead_curvature(
        *errors, look_ahead=0.2, limit=3.0, steering_scale=0.9
    )
    law = LookAheadAlignment(0.2, 3.0)
    rows = zip(*(array.tolist() for array in errors), strict=True)
    single = [law.curvature((0.0, 0.0, 0.0), *row, 0.9) for row in rows]
    expected = np.array([curvature for curvature, _ in single])
    np.testing.assert_allclose(turn, expected, atol=1e-13)
    assert clipped.tolist() == [flag for _, flag in single]
    assert 0 < clipped.sum() < CASES


def test_the_wrench_and_the_twist_of_a_rear_push(engine):
    rng = np.random.default_rng(2)
    contacts = rng.uniform(-0.2, -0.05, (CASES, 2))
    rho = rng.uniform(0.03, 0.1, CASES)
    steering = rng.uniform(-0.4, 0.4, CASES)
    lever = np.linalg.norm(contacts, axis=1)
    axis = -contacts / lever[:, None]
    wrenches, twists = rear_push(
        steering, 0.05, axis=axis, lever=lever, rho=rho, max_force=2.0
    )
    surface_size = np.hypot(np.hypot(*wrenches[:, :2].T), wrenches[:, 2] / rho)
    np.testing.assert_allclose(surface_size, 2.0)
    for i in range(300):
        car = RearSteerCar(
            tuple(contacts[i]), tuple(axis[i]), (0.0, 0.0), float(rho[i]), 0.6
        )
        delta = float(steering[i])
        assert wrenches[i, :2] == pytest.approx(car.force(delta, 2.0))
        turn = car.curvature(delta) * 0.05
        assert twists[i] == pytest.approx((0.05 * axis[i, 0], 0.05 * axis[i, 1], turn))


def test_the_holonomic_law(engine):
    rng = np.random.default_rng(3)
    goal = Pose2(0.4, 0.1, 0.8)
    path = TwistPath.between((Pose2(), goal), 0.08)
    surface = DraggedSurface(2.0, 0.08)
    law = HolonomicTracker(Pose2(), surface, 0.05)
    poses = rng.normal(size=(CASES, 3)) * (0.1, 0.1, 0.5)
    poses[:5] = 0.0
    errors = np.empty((CASES, 3))
    rates = np.empty((CASES, 3))
    twists = np.empty((CASES, 3))
    limited = np.empty(CASES, dtype=bool)
    for i, pose in enumerate(poses.tolist()):
        X_WB = Pose2(*pose)
        guidance = law.step(path, X_WB, 0.0, 0.03, 0.7)
        wanted = path.pose(guidance.progress)
        turned = math.remainder(wanted.yaw - X_WB.yaw, 2.0 * math.pi)
        errors[i] = (*X_WB.unapply(wanted.position), turned)
        rates[i] = path.rate(guidance.progress)
        twists[i] = guidance.twist[:3]
        limited[i] = guidance.saturated
    got, flags = holonomic(
        errors, rates, speed=0.03, decay=0.05, radius=path.radius, steering_scale=0.7
    )
    np.testing.assert_allclose(got, twists, atol=1e-14)
    assert flags.tolist() == limited.tolist()


@pytest.mark.parametrize(
    ("single", "kernel"),
    [
        (single_stanley, "stanley_steering"),
        (lookahead_alignment, "look_ahead_curvature"),
        (rear_car, "steered_push"),
        (holonomic_tracker, "pulled_twist"),
    ],
)
def test_a_batch_runs_the_kernel_of_the_loop(single, kernel):
    assert getattr(tracking, kernel) is getattr(single, kernel)


def test_laws_of_any_shape(engine):
    left = np.zeros((4, 1))
    wheelbase = np.array([0.05, 0.07, 0.09])
    delta, _ = rear_stanley(
        left, 0.1, 0.0, wheelbase=wheelbase, steering_bounds=(-1.0, 1.0)
    )
    assert delta.shape == (4, 3)
    one, clipped = lookahead_curvature(0.0, 0.1, 0.0, look_ahead=0.2, limit=3.0)
    assert one.shape == clipped.shape == ()
