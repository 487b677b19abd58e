"""The policy: what is seen at 10 Hz becomes the place to which the pusher is sent.

State in, state out. Without a plan one is made; then the pusher goes round the T to the
first contact and pushes, and each time the rest of the plan is steered to the goal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pushpressslide.core.pose import Point, Pose2
from pushpressslide.studies.pusht.detours import free_way
from pushpressslide.studies.pusht.plans import admissible, best_plan
from pushpressslide.studies.pusht.pushes import Push, final_pose
from pushpressslide.studies.pusht.servo import Pusher
from pushpressslide.studies.pusht.steering import halved, miss, steered
from pushpressslide.studies.pusht.stroke import stroke
from pushpressslide.studies.pusht.tee import PUSHER_RADIUS, WORLD, body_pose

OFF_FACE = 2.0  # [px] between pusher and face before a push
ARRIVED = 3.0  # [px] from there
SLOW = 80.0  # [px/s] of a pusher that has arrived
DONE = 0.5  # [px] of a push that is left
HALVED = 5.0  # [px] of the last push, above which it is steered in two halves
LOST = 4.0  # [px] of a miss that steering cannot mend
SLIDE = 14.0  # [px] along a face in one action
WAY_STEPS = (45.0, 30.0, 18.0, 10.0, 5.0)  # [px] along a way in one action


@dataclass(frozen=True, slots=True)
class State:
    """What the policy remembers from one action to the next."""

    velocity: Point = (0.0, 0.0)  # [px/s] of the pusher
    plan: tuple[Push, ...] = ()
    touching: bool = False  # whether the first push has begun
    plans: int = 0  # made up to now


@dataclass(frozen=True, slots=True)
class Seen:
    """One observation, in W."""

    pusher: Point  # [px]
    X_WB: Pose2


def seen(observation: tuple[float, ...]) -> Seen:
    """Return the observation of five numbers: pusher x, y, and x, y, yaw of T."""
    x, y, block_x, block_y, yaw = observation
    return Seen((x, y), body_pose(Pose2(block_x, block_y, yaw)))


def act(observed: Seen, state: State) -> tuple[Point, State]:
    """Return the next action [px] and state."""
    pusher = Pusher(observed.pusher, state.velocity)
    state = _planned(observed, state)
    target, state = _target(observed, pusher, state)
    x, y = pusher.action_to(target)
    action = (min(max(x, 0.0), WORLD), min(max(y, 0.0), WORLD))
    return action, replace(state, velocity=pusher.after(action).velocity)


def _planned(observed: Seen, state: State) -> State:
    """Return the state with a plan that leads to the goal."""
    plan = state.plan
    if plan:
        plan = steered(observed.X_WB, plan)
        if plan[0].length < DONE:
            plan = plan[1:]
            same = bool(plan) and plan[0].face == state.plan[0].face
            state = replace(state, touching=state.touching and same)
            if len(plan) == 1 and plan[0].length > HALVED:
                plan = halved(plan)
    mended = miss(final_pose(observed.X_WB, plan)) < LOST
    if plan and mended and admissible(observed.X_WB, plan):
        return replace(state, plan=plan)
    plan = best_plan(observed.X_WB, observed.pusher)
    plan = halved(plan)
    return replace(state, plan=plan, touching=False, plans=state.plans + 1)


def _target(observed: Seen, pusher: Pusher, state: State) -> tuple[Point, State]:
    """Return where the pusher shall be after this action."""
    push = state.plan[0]
    X_WB = observed.X_WB
    if not state.touching:
        begin = X_WB.apply(push.pushed.pusher(push.left, OFF_FACE))
        near = math.dist(observed.pusher, begin) < ARRIVED
        if not (near and math.hypot(*pusher.velocity) < SLOW):
            return _on_way(X_WB, pusher, begin), state
        state = replace(state, touching=True)
    place = push.pushed.place(X_WB.unapply(observed.pusher))
    off = push.left - place
    if abs(off) > SLIDE:
        slid = place + math.copysign(SLIDE, off)
        return X_WB.apply(push.pushed.pusher(slid, 0.5)), state
    return stroke(X_WB, pusher, push), state


def _on_way(X_WB: Pose2, pusher: Pusher, goal: Point) -> Point:
    """Return where the pusher shall be after one action of a way round the T."""
    way = free_way(X_WB, pusher.position, goal)
    if not way:
        return goal
    for step in WAY_STEPS:
        target = _along((pusher.position, *way), step)
        if _clear(X_WB, pusher, target):
            break
    return target


def _along(way: tuple[Point, ...], length: float) -> Point:
    """Return the point [px] of a way at a length from its start, or its end."""
    for a, b in zip(way, way[1:], strict=False):
        piece = math.dist(a, b)
        if piece >= length:
            part = length / piece
            return (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]))
        length -= piece
    return way[-1]


def _clear(X_WB: Pose2, pusher: Pusher, target: Point) -> bool:
    """Return whether the pusher stays off the T on its way to ``target``."""
    from pushpressslide.studies.pusht.tee import BODY, CENTER

    action = pusher.action_to(target)
    begun = PUSHER_RADIUS + 0.5
    for moved in pusher.periods(action):
        x, y = X_WB.unapply(moved.position)
        if BODY.shape.distance((x + CENTER[0], y + CENTER[1])) < begun:
            return False
    return True
