"""Position of a tip relative to the face that it is meant to touch: the gap between
them, and the normal of the face.

Positions are in the body frame B, heights above the support. A tip beyond the ends of
the face, or behind it, has an infinite gap and touches nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.task import ObjectModel
from pushpressslide.geometry.shapes import Shape
from pushpressslide.geometry.sides import Side
from pushpressslide.kernels.tip_step import PASSED

NEAR = 2e-3  # [m] a wall that is farther off is not met within a tick
NO_WALL = (math.inf, (1.0, 0.0))  # far off


class Face(Protocol):
    """A face that a tip may touch."""

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Gap [m] of a tip with its centre at ``tip`` and ``height`` [m], and the unit
        inward normal.
        """
        ...

    def wall(self, tip: Point, height: float) -> tuple[float, Point]:
        """Gap [m] to the nearest wall next to the face, and the normal of this wall.
        The gap is infinite without a wall.
        """
        ...


@dataclass(frozen=True, slots=True)
class SideFace:
    """A side of the object, up to the top, with the other walls of a notch."""

    side: Side
    walls: tuple[Side, ...]
    top: float  # [m]
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Gap [m] and unit inward normal."""
        return self._gap(self.side, tip, height)

    def wall(self, tip: Point, height: float) -> tuple[float, Point]:
        """Gap [m] to the nearest wall that a tip may meet besides the face, and the
        normal of this wall. The gap is infinite without a wall nearby.
        """
        if not self.walls:
            return NO_WALL
        found = [self._gap(wall, tip, height) for wall in self.walls]
        return min((wall for wall in found if wall[0] < NEAR), default=NO_WALL)

    def _gap(self, side: Side, tip: Point, height: float) -> tuple[float, Point]:
        gap, normal = side.gap(tip, self.tip_radius)
        above = max(0.0, height - self.top)
        if above >= self.tip_radius:
            return math.inf, normal
        # a tip whose centre is above the upper edge touches it later
        square = self.tip_radius * self.tip_radius - above * above
        gap += self.tip_radius - math.sqrt(square)
        return math.inf if gap <= -PASSED else gap, normal


@dataclass(frozen=True, slots=True)
class Top:
    """The top face."""

    shape: Shape
    origin: Point  # [m] in the shape's frame, of B
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Gap [m], and a normal without components in the plane."""
        gap = height - self.tip_radius - self.shape.top_height
        above = gap > -PASSED and self.shape.holds(tip, 0.0, self.origin)
        return gap if above else math.inf, (0.0, 0.0)

    def wall(self, tip: Point, height: float) -> tuple[float, Point]:
        """No wall: an infinite gap."""
        return NO_WALL


def face_of(body: ObjectModel, contact: Contact, tip_radius: float) -> Face:
    """Face of ``body`` that carries a ``contact``, for a tip of ``tip_radius`` [m]."""
    if contact.kind == "top":
        return Top(body.shape, body.center_of_mass, tip_radius)
    shape = body.shape.section(contact.height)
    contacted = (contact.point, contact.normal, body.center_of_mass)
    side = shape.side(*contacted)
    return SideFace(side, shape.walls(*contacted), shape.height, tip_radius)
