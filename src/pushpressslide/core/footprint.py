"""Footprints in the scene: overlaps, gaps, and what a ledge or an opening carries."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from pushpressslide.core import margins
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Opening, Shape, Support

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

    from pushpressslide.core.arrays import Array

SAME_EDGE = 1e-6
"""[m] within which two edges are the same: rounding."""


def overlap_area(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Return the area [m^2] that two footprints share."""
    return float(shape_1.placed(X_W1).intersection(shape_2.placed(X_W2)).area)


def gaps(shape: Shape, poses: Sequence[Pose2], others: Sequence[Polygon]) -> Array:
    """Return the distances (n, k) [m] of a footprint at n ``poses`` X_WG to k polygons
    in W; zero where they overlap.
    """
    import numpy as np
    import shapely

    there = np.array(others, dtype=object)[None]
    if (
        not shape.corners and shape.middle == shape.centroid
    ):  # a circle about its middle
        centers = shapely.points([X.apply(shape.middle) for X in poses])
        distances = shapely.distance(centers[:, None], there) - shape.circumradius
        return np.asarray(np.maximum(distances, 0.0))
    out: Array = shapely.distance(all_placed(shape, poses)[:, None], there)
    return out


def overlaps(shape: Shape, poses: Sequence[Pose2], other: Polygon) -> Array:
    """Return the areas (n,) [m^2] that a footprint at n ``poses`` X_WG shares with a
    polygon in W.
    """
    import shapely

    out: Array = shapely.area(shapely.intersection(all_placed(shape, poses), other))
    return out


def all_placed(shape: Shape, poses: Sequence[Pose2]) -> NDArray[np.object_]:
    """Return the footprint at n ``poses`` X_WG as n polygons for Shapely."""
    import numpy as np
    import shapely

    outline = shapely.get_coordinates(shape.placed(Pose2()))
    yaw = np.array([X.yaw for X in poses])
    place = np.array([X.position for X in poses])
    turned = np.exp(1j * yaw)[:, None] * outline.view(np.complex128)[None, :, 0]
    corners = np.stack([turned.real, turned.imag], axis=-1) + place[:, None]
    out: NDArray[np.object_] = shapely.polygons(corners)
    return out


def depth_beside(shape: Shape, X_WG: Pose2, opening: Opening, point: Point) -> float:
    """Return the depth [m] of a point in what an opening leaves of a footprint.

    What is left counts with its convex hull. The depth is negative outside, and
    infinite where no part of the footprint is over the opening.
    """
    from shapely import Point as Place
    from shapely import box

    w, h = opening.size
    x, y = opening.center
    whole = shape.placed(X_WG)
    rest = whole.difference(box(x - 0.5 * w, y - 0.5 * h, x + 0.5 * w, y + 0.5 * h))
    if rest.area == whole.area:
        return math.inf
    if rest.is_empty:
        return -math.inf
    hull = rest.convex_hull
    place = Place(point)
    if hull.covers(place):
        return float(hull.boundary.distance(place))
    return -float(hull.distance(place))


def edge_depths(
    shape: Shape, poses: Sequence[Pose2], points: Array, region: Polygon
) -> Array:
    """Return how far (n,) [m] points (n, 2) in W are inside the edge over which a
    footprint at n ``poses`` X_WG would tip from a region of W.

    What the region carries of the footprint counts with its convex hull. Depths are
    negative beyond it, and infinite where nothing of the hull's edge is the region's.
    """
    import numpy as np
    import shapely

    placed = all_placed(shape, poses)
    places = np.asarray(shapely.points(points))
    out = np.full(len(poses), np.inf)
    over = ~shapely.contains(region, placed)
    if not over.any():
        return out
    placed = placed[over]
    places = places[over]
    carried = shapely.convex_hull(shapely.intersection(placed, region))
    own = shapely.buffer(shapely.boundary(shapely.convex_hull(placed)), SAME_EDGE)
    edges = shapely.difference(shapely.boundary(carried), own)
    depths = np.where(shapely.is_empty(edges), np.inf, shapely.distance(edges, places))
    flat = shapely.area(carried) == 0.0
    beyond = np.where(
        flat, shapely.distance(region, places), shapely.distance(carried, places)
    )
    out[over] = np.where(flat | ~shapely.covers(carried, places), -beyond, depths)
    return out


def middle_room(support: Support, shape: Shape) -> BaseGeometry | None:
    """Return where in W an object's centre of mass may be on a table with an edge, with
    its margin; None where there is no edge.

    Where base and table are convex it is where ``edge_depths`` of a resting object
    allows it, else less.
    """
    from shapely import Polygon

    if support.region is None:
        return None
    margin = margins.EDGE_MARGIN * shape.half_width
    room: BaseGeometry = Polygon(support.region).buffer(-margin, join_style="mitre")
    return room


def around(
    shape: Shape, X_WG: Pose2, distance: float, count: int
) -> tuple[list[Point], float]:
    """Return ``count`` points even around a footprint, ``distance`` [m] off it, and how
    far apart [m].
    """
    line = shape.placed(X_WG).buffer(distance).exterior
    points = [line.interpolate(i / count, normalized=True) for i in range(count)]
    return [(p.x, p.y) for p in points], float(line.length) / count
