"""Can the robots get there: a check by kinematics alone, quick enough for the loading of a task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.task import Robot
from pushpressslide.robots.inverse import STRUCTURED_SEEDS, IkSolution, default_seeds, solve_ik
from pushpressslide.robots.kinematics import ArmKinematics, arm_kinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

Array = NDArray[np.float64]

REACH_MARGIN = 0.05
"""[rad] that every joint keeps from its limits for a point to count as within reach."""

QUICK_SEEDS = [0, 1, 2, 3, 6]
"""Of the structured starts of ``default_seeds``: the home posture turned, other wrists, other elbows."""

QUICK_ITERATIONS = 30
HOPELESS = 0.08  # [m] by which the tip may stay short, besides its tool's length, for a tilt to be tried
LONG_SEARCHES = 8  # points at most; bounds the time for a task that is hopeless


@dataclass(frozen=True)
class Reach:
    """What a robot reaches of m points."""

    ok: NDArray[np.bool_]  # (m,)
    joint_margin: Array  # (m,) [rad] the best that was found; of no meaning where not ok
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
    """Return which points (m, 3) [m] the tip's centre reaches, the tool so held, with ``joint_margin`` [rad].

    tool_yaw: [rad], scalar or (m,); None leaves it free. Searched from the home posture and its neighbours,
    so that the arm folded over backwards does not count. Of the points that a quick search misses the nearest
    are searched at length, unless ``quick``.
    """
    p = np.atleast_2d(np.asarray(points, dtype=np.float64))
    seeds = default_seeds(kin, p)[:, :STRUCTURED_SEEDS]
    first = solve_ik(kin, p, attitude, tool_yaw, seeds[:, QUICK_SEEDS], joint_margin, QUICK_ITERATIONS)
    missed = np.flatnonzero(~first.converged)
    if quick or len(missed) == 0:
        return _reach(first)
    doubtful = missed[np.argsort(first.position_residual[missed] + first.angle_residual[missed])][
        :LONG_SEARCHES
    ]
    yaw = tool_yaw if tool_yaw is None or np.ndim(tool_yaw) == 0 else np.asarray(tool_yaw)[doubtful]
    full = solve_ik(kin, p[doubtful], attitude, yaw, seeds[doubtful], joint_margin)
    fields = (first.q, first.position_residual, first.angle_residual, first.joint_margin, first.converged)
    better = (full.q, full.position_residual, full.angle_residual, full.joint_margin, full.converged)
    for old, new in zip(fields, better, strict=True):
        old[doubtful] = new
    return _reach(first)


def _reach(solution: IkSolution) -> Reach:
    return Reach(solution.converged, solution.joint_margin, solution.position_residual, solution.q)


def reach_problem(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    attitude: ToolAttitude = UPRIGHT,
    joint_margin: float = REACH_MARGIN,
) -> str | None:
    """Return in one line why a robot cannot bring its tip's centre to all points [m], tool so held; or None.

    Raises PushPressSlideError for a model that cannot be read.
    """
    kin = arm_kinematics(robot)
    found = reachable(kin, np.array(points, dtype=np.float64).reshape(-1, 3), attitude, None, joint_margin)
    return None if found.ok.all() else _problem(kin, robot, points, found, joint_margin)


def held_somehow_problem(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    holds: Sequence[tuple[ToolAttitude, Array | None]],
) -> str | None:
    """Return in one line why a robot cannot bring its tip's centre to all m points [m] with the tool held in
    any one of ``holds``, attitudes with tool yaws (m,) [rad] or None for any; or None.

    The places hardest to reach are looked at first: both ends, the nearest to the base's axis and the
    farthest.
    """
    kin = arm_kinematics(robot)
    p = np.array(points, dtype=np.float64).reshape(-1, 3)
    far = np.hypot(p[:, 0] - robot.base[0], p[:, 1] - robot.base[1])
    hardest = sorted({0, len(p) - 1, int(np.argmin(far)), int(np.argmax(far))})
    problem = None
    for attitude, yaws in holds:
        there = None if yaws is None else yaws[hardest]
        found = reachable(kin, p[hardest], attitude, there, REACH_MARGIN, quick=yaws is not None)
        if not found.ok.all():
            problem = problem or _problem(kin, robot, [points[i] for i in hardest], found, REACH_MARGIN)
            if attitude.tilt == 0.0 and found.miss.max() > robot.tip_length + HOPELESS:
                break  # no tilt makes up for that
            continue
        found = reachable(kin, p, attitude, yaws, REACH_MARGIN)
        if found.ok.all():
            return None
        problem = problem or _problem(kin, robot, points, found, REACH_MARGIN)
    return problem


def _problem(
    kin: ArmKinematics,
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    found: Reach,
    joint_margin: float,
) -> str:
    worst = int(np.argmax(np.where(found.ok, -1.0, found.miss)))
    x, y, z = (float(v) for v in points[worst])
    far = float(np.hypot(x - robot.base[0], y - robot.base[1]))
    missed = int((~found.ok).sum())
    return (
        f"{kin.facts.name} cannot bring its tip to ({x:.3f}, {y:.3f}, {z:.3f}), {far:.3f} m from its base's "
        f"axis, with joints {joint_margin:g} rad inside their limits "
        f"({missed} of {len(points)} points out of reach)"
    )
