"""A path of circular arcs and lines, with a trapezoidal speed profile, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from pushpressslide.core.pose import Pose2
from pushpressslide.kernels.arc_path import TURN as TURN
from pushpressslide.kernels.arc_path import eased, nearest, trapezoid


def advance(pose: Pose2, curvature: float, length: float) -> Pose2:
    """Pose reached from ``pose`` after ``length`` [m] along its heading at constant
    ``curvature`` [1/m].
    """
    half = 0.5 * curvature * length
    chord = length * (
        math.sin(half) / half if abs(half) > 1e-9 else 1.0 - half * half / 6.0
    )
    direction = pose.yaw + half
    return Pose2(
        pose.x + chord * math.cos(direction),
        pose.y + chord * math.sin(direction),
        pose.yaw + curvature * length,
    )


@dataclass(frozen=True)
class ArcPath:
    """A forward path of a car-like point: the start pose, then sections (curvature
    [1/m], length [m] >= 0).

    Poses are those of the vehicle frame V in the world: origin at the tracking point, x
    along the heading. The yaw along the path is continuous, not wrapped.
    """

    start: Pose2
    sections: tuple[tuple[float, float], ...]

    @cached_property
    def section_starts(self) -> tuple[tuple[float, Pose2], ...]:
        """Arc length and pose at the start of each section, and at the end of the path."""
        s = 0.0
        pose = self.start
        out = [(0.0, self.start)]
        for curvature, length in self.sections:
            pose = advance(pose, curvature, length)
            s += length
            out.append((s, pose))
        return tuple(out)

    @cached_property
    def length(self) -> float:
        """Total length [m]."""
        return sum(length for _, length in self.sections)

    @property
    def distance(self) -> float:
        """Distance [m] that the tracking point covers."""
        return self.length

    @property
    def turning(self) -> float:
        """Total turn [rad], positive to the left. Full turns count."""
        return sum(curvature * length for curvature, length in self.sections)

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

        Outside [0, length] the path continues straight.
        """
        if s < 0.0 or not self.sections:
            return advance(self.start, 0.0, s)
        if s > self.length:
            return advance(self.end, 0.0, s - self.length)
        i = self._section_index(s)
        return advance(
            self.section_starts[i][1],
            self.sections[i][0],
            s - self.section_starts[i][0],
        )

    def rest(self, s: float) -> ArcPath:
        """Rest of the path after arc length ``s`` in [0, length]."""
        i = self._section_index(s)
        curvature = self.sections[i][0]
        end = self.section_starts[i + 1][0]
        return ArcPath(self.pose(s), ((curvature, end - s), *self.sections[i + 1 :]))

    def curvature(self, s: float) -> float:
        """Signed curvature [1/m] at arc length ``s``. Zero outside the path."""
        if s < 0.0 or s > self.length or not self.sections:
            return 0.0
        return self.sections[self._section_index(s)][0]

    @cached_property
    def _bends(self) -> tuple[tuple[float, float, float], ...]:
        """Jumps of the curvature: arc length [m], size [1/m], and distance [m] from the
        nearer end of the path.
        """
        out = []
        for i in range(1, len(self.sections)):
            s = self.section_starts[i][0]
            change = self.sections[i][0] - self.sections[i - 1][0]
            out.append((s, change, min(s, self.length - s)))
        return tuple(out)

    def eased(self, s: float, half: float) -> tuple[float, float]:
        """Corrections of heading [rad] and curvature [1/m] at arc length ``s`` [m] that
        smooth the path.

        They average it over ``half`` [m] in either direction, so that the curvature has
        no jumps. The path itself would move by at most ``half``^2 / 12 times a jump of
        curvature.
        """
        return eased(s, half, self._bends)

    @cached_property
    def _projections(self) -> tuple[tuple[float, ...], ...]:
        """One ``kernels.arc_path.Piece`` for each section, and one for the straight
        line beyond the end.
        """
        rows = []
        pieces = (*self.sections, (0.0, math.inf))
        for (curvature, length), (s, pose) in zip(
            pieces, self.section_starts, strict=True
        ):
            x = pose.x
            y = pose.y
            yaw = pose.yaw
            a = math.cos(yaw)
            b = math.sin(yaw)
            c = s - a * x - b * y
            d = a * y - b * x
            if curvature:
                c = 1.0 / curvature
                d = math.copysign(1.0, curvature)
                yaw, a, b = yaw - curvature * s, x - c * b, y + c * a
            rows.append((s, s + length, curvature, yaw, a, b, c, d))
        return tuple(rows)

    @property
    def rows(
        self,
    ) -> tuple[tuple[tuple[float, ...], ...], tuple[tuple[float, ...], ...]]:
        """Rows for ``kernels.arc_path.nearest``: the sections of the path, and its
        jumps of curvature.
        """
        return self._projections, self._bends

    def nearest(
        self, x: float, y: float, s: float, half: float = 0.0
    ) -> tuple[float, float, float, float]:
        """Point of the path nearest to (x, y) [m], searched from the section at arc
        length ``s`` onwards.

        Returns the arc length [m] of that point, the offset [m] of (x, y) to the left
        of the path, and the heading [rad] and curvature [1/m] at that point, both
        ``eased`` over ``half`` [m]. The solution is in closed form. Beyond its end the
        path continues straight.
        """
        return nearest(x, y, s, half, self._projections, self._bends)


@dataclass(frozen=True)
class SpeedProfile:
    """Trapezoidal motion from rest to rest over ``length`` [m]: cruise ``speed`` [m/s],
    ramps of ``acceleration`` [m/s^2].
    """

    length: float
    speed: float
    acceleration: float

    @cached_property
    def cruise(self) -> float:
        """Highest speed reached [m/s]."""
        return min(self.speed, math.sqrt(max(self.length, 0.0) * self.acceleration))

    @cached_property
    def duration(self) -> float:
        """Time from rest to rest [s]."""
        if self.length <= 0.0:
            return 0.0
        v = self.cruise
        return self.length / v + v / self.acceleration

    def state_at(self, t: float) -> tuple[float, float]:
        """Arc length [m] and speed [m/s] at time ``t`` [s], clamped at the ends."""
        return trapezoid(t, self.length, self.cruise, self.acceleration)
