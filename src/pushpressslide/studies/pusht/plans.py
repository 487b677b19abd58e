"""Which three pushes: the fastest ones that keep clear of the walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.studies.pusht.detours import reachable, way_length
from pushpressslide.studies.pusht.joins import Joins, contacts, joins
from pushpressslide.studies.pusht.pushes import Push, final_pose, pushed_pose
from pushpressslide.studies.pusht.stroke import PUSH_STEP
from pushpressslide.studies.pusht.tee import CORNERS, FACES, GOAL_BODY, RHO, WALLS, overlap

WAY_STEP = 30.0  # [px] of the free pusher in one action
SLIDE_STEP = 15.0  # [px] of the pusher along a face in one action
LEAVE_STEPS = 5.0  # actions to leave a face and come to another
JUDGED = 400  # plans, the fastest first, that are looked at
PIECE = 15.0  # [px] of a push between poses that are looked at
ROOM = 4.0  # [px] of the T from a wall, in a plan
GIVE = 2.0  # [px] of that room that a correction may use
LAST = 10.0  # [px] of the pusher in the last push, at least
BEFORE_LAST = 0.9  # greatest overlap before the last push


def best_plan(X_WB: Pose2, pusher: Point) -> tuple[Push, ...]:
    """Return the three pushes that lead fastest from a pose to the goal; ``pusher``
    [px] in W is where the pusher is.

    Where the walls are in the way of all, the one that runs least into them.
    """
    found = joins(X_WB, GOAL_BODY)
    steps = _steps(found) + _first_ways(X_WB, pusher)[found.triples[:, 0]]
    order = np.argsort(steps)[:JUDGED]
    allowed = max(0.0, _overrun(X_WB))
    least = math.inf
    best: tuple[Push, ...] = ()
    for index in order[np.isfinite(steps[order])].tolist():
        triple = found.triples[index].tolist()
        lengths = found.lengths[index].tolist()
        plan = tuple(map(contacts().push, triple, lengths))
        worst = _worst(X_WB, plan)
        if worst <= allowed and overlap(final_pose(X_WB, plan[:2])) < BEFORE_LAST:
            return plan
        if worst < least:
            least = worst
            best = plan
    return best


def admissible(X_WB: Pose2, plan: Sequence[Push]) -> bool:
    """Return whether a plan keeps clear of the walls, or at least comes no nearer than
    the T is.
    """
    return _worst(X_WB, plan) <= max(GIVE, _overrun(X_WB) + GIVE)


def _steps(found: Joins) -> Array:
    """Return the actions (t,) that pushes and ways between them take."""
    ratios = 1.0 + (contacts().lefts / RHO) ** 2
    pushing = (found.lengths * ratios[found.triples]).sum(1) / PUSH_STEP
    between = _changes()
    first, middle, last = found.triples.T
    steps: Array = pushing + between[first, middle] + between[middle, last]
    short = found.lengths[:, 2] * ratios[last] < LAST
    steps[short] = math.inf
    return steps


@cache
def _changes() -> Array:
    """Return the actions (m, m) from one contact to another."""
    tried = contacts()
    places = [
        FACES[face].pusher(left)
        for face, left in zip(tried.faces, tried.lefts, strict=True)
    ]
    count = len(places)
    out = np.zeros((count, count))
    middle = Pose2(256.0, 256.0, 0.0)
    for a in range(count):
        for b in range(a):
            if tried.faces[a] == tried.faces[b]:
                steps = 1.0 + abs(tried.lefts[a] - tried.lefts[b]) / SLIDE_STEP
            else:
                start = middle.apply(places[a])
                steps = way_steps(way_length(middle, start, middle.apply(places[b])))
            out[a, b] = steps
            out[b, a] = steps
    return out


def way_steps(length: float) -> float:
    """Return the actions that a free way of a length [px] takes."""
    return LEAVE_STEPS + length / WAY_STEP


def _first_ways(X_WB: Pose2, pusher: Point) -> Array:
    """Return the actions (m,) from where the pusher is to each contact."""
    tried = contacts()
    out = np.full(len(tried.lefts), math.inf)
    for index, (face, left) in enumerate(zip(tried.faces, tried.lefts, strict=True)):
        place = X_WB.apply(FACES[face].pusher(left))
        if reachable(place):
            out[index] = way_steps(way_length(X_WB, pusher, place))
    return out


def _overrun(X_WB: Pose2) -> float:
    """Return how far [px] the T is beyond the room that the walls leave."""
    low, high = WALLS
    out = -math.inf
    for corner in CORNERS:
        for place in X_WB.apply(corner):
            out = max(out, low + ROOM - place, place - high + ROOM)
    return out


def _worst(X_WB: Pose2, plan: Sequence[Push]) -> float:
    """Return how far [px] the T runs into the walls on a plan; infinite where the
    pusher cannot be sent.
    """
    worst = 0.0
    for push in plan:
        pieces = max(1, math.ceil(push.length / PIECE))
        part = replace(push, length=push.length / pieces)
        pusher = push.pushed.pusher(push.left)
        if not reachable(X_WB.apply(pusher)):
            return math.inf
        for _ in range(pieces):
            X_WB = pushed_pose(X_WB, part)
            worst = max(worst, _overrun(X_WB))
            if not reachable(X_WB.apply(pusher)):
                return math.inf
    return worst
