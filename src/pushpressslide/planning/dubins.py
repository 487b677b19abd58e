"""Shortest forward paths between two poses for a car whose left and right curvature
limits may differ.

Dubins (1957) solved the problem for equal limits. For unequal limits the shortest path
is one of the same six words (Bakolas and Tsiotras, "Optimal synthesis of the asymmetric
sinistral/dextral Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011): LSL, RSR,
LSR, RSL, RLR, LRL. The solution is in closed form, in plain floats.
"""

from __future__ import annotations

import math
from typing import Literal

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.kernels.dubins import (
    NONE,
    Circles,
    Solution,
    dubins_solutions,
    shortest_solution,
    turning_circles,
)

Word = Literal["LSL", "RSR", "LSR", "RSL", "RLR", "LRL"]
WORDS: tuple[Word, ...] = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL")
"""The six words, in the order of the kernel's numbers."""


def _circles(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> Circles:
    """Turning circles of two poses. Raises ValueError as ``shortest_path`` does."""
    if not (0.0 < kappa_left < math.inf and 0.0 < kappa_right < math.inf):
        raise ValueError(
            f"curvature limits left {kappa_left}, right {kappa_right} 1/m; both "
            "must be finite and > 0"
        )
    X_WA = (start.x, start.y, start.yaw)
    X_WB = (goal.x, goal.y, goal.yaw)
    circles = turning_circles(X_WA, X_WB, kappa_left, kappa_right)
    if not math.isfinite(circles[4]):
        raise ValueError(f"start {start}, goal {goal}; must be finite")
    return circles


def _path(
    start: Pose2, solution: Solution, kappa_left: float, kappa_right: float
) -> ArcPath:
    _, word, *amounts = solution
    pieces = []
    for letter, amount in zip(WORDS[word], amounts, strict=True):
        if amount > 0.0:
            if letter == "S":
                pieces.append((0.0, amount))
            elif letter == "L":
                pieces.append((kappa_left, amount / kappa_left))
            else:
                pieces.append((-kappa_right, amount / kappa_right))
    return ArcPath(start, tuple(pieces))


def shortest_path(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> ArcPath:
    """Shortest path from ``start`` to ``goal`` whose curvature [1/m] is between
    -kappa_right and kappa_left.

    The path has at most three arcs of signed curvature, none of zero length, and no arc
    at all if the poses agree to within round-off. The final yaw equals that of the goal
    up to full turns. Of equally short words, the first of LSL, RSR, LSR, RSL, RLR, LRL
    is taken. Raises ValueError unless the poses are finite, and both limits are finite
    and > 0 (without a straight line there is no Dubins path).
    """
    best = shortest_solution(_circles(start, goal, kappa_left, kappa_right))
    return _path(start, best, kappa_left, kappa_right)


def candidates(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> list[tuple[Word, ArcPath]]:
    """All paths of the six words that join the poses, with their words, the shortest
    first.

    Words of three arcs occur twice, once for each position of the middle circle. Arcs
    of zero length are omitted. Raises ValueError as ``shortest_path`` does.
    """
    every = dubins_solutions(_circles(start, goal, kappa_left, kappa_right))
    solutions = sorted(
        (solution for solution in every if solution[1] != NONE),
        key=lambda solution: solution[0],
    )
    return [
        (WORDS[solution[1]], _path(start, solution, kappa_left, kappa_right))
        for solution in solutions
    ]
