"""Shortest forward paths between two poses for a car whose left and right curvature
limits may differ.

Dubins (1957) for equal limits; for unequal ones the shortest path is one of the same
six words (Bakolas and Tsiotras, "Optimal synthesis of the asymmetric sinistral/dextral
Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011): LSL, RSR, LSR, RSL, RLR, LRL.
Closed form, plain floats.
"""

from __future__ import annotations

import math
from typing import Literal

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2

Word = Literal["LSL", "RSR", "LSR", "RSL", "RLR", "LRL"]

_TURN = 2.0 * math.pi
# Angles [rad] this close to none or a full turn, and distances of this share of the
# radii, count as zero.
_ROUND_OFF = 1e-12

# Poses this close, in radii and [rad], are one: next to the start the shortest length
# jumps by whole circles.
_SAME_POSE = 5e-11

# Length [m], word, first arc [rad], middle [rad] or [m], last arc [rad].
_Solution = tuple[float, Word, float, float, float]


def _turn(angle: float) -> float:
    angle %= _TURN
    return angle if _ROUND_OFF < angle < _TURN - _ROUND_OFF else 0.0


def _solutions(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> list[_Solution]:
    if not (0.0 < kappa_left < math.inf and 0.0 < kappa_right < math.inf):
        raise ValueError(
            f"curvature limits left {kappa_left}, right {kappa_right} 1/m; both must "
            "be finite and > 0"
        )
    rl = 1.0 / kappa_left
    rr = 1.0 / kappa_right
    x, y = start.unapply((goal.x, goal.y))
    yaw = goal.yaw - start.yaw
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(yaw)):
        raise ValueError(f"start {start}, goal {goal}; must be finite")
    both = rl + rr
    if (
        math.hypot(x, y) <= _SAME_POSE * both
        and abs(math.remainder(yaw, _TURN)) <= _SAME_POSE
    ):
        x = y = yaw = 0.0
    s = math.sin(yaw)
    c = math.cos(yaw)
    tiny = _ROUND_OFF * both
    hypot = math.hypot
    atan2 = math.atan2
    out: list[_Solution] = []

    # Vectors between the centres of the turning circles, start to goal; start centres
    # (0, rl) and (0, -rr).
    left_x = x - rl * s
    right_x = x + rr * s
    left_y = y + rl * c
    right_y = y - rr * c

    dx = left_x
    dy = left_y - rl
    ll = hypot(dx, dy)
    ll_angle = atan2(dy, dx) if ll > tiny else 0.0
    first = _turn(ll_angle)
    last = _turn(yaw - ll_angle)
    out.append((ll + rl * (first + last), "LSL", first, ll, last))

    dx = right_x
    dy = right_y + rr
    rr_ = hypot(dx, dy)
    rr_angle = atan2(dy, dx) if rr_ > tiny else 0.0
    first = _turn(-rr_angle)
    last = _turn(rr_angle - yaw)
    out.append((rr_ + rr * (first + last), "RSR", first, rr_, last))

    # Inner tangents: the centres are p along the straight and rl + rr across it.
    dx = right_x
    dy = right_y - rl
    square = dx * dx + dy * dy - both * both
    if square >= -tiny * both:
        p = math.sqrt(max(square, 0.0))
        heading = atan2(dy, dx) + atan2(both, p)
        first = _turn(heading)
        last = _turn(heading - yaw)
        out.append((p + rl * first + rr * last, "LSR", first, p, last))

    dx = left_x
    dy = left_y + rr
    square = dx * dx + dy * dy - both * both
    if square >= -tiny * both:
        p = math.sqrt(max(square, 0.0))
        heading = atan2(dy, dx) - atan2(both, p)
        first = _turn(-heading)
        last = _turn(yaw - heading)
        out.append((p + rr * first + rl * last, "RSL", first, p, last))

    # Three arcs: the middle circle touches both others, rl + rr from either centre, on
    # one or the other side.
    half = 0.5 * rr_ / both
    if half <= 1.0 + _ROUND_OFF:
        opening = math.acos(min(half, 1.0))
        for side in (opening, -opening):
            to_middle = rr_angle + side
            back = rr_angle + math.pi - side
            first = _turn(0.5 * math.pi - to_middle)
            middle = _turn(back - to_middle)
            last = _turn(back - 0.5 * math.pi - yaw)
            out.append((rr * (first + last) + rl * middle, "RLR", first, middle, last))

    half = 0.5 * ll / both
    if half <= 1.0 + _ROUND_OFF:
        opening = math.acos(min(half, 1.0))
        for side in (opening, -opening):
            to_middle = ll_angle + side
            back = ll_angle + math.pi - side
            first = _turn(to_middle + 0.5 * math.pi)
            middle = _turn(to_middle - back)
            last = _turn(yaw - back - 0.5 * math.pi)
            out.append((rl * (first + last) + rr * middle, "LRL", first, middle, last))
    return out


def _path(
    start: Pose2, solution: _Solution, kappa_left: float, kappa_right: float
) -> ArcPath:
    _, word, *amounts = solution
    pieces = []
    for letter, amount in zip(word, amounts, strict=True):
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
    """Return the shortest path from ``start`` to ``goal`` with curvature in
    [-kappa_right, kappa_left] [1/m].

    At most three pieces, signed curvature, none of zero length; no piece at all when
    the poses agree to round-off. The yaw at the end is the goal's up to whole turns. Of
    equally short words the first of LSL, RSR, LSR, RSL, RLR, LRL is taken. Raises
    ValueError unless both limits are finite and > 0 (an interval of curvatures without
    zero inside has no Dubins path) and the poses finite.
    """
    solutions = _solutions(start, goal, kappa_left, kappa_right)
    best = solutions[0]
    for solution in solutions:
        if solution[0] < best[0] * (1.0 - _ROUND_OFF):
            best = solution
    return _path(start, best, kappa_left, kappa_right)


def candidates(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> list[tuple[Word, ArcPath]]:
    """Return every path of the six words that joins the poses, with its word, shortest
    first.

    Words of three arcs come twice, for the two places of the middle circle. Pieces of
    zero length are left out. Raises ValueError as ``shortest_path`` does.
    """
    solutions = sorted(
        _solutions(start, goal, kappa_left, kappa_right),
        key=lambda solution: solution[0],
    )
    return [
        (solution[1], _path(start, solution, kappa_left, kappa_right))
        for solution in solutions
    ]
