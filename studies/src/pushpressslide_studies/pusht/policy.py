"""The policy: from observations at 10 Hz to targets of the pusher.

The caller keeps the policy's state. If there is no plan, the policy makes one. The
pusher then moves around the T to the first contact and pushes. At each action the rest
of the plan is corrected so that it leads from the observed pose of the T to the goal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from pushpressslide.core.pose import Point, Pose2
from pushpressslide_studies.pusht.approach import arrived, on_way
from pushpressslide_studies.pusht.plans import NO_PLAN, Plan, best_plan, intrusion
from pushpressslide_studies.pusht.pushes import Push, final_pose
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.steering import halved, miss, miss_between, steered
from pushpressslide_studies.pusht.stroke import stroke
from pushpressslide_studies.pusht.tee import WORLD, body_pose

SLIDE = 14.0  # [px] along a face in one action
SLIDE_GAP = 0.5  # [px] off the face meanwhile
DONE = 0.5  # [px] of a push that is left
HALVED = 5.0  # [px] of the last push, above which it is steered in two halves
LOST = 4.0  # [px] of a miss that steering cannot mend
GIVE = 2.0  # [px] that a correction may bring the T nearer to a wall than planned
STILL = 0.2  # [px] of a T that has not moved
PATIENT = 2  # actions without a motion, after which any success is taken
STALLED = 8  # actions without a motion, after which another plan is made


@dataclass(frozen=True, slots=True)
class Observation:
    """Observed poses, in W."""

    pusher: Point  # [px]
    X_WB: Pose2


def observation(values: Sequence[float]) -> Observation:
    """Observation from the package's values: pusher x, y [px]; x, y [px] and yaw [rad]
    of the T.
    """
    x, y, block_x, block_y, yaw = values
    return Observation((x, y), body_pose(Pose2(block_x, block_y, yaw)))


@dataclass(frozen=True, slots=True)
class State:
    """State of the policy between two actions."""

    velocity: Point = (0.0, 0.0)  # [px/s] of the pusher
    plan: Plan = NO_PLAN
    touching: bool = False  # whether the first push has begun
    X_WB: Pose2 | None = None  # where the T was seen last
    stalled: int = 0  # actions of a push, the last ones, that have not moved the T
    plans: int = 0  # made up to now


def act(observed: Observation, state: State) -> tuple[Point, State]:
    """Next action [px] and next state."""
    pusher = Pusher(observed.pusher, state.velocity)
    state = _planned(observed, _progressed(observed.X_WB, state))
    state = _touched(observed.X_WB, pusher, state)
    x, y = pusher.action_to(_target(observed.X_WB, pusher, state))
    action = (min(max(x, 0.0), WORLD), min(max(y, 0.0), WORLD))
    return action, replace(state, velocity=pusher.after(action).velocity)


def _progressed(X_WB: Pose2, state: State) -> State:
    """State after the T has moved since the last action: the first push is shortened."""
    before = state.X_WB
    state = replace(state, X_WB=X_WB)
    if before is None or not (state.plan.pushes and state.touching):
        return state
    first, *rest = state.plan.pushes
    nx, ny = before.rotate(first.pushed.normal)
    advance = (X_WB.x - before.x) * nx + (X_WB.y - before.y) * ny
    shorter = replace(first, length=max(first.length - advance, 0.0))
    plan = replace(state.plan, pushes=(shorter, *rest))
    moved = miss_between(before, X_WB) > STILL
    return replace(state, plan=plan, stalled=0 if moved else state.stalled + 1)


def _planned(observed: Observation, state: State) -> State:
    """State with a new plan that leads to the goal."""
    rest = _rest(observed.X_WB, state.plan)
    if rest and state.stalled < STALLED:
        same = rest[0].face == state.plan.pushes[0].face
        plan = replace(state.plan, pushes=rest)
        return replace(state, plan=plan, touching=state.touching and same)
    plan = best_plan(observed.X_WB, observed.pusher)
    if plan.pushes:
        plan = replace(plan, pushes=halved(plan.pushes))
    return replace(state, plan=plan, touching=False, stalled=0, plans=state.plans + 1)


def _rest(X_WB: Pose2, plan: Plan) -> tuple[Push, ...]:
    """Remaining pushes, corrected so that they lead to the goal. Empty if this is
    impossible.
    """
    pushes = plan.pushes
    if pushes and pushes[0].length < DONE:
        pushes = pushes[1:]
    if not pushes:
        return ()
    if len(pushes) == 1 and pushes[0].length > HALVED:
        pushes = halved(pushes)
    pushes = steered(X_WB, pushes)
    if miss(final_pose(X_WB, pushes)) > LOST:
        return ()
    if intrusion(X_WB, pushes) > plan.intrusion + GIVE:
        return ()
    return pushes


def _touched(X_WB: Pose2, pusher: Pusher, state: State) -> State:
    """State, with the first push started if the pusher has arrived before its contact."""
    if state.touching or not state.plan.pushes:
        return state
    return replace(state, touching=arrived(X_WB, pusher, state.plan.pushes[0]))


def _target(X_WB: Pose2, pusher: Pusher, state: State) -> Point:
    """Target of the pusher for this action. If there is no plan, the pusher waits."""
    if not state.plan.pushes:
        return pusher.position
    push = state.plan.pushes[0]
    if not state.touching:
        return on_way(X_WB, pusher, push)
    place = push.pushed.place(X_WB.unapply(pusher.position))
    off = push.left - place
    if abs(off) > SLIDE:
        beside = place + math.copysign(SLIDE, off)
        return X_WB.apply(push.pushed.pusher(beside, SLIDE_GAP))
    return stroke(X_WB, pusher, push, hasty=state.stalled > PATIENT)
