"""Can the robots get there: a check by kinematics alone, quick enough for the loading
of a task.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.robots.inverse import (
    STRUCTURED_SEEDS,
    IkSolution,
    default_seeds,
    solve_ik,
)
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

REACH_MARGIN = 0.02
"""[rad] that every joint keeps from its limits for a point to count as within reach."""

QUICK_SEEDS = [0, 1, 2, 3, 6]
"""Of the structured starts of ``default_seeds``: the home posture turned, other wrists,
other elbows.
"""

QUICK_ITERATIONS = 30
# [m] by which the first look stays short of a point for which there is no second one
HOPELESS = 0.08
# [m] that an arm is less than stretched, beyond which the first look tells little
FOLDED = 0.2
FIRST_SEEDS = [0, 3, 6]
FIRST_ITERATIONS = 12  # of the first look at a point, which most within reach pass
LONG_SEARCHES = 8  # points at most; bounds the time for a task that is hopeless


@dataclass(frozen=True)
class Reach:
    """What a robot reaches of m points."""

    ok: NDArray[np.bool_]  # (m,)
    # (m,) [rad] the best that was found; of no meaning where not ok
    joint_margin: Array
    miss: Array  # (m,) [m] distance by which the tip stays short of the point
    q: Array  # (m, n) posture of that margin


def reachable(
    kin: ArmKinematics,
    points: Array,
    attitude: ToolAttitude = UPRIGHT,
    tool_yaw: Array | float | None = None,
    joint_margin: float = 0.0,
    *,
    quick: bool = False,
) -> Reach:
    """Return which points (m, 3) [m] the tip's centre reaches, the tool so held, with
    ``joint_margin`` [rad].

    tool_yaw: [rad], scalar or (m,); None leaves it free. Searched from the home posture
    and its neighbours, so that the arm folded over backwards does not count. Of the
    points that a quick search misses the nearest are searched at length, unless
    ``quick``.
    """
    p = np.atleast_2d(np.asarray(points, dtype=np.float64))
    seeds = default_seeds(kin, p)[:, :STRUCTURED_SEEDS]
    first = solve_ik(
        kin,
        p,
        attitude,
        tool_yaw,
        seeds[:, QUICK_SEEDS],
        joint_margin,
        QUICK_ITERATIONS,
    )
    missed = np.flatnonzero(~first.converged)
    if quick or len(missed) == 0:
        return _reach(first)
    doubtful = missed[
        np.argsort(first.position_residual[missed] + first.angle_residual[missed])
    ][:LONG_SEARCHES]
    yaw = (
        tool_yaw
        if tool_yaw is None or np.ndim(tool_yaw) == 0
        else np.asarray(tool_yaw)[doubtful]
    )
    full = solve_ik(kin, p[doubtful], attitude, yaw, seeds[doubtful], joint_margin)
    fields = (
        first.q,
        first.position_residual,
        first.angle_residual,
        first.joint_margin,
        first.converged,
    )
    better = (
        full.q,
        full.position_residual,
        full.angle_residual,
        full.joint_margin,
        full.converged,
    )
    for old, new in zip(fields, better, strict=True):
        old[doubtful] = new
    return _reach(first)


def _reach(solution: IkSolution) -> Reach:
    return Reach(
        solution.converged,
        solution.joint_margin,
        solution.position_residual,
        solution.q,
    )


def reach_problem(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    attitude: ToolAttitude = UPRIGHT,
    joint_margin: float = REACH_MARGIN,
) -> str | None:
    """Return in one line why a robot cannot bring its tip's centre to all points [m],
    tool so held; or None.

    Raises PushPressSlideError for a model that cannot be read.
    """
    kin = arm_kinematics(robot)
    found = reachable(
        kin,
        np.array(points, dtype=np.float64).reshape(-1, 3),
        attitude,
        None,
        joint_margin,
    )
    return None if found.ok.all() else _problem(kin, robot, points, found, joint_margin)


def held_somehow_problem(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    holds: Sequence[tuple[ToolAttitude, Array | None]],
) -> str | None:
    """Return in one line why a robot cannot bring its tip's centre to all m points [m]
    with the tool held in any one of ``holds``, attitudes with tool yaws (m,) [rad] or
    None for any; or None.

    The places hardest to reach are looked at first: both ends, the nearest to the
    base's axis and the farthest. Where the first hold misses one of them, all others
    are tried there at once; there is a long search only where a first look has found no
    hold that will do.
    """
    kin = arm_kinematics(robot)
    p = np.array(points, dtype=np.float64).reshape(-1, 3)
    far = np.hypot(p[:, 0] - robot.base[0], p[:, 1] - robot.base[1])
    hardest = sorted({0, len(p) - 1, int(np.argmin(far)), int(np.argmax(far))})
    first = _held(*holds[0], len(p))
    places = hardest
    short = _short(kin, p[hardest], first[hardest])
    found = Reach(
        short <= 0.0,
        np.zeros_like(short),
        short,
        np.zeros((len(hardest), kin.facts.size)),
    )
    if found.ok.all():
        found = _look(kin, p[hardest], first[hardest])
    if found.ok.all():
        found = _all_along(kin, p, first, hardest, found)
        places = list(range(len(p)))
        if found.ok.all():
            return None
    worst = places[_worst(found)]
    others = sorted((_held(*hold, len(p)) for hold in holds[1:]), key=np.ndim)
    held = [
        one
        for one in (first, *others)
        if (_short(kin, p[hardest], one[hardest]) <= 0.0).all()
    ]
    if not held:
        return _problem(kin, robot, [points[i] for i in places], found, REACH_MARGIN)
    axes = np.array([_axes(one)[worst] for one in held])
    there = np.tile(p[worst], (len(held), 1))
    able = _look(kin, there, axes)
    for patient in (False, True):
        if patient:
            able = _retried(kin, there, axes, able, each=True)
        for one in (one for one, ok in zip(held, able.ok, strict=True) if ok):
            seen = _look(kin, p[hardest], one[hardest])
            if patient:
                seen = _retried(kin, p[hardest], one[hardest], seen)
            if seen.ok.all() and _all_along(kin, p, one, hardest, seen).ok.all():
                return None
    # where it was thought worst it will do after all
    if held[0] is first and able.ok[0]:
        found = _retried(kin, p[places], first[places], found)
    return _problem(kin, robot, [points[i] for i in places], found, REACH_MARGIN)


def _held(hold: ToolAttitude, yaws: Array | None, count: int) -> Array:
    """Return the tool's axes (count, 3) for any yaw, or with ``yaws`` its rotations
    (count, 3, 3).
    """
    return (
        np.broadcast_to(hold.axis, (count, 3)) if yaws is None else hold.rotation(yaws)
    )


def _axes(held: Array) -> Array:
    return held if held.ndim == 2 else held[..., 2]


def _worst(found: Reach) -> int:
    return int(np.argmax(np.where(found.ok, -1.0, found.miss)))


def _look(kin: ArmKinematics, p: Array, held: Array) -> Reach:
    """Return which points (m, 3) a first look finds reached, with tool axes (m, 3) or
    rotations (m, 3, 3).
    """
    starts = default_seeds(kin, p)[:, FIRST_SEEDS]
    return _reach(
        solve_ik(kin, p, held, None, starts, REACH_MARGIN, FIRST_ITERATIONS, False)
    )


def _short(kin: ArmKinematics, p: Array, held: Array) -> Array:
    """Return by how much [m] the stretched links are too short for points (m, 3), < 0
    within their span.
    """
    shoulder, wrist, span = kin.span
    out: Array = np.linalg.norm(p - wrist * _axes(held) - shoulder, axis=-1) - span
    return out


def _all_along(
    kin: ArmKinematics, p: Array, held: Array, known: Sequence[int], there: Reach
) -> Reach:
    """Return which points are reached, searched from the postures ``there`` at the
    points ``known``.
    """
    nearest = np.linalg.norm(p[:, None] - p[known], axis=-1).argmin(axis=1)
    starts = there.q[nearest][:, None]
    found = _reach(
        solve_ik(kin, p, held, None, starts, REACH_MARGIN, FIRST_ITERATIONS, False)
    )
    return _retried(kin, p, held, found)


def _retried(
    kin: ArmKinematics, p: Array, held: Array, found: Reach, *, each: bool = False
) -> Reach:
    """Return what was found, after another search, which keeps off the limits, for what
    failed but is not farther from the shoulder than the stretched links are long.
    ``each`` counts for itself; else no more is searched once one is hopeless.
    """
    short = _short(kin, p, held)
    near = (short <= 0.0) & ((found.miss < HOPELESS) | (short < -FOLDED))
    again = np.flatnonzero(~found.ok & near)
    if len(again) and (each or near[~found.ok].all()):
        starts = default_seeds(kin, p[again])[:, :STRUCTURED_SEEDS]
        better = _reach(
            solve_ik(kin, p[again], held[again], None, starts, REACH_MARGIN)
        )
        for old, new in (
            (found.q, better.q),
            (found.miss, better.miss),
            (found.ok, better.ok),
        ):
            old[again] = new
    return found


def _problem(
    kin: ArmKinematics,
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    found: Reach,
    joint_margin: float,
) -> str:
    worst = _worst(found)
    x, y, z = (float(v) for v in points[worst])
    far = float(np.hypot(x - robot.base[0], y - robot.base[1]))
    missed = int((~found.ok).sum())
    return (
        f"{kin.facts.name} cannot bring its tip to ({x:.3f}, {y:.3f}, {z:.3f}), "
        f"{far:.3f} m from its base's "
        f"axis, with joints {joint_margin:g} rad inside their limits "
        f"({missed} of {len(points)} points out of reach)"
    )
