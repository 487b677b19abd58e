"""Tracking of an arc path by the axle of an object that is pushed like a car:
look-ahead alignment, and the wrench on the limit surface for the turn
(docs/mechanics.md, sections 3 and 5).
"""

from __future__ import annotations

from math import atan, cos, remainder, sin, sqrt

from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import TURN, ArcPath
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.rom.drives import ORIGIN
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment


class AxleTracker:
    """Tracking law of one car. Its wrench is about the CoM."""

    def __init__(
        self, law: LookAheadAlignment, car: PushedCar, max_friction: float
    ) -> None:
        """Bind the law to a car that slides straight under ``max_friction`` [N].

        The force across the heading is the force along it times the effective wheelbase
        and the curvature. It is zero for a car that is turned without friction.
        """
        self._curvature = law.curvature
        self._figures = (
            car.axle,
            car.effective_wheelbase,
            car.rho * car.rho,
            car.heading,
            cos(car.heading),
            sin(car.heading),
            max_friction,
        )

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench and twist that follow ``path``, an ArcPath, at ``speed`` [m/s].

        ``steering_scale`` narrows the steering of a car that steers by friction.
        """
        assert isinstance(path, ArcPath)
        axle, wheelbase, rho_squared, heading, ex, ey, max_friction = self._figures
        yaw = X_WB.yaw + heading
        x = X_WB.x + axle * cos(yaw)
        y = X_WB.y + axle * sin(yaw)
        progress, left, direction, curvature = path.nearest(x, y, progress)
        turned = remainder(direction - yaw, TURN)
        share = steering_scale if wheelbase > 0.0 else 1.0
        turn, saturated = self._curvature((x, y, yaw), left, turned, curvature, share)
        across = -wheelbase * turn  # force to the left per force along
        along = max_friction / sqrt(1.0 + across * across + rho_squared * turn * turn)
        w = speed * turn
        return Guidance(
            progress,
            along * (ex - across * ey),
            along * (ey + across * ex),
            along * rho_squared * turn,
            ORIGIN,
            speed * ex + w * axle * ey,
            speed * ey - w * axle * ex,
            w,
            ORIGIN,
            atan(across),
            (0.0, left, turned),
            saturated,
        )
