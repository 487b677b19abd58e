"""Reach of robots from kinematics alone, quick enough to be checked when a task is
loaded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics
from pushpressslide.robots.inverse import (
    STRUCTURED_SEEDS,
    IkSearch,
    IkSolution,
    default_seeds,
    solve_ik,
)
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import UPRIGHT, ToolAttitude

REACH_MARGIN = 0.02
"""Smallest distance [rad] of every joint from its limits at a point that counts as
within reach.
"""

QUICK_SEEDS = [0, 1, 2, 3, 6]
"""Indices of the structured starts of ``default_seeds`` used in a quick search: the
home posture turned, other wrists, other elbows.
"""

QUICK = IkSearch(iterations=30)
# [m] shortfall of the first search above which there is no second one
HOPELESS = 0.08
# [m] distance from full stretch above which the first search is not reliable
FOLDED = 0.2
FIRST_SEEDS = [0, 3, 6]
# first search for a point, which succeeds for most points within reach
FIRST = IkSearch(iterations=12, first_found=True)
LONG_SEARCHES = 8  # points at most; bounds the time for a task that is hopeless


@dataclass(frozen=True)
class Reach:
    """Reach of a robot for m points."""

    ok: NDArray[np.bool_]  # (m,)
    # (m,) [rad] the best that was found; of no meaning where not ok
    joint_margin: Array
    miss: Array  # (m,) [m] distance by which the tip stays short of the point
    q: Array  # (m, n) posture of that margin

    def replaced(self, rows: NDArray[np.intp], other: Reach) -> Reach:
        """Copy in which the elements at ``rows`` are replaced, in order, by the
        elements of ``other``.
        """
        ok = self.ok.copy()
        joint_margin = self.joint_margin.copy()
        miss = self.miss.copy()
        q = self.q.copy()
        ok[rows] = other.ok
        joint_margin[rows] = other.joint_margin
        miss[rows] = other.miss
        q[rows] = other.q
        return Reach(ok, joint_margin, miss, q)


def reachable(
    kin: ArmKinematics,
    points: Array,
    attitude: ToolAttitude = UPRIGHT,
    tool_yaw: Array | float | None = None,
    joint_margin: float = 0.0,
    *,
    quick: bool = False,
) -> Reach:
    """Reach of points (m, 3) [m] by the tip's centre at a given tool attitude, with
    ``joint_margin`` [rad].

    ``tool_yaw`` [rad] is a scalar or (m,); None leaves it free. The search starts from
    the home posture and its neighbours, so that postures folded over backwards do not
    count. Unless ``quick``, the points that a quick search misses by the least are
    searched again more thoroughly.
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
        QUICK,
    )
    missed = np.flatnonzero(~first.converged)
    if quick or len(missed) == 0:
        return _reach(first)
    miss = first.position_residual[missed] + first.angle_residual[missed]
    doubtful = missed[np.argsort(miss)][:LONG_SEARCHES]
    if tool_yaw is not None and np.ndim(tool_yaw) > 0:
        tool_yaw = np.asarray(tool_yaw)[doubtful]
    full = solve_ik(kin, p[doubtful], attitude, tool_yaw, seeds[doubtful], joint_margin)
    return _reach(first).replaced(doubtful, _reach(full))


def first_look(
    kin: ArmKinematics,
    p: Array,
    targets: ToolAttitude | Array,
    joint_margin: float = REACH_MARGIN,
) -> Reach:
    """Reach of points (m, 3) [m] by a short search, which finds most reachable points.

    Any posture that keeps ``joint_margin`` [rad] counts. ``targets`` is one attitude,
    tool axes (m, 3), or rotations (m, 3, 3).
    """
    starts = default_seeds(kin, p)[:, FIRST_SEEDS]
    return _reach(solve_ik(kin, p, targets, None, starts, joint_margin, FIRST))


def _reach(solution: IkSolution) -> Reach:
    return Reach(
        solution.converged,
        solution.joint_margin,
        solution.position_residual,
        solution.q,
    )


def held_somehow_problem(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    holds: Sequence[tuple[ToolAttitude, Array | None]],
) -> str | None:
    """Reason in one line why no attitude brings a tip's centre to all m points [m], or
    None.

    Each of ``holds`` is an attitude with tool yaws (m,) [rad], or None for any yaw. The
    hardest points are checked first: both ends, the point nearest to the base's axis
    and the farthest point. If the first hold misses one of these, all other holds are
    tried there at once. A long search follows only if a short search finds no hold.
    """
    kin = arm_kinematics(robot)
    p = np.array(points, dtype=np.float64).reshape(-1, 3)
    far = np.hypot(p[:, 0] - robot.base[0], p[:, 1] - robot.base[1])
    hardest = sorted({0, len(p) - 1, int(np.argmin(far)), int(np.argmax(far))})
    along = _PathReach(kin, p, hardest)
    first = _tool_targets(*holds[0], len(p))
    places, found = along.first_search(first)
    if found.ok.all():
        return None
    others = sorted((_tool_targets(*hold, len(p)) for hold in holds[1:]), key=np.ndim)
    near = [one for one in (first, *others) if (along.short(one) <= 0.0).all()]
    if near:
        worst = places[_worst(found)]
        solved, reachable = _some_hold(along, near, worst)
        if solved:
            return None
        # where it was thought worst it will do after all
        if near[0] is first and reachable.ok[0]:
            found = _retried(kin, p[places], first[places], found)
    return _problem(kin, robot, [points[i] for i in places], found, REACH_MARGIN)


@dataclass(frozen=True)
class _PathReach:
    """Points that one arm has to reach, in any tool attitude."""

    kin: ArmKinematics
    p: Array  # (m, 3) [m]
    hardest: list[int]  # indices of the points that are searched first

    def short(self, targets: Array) -> Array:
        """Shortfall [m], as in ``short_by``, at the hardest points."""
        return short_by(self.kin, self.p[self.hardest], targets[self.hardest])

    def first_search(self, targets: Array) -> tuple[list[int], Reach]:
        """Checked points, and the reach found for them.

        All points are checked, unless one of the hardest fails.
        """
        short = self.short(targets)
        postures = np.zeros((len(self.hardest), self.kin.facts.size))
        found = Reach(short <= 0.0, np.zeros_like(short), short, postures)
        if found.ok.all():
            found = self._look(targets)
        if not found.ok.all():
            return self.hardest, found
        everywhere = _all_along(self.kin, self.p, targets, self.hardest, found)
        return list(range(len(self.p))), everywhere

    def reached(self, targets: Array, *, patient: bool = False) -> bool:
        """Whether all points are reached. With ``patient``, the hardest points are
        searched a second time if the first search fails.
        """
        found = self._look(targets)
        if patient:
            hardest = self.hardest
            found = _retried(self.kin, self.p[hardest], targets[hardest], found)
        if not found.ok.all():
            return False
        everywhere = _all_along(self.kin, self.p, targets, self.hardest, found)
        return bool(everywhere.ok.all())

    def _look(self, targets: Array) -> Reach:
        return first_look(self.kin, self.p[self.hardest], targets[self.hardest])


def _some_hold(along: _PathReach, holds: list[Array], worst: int) -> tuple[bool, Reach]:
    """Whether one of ``holds`` reaches all points, and the reach of the ``worst`` point
    with each hold.

    Holds that miss the worst point are not tried at the other points. If no hold
    succeeds, the search is repeated with more patience.
    """
    kin = along.kin
    axes = np.array([_axes(held)[worst] for held in holds])
    there = np.tile(along.p[worst], (len(holds), 1))
    reachable = first_look(kin, there, axes)
    if any(along.reached(holds[i]) for i in np.flatnonzero(reachable.ok)):
        return True, reachable
    reachable = _retried(kin, there, axes, reachable, each=True)
    reached = any(
        along.reached(holds[i], patient=True) for i in np.flatnonzero(reachable.ok)
    )
    return reached, reachable


def _tool_targets(hold: ToolAttitude, yaws: Array | None, count: int) -> Array:
    """Tool axes (count, 3) if any yaw is allowed, or rotations (count, 3, 3) for given
    ``yaws``.
    """
    if yaws is None:
        return np.broadcast_to(hold.axis, (count, 3))
    return hold.rotation(yaws)


def _axes(targets: Array) -> Array:
    if targets.ndim == 2:
        return targets
    axes: Array = targets[..., 2]
    return axes


def _worst(reach: Reach) -> int:
    return int(np.argmax(np.where(reach.ok, -1.0, reach.miss)))


def short_by(kin: ArmKinematics, p: Array, targets: Array) -> Array:
    """Distances (m,) [m] of points (m, 3) beyond the span of the stretched links.
    Negative within the span.
    """
    shoulder, wrist, span = kin.span
    out: Array = np.linalg.norm(p - wrist * _axes(targets) - shoulder, axis=-1) - span
    return out


def _all_along(
    kin: ArmKinematics, p: Array, targets: Array, known: Sequence[int], there: Reach
) -> Reach:
    """Reach of all points ``p``.

    The search starts from the postures ``there``, which were already found at the
    points ``known``.
    """
    nearest = np.linalg.norm(p[:, None] - p[known], axis=-1).argmin(axis=1)
    starts = there.q[nearest][:, None]
    found = _reach(solve_ik(kin, p, targets, None, starts, REACH_MARGIN, FIRST))
    return _retried(kin, p, targets, found)


def _retried(
    kin: ArmKinematics, p: Array, targets: Array, reach: Reach, *, each: bool = False
) -> Reach:
    """Reach after another search for the failed points, now with the joints kept away
    from their limits.

    Hopeless points, such as points beyond the span of the stretched links, are not
    searched. If there is one, no other point is searched either, except with ``each``.
    """
    short = short_by(kin, p, targets)
    near = (short <= 0.0) & ((reach.miss < HOPELESS) | (short < -FOLDED))
    again = np.flatnonzero(~reach.ok & near)
    if len(again) and (each or near[~reach.ok].all()):
        starts = default_seeds(kin, p[again])[:, :STRUCTURED_SEEDS]
        better = _reach(
            solve_ik(kin, p[again], targets[again], None, starts, REACH_MARGIN)
        )
        return reach.replaced(again, better)
    return reach


def _problem(
    kin: ArmKinematics,
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    reach: Reach,
    joint_margin: float,
) -> str:
    worst = _worst(reach)
    x, y, z = (float(v) for v in points[worst])
    far = float(np.hypot(x - robot.base[0], y - robot.base[1]))
    missed = int((~reach.ok).sum())
    return (
        f"{kin.facts.name} cannot bring its tip to ({x:.3f}, {y:.3f}, {z:.3f}), "
        f"{far:.3f} m from its base's "
        f"axis, with joints {joint_margin:g} rad inside their limits "
        f"({missed} of {len(points)} points out of reach)"
    )
