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
from pushpressslide.studies.pusht.steering import halved, miss, miss_between, steered
from pushpressslide.studies.pusht.stroke import stroke
from pushpressslide.studies.pusht.tee import PUSHER_RADIUS, WORLD, body_pose

OFF_FACE = 2.0  # [px] between pusher and face before a push
ARRIVED = 3.0  # [px] from there
SLOW = 80.0  # [px/s] of a pusher that has arrived
DONE = 0.5  # [px] of a push that is left
HALVED = 5.0  # [px] of the last push, above which it is steered in two halves
STILL = 0.2  # [px] of a T that has not moved
PATIENT = 2  # actions without a motion, after which any success is taken
STALLED = 8  # actions without a motion, after which another plan is made
LOST = 4.0  # [px] of a miss that steering cannot mend
SLIDE = 14.0  # [px] along a face in one action
WAY_STEPS = (45.0, 30.0, 18.0, 10.0, 5.0)  # [px] along a way in one action


@dataclass(frozen=True, slots=True)
class State:
    """What the policy remembers from one action to the next."""

    velocity: Point = (0.0, 0.0)  # [px/s] of the pusher
    plan: tuple[Push, ...] = ()
    touching: bool = False  # whether the first push has begun
    X_WB: Pose2 | None = None  # where the T was seen last
    plans: int = 0  # made up to now
    stalled: int = 0  # actions in a push that have not moved the T


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
    state = _progressed(observed.X_WB, state)
    plan = _rest(observed.X_WB, state.plan)
    if plan and state.stalled < STALLED:
        same = plan[0].face == state.plan[0].face
        return replace(state, plan=plan, touching=state.touching and same)
    plan = halved(best_plan(observed.X_WB, observed.pusher))
    return replace(
        state, plan=plan, touching=False, plans=state.plans + 1, stalled=0
    )


def _progressed(X_WB: Pose2, state: State) -> State:
    """Return the state after what the first push has moved the T since last time."""
    before = state.X_WB
    state = replace(state, X_WB=X_WB)
    if before is None or not (state.plan and state.touching):
        return state
    first, *rest = state.plan
    x, y = before.rotate(first.pushed.normal)
    advance = (X_WB.x - before.x) * x + (X_WB.y - before.y) * y
    moved = miss_between(before, X_WB) > STILL
    stalled = 0 if moved else state.stalled + 1
    shorter = replace(first, length=max(first.length - advance, 0.0))
    return replace(state, plan=(shorter, *rest), stalled=stalled)


def _rest(X_WB: Pose2, plan: tuple[Push, ...]) -> tuple[Push, ...]:
    """Return what is left of a plan, steered to the goal; empty if it does not lead
    there.
    """
    if plan and plan[0].length < DONE:
        plan = plan[1:]
    if not plan:
        return ()
    if len(plan) == 1 and plan[0].length > HALVED:
        plan = halved(plan)
    plan = steered(X_WB, plan)
    mended = miss(final_pose(X_WB, plan)) < LOST
    return plan if mended and admissible(X_WB, plan) else ()


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
    return stroke(X_WB, pusher, push, state.stalled > PATIENT), state


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
