"""Contacts of a spherical tip with the side of an object, for many samples at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from pushpressslide.core.arrays import Array
from pushpressslide.identification.pairs import rotated
from pushpressslide.identification.streams import Stream


@dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts of n samples, in the object's frame G."""

    gaps: Array  # (n,) [m] from the tip's surface to the object; < 0: they overlap
    points: Array  # (n, 2) [m] points of the object nearest to the tip
    normals: Array  # (n, 2) unit, into the object


@dataclass(frozen=True)
class TipContact:
    """A tip, and the outline of the object at its height."""

    outline: shapely.Polygon  # [m] in G, at the height of the tip
    radius: float  # [m]

    def contacts(self, tip: Array, pose: Array) -> Contacts:
        """Contacts of tips with centres at ``tip`` (n, 2) [m] with the object at
        ``pose`` (n, 3) [m, m, rad], both in W.
        """
        centers = rotated(tip - pose[:, :2], -pose[:, 2])
        places = shapely.points(centers)
        lines = shapely.shortest_line(places, self.outline.exterior)
        nearest = shapely.get_coordinates(lines).reshape(len(tip), 2, 2)[:, 1]
        away = nearest - centers
        distance = np.hypot(*away.T)
        outside = np.where(shapely.contains(self.outline, places), -1.0, 1.0)
        normals = away * (outside / np.maximum(distance, 1e-12))[:, None]
        return Contacts(outside * distance - self.radius, nearest, normals)

    def gaps(self, times: Array, tip: Stream, placed: Stream) -> Array:
        """Gaps (n,) [m] between tip and object at ``times`` (n,) [s], from streams on
        one clock.
        """
        return self.contacts(tip.values_at(times)[:, :2], placed.values_at(times)).gaps
