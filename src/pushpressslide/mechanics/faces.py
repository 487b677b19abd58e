"""The side faces of an object, on which a tip can push."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point, turned_left
from pushpressslide.core.task import ObjectModel
from pushpressslide.geometry.polygon import turn_near
from pushpressslide.geometry.sides import Side


@dataclass(frozen=True, slots=True)
class Face:
    """One side face, in B, the frame at the projected centre of mass."""

    # index of the footprint's side, counter-clockwise; on a cylinder, of the direction
    index: int
    # [m] point of the face nearest to the line through the CoM along the normal, clear
    # of the corners
    foot: Point
    normal: Point  # unit, inward
    # [m] distance of ``foot`` to the left of that line, seen along the normal; 0 if the
    # face is wide enough
    offset: float
    # [m] distance of the CoM from the face's line; < 0 if it is on the tip's side
    depth: float
    # [m] right and left end, from that line, of the part that a tip can touch; both are
    # at the foot on a round face, which continues to both sides
    ends: tuple[float, float]
    flat: bool


@lru_cache(maxsize=64)
def faces(
    body: ObjectModel,
    corner_clearance: float,
    tip_radius: float = 0.0,
    height: float = 0.0,
    lean: float = 0.5 * math.pi,
) -> tuple[Face, ...]:
    """Faces of ``body`` that a tip of ``tip_radius`` [m] can touch at ``height`` [m].

    Their lean is at most ``lean`` [rad]. A tip of zero radius can touch all faces. If a
    part of a face is blocked, each remaining part counts as a face. Contacts stay
    ``corner_clearance`` [m] away from the corners, or at the middle of an edge that is
    too short for this. A part on which a creeping tip would meet a different normal is
    excluded.
    """
    out = []
    com = body.center_of_mass
    creep = margins.CREEP * tip_radius
    side = body.shape.section(height, lean)
    for place in side.side_places(corner_clearance, tip_radius, com):
        foot = place.point
        normal = place.normal
        left = turned_left(normal)
        offset = foot[0] * left[0] + foot[1] * left[1]
        depth = -(foot[0] * normal[0] + foot[1] * normal[1])
        ends = place.ends or (offset, offset)
        flat = place.ends is not None
        if flat and ends[1] - ends[0] < 2.0 * creep:
            place_in_G = (foot[0] + com[0], foot[1] + com[1])
            turned = turn_near(side.corners, place_in_G, normal, creep)
            if turned > margins.CREPT_TURN:
                continue
        out.append(Face(place.index, foot, normal, offset, depth, ends, flat))
    return tuple(out)


def side_of(body: ObjectModel, contact: Contact) -> Side:
    """Side of ``body`` on which ``contact`` lies."""
    section = body.shape.section(contact.height)
    return section.side(contact.point, contact.normal, body.center_of_mass)


def room_ahead(body: ObjectModel, face: Face) -> float:
    """Distance [m] from the CoM to the leading edge when ``face`` is pushed along its
    normal.
    """
    return body.shape.extent(face.normal, body.center_of_mass)
