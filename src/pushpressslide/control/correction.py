"""Re-planning on the way: a path from where the object really is costs microseconds, so
that errors need not be chased.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pushpressslide.core.control import TipState
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.identification.online import Identified
from pushpressslide.modes.base import Mode

SLID = 2.5e-3  # [m] of a contact along its face
OFF_PATH = 1e-3  # [m] of the tracking point from the path
OFF_HEADING = 0.0175  # [rad] of the heading from the path's; 1 degree
OFF_AXLE = 0.015  # [m] of the virtual axle from where the plan has it
ROOM = 0.02  # [m] of path that must be left
PAUSE = 0.4  # [s] between two re-plans
# times the way that is left: a longer plan has turned a loop and is not taken
DETOUR = 1.1
SLACK = 0.005  # [m] on top of that


def touched_points(
    plan: Plan, X_WB: Pose2, tips: tuple[TipState, ...]
) -> tuple[Point, ...]:
    """Return where the tips touch the object's surface, in B [m], by their own
    kinematics.

    On the line of its face, the circle of a round side, or the top: a tip's measured
    depth is not a slide.
    """
    out = []
    shape = plan.task.object.shape
    com = plan.task.object.center_of_mass
    for c in plan.choice.contacts:
        at = tips[c.arm].position
        p = X_WB.unapply((at[0], at[1]))
        if c.kind == "side":
            p = shape.side(c.point, c.normal, com).foot(p)
        out.append(p)
    return tuple(out)


def slide(plan: Plan, touched: tuple[Point, ...]) -> float:
    """Return how far the farthest contact has slid from where the plan has it [m]."""
    return max(
        math.dist(p, c.point)
        for p, c in zip(touched, plan.choice.contacts, strict=True)
    )


def side_slide(plan: Plan, touched: tuple[Point, ...]) -> float:
    """Return how far the farthest contact on a side face has slid from where the plan
    has it [m].
    """
    pairs = zip(touched, plan.choice.contacts, strict=True)
    return max(
        (math.dist(p, c.point) for p, c in pairs if c.kind == "side"), default=0.0
    )


def left_of(plan: Plan, progress: float) -> Plan:
    """Return a plan along arcs without the first ``progress`` [m] of its path; any
    other as it is.
    """
    path = plan.path
    if not isinstance(path, ArcPath):
        return plan
    return replace(plan, path=path.rest(min(max(progress, 0.0), path.length)))


def led_in(path: MotionPath, length: float) -> MotionPath:
    """Return ``path`` with ``length`` [m] put before its start."""
    if isinstance(path, ArcPath):
        return ArcPath(advance(path.start, 0.0, -length), ((0.0, length), *path.pieces))
    return path.led_in(length)


def corrected(
    mode: Mode,
    plan: Plan,
    X_WB: Pose2,
    touched: tuple[Point, ...],
    guidance: Guidance,
    left: float,
    since_last: float,
    identified: Identified | None = None,
) -> tuple[Plan, float, float] | None:
    """Return a better plan from here, with the progress [m] and the clock [s] to start
    it at speed; None if all is well.

    Made when a contact has slid or the tracking point is off the path, ``left`` [m]
    before the end, unless that would take a detour; or when the virtual axle is
    ``identified`` to be elsewhere.
    """
    _, across, heading = guidance.error
    off = (
        abs(across) > OFF_PATH
        or abs(heading) > OFF_HEADING
        or slide(plan, touched) > SLID
    )
    X = plan.X_BV
    planned = X.x * math.cos(X.yaw) + X.y * math.sin(X.yaw)
    moved = identified is not None and abs(identified.axle - planned) > OFF_AXLE
    if not (off or moved) or left < ROOM or since_last < PAUSE:
        return None
    longest = DETOUR * left + SLACK
    if moved and identified is not None:  # the path of another point has another length
        longest += 2.0 * abs(identified.axle - planned)
    fresh = mode.replan(
        left_of(plan, guidance.progress), X_WB, touched, longest, identified
    )
    if fresh is None:
        return None
    # at speed: the new path begins with the way on which its profile would have reached
    # it
    v = plan.profile.speed
    a = plan.profile.acceleration
    ramp = 0.5 * v * v / a
    path = led_in(fresh.path, ramp)
    return (
        replace(fresh, path=path, profile=SpeedProfile(path.length, v, a)),
        ramp,
        v / a,
    )
