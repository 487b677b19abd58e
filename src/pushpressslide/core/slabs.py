"""Solid behind a support that is not the table: slabs around its opening, and the
opening's back.
"""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.control import Vector3
from pushpressslide.core.scene import Support

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

    @property
    def center(self) -> Vector3:
        """X, y and height [m] of its centre."""
        x, y, z = (0.5 * (a + b) for a, b in (self.x, self.y, self.height))
        return (x, y, z)


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
