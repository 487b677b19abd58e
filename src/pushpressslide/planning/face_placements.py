"""Placements of two arms that push an object's faces: side by side on one face, or one
on each of two faces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import cross
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.mechanics.faces import Face
from pushpressslide.planning.side_contacts import (
    drag_refusal,
    least_distance,
    side_contact,
)

# places on each of two faces, in shares of the face on either side of the CoM's line
PLACES = (-1.0, -0.5, 0.0, 0.5, 1.0)

Contacts = tuple[Contact, ...]


def side_by_side(scene: Scene, face: Face, height: float) -> list[Contacts]:
    """Contacts left and right of the line through the CoM at ``height`` [m], the widest
    pair first.
    """
    low, high = face.ends
    inside = max(scene.inset, min(high, -low) - scene.inset)
    return [
        (side_contact(0, face, half, height), side_contact(1, face, -half, height))
        for half in (share * inside for share in margins.WIDTHS)
    ]


def side_by_side_refusal(
    query: MotionQuery, face: Face, contacts: Contacts
) -> Refusal | None:
    """Refusal of two contacts on a face, or None."""
    left, right = contacts
    distances = math.dist(left.point, right.point)
    needed = least_distance(query.scene)
    if distances < needed:
        text = "contacts {figure:mm.0f} apart, two tools need {allowed:mm.0f}"
        return Refusal("too_close", text, distances, needed, "m")
    if abs(face.offset) > 1e-9:
        text = "no contact on the other side of the line through the CoM"
        return Refusal("offset_contact", text)
    return drag_refusal(query, (face,), 2, left.height)


def on_two_faces(scene: Scene, pair: Sequence[Face], height: float) -> list[Contacts]:
    """Contacts at ``height`` [m], one on each of two faces, with enough space between
    the tools.
    """
    sides = []
    for arm, face in enumerate(pair):
        right, left = face.ends
        low = right + scene.inset
        high = left - scene.inset
        middle = min(max(0.0, low), high)
        offsets = (
            middle + k * (high - middle if k > 0.0 else middle - low) for k in PLACES
        )
        sides.append([side_contact(arm, face, offset, height) for offset in offsets])
    distances = least_distance(scene)
    return [
        (a, b) for a, b in product(*sides) if math.dist(a.point, b.point) >= distances
    ]


def angle_between(first: Face, second: Face) -> float:
    """Angle [rad] between the normals of two faces."""
    a = first.normal
    b = second.normal
    return abs(math.atan2(cross(a, b), a[0] * b[0] + a[1] * b[1]))


def spread(contacts: Sequence[Contact]) -> float:
    """Sum [m] of the contacts' distances from the CoM.

    It is rounded so that mirrored objects give equal sums.
    """
    return round(sum(math.hypot(*contact.point) for contact in contacts), 6)
