"""Look-ahead alignment of a unicycle with its path (docs/mechanics.md, section 4.2).

A virtual target slides along the path, ahead of the vehicle by the look-ahead. The
curvature is proportional to the target's lateral coordinate in the vehicle frame. With
the gain 4 / look_ahead^2 the lateral error decays critically, as (1 + 2 D / look_ahead)
exp(-2 D / look_ahead) over a distance D. Errors are REFERENCE MINUS ACTUAL.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

from pushpressslide.core.pose import Pose2
from pushpressslide.kernels.tracking import clipped, look_ahead_curvature


@dataclass(frozen=True, slots=True)
class LookAheadAlignment:
    """The look-ahead law.

    With ``fixed`` it follows the paper literally: the target stays ``look_ahead``
    beyond the goal.
    """

    look_ahead: float  # [m] > 0
    limit: float  # [1/m] largest commanded curvature
    fixed: Pose2 | None = None  # the goal pose of the vehicle, for the paper's target

    def curvature(
        self,
        X_WV: tuple[float, float, float],
        left_error: float,
        heading_error: float,
        path_curvature: float,
        steering_scale: float = 1.0,
    ) -> tuple[float, bool]:
        """Curvature [1/m] to drive, and whether it was clipped.

        ``X_WV`` is the vehicle's pose. ``left_error`` [m] and ``heading_error`` [rad]
        are reference minus actual, and ``path_curvature`` [1/m] is the path's curvature
        at the nearest point. ``steering_scale`` narrows the bounds.
        """
        ell = self.look_ahead
        limit = steering_scale * self.limit
        if self.fixed is None:
            return look_ahead_curvature(
                left_error, heading_error, path_curvature, ell, limit
            )
        goal = self.fixed
        x, y, yaw = X_WV
        dx = goal.x + ell * cos(goal.yaw) - x
        dy = goal.y + ell * sin(goal.yaw) - y
        wanted = 4.0 * (cos(yaw) * dy - sin(yaw) * dx) / (ell * ell)
        return clipped(wanted, limit)
