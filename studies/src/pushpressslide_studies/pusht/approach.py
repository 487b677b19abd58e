"""Approach of the free pusher to the first contact of a push, action by action."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.detours import free_space
from pushpressslide_studies.pusht.pushes import Push
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.tee import BODY, CENTER, PUSHER_RADIUS

OFF_FACE = 2.0  # [px] between pusher and face before a push
NEAR = 3.0  # [px] from there
SLOW = 80.0  # [px/s] of a pusher that has arrived
STEPS = (45.0, 30.0, 18.0, 10.0, 5.0)  # [px] along a way in one action
CLEAR = 0.5  # [px] of the pusher from the T on the way


def arrived(X_WB: Pose2, pusher: Pusher, push: Push) -> bool:
    """Whether the pusher is just before the contact of a push, and slow."""
    near = math.dist(pusher.position, _before(X_WB, push)) < NEAR
    return near and math.hypot(*pusher.velocity) < SLOW


def on_way(X_WB: Pose2, pusher: Pusher, push: Push) -> Point:
    """Target of the pusher for the next action on its path to a push.

    It is as far along the path as the longest of ``STEPS`` with which, by the exact
    servo, the pusher does not touch the T.
    """
    goal = _before(X_WB, push)
    path = free_space(X_WB, pusher.position, goal) or (goal,)
    targets = [_along((pusher.position, *path), step) for step in STEPS]
    for target in targets:
        if _clear(X_WB, pusher, target):
            return target
    return targets[-1]


def _before(X_WB: Pose2, push: Push) -> Point:
    """Position [px] in W of the pusher just before a push."""
    return X_WB.apply(push.pushed.pusher(push.left, OFF_FACE))


def _along(polyline: Sequence[Point], length: float) -> Point:
    """Point [px] of a path at a given length from its start, or the path's end."""
    for a, b in pairwise(polyline):
        segment = math.dist(a, b)
        if segment >= length > 0.0:
            part = length / segment
            return (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]))
        length -= segment
    return polyline[-1]


def _clear(X_WB: Pose2, pusher: Pusher, target: Point) -> bool:
    """Whether the pusher stays clear of the T on its way to ``target``."""
    for moved in pusher.periods(pusher.action_to(target)):
        x, y = X_WB.unapply(moved.position)
        distance = BODY.shape.distance((x + CENTER[0], y + CENTER[1]))
        if distance < PUSHER_RADIUS + CLEAR:
            return False
    return True
