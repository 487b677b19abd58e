"""The area covered by triangles at one level, from the border that remains when common
edges cancel.

Some programs split a concave face into a fan of triangles. Some of these lie outside
the face, and are cancelled by others with the opposite orientation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry as Area

    from pushpressslide.core.arrays import Array

MOST_EDGES = 20_000
"""Largest number of edges in a border. The border of a level face has few edges, that
of a rough face many more.
"""


def covered(triangles: Array, grid: float) -> Area:
    """Area in which the winding numbers of triangles (m, 3, 2) add up to more than
    zero. Counter-clockwise triangles count as positive.

    Corners [m] are rounded to ``grid``. Raises ValueError for a border with too many
    edges.
    """
    starts, ends, counts = _border(triangles, grid)
    if len(starts) > MOST_EDGES:
        found = f"{len(starts)} edges about what is level in it"
        raise ValueError(f"it is not flat: {found}, allowed up to {MOST_EDGES}")
    return _within(starts, ends, counts, grid)


def enclosed(tails: Array, heads: Array, grid: float) -> Area:
    """Area to the left of closed loops of directed edges, from ``tails`` to ``heads``
    (m, 2) [m].

    Corners are rounded to ``grid``.
    """
    import numpy as np

    starts = np.round(tails / grid)
    ends = np.round(heads / grid)
    real = (starts != ends).any(axis=1)
    return _within(starts[real], ends[real], np.ones(np.count_nonzero(real)), grid)


def _within(starts: Array, ends: Array, counts: Array, grid: float) -> Area:
    """Area with positive winding numbers of directed edges (k, 2) [grid], each counted
    ``counts`` (k,) times.
    """
    import numpy as np
    import shapely

    lines = shapely.linestrings(grid * np.stack((starts, ends), axis=1))
    cells = shapely.get_parts(
        shapely.polygonize([shapely.union_all(lines, grid_size=grid)])
    )
    cells = cells[shapely.area(cells) > grid * grid]
    points = shapely.get_coordinates(shapely.point_on_surface(cells)) / grid
    inside = [_winding(point, starts, ends, counts) > 0 for point in points]
    return shapely.union_all(cells[inside], grid_size=grid)


def _border(triangles: Array, grid: float) -> tuple[Array, Array, Array]:
    """Starts (k, 2) and ends (k, 2) [grid] of the edges that do not cancel, and the
    number of times each remains.

    The number is negative for the reverse direction.
    """
    import numpy as np

    places = np.round(triangles.reshape(-1, 2) / grid)
    corners, number = np.unique(places, axis=0, return_inverse=True)
    a, b, c = number.reshape(-1, 3).T
    tails = np.concatenate((a, b, c))
    heads = np.concatenate((b, c, a))
    low = np.minimum(tails, heads)
    keys = low * len(corners) + np.maximum(tails, heads)
    keys, place = np.unique(keys, return_inverse=True)
    sense = np.sign(heads - tails)
    counts = np.bincount(place, weights=sense, minlength=len(keys))
    rest = counts != 0.0
    low, high = np.divmod(keys[rest], len(corners))
    return corners[low], corners[high], counts[rest]


def _winding(point: Array, tails: Array, heads: Array, counts: Array) -> float:
    """Winding number of directed edges about a point that is on none of them."""
    import numpy as np

    edge = heads - tails
    offset = point - tails
    left = edge[:, 0] * offset[:, 1] > edge[:, 1] * offset[:, 0]
    below = tails[:, 1] <= point[1]
    upwards = below & (heads[:, 1] > point[1]) & left
    downwards = ~below & (heads[:, 1] <= point[1]) & ~left
    return float(np.sum(counts * upwards) - np.sum(counts * downwards))
