"""A path of circular arcs and straight lines, and a trapezoidal speed along it; both closed form, in plain
floats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from pushpressslide.core.pose import Point, Pose2


def advance(pose: Pose2, curvature: float, length: float) -> Pose2:
    """Return the pose reached from ``pose`` after ``length`` [m] along its heading at constant ``curvature``
    [1/m].
    """
    half = 0.5 * curvature * length
    chord = length * (math.sin(half) / half if abs(half) > 1e-9 else 1.0 - half * half / 6.0)
    direction = pose.yaw + half
    return Pose2(
        pose.x + chord * math.cos(direction),
        pose.y + chord * math.sin(direction),
        pose.yaw + curvature * length,
    )


@dataclass(frozen=True)
class ArcPath:
    """A forward path of a car-like point: the start pose, then (curvature [1/m], length [m] >= 0) pieces.

    Poses are those of the vehicle frame V in the world: origin at the tracking point, x along the heading.
    The yaw along the path is continuous, not wrapped.
    """

    start: Pose2
    pieces: tuple[tuple[float, float], ...]

    @cached_property
    def starts(self) -> tuple[tuple[float, Pose2], ...]:
        """Arc length and pose at the start of each piece, and at the end."""
        s, pose, out = 0.0, self.start, [(0.0, self.start)]
        for curvature, length in self.pieces:
            pose = advance(pose, curvature, length)
            s += length
            out.append((s, pose))
        return tuple(out)

    @cached_property
    def length(self) -> float:
        """Total length [m]."""
        return sum(length for _, length in self.pieces)

    @property
    def end(self) -> Pose2:
        """Last pose."""
        return self.starts[-1][1]

    def _piece(self, s: float) -> int:
        for i in range(len(self.pieces) - 1):
            if s < self.starts[i + 1][0]:
                return i
        return len(self.pieces) - 1

    def pose(self, s: float) -> Pose2:
        """Return the pose at arc length ``s``; outside [0, length] the first or last piece's tangent goes on
        straight.
        """
        if s < 0.0 or not self.pieces:
            return advance(self.start, 0.0, s)
        if s > self.length:
            return advance(self.end, 0.0, s - self.length)
        i = self._piece(s)
        return advance(self.starts[i][1], self.pieces[i][0], s - self.starts[i][0])

    def curvature(self, s: float) -> float:
        """Return the signed curvature [1/m] at arc length ``s``; zero outside the path."""
        if s < 0.0 or s > self.length or not self.pieces:
            return 0.0
        return self.pieces[self._piece(s)][0]

    def project(self, point: Point, s_guess: float, window: float = 0.05) -> float:
        """Return the arc length, within ``window`` [m] of ``s_guess``, of the path's nearest point to
        ``point``.

        Newton steps on the tangential error, each bounded by the window; the result may run past the end.
        """
        s = s_guess
        for _ in range(4):
            pose = self.pose(s)
            dx, dy = point[0] - pose.x, point[1] - pose.y
            c, si = math.cos(pose.yaw), math.sin(pose.yaw)
            along, left = c * dx + si * dy, -si * dx + c * dy
            scale = 1.0 - self.curvature(s) * left
            step = along / max(scale, 0.3)
            s = min(max(s + step, s_guess - window), s_guess + window)
            if abs(step) < 1e-9:
                break
        return s


@dataclass(frozen=True, slots=True)
class SpeedProfile:
    """Trapezoidal motion from rest to rest over ``length`` [m]: cruise ``speed`` [m/s], ramps of
    ``acceleration`` [m/s^2].
    """

    length: float
    speed: float
    acceleration: float

    @property
    def cruise(self) -> float:
        """Highest speed that is reached [m/s]."""
        return min(self.speed, math.sqrt(max(self.length, 0.0) * self.acceleration))

    @property
    def duration(self) -> float:
        """Time from rest to rest [s]."""
        if self.length <= 0.0:
            return 0.0
        v = self.cruise
        return self.length / v + v / self.acceleration

    def at(self, t: float) -> tuple[float, float]:
        """Return arc length [m] and speed [m/s] at time ``t`` [s], held at the ends."""
        if t <= 0.0 or self.length <= 0.0:
            return 0.0, 0.0
        total, v, a = self.duration, self.cruise, self.acceleration
        if t >= total:
            return self.length, 0.0
        ramp = v / a
        if t < ramp:
            return 0.5 * a * t * t, a * t
        if t > total - ramp:
            left = total - t
            return self.length - 0.5 * a * left * left, a * left
        return v * (t - 0.5 * ramp), v

    def speed_at(self, s: float) -> float:
        """Return the profile's speed [m/s] at arc length ``s``."""
        s = min(max(s, 0.0), self.length)
        return min(self.cruise, math.sqrt(2.0 * self.acceleration * min(s, self.length - s)))
