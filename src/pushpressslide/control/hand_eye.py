"""Where a tip is in the pictures, beside where its arm measures it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2

OTHERWISE = 3e-3
"""Standard deviation [m] by which the offset of a tip differs in another posture: its arm's
base and its tool are turned.
"""

MOST_OFFSET = 16e-3
"""Largest offset [m] that base, tool and camera give a tip: one that is farther off is
elsewhere on the object.
"""

SURE = 3.0
"""Standard deviations within which two offsets of a tip agree."""


class HandEye(NamedTuple):
    """Vector from a tip as measured to the tip as seen, in world axes, and its
    covariance.
    """

    offset: Point = (0.0, 0.0)  # [m]
    xx: float = 0.0  # [m^2]
    xy: float = 0.0
    yy: float = 0.0

    @classmethod
    def within(cls, deviation: float) -> HandEye:
        """An offset of which only the standard ``deviation`` [m] is known."""
        variance = deviation * deviation
        return cls((0.0, 0.0), variance, 0.0, variance)

    @classmethod
    def from_axes(cls, offset: Point, covariance: Array, yaw: float) -> HandEye:
        """An ``offset`` [m] with a ``covariance`` (2, 2) [m^2] in axes at ``yaw`` [rad]."""
        P = _turned(covariance, yaw)
        return cls(offset, float(P[0, 0]), float(P[0, 1]), float(P[1, 1]))

    def elsewhere(self) -> HandEye:
        """The same tip in another posture of its arm."""
        grown = OTHERWISE * OTHERWISE
        return self._replace(xx=self.xx + grown, yy=self.yy + grown)

    @property
    def plausible(self) -> bool:
        """Whether base, tool and camera may be off by this much."""
        return math.hypot(*self.offset) < MOST_OFFSET

    def agrees(self, other: HandEye) -> bool:
        """Whether two offsets may be of one tip: one that slid is elsewhere."""
        x = self.offset[0] - other.offset[0]
        y = self.offset[1] - other.offset[1]
        xx, xy, yy = self.xx + other.xx, self.xy + other.xy, self.yy + other.yy
        return yy * x * x - 2.0 * xy * x * y + xx * y * y < SURE**2 * (
            xx * yy - xy * xy
        )

    def covariance_in(self, X_WG: Pose2) -> Array:
        """Covariance (2, 2) [m^2] in the axes of G."""
        return _turned(np.array(((self.xx, self.xy), (self.xy, self.yy))), -X_WG.yaw)


def _turned(covariance: Array, yaw: float) -> Array:
    """``covariance`` (2, 2) of a vector turned by ``yaw`` [rad]."""
    c, s = math.cos(yaw), math.sin(yaw)
    R = np.array(((c, -s), (s, c)))
    P: Array = R @ covariance @ R.T
    return P
