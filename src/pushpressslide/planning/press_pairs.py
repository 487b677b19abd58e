"""Placements of two arms that press the top of an object."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from pushpressslide.core import margins
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.query import Ends, MotionQuery
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.mechanics.wall import lean, lean_press
from pushpressslide.planning.hollow import hollow_refusal
from pushpressslide.planning.side_contacts import assignments
from pushpressslide.rom.drives import ORIGIN

ROUNDING = 1e-6  # [m] by which a contact may be nearer to the edge

Pair = tuple[Point, Point]


@dataclass(frozen=True, slots=True)
class PlacedPair:
    """Two contacts assigned to arms, still without loads, and the path of the body."""

    contacts: tuple[Contact, ...]
    path: TwistPath
    crossing: bool  # whichever arm takes which contact
    refusal: Refusal | None  # the refusal of the places


def placed_pairs(query: MotionQuery) -> list[PlacedPair]:
    """Pairs of contacts, those nearest to their arms first."""
    places = top_places(query.body, query.scene.inset)
    farthest = max((math.hypot(*place) for place in places), default=0.0)
    placed = [_placed(query, points, farthest) for points in _pairs(query)]
    return sorted(
        placed,
        key=lambda pair: _arm_length(query.scene, query.body_ends, pair.contacts),
    )


def _placed(query: MotionQuery, points: Pair, farthest: float) -> PlacedPair:
    """A pair of contacts assigned to arms. ``farthest`` [m] is the largest distance of
    any place from the CoM.
    """
    body = query.body
    radius = max(farthest, *(math.hypot(*point) for point in points))
    path = TwistPath.between(query.body_ends, radius)
    poses = [path.pose(0.25 * i * path.length) for i in range(5)]
    assigned = assignments(query.scene.bases, points, poses)
    arms = next(iter(assigned), None)
    if query.motion.contacts is not None and (0, 1) in assigned:
        arms = (0, 1)
    if arms == (1, 0):
        points = (points[1], points[0])
    contacts = tuple(
        Contact(arm, "top", point, ORIGIN, body.shape.top_height)
        for arm, point in enumerate(points)
    )
    return PlacedPair(contacts, path, arms is None, _refusal(query.scene, points))


def _arm_length(scene: Scene, ends: Ends, contacts: Sequence[Contact]) -> float:
    """Sum [m] of the contacts' distances from their arms' bases at both ``ends`` X_WB."""
    bases = scene.bases
    return sum(
        math.dist(X_WB.apply(contact.point), bases[contact.arm][:2])
        for X_WB in ends
        for contact in contacts
    )


def _pairs(query: MotionQuery) -> list[Pair]:
    """Pairs of places to press, in B [m]: opposite each other about the CoM, or as
    prescribed.

    If a concave top has no place opposite, the nearest place to that point is used.
    """
    scene = query.scene
    body = query.body
    given = query.motion.contacts
    if given is not None and len(given) == 2:
        first, second = (body.X_GB.inverse().apply(place) for place in given)
        return [(first, second)]
    dx, dy = lean(scene, query.goal, query.motion.press_force or lean_press(scene))
    pairs: list[Pair] = []
    places = top_places(body, scene.inset)
    for p in places:
        q = (-p[0], -p[1])
        if not body.shape.convex and not inside_top(body, q, scene.inset - ROUNDING):
            q = min(places, key=partial(math.dist, q))
        new = all(
            min(math.dist(p, other) for other in pair) > ROUNDING for pair in pairs
        )
        if not new or math.dist(p, q) < margins.ARM.hand_room:
            continue
        if inside_top(body, q, scene.inset - ROUNDING):
            pairs.append((p, q))
    return [((px + dx, py + dy), (qx + dx, qy + dy)) for (px, py), (qx, qy) in pairs]


def _refusal(scene: Scene, points: Pair) -> Refusal | None:
    """Refusal of two contacts at any loads, or None."""
    deep = hollow_refusal(scene)
    if deep is not None:
        return deep
    inset = scene.inset
    if not all(inside_top(scene.body, p, inset - ROUNDING) for p in points):
        text = "the contacts must be {allowed:mm.0f} inside the object's top"
        return Refusal("off_top", text, None, inset, "m")
    distances = math.dist(*points)
    needed = margins.ARM.hand_room
    if distances < needed:
        text = "the contacts are {figure:mm.0f} apart, allowed from {allowed:mm.0f}"
        return Refusal("too_close", text, distances, needed, "m")
    return None
