"""A joint trajectory stays inside its limits and on its path, kinks or not.

The oracle is finite differences of densely sampled positions.
"""

import numpy as np
import pytest

from pushpressslide.arms.smooth_joints import (
    SPACING,
    JointLimits,
    Polyline,
    smooth_trajectory,
)

LIMITS = JointLimits(
    np.array([2.0, 2.5]), np.array([8.0, 15.0]), np.array([4000.0, 7500.0])
)
PERIOD = 1e-4


def polyline(rows: list, seconds: float) -> Polyline:
    joints = np.array(rows)
    times = np.linspace(0.0, seconds, len(joints))
    return Polyline(times, joints, ("move",) * len(joints))


PATHS = {
    # a step of joint 2 between two knots, as an elbow that changes its way
    "kink": [(0.01 * i, 0.0 if i < 50 else 0.05 * (i - 50)) for i in range(100)],
    "corner": [(0.5, 0.0), (0.5, 0.8), (1.2, 0.8)],
    "back": [(0.0, 0.0), (0.6, 0.1), (0.0, 0.2)],
    "rest": [(0.0, 0.0), (0.3, 0.1), (0.3, 0.1), (0.6, 0.1)],
}


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("seconds", [0.2, 5.0])
def test_speed_acceleration_and_jerk_are_within_limits(
    name: str, seconds: float
) -> None:
    made = smooth_trajectory(polyline(PATHS[name], seconds), LIMITS, PERIOD)
    q = made.positions[:-1]  # the last step is shorter
    for order, limit in ((1, LIMITS.speed), (2, LIMITS.acceleration)):
        rates = np.abs(np.diff(q, order, axis=0)) / PERIOD**order
        assert (rates < 1.01 * limit).all()
    jerk = np.abs(np.diff(made.accelerations[:-1], axis=0)) / PERIOD
    assert (jerk < 1.01 * LIMITS.jerk).all()
    assert made.times[-1] >= 0.6 * seconds
    assert np.diff(q, axis=0) / PERIOD == pytest.approx(
        made.velocities[:-2], abs=0.5 * PERIOD * LIMITS.acceleration.max() + 1e-9
    )


@pytest.mark.parametrize("name", PATHS)
def test_it_leads_from_rest_to_rest_along_the_path(name: str) -> None:
    planned = polyline(PATHS[name], 1.0)
    made = smooth_trajectory(planned, LIMITS, 1e-3)
    assert made.positions[[0, -1]] == pytest.approx(planned.joints[[0, -1]], abs=1e-9)
    for ends in (made.velocities, made.accelerations):
        assert ends[[0, -1]] == pytest.approx(np.zeros((2, 2)), abs=1e-6)
    assert made.deviation < 1.5 * SPACING


def test_a_path_that_is_slow_enough_keeps_its_time() -> None:
    straight = polyline([(0.01 * i, 0.02 * i) for i in range(50)], 10.0)
    made = smooth_trajectory(straight, LIMITS, 1e-2)
    assert made.times[-1] == pytest.approx(10.0)


def test_two_parts_are_joined_with_their_phases() -> None:
    first = Polyline(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]), ("touch",) * 2)
    second = Polyline(np.array([5.0, 7.0]), np.array([[1.0], [3.0]]), ("move",) * 2)
    whole = first.followed_by(second)
    assert whole.times.tolist() == [0.0, 1.0, 3.0]
    assert whole.joints.ravel().tolist() == [0.0, 1.0, 3.0]
    assert whole.phases == ("touch", "touch", "move")
