"""Shortest forward paths between two poses for a car whose left and right curvature
limits may differ.

Dubins (1957) for equal limits; for unequal ones the shortest path is one of the same
six words (Bakolas and Tsiotras, "Optimal synthesis of the asymmetric sinistral/dextral
Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011): LSL, RSR, LSR, RSL, RLR, LRL.
Closed form, plain floats.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Point, Pose2

Word = Literal["LSL", "RSR", "LSR", "RSL", "RLR", "LRL"]

_TURN = 2.0 * math.pi
# Angles [rad] this close to none or a full turn, and distances of this share of the
# radii, count as zero.
_ROUND_OFF = 1e-12

# Poses this close, in radii and [rad], are one: next to the start the shortest length
# jumps by whole circles.
_SAME_POSE = 5e-11

# Of the coordinates and radii: what rounding leaves unknown of where a centre is. A
# tangent along one of the headings but for that is along it: else a straight of 1e-8 m
# begins or ends with a whole circle.
_BLUR = 1e-15

# Length [m], word, first arc [rad], middle [rad] or [m], last arc [rad].
_Solution = tuple[float, Word, float, float, float]


def _turn(angle: float) -> float:
    angle %= _TURN
    if _ROUND_OFF < angle < _TURN - _ROUND_OFF:
        return angle
    return 0.0


@dataclass(frozen=True, slots=True)
class _Circles:
    """The turning circles of both ends, seen from the start pose.

    The start's centres are (0, rl) and (0, -rr). ``left`` and ``right`` are the vectors
    from the start's own position to the goal's centres.
    """

    rl: float  # [m] radius of left turns
    rr: float
    left: Point  # [m]
    right: Point
    yaw: float  # [rad] of the goal
    blur: float  # [m] that is unknown of the centres

    @classmethod
    def between(
        cls, start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
    ) -> _Circles:
        """Return the circles of two poses; raises ValueError as ``shortest_path``."""
        if not (0.0 < kappa_left < math.inf and 0.0 < kappa_right < math.inf):
            raise ValueError(
                f"curvature limits left {kappa_left}, right {kappa_right} 1/m; both "
                "must be finite and > 0"
            )
        rl = 1.0 / kappa_left
        rr = 1.0 / kappa_right
        x, y = start.unapply((goal.x, goal.y))
        yaw = goal.yaw - start.yaw
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(yaw)):
            raise ValueError(f"start {start}, goal {goal}; must be finite")
        same_place = math.hypot(x, y) <= _SAME_POSE * (rl + rr)
        if same_place and abs(math.remainder(yaw, _TURN)) <= _SAME_POSE:
            x = y = yaw = 0.0
        s = math.sin(yaw)
        c = math.cos(yaw)
        places = abs(start.x) + abs(start.y) + abs(goal.x) + abs(goal.y)
        blur = _BLUR * (places + rl + rr)
        left = (x - rl * s, y + rl * c)
        right = (x + rr * s, y - rr * c)
        return cls(rl, rr, left, right, yaw, blur)

    @property
    def both(self) -> float:
        """The sum of the radii [m]."""
        return self.rl + self.rr

    def outer(self) -> Iterator[_Solution]:
        """Yield LSL and RSR, along the outer tangents."""
        length, angle = self.left_line()
        first = _turn(angle)
        last = _turn(self.yaw - angle)
        yield length + self.rl * (first + last), "LSL", first, length, last
        length, angle = self.right_line()
        first = _turn(-angle)
        last = _turn(angle - self.yaw)
        yield length + self.rr * (first + last), "RSR", first, length, last

    def left_line(self) -> Point:
        """Return distance [m] and direction [rad] from left centre to left centre."""
        return self._line(self.left[0], self.left[1] - self.rl)

    def right_line(self) -> Point:
        """Return distance [m] and direction [rad] from right to right centre."""
        return self._line(self.right[0], self.right[1] + self.rr)

    def _line(self, dx: float, dy: float) -> Point:
        """Length [m] and direction [rad] of a line between centres; no direction of
        none, and a heading's where it is along that but for rounding.
        """
        length = math.hypot(dx, dy)
        if length <= _ROUND_OFF * self.both:
            return length, 0.0
        angle = math.atan2(dy, dx)
        for heading in (0.0, self.yaw):
            if abs(math.remainder(angle - heading, _TURN)) * length <= self.blur:
                return length, heading
        return length, angle

    def inner(self) -> Iterator[_Solution]:
        """Yield LSR and RSL, along the inner tangents, where there are any."""
        straight, direction, opening = self._inner(
            self.right[0], self.right[1] - self.rl
        )
        if straight >= 0.0:
            heading = direction + opening
            first = _turn(heading)
            last = _turn(heading - self.yaw)
            length = straight + self.rl * first + self.rr * last
            yield length, "LSR", first, straight, last
        straight, direction, opening = self._inner(self.left[0], self.left[1] + self.rr)
        if straight >= 0.0:
            heading = direction - opening
            first = _turn(-heading)
            last = _turn(self.yaw - heading)
            length = straight + self.rr * first + self.rl * last
            yield length, "RSL", first, straight, last

    def _inner(self, dx: float, dy: float) -> tuple[float, float, float]:
        """Return the straight part [m] of the inner tangent of two circles, < 0 where
        there is none, their direction and the angle [rad] from there to the tangent.

        The centres are the straight apart along the tangent, and rl + rr across it.
        """
        both = self.both
        square = dx * dx + dy * dy - both * both
        if not square >= -(_ROUND_OFF * both) * both:
            return -1.0, 0.0, 0.0
        straight = math.sqrt(max(square, 0.0))
        return straight, math.atan2(dy, dx), math.atan2(both, straight)

    def three_arcs(self) -> Iterator[_Solution]:
        """Yield RLR and LRL, twice each, where the middle circle can touch both others:
        it is rl + rr from either centre, on one or the other side.
        """
        length, angle = self.right_line()
        for side in _openings(0.5 * length / self.both):
            to_middle = angle + side
            back = angle + math.pi - side
            first = _turn(0.5 * math.pi - to_middle)
            middle = _turn(back - to_middle)
            last = _turn(back - 0.5 * math.pi - self.yaw)
            length = self.rr * (first + last) + self.rl * middle
            yield length, "RLR", first, middle, last
        length, angle = self.left_line()
        for side in _openings(0.5 * length / self.both):
            to_middle = angle + side
            back = angle + math.pi - side
            first = _turn(to_middle + 0.5 * math.pi)
            middle = _turn(to_middle - back)
            last = _turn(self.yaw - back - 0.5 * math.pi)
            length = self.rl * (first + last) + self.rr * middle
            yield length, "LRL", first, middle, last


def _openings(half: float) -> tuple[float, ...]:
    """Return the angles [rad] from the line of centres to the middle circle's, both
    ways; ``half`` is half the distance of the centres over rl + rr.
    """
    if half > 1.0 + _ROUND_OFF:
        return ()
    opening = math.acos(min(half, 1.0))
    return opening, -opening


def _solutions(
    start: Pose2, goal: Pose2, kappa_left: float, kappa_right: float
) -> list[_Solution]:
    circles = _Circles.between(start, goal, kappa_left, kappa_right)
    return [*circles.outer(), *circles.inner(), *circles.three_arcs()]


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
    """Return the shortest path from ``start`` to ``goal`` whose curvature [1/m] is
    between -kappa_right and kappa_left.

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
