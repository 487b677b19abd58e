"""Tracking of a pressed object driven as a unicycle: along a path, and turned on the
spot (docs/mechanics.md, sections 2 and 4).
"""

from __future__ import annotations

import math
from math import atan, cos, remainder, sin, sqrt, tan

from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.rom.drives import ORIGIN, SpinDrive, SteeredDrive
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

TURN = 2.0 * math.pi
PIVOT_GAIN = 2.0  # [1/s] pull on the axle along the axis while turning on the spot
PIVOT_SHARE = 0.3  # largest pull, as a share of the turn's force


class UnicycleTracker:
    """Look-ahead alignment of a pressed object, with the wrench on the limit surface
    for the turn.
    """

    def __init__(self, law: LookAheadAlignment, drive: SteeredDrive) -> None:
        """Bind the law to a vehicle."""
        car = drive.car
        self._curvature = law.curvature
        X_BV = drive.X_BV
        rx = car.contact[0] - car.cop[0]
        ry = car.contact[1] - car.cop[1]
        self._axle = (X_BV.x, X_BV.y, X_BV.yaw, math.cos(X_BV.yaw), math.sin(X_BV.yaw))
        self._force = (
            drive.angle,
            drive.turn,
            drive.effective_wheelbase,
            drive.right,
            drive.left,
        )
        inverse = 1.0 / math.hypot(rx, ry)
        self._press = (rx, ry, inverse, car.cop, drive.max_friction, drive.stiffness)

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench (about the CoP) and twist that follow ``path`` at ``speed`` [m/s].

        ``steering_scale`` is not used: a turn takes less of the press's friction than
        straight sliding.
        """
        assert isinstance(path, ArcPath)
        qx, qy, axis, ex, ey = self._axle
        planned, turning, wheelbase, right, left_most = self._force
        rx, ry, inverse, cop, max_friction, stiffness = self._press
        yaw = X_WB.yaw
        c = cos(yaw)
        s = sin(yaw)
        x = X_WB.x + c * qx - s * qy
        y = X_WB.y + s * qx + c * qy
        progress, left, heading, curvature = path.nearest(x, y, progress)
        heading_error = remainder(heading - yaw - axis, TURN)
        turn, _ = self._curvature(
            (x, y, yaw + axis), left, heading_error, curvature, 1.0
        )
        wanted = atan(wheelbase * (turn - turning))
        steering = min(max(wanted, right), left_most)
        if steering != wanted:
            turn = turning + tan(steering) / wheelbase
        fx = cos(planned + steering)
        fy = sin(planned + steering)
        lever = rx * fy - ry * fx
        # |f| = mu_s N / sqrt(1 + (d sin(phi) / rho)^2)
        size = max_friction / sqrt(1.0 + stiffness * (lever * inverse) ** 2)
        w = speed * turn
        return Guidance(
            progress,
            size * fx,
            size * fy,
            size * lever,
            cop,
            speed * ex + w * qy,
            speed * ey - w * qx,
            w,
            ORIGIN,
            steering,
            (0.0, left, heading_error),
            steering != wanted,
        )


class PivotTracker:
    """Law of a spin: the force is across the axis, with a small component along it to
    keep the pivot in place.
    """

    def __init__(self, drive: SpinDrive) -> None:
        """Bind to a vehicle and its pivot."""
        self._car = drive.car
        self._max_friction = drive.max_friction
        self._X_BV = drive.X_BV

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench (about the centre of pressure) and twist that turn the object along
        ``path`` at ``speed`` [m/s].
        """
        assert isinstance(path, TwistPath)
        car = self._car
        X_BV = self._X_BV
        X_WV = X_WB.compose(X_BV)
        progress = path.nearest(X_WV, progress)
        wanted = path.pose(progress)
        along, left = X_WV.unrotate((wanted.x - X_WV.x, wanted.y - X_WV.y))
        w = speed * path.rate(progress)[2]
        most = PIVOT_SHARE * abs(car.effective_wheelbase * w)
        v = min(max(PIVOT_GAIN * along, -most), most)
        fx, fy = car.force(v, w, self._max_friction)
        ex, ey = car.axis
        d = car.lever
        return Guidance(
            progress,
            fx,
            fy,
            d * (ex * fy - ey * fx),
            car.cop,
            v * ex + w * X_BV.y,
            v * ey - w * X_BV.x,
            w,
            ORIGIN,
            math.atan2(car.effective_wheelbase * w, v) if w else 0.0,
            (along, left, remainder(wanted.yaw - X_WV.yaw, TURN)),
            False,
        )
