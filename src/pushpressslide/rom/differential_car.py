"""An object pushed from behind by two normal forces moves like a differential car that
only goes forward.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point, Pose2


@dataclass(frozen=True, slots=True)
class DifferentialCar:
    """The reduced model of two parallel pushes by normal forces (docs/mechanics.md,
    section 5, mode 2).

    The vehicle frame V has its origin at the centre of pressure and its x axis along
    the pushes. The contacts cannot pull, so the curvature lies in [-left_offset/rho^2,
    right_offset/rho^2]. The car cannot turn on the spot or reverse. Raises ValueError
    for offsets <= 0.
    """

    cop: Point  # [m] in B
    heading: float  # [rad] of the pushing direction in B
    left_offset: float  # [m] > 0 of the left line of force from the centre of pressure
    right_offset: float  # [m] > 0 of the right one
    rho: float  # [m] > 0

    def __post_init__(self) -> None:
        if not (self.left_offset > 0.0 and self.right_offset > 0.0 and self.rho > 0.0):
            raise ValueError(
                f"offsets {self.left_offset}, {self.right_offset} and rho {self.rho} "
                "m; must be > 0"
            )

    @property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame in the body frame."""
        return Pose2(self.cop[0], self.cop[1], self.heading)

    @property
    def curvature_limits(self) -> tuple[float, float]:
        """Smallest and largest curvature [1/m] of the path of the centre of pressure."""
        square = self.rho * self.rho
        return -self.left_offset / square, self.right_offset / square

    @property
    def minimum_turning_radius(self) -> float:
        """Smallest turning radius [m], to the side with the tighter turns."""
        return self.rho * self.rho / max(self.left_offset, self.right_offset)

    def normals(self, curvature: float, max_force: float) -> tuple[float, float]:
        """Left and right normal force [N], on the limit surface.

        Outside the curvature limits one of them is negative. F = mu_s N / sqrt(1 + (rho
        kappa)^2) and tau = rho^2 kappa F; ``max_force`` [N] is mu_s N.
        """
        force = max_force / math.hypot(1.0, self.rho * curvature)
        torque = self.rho * self.rho * curvature * force
        width = self.left_offset + self.right_offset
        return (self.right_offset * force - torque) / width, (
            self.left_offset * force + torque
        ) / width
