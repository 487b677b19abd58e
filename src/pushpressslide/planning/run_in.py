"""Paths that end with a straight run-in, on which errors decay."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core import margins
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.pose import Pose2
from pushpressslide.planning.dubins import candidates, shortest_path


def with_run_in(
    ends: tuple[Pose2, Pose2],
    left: float,
    right: float,
    run_in: float,
    turning: float | None = None,
) -> ArcPath:
    """Shortest path that ends with a straight line of ``run_in`` [m] and whose
    curvature [1/m] is between -right and left.

    Paths with a total turn of ``turning`` [rad], to within half a turn, have priority:
    an arm whose plan turns one way cannot follow a path that turns the other way.
    """
    start, goal = ends
    staging = advance(goal, 0.0, -run_in)
    path = shortest_path(start, staging, left, right)
    if turning is not None and abs(path.turning - turning) > math.pi:
        others = (other for _, other in candidates(start, staging, left, right))
        alike = (p for p in others if abs(p.turning - turning) <= math.pi)
        path = next(alike, path)
    return ArcPath(
        start,
        tuple(
            segment for segment in (*path.sections, (0.0, run_in)) if segment[1] > 0.0
        ),
    )


def longest_way(radius: float, direct: float) -> float:
    """Largest length [m] of a path without a loop, for an object of ``radius`` [m] that
    is ``direct`` [m] from its goal.
    """
    return margins.LOOP_RATIO * direct + margins.LOOP_SLACK * radius


def loop_free_length(start: Pose2, goal: Pose2, curvature: float) -> float:
    """Length [m] above which a path with curvatures up to ``curvature`` [1/m] is taken
    to contain a loop.
    """
    return 1.15 * math.hypot(goal.x - start.x, goal.y - start.y) + 1.0 / curvature


def gentlest(
    ends: tuple[Pose2, Pose2],
    curvatures: Sequence[float],
    run_ins: Sequence[float],
    longest: float | None = None,
    turning: float | None = None,
) -> tuple[float, float, ArcPath]:
    """Run-in [m], curvature [1/m] and path of the gentlest turns and the longest run-in
    that fit.

    ``curvatures`` [1/m] are sorted with the gentlest first, ``run_ins`` [m] with the
    longest first. ``longest`` [m] limits the length (default: ``loop_free_length`` of
    the curvature). If nothing fits, the shortest path is returned. ``turning`` [rad] is
    as in ``with_run_in``.
    """
    tightest = curvatures[-1]
    lower = run_ins[-1]
    # tighter turns and a shorter run-in can do all that the others can: none is shorter
    shortest = with_run_in(ends, tightest, tightest, lower, turning)
    if shortest.length > _max_length(ends, curvatures[0], longest):
        return lower, tightest, shortest
    for curvature in curvatures:
        upper = _max_length(ends, curvature, longest)
        if with_run_in(ends, curvature, curvature, lower, turning).length > upper:
            continue
        for run_in in run_ins:
            path = with_run_in(ends, curvature, curvature, run_in, turning)
            if path.length <= upper:
                return run_in, curvature, path
    return lower, tightest, shortest


def _max_length(
    ends: tuple[Pose2, Pose2], curvature: float, longest: float | None
) -> float:
    """Largest length [m] of a path of a curvature [1/m]."""
    return loop_free_length(*ends, curvature) if longest is None else longest
