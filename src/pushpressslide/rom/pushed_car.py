"""An object that two arms push on one face, as a car with bounded curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Pose2


@dataclass(frozen=True, slots=True)
class PushedCar:
    """A car whose axle, the point without side slip, is ahead of the CoM along the
    pushes (docs/mechanics.md, section 5).
    """

    heading: float  # [rad] of the pushes in B
    axle: float  # [m] ahead of the CoM
    # [m] of the axle from the CoP under way: rho^2 / d with equal forces, 0 without
    # friction
    effective_wheelbase: float
    rho: float  # [m]
    left: float  # [1/m] > 0 tightest curve to the left
    right: float  # [1/m] > 0 to the right

    @property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame, at the axle, in the body frame."""
        return Pose2(
            self.axle * math.cos(self.heading),
            self.axle * math.sin(self.heading),
            self.heading,
        )

    @property
    def tightest(self) -> float:
        """Largest curvature [1/m] possible to both sides."""
        return min(self.left, self.right)
