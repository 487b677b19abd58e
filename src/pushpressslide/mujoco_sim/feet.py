"""Feet of a body on its support: points that carry its base, each with a share of it.

MuJoCo's contact of two flat faces has a few points at the corners, with up to three
times the moment of friction of the true pressure. A grid of points over the base has
the moment of the pressure, if each carries the load of its own cell.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.geometry.mesh_body import MeshBody
from pushpressslide.geometry.shape import Shape
from pushpressslide.mechanics.bowed import base_factors

CELLS = 6
"""Cells across a base where it is narrow."""
MOST_CELLS = 10
"""Largest number of cells along a base."""
RIM = 0.05
"""Width of the rim, as a share of the base's breadth. Its cells have feet of their own:
the base tips about these, hardly earlier than about its edge.
"""
SLIVER = 1e-3
"""Area, as a share of a cell's, below which a cell gets no foot."""
FINE = 24
"""Resolution of the rule for a base's mean distance from its middle."""

LEAST_SHARE = 1e-3
"""Load of a foot, as a share of the largest, below which it is left out."""


class Feet(NamedTuple):
    """Feet of a base in its shape's frame G."""

    points: Array  # (n, 2) [m]
    shares: Array  # (n,) of the base's area; their sum is 1

    def bowed(self, shape: Shape, bow: float, feet: float) -> Feet:
        """Feet of a bowed base, or of one that has real ``feet``, as
        ``mechanics.bowed`` has it.
        """
        shares = self.shares * base_factors(shape, self.points, bow, feet)
        bears = shares > LEAST_SHARE * shares.max()
        return Feet(self.points[bears], shares[bears] / shares[bears].sum())


def feet_of(shape: Shape) -> Feet:
    """Feet of a shape: the centroids of cells, enlarged about the base's centroid so
    that the mean distance from there is that of the base.

    This restores the moment of friction in a turn on the spot.
    """
    cells = _cells(shape)
    points, areas = shape.base_rule(FINE)
    shares = areas / areas.sum()
    center = cells.shares @ cells.points
    wanted = np.hypot(*(points - shares @ points).T) @ shares
    got = np.hypot(*(cells.points - center).T) @ cells.shares
    return Feet(center + wanted / got * (cells.points - center), cells.shares)


def _cells(shape: Shape) -> Feet:
    """Centroids and areas of the cells of a grid over the base, cut at its border and
    at its rim.
    """
    import shapely

    base = shape.base if isinstance(shape, MeshBody) else shape.placed(Pose2())
    x_min, y_min, x_max, y_max = base.bounds
    breadth = min(shape.breadth, x_max - x_min, y_max - y_min)
    nx, ny = (
        min(MOST_CELLS, round(CELLS * math.sqrt(width / breadth)))
        for width in (x_max - x_min, y_max - y_min)
    )
    xs = np.linspace(x_min, x_max, nx + 1)
    ys = np.linspace(y_min, y_max, ny + 1)
    low = np.stack(np.meshgrid(xs[:-1], ys[:-1]), axis=-1).reshape(-1, 2)
    high = np.stack(np.meshgrid(xs[1:], ys[1:]), axis=-1).reshape(-1, 2)
    inner = base.buffer(-RIM * breadth, join_style="mitre")
    size = np.prod(high - low, axis=1)[0]
    points, areas = [], []
    for part in (inner, base.difference(inner)):
        cut = np.array(shapely.intersection(part, shapely.box(*low.T, *high.T)))
        kept = cut[shapely.area(cut) > SLIVER * size]
        points.append(shapely.get_coordinates(shapely.centroid(kept)))
        areas.append(shapely.area(kept))
    shares = np.concatenate(areas)
    return Feet(np.concatenate(points), shares / shares.sum())
