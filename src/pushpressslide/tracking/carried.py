"""Holonomic law for an object that may be on a wall: the arms provide the sliding
wrench minus the weight in the plane (docs/mechanics.md, section 7).
"""

from __future__ import annotations

from dataclasses import replace

from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import MotionPath
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.wrench import Wrench
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.tracking.holonomic import HolonomicTracker


class CarriedTracker:
    """Holonomic law with an in-plane weight.

    The weight acts at the CoM. Tips that carry it at another height shift the CoP by
    ``lever`` times the weight, against its direction. Without an in-plane weight the
    law equals the holonomic law.
    """

    def __init__(
        self,
        X_BV: Pose2,
        surface: DraggedSurface,
        weight: Point,
        lever: float,
        decay: float,
    ) -> None:
        """Bind the law.

        ``weight`` [N] is the component in the plane. ``lever`` [m/N] is the height of
        the tips above the CoM divided by the load.
        """
        self._X_BV = X_BV
        self._surface = surface
        self._decay = decay
        self._weight = weight
        self._lever = lever
        self._level = HolonomicTracker(X_BV, surface, decay=decay)

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Wrench of the arms, about the surface's centre, and twist that follow
        ``path``, a TwistPath, at ``speed`` [m/s] in its own metric.
        """
        if not any(self._weight):
            return self._level.step(path, X_WB, progress, speed, steering_scale)
        wx, wy = X_WB.unrotate(self._weight)
        x, y = self._surface.center
        lifted = replace(
            self._surface, center=(x - self._lever * wx, y - self._lever * wy)
        )
        law = HolonomicTracker(self._X_BV, lifted, decay=self._decay)
        guidance = law.step(path, X_WB, progress, speed, steering_scale)
        slid = guidance.wrench.moved_to((x, y))
        held = Wrench(wx, wy, 0.0).moved_to((x, y))
        return guidance._replace(
            fx=slid.fx - held.fx,
            fy=slid.fy - held.fy,
            tau=slid.tau - held.tau,
            about=(x, y),
        )
