"""Steps of a control tick other than the tracking law: pose filter, pacing along the
path, and steering scale.
"""

from __future__ import annotations

from math import hypot, sqrt

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.arc_path import wrapped
from pushpressslide.kernels.kernel import kernel
from pushpressslide.kernels.plane import Pose

Pace = tuple[float, float, float, float]
"""Bounds of the speed along a path: final speed [m/s], largest speed [m/s],
acceleration [m/s^2], and gain [1/s] that makes up for a lag behind the time reference.
"""
SteeringScale = tuple[float, float, float, float]
"""Parameters of the steering scale: friction utilisation above which it decreases,
rates of decrease and increase [1/s], and smallest value.
"""


@kernel
def corrected(predicted: Pose, measured: Pose, gain: float) -> Pose:
    """A predicted pose, corrected by a fraction ``gain`` of its difference from a
    measured pose.
    """
    turn = wrapped(measured[2] - predicted[2])
    return (
        predicted[0] + gain * (measured[0] - predicted[0]),
        predicted[1] + gain * (measured[1] - predicted[1]),
        predicted[2] + gain * turn,
    )


@kernel
def paced(
    planned: Vector, progress: float, left: float, min_speed: float, pace: Pace
) -> float:
    """Speed [m/s] along a path: that of the profile, plus a term that makes up for a
    lag.

    ``planned`` are progress [m] and speed [m/s] of the profile, ``left`` [m] is the
    remaining length of the path, and ``min_speed`` [m/s] the smallest speed.
    """
    floor, upper, acceleration, catch_up = pace
    wanted = planned[1] + catch_up * (planned[0] - progress)
    braking = floor + sqrt(acceleration * max(left, 0.0))
    return min(max(wanted, min_speed), upper, braking)


@kernel
def eased_steering_scale(
    share: float, used: float, dt: float, steering_scale: SteeringScale
) -> float:
    """Fraction of the steering that may be used after another ``dt`` [s] at the
    friction utilisation ``used``.
    """
    use, fall, rise, lower = steering_scale
    rate = -fall if used > use else rise
    return min(1.0, max(lower, share + rate * dt))


@kernel
def approached(value: Vector, target: Vector, step: float) -> Vector:
    """``target`` if it is within ``step`` of ``value``, otherwise the point a ``step``
    towards it.
    """
    dx = target[0] - value[0]
    dy = target[1] - value[1]
    size = hypot(dx, dy)
    if size <= step:
        return target
    return value[0] + dx * step / size, value[1] + dy * step / size
