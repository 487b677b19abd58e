"""Selection of three pushes: the fastest that keep clear of the walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.detours import reachable, way_length
from pushpressslide_studies.pusht.joins import Contacts, Joins, contacts, joins
from pushpressslide_studies.pusht.pushes import (
    PUSH_STEP,
    Push,
    final_pose,
    pushed_pose,
)
from pushpressslide_studies.pusht.tee import (
    CORNERS,
    FACES,
    GOAL_BODY,
    RHO,
    WALLS,
    WORLD,
    overlap,
)

WAY_STEP = 30.0  # [px] of the free pusher in one action
SLIDE_STEP = 15.0  # [px] of the pusher along a face in one action
LEAVE_STEPS = 5.0  # actions to leave a face and come to another
JUDGED = 400  # plans, the fastest first, that are looked at
PIECE = 15.0  # [px] of a push between poses that are looked at
ROOM = 4.0  # [px] of the T from a wall
LAST = 10.0  # [px] of the pusher in the last push, at least
BEFORE_LAST = 0.9  # greatest overlap before the last push


@dataclass(frozen=True, slots=True)
class Plan:
    """Pushes that lead to the goal."""

    pushes: tuple[Push, ...] = ()
    intrusion: float = 0.0  # [px] of the T into the room before the walls, at most


NO_PLAN = Plan()


def best_plan(X_WB: Pose2, pusher: Point) -> Plan:
    """The three pushes that lead fastest from a pose to the goal. ``pusher`` [px] is
    the pusher's position in W.

    If the walls obstruct all triples, the pushes with the smallest intrusion are taken.
    The plan is empty if the pusher can reach no contact.
    """
    found = joins(X_WB, GOAL_BODY)
    steps = _steps(found) + _first_ways(X_WB, pusher)[found.triples[:, 0]]
    order = np.argsort(steps)[:JUDGED]
    allowed = _intrusion(X_WB)
    best = Plan(intrusion=math.inf)
    for index in order[np.isfinite(steps[order])].tolist():
        pushes = _pushes(found, index)
        if overlap(final_pose(X_WB, pushes[:-1])) > BEFORE_LAST:
            continue
        deepest = intrusion(X_WB, pushes)
        if deepest < best.intrusion:
            best = Plan(pushes, deepest)
        if deepest <= allowed:
            break
    return best


def intrusion(X_WB: Pose2, pushes: Sequence[Push]) -> float:
    """Largest intrusion [px] of the T into the margin along the walls, during pushes
    from a pose. Infinite if the pusher cannot be sent to a contact.
    """
    deepest = 0.0
    for push in pushes:
        pieces = max(1, math.ceil(push.length / PIECE))
        part = replace(push, length=push.length / pieces)
        pusher = push.pushed.pusher(push.left)
        if not reachable(X_WB.apply(pusher)):
            return math.inf
        for _ in range(pieces):
            X_WB = pushed_pose(X_WB, part)
            deepest = max(deepest, _intrusion(X_WB))
            if not reachable(X_WB.apply(pusher)):
                return math.inf
    return deepest


def _intrusion(X_WB: Pose2) -> float:
    """Intrusion [px] of the T into the margin along the walls. 0 if there is none."""
    low, high = WALLS
    deepest = 0.0
    for corner in CORNERS:
        for place in X_WB.apply(corner):
            deepest = max(deepest, low + ROOM - place, place - high + ROOM)
    return deepest


def _pushes(pushes: Joins, index: int) -> tuple[Push, ...]:
    triple = pushes.triples[index].tolist()
    lengths = pushes.lengths[index].tolist()
    return tuple(map(contacts().push, triple, lengths))


def _steps(pushes: Joins) -> Array:
    """Numbers of actions (t,) for the pushes and the paths between them. Infinite if
    the last push is too short.
    """
    ratios = 1.0 + (contacts().lefts / RHO) ** 2
    pusher = pushes.lengths * ratios[pushes.triples]
    first, middle, last = pushes.triples.T
    between = _changes()
    steps: Array = pusher.sum(1) / PUSH_STEP
    steps += between[first, middle] + between[middle, last]
    steps[pusher[:, 2] < LAST] = math.inf
    return steps


@cache
def _changes() -> Array:
    """Numbers of actions (m, m) from one contact to another."""
    tried = contacts()
    count = len(tried.lefts)
    out = np.zeros((count, count))
    for a in range(count):
        for b in range(a):
            out[a, b] = _change(tried, a, b)
            out[b, a] = out[a, b]
    return out


def _change(tried: Contacts, a: int, b: int) -> float:
    """Number of actions from one contact to another, with the T in the middle of the
    field.
    """
    if tried.faces[a] == tried.faces[b]:
        return 1.0 + abs(float(tried.lefts[a] - tried.lefts[b])) / SLIDE_STEP
    middle = Pose2(0.5 * WORLD, 0.5 * WORLD)
    start, goal = (
        middle.apply(FACES[tried.faces[i]].pusher(float(tried.lefts[i])))
        for i in (a, b)
    )
    return _way_steps(way_length(middle, start, goal))


def _way_steps(length: float) -> float:
    """Number of actions on a free path with a length [px]."""
    return LEAVE_STEPS + length / WAY_STEP


def _first_ways(X_WB: Pose2, pusher: Point) -> Array:
    """Number of actions (m,) that take the pusher from its position to each contact.
    Infinite for contacts to which it cannot be sent.
    """
    tried = contacts()
    out = np.full(len(tried.lefts), math.inf)
    for index, (face, left) in enumerate(zip(tried.faces, tried.lefts, strict=True)):
        place = X_WB.apply(FACES[face].pusher(float(left)))
        if reachable(place):
            out[index] = _way_steps(way_length(X_WB, pusher, place))
    return out
