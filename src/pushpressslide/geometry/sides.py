"""The sides of a footprint at their contacts: flat, or round.

All in B, the frame at the projected centre of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pushpressslide.core.pose import Point
from pushpressslide.kernels.plane import flat_gap

if TYPE_CHECKING:
    from pushpressslide.core.arrays import Array

ROUND_SIDES = 24  # a whole round side is offered as this many directions
ON_FACE = 1e-6  # [m] from a face's line at which a corner belongs to it


@dataclass(frozen=True, slots=True)
class SidePlace:
    """A place on a side where a tip may touch."""

    # of the footprint's edge, counter-clockwise; on a cylinder, of the direction
    index: int
    point: Point  # [m]
    normal: Point  # unit, inward
    # [m] along a flat side, to the left of the normal from B's origin: what of the side
    # a tip can touch, right end and left end; None on a round side
    ends: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class FlatSide:
    """A face of a shape with corners."""

    point: Point  # [m] in B, of the contact
    normal: Point  # unit, inward
    depth: float  # [m] of the face along the normal
    ends: tuple[float, float]  # [m] along the face, to the left of the normal

    def gap(self, tip: Point, tip_radius: float) -> tuple[float, Point]:
        """Gap [m] between a tip and the face, and the face's normal. The gap is
        infinite beyond the ends of the face.
        """
        gap = flat_gap(tip, tip_radius, self.normal, self.depth, self.ends)
        return gap, self.normal

    def foot(self, point: Point) -> Point:
        """Point [m] nearest to ``point`` on the line of the face."""
        x, y = self.point
        nx, ny = self.normal
        across = (point[1] - y) * nx - (point[0] - x) * ny
        return (x - across * ny, y + across * nx)

    def distance(self, point: Point) -> float:
        """Distance [m] of a ``point`` outside from the face, its ends included."""
        nx, ny = self.normal
        along = -ny * point[0] + nx * point[1]
        right, left = self.ends
        beyond = max(right - along, along - left, 0.0)
        ahead = self.depth - (nx * point[0] + ny * point[1])
        return math.hypot(beyond, max(ahead, 0.0))

    def normal_at(self, point: Point) -> Point:
        """Normal of the face, the same at every point."""
        return self.normal

    def coordinates(self, x: Array, y: Array) -> Array:
        """Positions (N,) [m] along the face of points in B."""
        nx, ny = self.normal
        return -ny * x + nx * y


@dataclass(frozen=True, slots=True)
class RoundSide:
    """A side that is an arc, with a normal that depends on the point."""

    center: Point  # [m] in B
    radius: float  # [m]
    normal: Point  # unit, inward, at the contact
    # [rad] direction of its first point from the centre, and how far it goes on from
    # there, counter-clockwise; None: a whole circle
    arc: tuple[float, float] | None = None

    def gap(self, tip: Point, tip_radius: float) -> tuple[float, Point]:
        """Gap [m] between a tip and the arc, and the normal there. The gap is infinite
        beyond the ends of the arc.
        """
        x = self.center[0] - tip[0]
        y = self.center[1] - tip[1]
        distance = math.hypot(x, y)
        gap = distance - self.radius - tip_radius
        if self.arc is not None and not on_arc(self.arc, (-x, -y)):
            gap = math.inf
        return gap, (x / distance, y / distance) if distance > 0.0 else self.normal

    def distance(self, point: Point) -> float:
        """Distance [m] of a ``point`` from the circle of the arc. 0 inside."""
        return max(math.dist(point, self.center) - self.radius, 0.0)

    def foot(self, point: Point) -> Point:
        """Point [m] of the arc's circle in the direction of ``point`` from its centre."""
        x = point[0] - self.center[0]
        y = point[1] - self.center[1]
        k = self.radius / math.hypot(x, y)
        return (k * x + self.center[0], k * y + self.center[1])

    def normal_at(self, point: Point) -> Point:
        """Unit vector from ``point`` to the centre."""
        x = self.center[0] - point[0]
        y = self.center[1] - point[1]
        return (x / math.hypot(x, y), y / math.hypot(x, y))

    def coordinates(self, x: Array, y: Array) -> Array:
        """Arc lengths (N,) [m] from the contact to points in B."""
        import numpy as np

        x = x - self.center[0]
        y = y - self.center[1]
        nx, ny = self.normal
        arcs: Array = self.radius * np.arctan2(-ny * x + nx * y, -(nx * x + ny * y))
        return arcs


Side = FlatSide | RoundSide
"""Side of a footprint, relative to a contact on it."""


def on_arc(arc: tuple[float, float], direction: Point) -> bool:
    """Whether a direction from the centre of an arc meets the arc.

    ``arc`` holds the angle [rad] of the arc's first point, and the angle [rad] that the
    arc covers from that point on.
    """
    start, sweep = arc
    after = math.atan2(direction[1], direction[0]) - start
    return after % (2.0 * math.pi) <= sweep
