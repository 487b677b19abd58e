"""How an object turns that a single tip moves, by pictures alone.

A tip that sticks to an object moves by d along the object's axes, and turns it by
a d_y - b d_x (docs/mechanics.md, section 4.3). So the yaw in pictures is linear in the
tip's travel along these axes, and least squares give the turn arm (a, b) without a prior.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from pushpressslide.core.pose import Point, Pose2, wrap_angle


def along_object(step: Point, yaw: float, turn: float) -> Point:
    """A ``step`` [m] along the axes of an object that turns from ``yaw`` [rad] by
    ``turn`` [rad] meanwhile.
    """
    return Pose2(0.0, 0.0, yaw + 0.5 * turn).unrotate(step)


class Reach(NamedTuple):
    """Identified distance of a tip's centre from the virtual axle."""

    value: float  # [m]
    deviation: float  # [m] standard deviation
    direction: Point  # unit vector in G, from the axle


class Sight(NamedTuple):
    """A picture of an object, with the place of the tip that moves it."""

    place: Point  # [m] of the tip's centre
    yaw: float  # [rad] of the object as estimated
    picture_yaw: float  # [rad] of the object in the picture


class TurnState(NamedTuple):
    """Sums over pictures of (x, y, w): the tip's travel along the object's axes, and
    the yaw.
    """

    # of products, less their means in each uninterrupted drive
    xx: float = 0.0
    xy: float = 0.0
    yy: float = 0.0
    xw: float = 0.0
    yw: float = 0.0
    ww: float = 0.0
    freedom: int = 0  # number of pictures less that of drives
    last: Sight | None = None  # of this drive; None: it has yet to begin
    pictures: int = 0  # in this drive
    travel: Point = (0.0, 0.0)  # [m] of the tip in this drive
    means: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in this drive

    def paused(self) -> TurnState:
        """State while the tip does not move the object."""
        return self if self.last is None else self._replace(last=None)

    def including(self, sight: Sight) -> TurnState:
        """State after another ``sight``."""
        last = self.last
        if last is None:
            means = (0.0, 0.0, sight.picture_yaw)
            return self._replace(last=sight, pictures=1, travel=(0.0, 0.0), means=means)
        turned = last.picture_yaw + wrap_angle(sight.picture_yaw - last.picture_yaw)
        moved = (sight.place[0] - last.place[0], sight.place[1] - last.place[1])
        dx, dy = along_object(moved, last.yaw, wrap_angle(sight.yaw - last.yaw))
        travel = (self.travel[0] + dx, self.travel[1] + dy)
        return self._with(travel, sight._replace(picture_yaw=turned))

    def _with(self, travel: Point, sight: Sight) -> TurnState:
        """State after a ``sight`` at the end of a ``travel`` [m]."""
        number = self.pictures + 1
        mean_x, mean_y, mean_w = self.means
        x = travel[0] - mean_x
        y = travel[1] - mean_y
        w = sight.picture_yaw - mean_w
        share = 1.0 - 1.0 / number
        return TurnState(
            self.xx + share * x * x,
            self.xy + share * x * y,
            self.yy + share * y * y,
            self.xw + share * x * w,
            self.yw + share * y * w,
            self.ww + share * w * w,
            self.freedom + 1,
            sight,
            number,
            travel,
            (mean_x + x / number, mean_y + y / number, mean_w + w / number),
        )

    def reach(self) -> Reach | None:
        """Distance from the tip to the axle. None if the sums do not determine it."""
        size = self.xx * self.yy - self.xy * self.xy
        freedom = self.freedom - 2
        if freedom < 1 or size <= 1e-9 * self.xx * self.yy:
            return None
        a = (self.xx * self.yw - self.xy * self.xw) / size
        b = (self.xy * self.yw - self.yy * self.xw) / size
        arm = math.hypot(a, b)
        if arm == 0.0:
            return None
        left = max(self.ww - a * self.yw + b * self.xw, 0.0) / freedom
        # along the arm, of the inverse of the sums
        ex = a / arm
        ey = b / arm
        variance = left / size
        variance *= ex * ex * self.xx + 2.0 * ex * ey * self.xy + ey * ey * self.yy
        return Reach(1.0 / arm, math.sqrt(variance) / (arm * arm), (ex, ey))
