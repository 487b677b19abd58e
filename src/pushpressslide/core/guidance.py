"""The output of a tracking law at one tick."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist, Wrench


class Guidance(NamedTuple):
    """Wanted wrench and twist, and the nearest point of the path.

    Its fields are plain numbers, since nested objects take longer to construct than
    their contents.
    """

    progress: float  # [m] arc length of the path's nearest point
    fx: float  # [N] the wrench, in B
    fy: float  # [N]
    tau: float  # [N m] about the point ``about``
    about: Point  # [m] the CoM for pushes, the centre of pressure for presses
    vx: float  # [m/s] the twist, in B: of the body point ``of``
    vy: float  # [m/s]
    w: float  # [rad/s]
    point: Point  # [m]
    steering: float  # [rad] force angle from the heading axis
    # along [m], left [m], heading [rad]; reference minus actual
    error: tuple[float, float, float]
    saturated: bool

    @property
    def wrench(self) -> Wrench:
        """Wanted wrench, in B."""
        return Wrench(self.fx, self.fy, self.tau, self.about)

    def turning_at_most(self, rate: float) -> Guidance:
        """Guidance whose twist turns by at most ``rate`` [rad/s], along the same path:
        the object is led more slowly.
        """
        if abs(self.w) <= rate:
            return self
        share = rate / abs(self.w)
        vx, vy, w = share * self.vx, share * self.vy, share * self.w
        return self._replace(vx=vx, vy=vy, w=w)

    @property
    def twist(self) -> Twist:
        """Wanted twist, in B."""
        return Twist(self.vx, self.vy, self.w, self.point)
