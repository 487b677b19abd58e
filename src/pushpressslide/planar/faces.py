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
from pushpressslide.core.shapes import Side
from pushpressslide.core.task import ObjectModel
from pushpressslide.planar.support import Support

PASSED = 1e-3  # [m] behind a face: a tip there came round its end, not through it


class Face(Protocol):
    """What a tip may touch."""

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return the gap [m] of a tip whose centre is at ``tip`` and ``height`` [m],
        and the unit inward normal.
        """
        ...


@dataclass(frozen=True, slots=True)
class SideFace:
    """A side of the object, up to its top."""

    side: Side
    top: float  # [m]
    tip_radius: float  # [m]

    def gap(self, tip: Point, height: float) -> tuple[float, Point]:
        """Return gap and normal."""
        gap, normal = self.side.gap(tip, self.tip_radius)
        beside = height <= self.top and gap > -PASSED
        return gap if beside else math.inf, normal


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
    if contact.kind == "top":
        return Top(support, shape.height, tip_radius)
    side = shape.side(contact.point, contact.normal, body.center_of_mass)
    return SideFace(side, shape.height, tip_radius)
