"""The border of a footprint: straight edges and arcs, counter-clockwise, in one frame."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point, Pose2, turned_left

CHORDS = 48  # of a whole circle: they are 0.2 % of its radius inside it


@dataclass(frozen=True, slots=True)
class Edge:
    """A straight side; the object is on its left."""

    start: Point  # [m]
    end: Point

    @property
    def length(self) -> float:
        """Length [m]."""
        return math.dist(self.start, self.end)

    @property
    def normal(self) -> Point:
        """Unit normal into the object."""
        length = self.length
        dx = self.end[0] - self.start[0]
        dy = self.end[1] - self.start[1]
        return turned_left((dx / length, dy / length))

    def point_at(self, place: float) -> Point:
        """Point at distance ``place`` [m] from the start."""
        share = place / self.length
        return (
            self.start[0] + share * (self.end[0] - self.start[0]),
            self.start[1] + share * (self.end[1] - self.start[1]),
        )

    def points(self, count: int) -> list[Point]:
        """Evenly spaced points, including both ends."""
        step = self.length / (count - 1)
        return [self.point_at(i * step) for i in range(count)]

    def transformed(self, X: Pose2) -> Edge:
        """The edge in the frame in which its own frame has the pose ``X``."""
        return Edge(X.apply(self.start), X.apply(self.end))


@dataclass(frozen=True, slots=True)
class Arc:
    """A convex round side, with its centre on the side of the object."""

    center: Point  # [m]
    radius: float  # [m]
    start: float  # [rad] direction of its first point from the centre
    sweep: float  # [rad] > 0, counter-clockwise

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.radius * self.sweep

    def point_at(self, angle: float) -> Point:
        """Point in the direction ``angle`` [rad] from the centre."""
        return (
            self.center[0] + self.radius * math.cos(angle),
            self.center[1] + self.radius * math.sin(angle),
        )

    def points(self, count: int) -> list[Point]:
        """Evenly spaced points, including both ends."""
        step = self.sweep / (count - 1)
        return [self.point_at(self.start + i * step) for i in range(count)]

    @property
    def whole(self) -> bool:
        """Whether the arc is a full circle."""
        return self.sweep >= 2.0 * math.pi - 1e-9

    def transformed(self, X: Pose2) -> Arc:
        """The arc in the frame in which its own frame has the pose ``X``."""
        return Arc(X.apply(self.center), self.radius, self.start + X.yaw, self.sweep)


BorderSide = Edge | Arc


@dataclass(frozen=True, slots=True)
class Border:
    """The closed line round a footprint."""

    corners: tuple[Point, ...]  # [m] of the polygon that has chords in place of arcs
    sides: tuple[BorderSide, ...]  # in order; the first begins at the first corner

    def transformed(self, X: Pose2) -> Border:
        """The border in the frame in which its own frame has the pose ``X``."""
        return Border(
            tuple(X.apply(corner) for corner in self.corners),
            tuple(side.transformed(X) for side in self.sides),
        )


def border_of(corners: tuple[Point, ...]) -> Border:
    """Border of a polygon with counter-clockwise corners [m]."""
    following = corners[1:] + corners[:1]
    return Border(corners, tuple(map(Edge, corners, following)))


def round_border(radius: float) -> Border:
    """Border of a disc about the origin, of ``radius`` [m]."""
    circle = Arc((0.0, 0.0), radius, 0.0, 2.0 * math.pi)
    step = 2.0 * math.pi / CHORDS
    return Border(tuple(circle.point_at(i * step) for i in range(CHORDS)), (circle,))
