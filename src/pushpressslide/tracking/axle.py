"""Follows a path of arcs with the axle of an object that is pushed like a car
(docs/mechanics.md, sections 3 and 5): look-ahead alignment, and the wrench on the limit
surface that turns so.
"""

from __future__ import annotations

from math import atan, cos, remainder, sin, sqrt

from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import TURN, ArcPath
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment


class AxleTracker:
    """The law of one car; its wrench is about the CoM."""

    def __init__(
        self,
        law: LookAheadAlignment,
        heading: float,
        axle: float,
        lead: float,
        rho: float,
        level: float,
    ) -> None:
        """Bind the law to a car heading along ``heading`` [rad] in B, its axle ``axle``
        [m] ahead of the CoM.

        ``lead`` [m] is the axle's distance from the CoP under way: across the heading
        acts lead times the curvature of the force along it, 0 for a car that is turned
        without friction. ``level``: mu_s N [N].
        """
        self._curvature = law.curvature
        self._figures = (
            axle,
            lead,
            rho * rho,
            heading,
            cos(heading),
            sin(heading),
            level,
        )

    def step(
        self, path: MotionPath, X_WB: Pose2, progress: float, speed: float, grip: float
    ) -> Guidance:
        """Return wrench and twist that follow ``path``, an ArcPath, at ``speed`` [m/s].

        ``grip`` narrows the steering of a car that steers by friction.
        """
        assert isinstance(path, ArcPath)
        axle, lead, rho_squared, heading, ex, ey, level = self._figures
        yaw = X_WB.yaw + heading
        x = X_WB.x + axle * cos(yaw)
        y = X_WB.y + axle * sin(yaw)
        progress, left, direction, curvature = path.nearest(x, y, progress)
        turned = remainder(direction - yaw, TURN)
        share = grip if lead > 0.0 else 1.0
        turn, saturated = self._curvature((x, y, yaw), left, turned, curvature, share)
        across = -lead * turn  # force to the left per force along
        along = level / sqrt(1.0 + across * across + rho_squared * turn * turn)
        w = speed * turn
        return Guidance(
            progress,
            Wrench(
                along * (ex - across * ey),
                along * (ey + across * ex),
                along * rho_squared * turn,
            ),
            Twist(speed * ex + w * axle * ey, speed * ey - w * axle * ex, w),
            atan(across),
            (0.0, left, turned),
            saturated,
        )
