"""What the controller knows at the end of a run: whether the object is at its goal."""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core import margins
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.record import Ending


class LastLook(NamedTuple):
    """Estimated pose of the object at the end of a run."""

    X_WG: Pose2
    spread: tuple[float, float]  # [m], [rad] standard deviations of place and yaw
    lasting_error: float = 0.0  # [m] the same, that more pictures do not lessen
    after_release: bool = True  # whether a picture shows it since the tips let go

    def ending(
        self, goal: Pose2, tolerance: Tolerance, doubt: float = margins.DOUBT
    ) -> Ending:
        """Goal reached or missed, if the errors are inside or outside the tolerance by
        ``doubt`` standard deviations. Otherwise not verified.
        """
        off = math.dist(self.X_WG.position, goal.position)
        turned = abs(wrap_angle(self.X_WG.yaw - goal.yaw))
        place, yaw = (doubt * deviation for deviation in self.spread)
        place = math.hypot(place, margins.DOUBT * self.lasting_error)
        text = f"seen {off * 1e3:.1f} mm and {math.degrees(turned):.1f} deg off"
        if off - place > tolerance.position or turned - yaw > tolerance.yaw:
            return Ending("goal_missed", text)
        if not self.after_release:
            return Ending("not_verified", f"{text} before the tips let go, not since")
        near = off + place <= tolerance.position
        if near and turned + yaw <= tolerance.yaw:
            return Ending("goal_reached")
        known = f"known to {place * 1e3:.1f} mm and {math.degrees(yaw):.1f} deg"
        return Ending("not_verified", f"{text}, {known}")

    def tells(self, tolerance: Tolerance) -> bool:
        """Whether the pose is known so well that an object in the inner half of the
        tolerance is verified.
        """
        place, yaw = (2.0 * margins.DOUBT * deviation for deviation in self.spread)
        place = math.hypot(place, 2.0 * margins.DOUBT * self.lasting_error)
        known = place <= tolerance.position and yaw <= tolerance.yaw
        return known and self.after_release
