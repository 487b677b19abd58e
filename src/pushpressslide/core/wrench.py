"""Planar wrenches and twists, each with its reference point."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.pose import Point, cross


class Wrench(NamedTuple):
    """Force (fx, fy) [N] and moment tau [N m] about the point ``about``, exerted by the
    robots ON the object.

    Everything is in one planar frame: the body frame B, unless stated otherwise
    (docs/mechanics.md, section 0).
    """

    fx: float
    fy: float
    tau: float
    about: Point = (0.0, 0.0)

    def moved_to(self, point: Point) -> Wrench:
        """The same wrench with its moment about ``point``: tau_p = tau_o - (p - o) x F."""
        arm = (point[0] - self.about[0], point[1] - self.about[1])
        return Wrench(
            self.fx, self.fy, self.tau - cross(arm, (self.fx, self.fy)), point
        )


class Twist(NamedTuple):
    """Velocity (vx, vy) [m/s] of the body point ``point`` and angular velocity w [rad/s],
    in one planar frame.
    """

    vx: float
    vy: float
    w: float
    point: Point = (0.0, 0.0)

    def moved_to(self, point: Point) -> Twist:
        """The same motion as the velocity of another body point: v_p = v_o + w J (p -
        o).
        """
        rx = point[0] - self.point[0]
        ry = point[1] - self.point[1]
        return Twist(self.vx - self.w * ry, self.vy + self.w * rx, self.w, point)
