"""The next action of a push: the target of the pusher with the best result in the
forward model.

An episode ends with the first action after which the overlap is above 95 %. The last
action should therefore be long and end at the goal, instead of just exceeding this
threshold.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.forward import predicted
from pushpressslide_studies.pusht.pushes import PUSH_STEP, Push, pushed_pose
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.steering import miss
from pushpressslide_studies.pusht.tee import overlap

NEAR = 25.0  # [px] of the T from the goal, from which the end is looked for
SUCCESS = 0.949  # overlap that a stride before the last one stays below
ENOUGH = 0.951  # overlap that ends an episode for sure
GOOD = 0.98  # overlap with which an episode may end
STRIDES = (-8.0, -4.0, -2.0, 0.0, 2.0, 4.0, 8.0)  # [px] more than the planned one
SIDEWAYS = (-9.0, -4.0, -2.0, 0.0, 2.0, 4.0, 9.0)  # [px] beside the planned contact
HALVINGS = 4  # of the spacing, round the best target
LONGER = 0.05  # of a stride, by which one may be longer to spare another
AIMS = 2  # corrections of a target by the forward model


def stroke(X_WB: Pose2, pusher: Pusher, push: Push, hasty: bool) -> Point:
    """Target of the pusher for the next action of a push.

    An action ends the episode if it brings the overlap above the threshold. With
    ``hasty``, any overlap above the threshold is accepted, otherwise only an overlap
    above ``GOOD``.
    """
    most = PUSH_STEP / push.pusher_ratio
    count = max(1, math.ceil(push.length / most - LONGER))
    stride = replace(push, length=push.length / count)
    target = _aimed(X_WB, pusher, stride)
    if miss(X_WB) > NEAR:
        return target
    options = [target, *_options(X_WB, stride)]
    overlaps = [_overlap(X_WB, pusher, option) for option in options]
    best = max(range(len(options)), key=overlaps.__getitem__)
    if overlaps[best] > (ENOUGH if hasty else GOOD):
        return _refined(X_WB, pusher, options[best])
    if overlaps[0] < SUCCESS:
        return target
    early = [index for index, share in enumerate(overlaps) if share < SUCCESS]
    if not early:
        return options[best]
    return options[max(early, key=overlaps.__getitem__)]


def _overlap(X_WB: Pose2, pusher: Pusher, target: Point) -> float:
    """Overlap after an action towards a target."""
    return overlap(predicted(X_WB, pusher, pusher.action_to(target)))


def _aimed(X_WB: Pose2, pusher: Pusher, push: Push) -> Point:
    """Target at which the T has covered the length of a push."""
    wanted = pushed_pose(X_WB, push)
    nx, ny = wanted.rotate(push.pushed.normal)
    x, y = _target(X_WB, push)
    for _ in range(AIMS):
        pose = predicted(X_WB, pusher, pusher.action_to((x, y)))
        missing = (wanted.x - pose.x) * nx + (wanted.y - pose.y) * ny
        missing *= push.pusher_ratio
        x += missing * nx
        y += missing * ny
    return (x, y)


def _target(X_WB: Pose2, push: Push) -> Point:
    """Position [px] of the pusher at the end of a push."""
    return pushed_pose(X_WB, push).apply(push.pushed.pusher(push.left))


def _options(X_WB: Pose2, push: Push) -> Iterator[Point]:
    """Yield variations of a push's target, with the contact shifted sideways and the
    length changed.
    """
    for side in SIDEWAYS:
        left = push.pushed.clipped(push.left + side)
        for more in STRIDES:
            length = max(push.length + more, 0.0)
            yield _target(X_WB, replace(push, left=left, length=length))


def _refined(X_WB: Pose2, pusher: Pusher, target: Point) -> Point:
    """Nearby target with the greatest overlap (pattern search)."""
    best = target
    most = _overlap(X_WB, pusher, target)
    spacing = 1.0
    for _ in range(HALVINGS):
        x, y = best
        for dx, dy in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            trial = (x + spacing * dx, y + spacing * dy)
            share = _overlap(X_WB, pusher, trial)
            if share > most:
                most = share
                best = trial
        spacing *= 0.5
    return best
