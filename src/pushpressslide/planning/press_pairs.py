"""Where two arms press the top of an object."""

from __future__ import annotations

import math

from pushpressslide.core.pose import Point
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.task import ObjectModel, Task
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.mechanics.wall import lean, lean_press
from pushpressslide.planning.held_twist import EDGE

ROUNDING = 1e-6  # [m] by which a contact may be nearer to the edge
APART = 0.10  # [m] between the contacts, so that the arms have room

Pair = tuple[Point, Point]


def press_pairs(task: Task) -> list[Pair]:
    """Return pairs of places to press, in B [m]: opposite each other about the CoM, or given."""
    scene = task.scene
    body = task.object
    given = task.motion.contacts
    if given is not None and len(given) == 2:
        first, second = (body.X_GB.inverse().apply(p) for p in given)
        return [(first, second)]
    dx, dy = lean(scene, task.goal, task.motion.press_force or lean_press(scene))
    pairs: list[Pair] = []
    for p in top_places(body, EDGE):
        q = (-p[0], -p[1])
        new = all(
            min(math.dist(p, other) for other in pair) > ROUNDING for pair in pairs
        )
        if not new or math.dist(p, q) < APART:
            continue
        if inside_top(body, q, EDGE - ROUNDING):
            pairs.append((p, q))
    return [((px + dx, py + dy), (qx + dx, qy + dy)) for (px, py), (qx, qy) in pairs]


def pair_refusal(body: ObjectModel, points: Pair) -> Refusal | None:
    """Return what stands against two contacts, whatever their loads."""
    if not all(inside_top(body, p, EDGE - ROUNDING) for p in points):
        text = "the contacts must be {allowed:mm.0f} inside the object's top"
        return Refusal("off_top", text, None, EDGE, "m")
    apart = math.dist(*points)
    if apart < APART:
        text = "the contacts are {figure:mm.0f} apart, allowed from {allowed:mm.0f}"
        return Refusal("too_close", text, apart, APART, "m")
    return None
