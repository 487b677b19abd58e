"""Where a tip is before the face that it is to touch: the gap between them, and the
face's normal there.

Places in the body frame B, heights above the support. A tip beside the face, or behind
it, has an infinite gap: it touches nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.task import Cylinder, ObjectModel
from pushpressslide.planar.support import Support

PASSED = 1e-3  # [m] behind a face: a tip there came round its end, not through it
ON_FACE = 1e-6  # [m] from a face's line at which a corner belongs to it


class Face(Protocol):
    """What a tip may touch."""

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return the gap [m] of a tip whose centre is at ``tip`` and ``height`` [m],
        and the unit inward normal.
        """
        ...


@dataclass(frozen=True, slots=True)
class FlatSide:
    """A side face of a box or prism."""

    normal: Point  # inward
    depth: float  # [m] of the face along the normal
    ends: tuple[float, float]  # [m] along the face, to the left of the normal
    top: float  # [m]
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return gap and normal."""
        nx, ny = self.normal
        gap = self.depth - self.tip_radius - (nx * tip[0] + ny * tip[1])
        before = (
            self.ends[0] <= nx * tip[1] - ny * tip[0] <= self.ends[1]
            and height <= self.top
        )
        return gap if before and gap > -PASSED else math.inf, self.normal


@dataclass(frozen=True, slots=True)
class RoundSide:
    """The side of a cylinder: its normal follows the tip."""

    center: Point  # [m]
    radius: float  # [m]
    top: float  # [m]
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return gap and normal."""
        x = self.center[0] - tip[0]
        y = self.center[1] - tip[1]
        distance = math.hypot(x, y)
        gap = distance - self.radius - self.tip_radius
        if gap < -PASSED or height > self.top:
            return math.inf, (1.0, 0.0)
        return gap, (x / distance, y / distance)


@dataclass(frozen=True, slots=True)
class Top:
    """The top face."""

    support: Support
    height: float  # [m]
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return gap and normal, which has no part in the plane."""
        gap = height - self.tip_radius - self.height
        above = gap > -PASSED and self.support.outwards(tip) <= 1.0
        return gap if above else math.inf, (0.0, 0.0)


def face_of(
    body: ObjectModel, support: Support, contact: Contact, tip_radius: float
) -> Face:
    """Return the face of ``body`` on which a ``contact`` is, for a tip of
    ``tip_radius`` [m].
    """
    shape = body.shape
    com = body.center_of_mass
    if contact.kind == "top":
        return Top(support, shape.height, tip_radius)
    if isinstance(shape, Cylinder):
        return RoundSide((-com[0], -com[1]), shape.radius, shape.height, tip_radius)
    nx, ny = contact.normal
    corners = [(x - com[0], y - com[1]) for x, y in shape.footprint]
    depth = min(nx * x + ny * y for x, y in corners)
    along = [nx * y - ny * x for x, y in corners if nx * x + ny * y < depth + ON_FACE]
    return FlatSide(
        contact.normal, depth, (min(along), max(along)), shape.height, tip_radius
    )
