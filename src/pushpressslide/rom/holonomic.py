"""An object whose every twist, or a cone of twists, can be driven: a holonomic base at
the tracking point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point, Pose2


@dataclass(frozen=True, slots=True)
class Holonomic:
    """The reduced model of two presses, or of two pushes within their cone
    (docs/mechanics.md, 6, 7, 9).

    Vehicle frame V: origin at the tracking point, axes parallel to B. Raises ValueError
    for bounds <= 0.
    """

    # [m] tracking point in B: the CoM, or the CoP when pivoting
    point: Point = (0.0, 0.0)
    max_speed: float = math.inf  # [m/s] > 0
    max_turn_rate: float = math.inf  # [rad/s] > 0

    def __post_init__(self) -> None:
        if not (self.max_speed > 0.0 and self.max_turn_rate > 0.0):
            raise ValueError(
                f"max_speed {self.max_speed} m/s, max_turn_rate {self.max_turn_rate} "
                "rad/s; must be > 0"
            )

    @property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame in the body frame."""
        return Pose2(self.point[0], self.point[1], 0.0)

    @property
    def minimum_turning_radius(self) -> float:
        """Smallest turning radius [m]: it turns on the spot."""
        return 0.0

    @property
    def input_bounds(
        self,
    ) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
        """Bounds of the inputs (vx, vy [m/s], w [rad/s]) one by one.

        The speed is bounded as a vector too.
        """
        v = self.max_speed
        w = self.max_turn_rate
        return (-v, v), (-v, v), (-w, w)

    def xdot(
        self, x: tuple[float, float, float], u: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        """Return the rate of the pose (x, y, yaw) of V in the world for the twist u =
        (vx, vy, w) in V.
        """
        c = math.cos(x[2])
        s = math.sin(x[2])
        return (c * u[0] - s * u[1], s * u[0] + c * u[1], u[2])

    def saturated(self, u: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the twist scaled as a whole, so that its direction stays, until it is
        within the bounds.
        """
        excess = max(
            1.0, math.hypot(u[0], u[1]) / self.max_speed, abs(u[2]) / self.max_turn_rate
        )
        return (u[0] / excess, u[1] / excess, u[2] / excess)
