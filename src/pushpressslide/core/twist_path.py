"""A path of constant body twists: any planar motion, including spins and sideways
sliding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.wrench import Twist
from pushpressslide.kernels.plane import carried

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TwistRate = tuple[float, float, float]
"""Body twist per metre of path: vx, vy [-], w [rad/m]."""

SHORTEST = 1e-12
"""Distance [m] below which two poses count as one: round-off."""


def integrate(pose: Pose2, rate: TwistRate, length: float) -> Pose2:
    """Pose reached from ``pose`` after ``length`` [m] at a constant body twist: the
    exponential map.
    """
    return Pose2(*carried((pose.x, pose.y, pose.yaw), rate, length))


def screw(start: Pose2, end: Pose2) -> TwistRate:
    """Constant body twist (vx, vy [m], w [rad]) that leads from ``start`` to ``end`` in
    unit time: the logarithm. The turn is below 180 degrees.
    """
    x, y = start.unrotate((end.x - start.x, end.y - start.y))
    w = wrap_angle(end.yaw - start.yaw)
    half = 0.5 * w
    k = half / math.tan(half) if abs(half) > 1e-9 else 1.0
    return (k * x + half * y, k * y - half * x, w)


def reached(pose: Pose2, twists: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses (m, 3) reached from ``pose`` after unit time at each of the body ``twists``
    (m, 3).
    """
    import numpy as np

    vx, vy, w = twists.T
    half = 0.5 * w
    # chord: ratio of its length to the arc's, and its direction
    chord = np.sinc(half / math.pi)
    heading = pose.yaw + half
    c = chord * np.cos(heading)
    s = chord * np.sin(heading)
    return np.stack(
        [pose.x + c * vx - s * vy, pose.y + s * vx + c * vy, pose.yaw + w], axis=-1
    )


def screws(
    section_starts: NDArray[np.float64], ends: NDArray[np.float64]
) -> NDArray[np.float64]:
    """``screw`` (m, n, 3) of all pairs of m starts and n ends, given as rows (x, y,
    yaw).
    """
    import numpy as np

    x0, y0, yaw0 = section_starts.T[:, :, None]
    x1, y1, yaw1 = ends.T[:, None, :]
    dx = x1 - x0
    dy = y1 - y0
    w = math.pi - np.remainder(math.pi - (yaw1 - yaw0), 2.0 * math.pi)
    x = np.cos(yaw0) * dx + np.sin(yaw0) * dy
    y = np.cos(yaw0) * dy - np.sin(yaw0) * dx
    half = 0.5 * w
    k = 1.0 / np.where(
        np.abs(half) > 1e-9, np.tan(half) / np.where(half == 0.0, 1.0, half), 1.0
    )
    return np.stack([k * x + half * y, k * y - half * x, w], axis=-1)


@dataclass(frozen=True)
class TwistPath:
    """A path of the vehicle frame V: the start pose, then sections (twist per metre,
    length [m] >= 0).

    A turn by one radian counts as a length of ``radius`` [m], so that the twist of
    every section has vx^2 + vy^2 + (radius w)^2 = 1.
    """

    start: Pose2
    sections: tuple[tuple[TwistRate, float], ...]
    radius: float

    @classmethod
    def between(cls, poses: tuple[Pose2, ...], radius: float) -> TwistPath:
        """Path through ``poses`` of V, from each to the next at a constant twist.
        Repeated poses are skipped.
        """
        pieces = []
        for a, b in pairwise(poses):
            vx, vy, w = screw(a, b)
            length = math.hypot(vx, vy, radius * w)
            if length > SHORTEST:
                pieces.append(((vx / length, vy / length, w / length), length))
        return cls(poses[0], tuple(pieces), radius)

    @cached_property
    def section_starts(self) -> tuple[tuple[float, Pose2], ...]:
        """Arc length and pose at the start of each section, and at the end of the path."""
        s = 0.0
        pose = self.start
        out = [(0.0, self.start)]
        for rate, length in self.sections:
            s = s + length
            pose = integrate(pose, rate, length)
            out.append((s, pose))
        return tuple(out)

    @property
    def length(self) -> float:
        """Total length [m]."""
        return self.section_starts[-1][0]

    @property
    def distance(self) -> float:
        """Distance [m] that the tracking point covers. Turns on the spot add nothing."""
        return sum(math.hypot(vx, vy) * length for (vx, vy, _), length in self.sections)

    @property
    def end(self) -> Pose2:
        """Last pose."""
        return self.section_starts[-1][1]

    def _section_index(self, s: float) -> int:
        for i in range(len(self.sections) - 1):
            if s < self.section_starts[i + 1][0]:
                return i
        return len(self.sections) - 1

    def pose(self, s: float) -> Pose2:
        """Pose at arc length ``s`` [m].

        Beyond either end, the path continues with the twist at that end.
        """
        if not self.sections:
            return self.start
        i = self._section_index(s)
        return integrate(
            self.section_starts[i][1],
            self.sections[i][0],
            s - self.section_starts[i][0],
        )

    def rate(self, s: float) -> TwistRate:
        """Twist per metre at arc length ``s`` [m], in V.

        It is zero for a path without sections.
        """
        return (
            self.sections[self._section_index(s)][0]
            if self.sections
            else (0.0, 0.0, 0.0)
        )

    def initial_twist(self, point: Point) -> Twist:
        """Initial twist per metre of a body whose ``point`` [m] in B follows the path."""
        return Twist(*self.rate(0.0), point)

    def nearest(self, X_WV: Pose2, s: float) -> float:
        """Arc length [m], near ``s`` and not before it, of the pose nearest to
        ``X_WV``.

        It is found by one Newton step in the metric of ``radius``. For a constant twist
        it is exact up to second order in the error.
        """
        at = self.pose(s)
        vx, vy, w = self.rate(s)
        x, y = at.unrotate((X_WV.x - at.x, X_WV.y - at.y))
        ahead = (
            vx * x
            + vy * y
            + self.radius * self.radius * w * wrap_angle(X_WV.yaw - at.yaw)
        )
        return s + max(0.0, ahead)

    def led_in(self, length: float) -> TwistPath:
        """The path extended backwards from its start by ``length`` [m], with its first
        twist.
        """
        rate = self.rate(0.0)
        return TwistPath(
            integrate(self.start, rate, -length),
            ((rate, length), *self.sections),
            self.radius,
        )
