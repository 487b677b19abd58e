"""The side faces of an object, seen as places to push."""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.core.pose import Point, turned_left
from pushpressslide.core.task import ObjectModel


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
    """Return the faces of ``body``.

    Contacts stay ``corner_clearance`` [m] away from the corners (or at a short edge's
    middle).
    """
    out = []
    places = body.shape.side_points(corner_clearance, body.center_of_mass)
    for i, (foot, normal) in enumerate(places):
        left = turned_left(normal)
        offset = foot[0] * left[0] + foot[1] * left[1]
        depth = -(foot[0] * normal[0] + foot[1] * normal[1])
        out.append(Face(i, foot, normal, offset, depth))
    return tuple(out)


def room_ahead(body: ObjectModel, face: Face) -> float:
    """Return the distance [m] from the CoM to the leading edge when ``face`` is pushed
    along its normal.
    """
    return body.shape.extent(face.normal, body.center_of_mass)
