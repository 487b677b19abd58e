"""The top of an object, seen as a place to press: an upright shape's top is its base's
outline. All in B.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.core.task import Cylinder, ObjectModel

DIRECTIONS = 12  # from the CoM in which places are offered, from G's x axis on
# of the way from the CoM to the edge at which places are offered
SHARES = (0.85, 0.65, 0.4)


def _edges(body: ObjectModel) -> list[tuple[float, float, float, float]]:
    """Inward unit normal (x, y), distance of the CoM inside the edge's line, width
    across; polygons only.
    """
    assert not isinstance(body.shape, Cylinder)
    com = body.center_of_mass
    corners = body.shape.footprint
    out = []
    for (ax, ay), (bx, by) in zip(corners, (*corners[1:], corners[0]), strict=True):
        length = math.hypot(bx - ax, by - ay)
        nx = -(by - ay) / length
        ny = (bx - ax) / length
        inside = (com[0] - ax) * nx + (com[1] - ay) * ny
        width = max((x - ax) * nx + (y - ay) * ny for x, y in corners)
        out.append((nx, ny, inside, width))
    return out


def inside_top(body: ObjectModel, point: Point, margin: float) -> bool:
    """Return whether ``point`` [m] is at least ``margin`` [m] inside the outline."""
    if isinstance(body.shape, Cylinder):
        com = body.center_of_mass
        return (
            math.hypot(point[0] + com[0], point[1] + com[1])
            <= body.shape.radius - margin
        )
    return all(
        inside + point[0] * nx + point[1] * ny >= margin
        for nx, ny, inside, _ in _edges(body)
    )


def room_inside(body: ObjectModel, point: Point) -> float:
    """Return how far ``point`` [m] is inside the outline, in half widths across the
    nearest edge; < 0 outside.
    """
    return float(rooms_inside(body, np.array([point]))[0])


def rooms_inside(body: ObjectModel, points: Array) -> Array:
    """Return the same of ``points`` (m, 2)."""
    if isinstance(body.shape, Cylinder):
        x, y = (points + np.array(body.center_of_mass)).T
        round_room: Array = 1.0 - np.hypot(x, y) / body.shape.radius
        return round_room
    nx, ny, inside, width = np.array(_edges(body)).T
    room: Array = (2.0 * (inside + points @ np.stack([nx, ny])) / width).min(1)
    return room


def half_width(body: ObjectModel) -> float:
    """Return half of the least width of the outline [m]."""
    if isinstance(body.shape, Cylinder):
        return body.shape.radius
    return 0.5 * min(width for _, _, _, width in _edges(body))


def top_places(body: ObjectModel, margin: float) -> list[Point]:
    """Return places to press [m], ``margin`` [m] inside the outline: in all directions
    from the CoM.
    """
    out = []
    for i in range(DIRECTIONS):
        angle = 2.0 * math.pi * i / DIRECTIONS
        u = (math.cos(angle), math.sin(angle))
        if isinstance(body.shape, Cylinder):
            cx, cy = body.center_of_mass
            radius = body.shape.radius - margin
            b = cx * u[0] + cy * u[1]
            room = b * b - cx * cx - cy * cy + radius * radius
            far = -b + math.sqrt(room) if room > 0.0 else 0.0
        else:
            ways = [
                (inside - margin) / -(u[0] * nx + u[1] * ny)
                for nx, ny, inside, _ in _edges(body)
                if u[0] * nx + u[1] * ny < -1e-9
            ]
            far = min(ways)
        out += [
            (share * far * u[0], share * far * u[1]) for share in SHARES if far > margin
        ]
    return out
