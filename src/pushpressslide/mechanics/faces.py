"""The side faces of an object, seen as places to push."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core.pose import Point, turned_left
from pushpressslide.core.task import Cylinder, ObjectModel

CYLINDER_FACES = 24  # a round side is offered as this many directions


@dataclass(frozen=True, slots=True)
class Face:
    """One side face; all in B, the frame at the projected centre of mass."""

    # of the footprint's edge, counter-clockwise; on a cylinder, of the direction
    index: int
    # [m] the face's point nearest to the line through the CoM along the normal, corners
    # kept clear
    foot: Point
    normal: Point  # unit, inward
    # [m] of ``foot`` to the left of that line, seen along the normal; 0 where the face
    # is wide enough
    offset: float
    depth: float  # [m] distance of the CoM from the face's line, > 0


def faces(body: ObjectModel, corner_clearance: float) -> tuple[Face, ...]:
    """Return the faces of ``body``; contacts stay ``corner_clearance`` [m] away from
    the corners (or at a short edge's middle).
    """
    com = body.center_of_mass
    if isinstance(body.shape, Cylinder):
        out = []
        for i in range(CYLINDER_FACES):
            angle = 2.0 * math.pi * i / CYLINDER_FACES
            normal = (math.cos(angle), math.sin(angle))
            point = (
                -body.shape.radius * normal[0] - com[0],
                -body.shape.radius * normal[1] - com[1],
            )
            side = turned_left(normal)
            out.append(
                Face(
                    i,
                    point,
                    normal,
                    point[0] * side[0] + point[1] * side[1],
                    -(point[0] * normal[0] + point[1] * normal[1]),
                )
            )
        return tuple(out)
    corners = [(x - com[0], y - com[1]) for x, y in body.shape.footprint]
    out = []
    for i, a in enumerate(corners):
        b = corners[(i + 1) % len(corners)]
        length = math.hypot(b[0] - a[0], b[1] - a[1])
        u = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        normal = turned_left(u)  # inward of a counter-clockwise polygon
        along = -(a[0] * u[0] + a[1] * u[1])  # of the CoM's foot, from corner a
        clear = min(corner_clearance, 0.5 * length)
        place = min(max(along, clear), length - clear)
        foot = (a[0] + place * u[0], a[1] + place * u[1])
        side = turned_left(normal)
        out.append(
            Face(
                i,
                foot,
                normal,
                foot[0] * side[0] + foot[1] * side[1],
                -(foot[0] * normal[0] + foot[1] * normal[1]),
            )
        )
    return tuple(out)


def room_ahead(body: ObjectModel, face: Face) -> float:
    """Return the distance [m] from the CoM to the leading edge when ``face`` is pushed
    along its normal.
    """
    com = body.center_of_mass
    shape = body.shape
    if isinstance(shape, Cylinder):
        return shape.radius + com[0] * face.normal[0] + com[1] * face.normal[1]
    return max(
        (x - com[0]) * face.normal[0] + (y - com[1]) * face.normal[1]
        for x, y in shape.footprint
    )
