"""Footprints in the scene: overlaps, gaps, and the part supported by a ledge or beside
an opening.
"""

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
"""Distance [m] below which two edges count as one, for round-off."""


def overlap_area(shape_1: Shape, X_W1: Pose2, shape_2: Shape, X_W2: Pose2) -> float:
    """Common area [m^2] of two footprints."""
    return float(shape_1.placed(X_W1).intersection(shape_2.placed(X_W2)).area)


def gaps(shape: Shape, poses: Sequence[Pose2], others: Sequence[Polygon]) -> Array:
    """Distances (n, k) [m] of a footprint at n ``poses`` X_WG from k polygons in W.
    Zero if they overlap.
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
    """Common areas (n,) [m^2] of a footprint at n ``poses`` X_WG and a polygon in W."""
    import shapely

    out: Array = shapely.area(shapely.intersection(all_placed(shape, poses), other))
    return out


def all_placed(shape: Shape, poses: Sequence[Pose2]) -> NDArray[np.object_]:
    """The footprint at n ``poses`` X_WG as n Shapely polygons."""
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
    """Depth [m] of a point inside the part of a footprint that is not over an opening.

    Depth is measured from the edge of this part's convex hull. It is negative outside
    the hull, and infinite if no part of the footprint is over the opening.
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
    """Depths (n,) [m] of ``points`` (n, 2), in W, inside the tipping edge of a
    footprint on a ``region``.

    The footprint is at n ``poses`` X_WG. Depths are measured from the edge of the
    convex hull of the supported part of the footprint. They are negative outside the
    hull, and infinite if no edge of the hull lies on the edge of the region.
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
    """Region in W in which an object's centre of mass stays clear of a table's edge.
    None without an edge.

    For a convex base and table it is the region that ``edge_depths`` allows for a
    resting object; otherwise it is smaller.
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
    """``count`` evenly spaced points around a footprint, ``distance`` [m] off it, and
    their spacing [m].
    """
    line = shape.placed(X_WG).buffer(distance).exterior
    points = [line.interpolate(i / count, normalized=True) for i in range(count)]
    return [(p.x, p.y) for p in points], float(line.length) / count
