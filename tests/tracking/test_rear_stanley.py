"""Laws of the rear Stanley steering, on the exact kinematics of the reduced model."""

import math

import pytest

from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.pose import Pose2
from pushpressslide.tracking.rear_stanley import rear_stanley

WHEELBASE = 0.045


def drive(steer, path, start, length, signs=(1.0, 1.0), step=2e-4):
    """Follow ``path`` from ``start``; the axle moves along its heading with w/v =
    -tan(delta)/wheelbase.
    """
    pose = start
    s = 0.0
    errors = []
    for _ in range(int(length / step)):
        s, left, direction, curvature = path.nearest(pose.x, pose.y, s)
        heading = math.remainder(direction - pose.yaw, 2.0 * math.pi)
        errors.append((left, heading))
        delta, _ = steer(signs[0] * left, signs[1] * heading, curvature, 1.0)
        pose = advance(pose, -math.tan(delta) / WHEELBASE, step)
    return errors


def straight(length=2.0):
    return ArcPath(Pose2(), ((0.0, length),))


def law(gain=1.0, **more):
    return rear_stanley(WHEELBASE, (-1.2, 1.2), gain, **more)


def test_reference_minus_actual_converges():
    errors = drive(law(), straight(), Pose2(0.0, 0.01, 0.1), 1.0)
    assert abs(errors[-1][0]) < 1e-5
    assert abs(errors[-1][1]) < 1e-4


@pytest.mark.parametrize("signs", [(-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
def test_every_other_sign_combination_diverges(signs):
    errors = drive(law(), straight(), Pose2(0.0, 0.01, 0.1), 1.0, signs)
    assert abs(errors[-1][0]) > 0.01 or abs(errors[-1][1]) > 0.5


def overshoot(gain):
    """Largest crossing to the other side, as a share of the first offset."""
    errors = drive(law(gain), straight(), Pose2(0.0, -0.002, 0.0), 1.0)
    return max(0.0, -min(e for e, _ in errors)) / 0.002


@pytest.mark.parametrize("gain", [0.25, 0.5, 1.0])
def test_no_overshoot_up_to_the_critical_gain(gain):
    assert overshoot(gain) < 1e-3


@pytest.mark.parametrize(("gain", "expected"), [(2.0, 0.04), (4.0, 0.16), (8.0, 0.30)])
def test_overshoot_beyond_the_critical_gain_is_that_of_a_second_order_system(
    gain, expected
):
    assert overshoot(gain) == pytest.approx(expected, abs=0.02)


def test_feed_forward_removes_the_offset_on_a_curve():
    circle = ArcPath(Pose2(), ((4.0, 3.0),))
    with_it = drive(law(), circle, Pose2(), 1.2)
    without = drive(law(feed_forward=False), circle, Pose2(), 1.2)
    assert abs(with_it[-1][0]) < 1e-5
    # without it the axle runs outside, on a wider circle: |e| / (4 L) = L kappa',
    # kappa' = kappa / (1 + kappa |e|)
    offset = without[-1][0]
    assert offset == pytest.approx(
        4.0 * WHEELBASE**2 * 4.0 / (1.0 + 4.0 * offset), rel=0.01
    )


def test_steering_is_clipped_and_says_so():
    bounded = rear_stanley(WHEELBASE, (-0.1, 0.2))
    assert bounded(0.0, 1.0, 0.0, 1.0) == (-0.1, True)
    assert bounded(0.0, -1.0, 0.0, 1.0) == (0.2, True)
    assert bounded(0.0, 0.05, 0.0, 1.0) == (-0.05, False)


def test_by_default_the_gain_is_the_largest_without_overshoot():
    errors = (0.01, 0.0, 0.0, 1.0)
    default = rear_stanley(WHEELBASE, (-1.0, 1.0))(*errors)
    assert default == rear_stanley(WHEELBASE, (-1.0, 1.0), gain=1.0)(*errors)
    assert default[0] == pytest.approx(-math.atan(0.01 / (4.0 * WHEELBASE)))
