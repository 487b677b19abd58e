"""Solid slabs behind a support other than the table: around its opening, and at the
opening's back.
"""

from __future__ import annotations

from typing import NamedTuple

from pydrake.math import RigidTransform

from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Support
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.sim.convert import rigid_transform

NOWHERE = (0.0, 0.0, 0.0, 0.0)  # edges of an opening that there is not


class Slab(NamedTuple):
    """A box along the axes of a support's frame."""

    x: tuple[float, float]  # [m] from, to
    y: tuple[float, float]
    height: tuple[float, float]

    @property
    def size(self) -> tuple[float, float, float]:
        """Edge lengths [m]."""
        spans = (self.x, self.y, self.height)
        width, length, thickness = (b - a for a, b in spans)
        return (width, length, thickness)

    def pose(self, frame: SupportFrame) -> RigidTransform:
        """Pose of the slab's centre in the world."""
        x, y, z = (0.5 * (a + b) for a, b in (self.x, self.y, self.height))
        return rigid_transform(Pose2(x, y), z, frame)


def slabs(
    support: Support, reach: float, low: float, thickness: float, level: float
) -> list[Slab]:
    """Slabs of a support about its frame's origin, without those of zero volume.

    They extend ``reach`` [m] to the sides and up, and down to ``low`` [m] along y. In
    height they extend from ``level`` [m] to ``thickness`` [m] behind the opening's
    back.
    """
    opening = support.opening
    left, right, bottom, top = NOWHERE if opening is None else opening.edges
    depth = 0.0 if opening is None else opening.depth
    solid = (-depth - thickness, level)
    every = [
        Slab((-reach, left), (low, reach), solid),
        Slab((right, reach), (low, reach), solid),
        Slab((left, right), (low, bottom), solid),
        Slab((left, right), (top, reach), solid),
        Slab((left, right), (bottom, top), (-depth - thickness, level - depth)),
    ]
    return [slab for slab in every if min(slab.size) > 0.0]
