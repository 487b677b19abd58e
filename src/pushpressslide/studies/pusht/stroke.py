"""The next action of a push: the pusher's target that the forward model likes best.

An episode ends with the first action after which the overlap is above 95 %. So the last
action should be a stride onto the goal, not a creep over that threshold.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.studies.pusht.forward import predicted
from pushpressslide.studies.pusht.pushes import Push, final_pose, pushed_pose
from pushpressslide.studies.pusht.servo import Pusher
from pushpressslide.studies.pusht.steering import miss
from pushpressslide.studies.pusht.tee import overlap

PUSH_STEP = 12.0  # [px] of the pusher along the normal in one action
NEAR = 30.0  # [px] of the last push, from which the end is looked for
SUCCESS = 0.949  # overlap that a stride before the last one stays below
GOOD = 0.98  # overlap with which an episode may end
STRIDES = (-6.0, -3.0, -1.5, 0.0, 1.5, 3.0, 6.0)  # [px] more than the planned one
SIDEWAYS = (-9.0, -4.0, -2.0, 0.0, 2.0, 4.0, 9.0)  # [px] beside the planned contact
HALVINGS = 4  # of the spacing, round the best target


def stroke(X_WB: Pose2, pusher: Pusher, plan: Sequence[Push]) -> Point:
    """Return where the pusher shall be after the next action of the first push."""
    first = plan[0]
    most = PUSH_STEP / first.pusher_ratio
    count = max(1, math.ceil(first.length / most - 0.05))
    length = first.length / count
    planned = _target(X_WB, replace(first, length=length))
    left = sum(push.length for push in plan)
    alone = all(push.face == first.face for push in plan)
    if not (alone and left < NEAR):
        return planned
    rest = (replace(first, length=first.length - length), *plan[1:])
    options = [
        (target, predicted(X_WB, pusher, pusher.action_to(target)))
        for target in _options(X_WB, replace(first, length=length))
    ]
    overlaps = [overlap(pose) for _, pose in options]
    best = max(range(len(options)), key=overlaps.__getitem__)
    if overlaps[best] > GOOD:
        return _refined(X_WB, pusher, options[best][0])
    early = [index for index, share in enumerate(overlaps) if share < SUCCESS]
    if not early:
        return options[best][0]
    going = min(early, key=lambda index: miss(final_pose(options[index][1], rest)))
    return options[going][0]


def _target(X_WB: Pose2, push: Push) -> Point:
    """Return where the pusher is at the end of a push."""
    return pushed_pose(X_WB, push).apply(push.pushed.pusher(push.left))


def _options(X_WB: Pose2, push: Push) -> Iterator[Point]:
    """Yield targets about that of a push."""
    for side in SIDEWAYS:
        left = push.pushed.clipped(push.left + side)
        for more in STRIDES:
            length = max(push.length + more, 0.0)
            yield _target(X_WB, replace(push, left=left, length=length))


def _refined(X_WB: Pose2, pusher: Pusher, target: Point) -> Point:
    """Return the target near by with the greatest overlap (pattern search)."""
    best = target
    most = overlap(predicted(X_WB, pusher, pusher.action_to(target)))
    spacing = 1.0
    for _ in range(HALVINGS):
        x, y = best
        for dx, dy in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            trial = (x + spacing * dx, y + spacing * dy)
            share = overlap(predicted(X_WB, pusher, pusher.action_to(trial)))
            if share > most:
                most = share
                best = trial
        spacing *= 0.5
    return best
