"""Tracking of a pushed object driven as a rear-steer car (docs/mechanics.md, section
3).

All numbers are plain floats, for use in a control loop. A test bounds the cost.
"""

from __future__ import annotations

import math
from math import cos, sin

from pushpressslide.core import margins
from pushpressslide.core.allocation import new
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.kernels.arc_path import wrapped
from pushpressslide.kernels.tracking import Car, steered_push
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_stanley import Steering

EASING = 0.5 * margins.ARM.steering_time  # [s]


class RearPushTracker:
    """Rear Stanley law, with the wrench on the limit surface for its steering."""

    def __init__(
        self, steer: Steering, car: RearSteerCar, X_BV: Pose2, max_friction: float
    ) -> None:
        """Bind the law to a car whose frame ``X_BV`` follows the path.

        ``max_friction`` is mu_s N [N].
        """
        ex, ey = car.axis
        self._figures = (
            math.atan2(ey, ex),
            math.hypot(*X_BV.position),
            math.atan2(X_BV.y, X_BV.x),
        )
        self._car = figures_of_car(car, max_friction)
        self._law = (steer, car.cop, X_BV.position)

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench and twist that follow ``path`` at ``speed`` [m/s] from pose ``X_WB``."""
        assert isinstance(path, ArcPath)
        heading_axis, reach, bearing = self._figures
        steer, cop, axle = self._law
        yaw = X_WB.yaw + heading_axis
        ahead = X_WB.yaw + bearing
        x = X_WB.x + reach * cos(ahead)
        y = X_WB.y + reach * sin(ahead)
        progress, left, heading, curvature = path.nearest(
            x, y, progress, EASING * speed
        )
        heading_error = wrapped(heading - yaw)
        delta, saturated = steer(left, heading_error, curvature, steering_scale)
        wrench, twist = steered_push(delta, speed, self._car)
        fx, fy, tau = wrench
        vx, vy, w = twist  # the axle moves along the heading axis
        errors = (0.0, left, heading_error)
        to_drive = (
            progress,
            fx,
            fy,
            tau,
            cop,
            vx,
            vy,
            w,
            axle,
            delta,
            errors,
            saturated,
        )
        return new(Guidance, to_drive)


def figures_of_car(car: RearSteerCar, max_friction: float) -> Car:
    """Parameters of a car for ``kernels.tracking.steered_push``. ``max_friction`` is
    mu_s N [N].
    """
    ex, ey = car.axis
    stretch = 1.0 + (car.lever / car.rho) ** 2
    turning = -1.0 / car.effective_wheelbase
    return ex, ey, max_friction, stretch, -car.lever, turning
