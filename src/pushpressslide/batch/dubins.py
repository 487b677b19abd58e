"""Shortest Dubins paths on arrays, left and right curvature limits of their own: the
answers of ``planning.dubins.shortest_path``.

Bakolas and Tsiotras, "Optimal synthesis of the asymmetric sinistral/dextral
Markov-Dubins problem", J. Optim. Theory Appl. 150, 2011.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pushpressslide.batch.angles import arctan2, cos, sin
from pushpressslide.batch.checks import check_last, check_positive
from pushpressslide.batch.elementwise import Argument, column, figures, table, values
from pushpressslide.core.arrays import Array
from pushpressslide.core.formulas import Column, Columns, Flag, greater, least, where
from pushpressslide.planning.dubins import Word

WORDS: tuple[Word, ...] = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL")
NONE = -1  # word of a row that is no number
LSL = 0.0
RSR = 1.0
LSR = 2.0
RSL = 3.0
RLR = 4.0
LRL = 5.0

TURN = 2.0 * math.pi
TURNS = 1.0 / TURN
# as ``planning.dubins``: angles [rad] this close to none or a full turn, and distances
# of this share of the radii, count as zero
ROUND_OFF = 1e-12
SAME_POSE = 5e-11  # poses this close, in radii and [rad], are one
BLUR = 1e-15  # of coordinates and radii, that is unknown of where a centre is


class DubinsPaths(NamedTuple):
    """Paths of three pieces; a piece may have no length."""

    length: Array  # (...) [m]; NaN where a pose is no number
    word: NDArray[np.int8]  # (...) number in WORDS, NONE where a pose is no number
    lengths: Array  # (..., 3) [m] of the pieces
    curvatures: Array  # (..., 3) [1/m] of the pieces, positive to the left


class Pose(NamedTuple):
    """A pose."""

    x: Column  # [m]
    y: Column  # [m]
    yaw: Column  # [rad]


class Limits(NamedTuple):
    """Curvature limits [1/m] > 0."""

    left: Column
    right: Column


class Circles(NamedTuple):
    """The turning circles of both ends, seen from the start pose."""

    rl: Column  # [m] radius of left turns
    rr: Column
    left_x: Column  # [m] from the start's own position to the goal's left centre
    left_y: Column
    right_x: Column
    right_y: Column
    yaw: Column  # [rad] of the goal
    blur: Column  # [m] that is unknown of the centres


class Path(NamedTuple):
    """The shortest path so far."""

    length: Column  # [m]
    word: Column
    first: Column  # [m] of the pieces
    middle: Column
    last: Column


class Line(NamedTuple):
    """A line of two centres."""

    length: Column  # [m]
    angle: Column  # [rad]


def shortest_paths(
    starts: ArrayLike, goals: ArrayLike, kappa_left: ArrayLike, kappa_right: ArrayLike
) -> DubinsPaths:
    """Return the shortest paths (...) from ``starts`` to ``goals`` (..., 3): x, y [m]
    and yaw [rad], with curvatures in [-``kappa_right``, ``kappa_left``] (...) [1/m].

    Of equally short words the first of WORDS. Raises ValueError unless all limits are
    finite and > 0.
    """
    arguments, shape = _arguments(starts, goals, kappa_left, kappa_right)
    length, word, lengths, curvatures = values(shortest, arguments, shape, (0, 0, 3, 3))
    return DubinsPaths(length, word.astype(np.int8), lengths, curvatures)


def shortest_lengths(
    starts: ArrayLike, goals: ArrayLike, kappa_left: ArrayLike, kappa_right: ArrayLike
) -> Array:
    """Return the lengths (...) [m] of ``shortest_paths`` alone."""
    arguments, shape = _arguments(starts, goals, kappa_left, kappa_right)
    (length,) = values(shortest_length, arguments, shape, (0,))
    return length


def _arguments(
    starts: ArrayLike, goals: ArrayLike, kappa_left: ArrayLike, kappa_right: ArrayLike
) -> tuple[tuple[Argument, ...], tuple[int, ...]]:
    """Return the columns of paths, and their leading shape."""
    a, b, left, right = figures(starts, goals, kappa_left, kappa_right)
    check_last(a, (3,), "starts")
    check_last(b, (3,), "goals")
    check_positive(left, "kappa_left", "1/m")
    check_positive(right, "kappa_right", "1/m")
    shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1], left.shape, right.shape)
    arguments = (
        table(Pose, a, shape),
        table(Pose, b, shape),
        Limits(column(left, shape), column(right, shape)),
    )
    return arguments, shape


def shortest_length(start: Pose, goal: Pose, limits: Limits) -> Columns:
    """Return the length of the shortest path."""
    path = shortest_of_words(start, goal, limits)
    return (where(np.isfinite(path.length), path.length, math.nan),)


def shortest(start: Pose, goal: Pose, limits: Limits) -> Columns:
    """Return length, word, lengths and curvatures of the shortest path."""
    path = shortest_of_words(start, goal, limits)
    finite = np.isfinite(path.length)
    word = path.word
    starts_left = (word == LSL) | (word == LSR) | (word == LRL)
    ends_left = (word == LSL) | (word == RSL) | (word == LRL)
    bent = where(word == RLR, limits.left, where(word == LRL, -limits.right, 0.0))
    return (
        where(finite, path.length, math.nan),
        where(finite, word, NONE),
        path.first,
        path.middle,
        path.last,
        where(starts_left, limits.left, -limits.right),
        bent,
        where(ends_left, limits.left, -limits.right),
    )


def shortest_of_words(start: Pose, goal: Pose, limits: Limits) -> Path:
    """Return the shortest path of the six words, those of three arcs
    with the middle one beyond half a turn: the other is never the shortest.
    """
    c = circles_of(start, goal, limits)
    left = line_of(c.left_x, c.left_y - c.rl, c)
    right = line_of(c.right_x, c.right_y + c.rr, c)
    first = turn(left.angle)
    last = turn(c.yaw - left.angle)
    path = path_of(LSL, c.rl * first, left.length, c.rl * last)
    first = turn(-right.angle)
    last = turn(right.angle - c.yaw)
    path = shorter(path, path_of(RSR, c.rr * first, right.length, c.rr * last))
    path = shorter(path, inner_left(c))
    path = shorter(path, inner_right(c))
    path = shorter(path, three_right(right, c))
    return shorter(path, three_left(left, c))


def circles_of(start: Pose, goal: Pose, limits: Limits) -> Circles:
    """Return the circles of two poses."""
    rl = 1.0 / limits.left
    rr = 1.0 / limits.right
    dx = goal.x - start.x
    dy = goal.y - start.y
    c = cos(start.yaw)
    s = sin(start.yaw)
    x = c * dx + s * dy
    y = c * dy - s * dx
    yaw = goal.yaw - start.yaw
    near = SAME_POSE * (rl + rr)
    off = yaw - TURN * np.floor(yaw * TURNS + 0.5)
    same = (x * x + y * y <= near * near) & (np.abs(off) <= SAME_POSE)
    x = where(same, 0.0, x)
    y = where(same, 0.0, y)
    yaw = where(same, 0.0, yaw)
    c = cos(yaw)
    s = sin(yaw)
    places = np.abs(start.x) + np.abs(start.y) + np.abs(goal.x) + np.abs(goal.y)
    blur = BLUR * (places + rl + rr)
    return Circles(rl, rr, x - rl * s, y + rl * c, x + rr * s, y - rr * c, yaw, blur)


def turn(angle: Column) -> Column:
    """Return an angle in [0, 2 pi), zero where it is a full turn to round-off."""
    rest = angle - TURN * np.floor((angle + ROUND_OFF) * TURNS)
    return where(rest > ROUND_OFF, rest, 0.0)


def line_of(dx: Column, dy: Column, c: Circles) -> Line:
    """Length and direction of a line: zero of none, and a heading's where it is along
    that but for rounding.
    """
    length = np.sqrt(dx * dx + dy * dy)
    some = length > ROUND_OFF * (c.rl + c.rr)
    angle = where(some, arctan2(dy, dx), 0.0)
    past = angle - c.yaw
    past = past - TURN * np.floor(past * TURNS + 0.5)
    angle = where(np.abs(past) * length <= c.blur, c.yaw, angle)
    return Line(length, where(np.abs(angle) * length <= c.blur, 0.0, angle))


def path_of(word: float, first: Column, middle: Column, last: Column) -> Path:
    """Return a path of three pieces [m]."""
    return Path(first + middle + last, word, first, middle, last)


def shorter(a: Path, b: Path) -> Path:
    """Return the shorter of two paths, ``a`` where they are equal to round-off."""
    better = b.length < a.length * (1.0 - ROUND_OFF)
    return Path(
        where(better, b.length, a.length),
        where(better, b.word, a.word),
        where(better, b.first, a.first),
        where(better, b.middle, a.middle),
        where(better, b.last, a.last),
    )


def inner_left(c: Circles) -> Path:
    """Return LSR, infinitely long where the circles have no inner tangent."""
    dx = c.right_x
    dy = c.right_y - c.rl
    both = c.rl + c.rr
    square = tangent_square(dx, dy, both)
    straight = np.sqrt(greater(square, 0.0))
    # the direction of the centres, turned by that of (straight, both)
    heading = arctan2(dy * straight + dx * both, dx * straight - dy * both)
    first = turn(heading)
    last = turn(heading - c.yaw)
    path = path_of(LSR, c.rl * first, straight, c.rr * last)
    return possible(path, square >= 0.0)


def inner_right(c: Circles) -> Path:
    """Return RSL, infinitely long where the circles have no inner tangent."""
    dx = c.left_x
    dy = c.left_y + c.rr
    both = c.rl + c.rr
    square = tangent_square(dx, dy, both)
    straight = np.sqrt(greater(square, 0.0))
    heading = arctan2(dy * straight - dx * both, dx * straight + dy * both)
    first = turn(-heading)
    last = turn(c.yaw - heading)
    path = path_of(RSL, c.rr * first, straight, c.rl * last)
    return possible(path, square >= 0.0)


def tangent_square(dx: Column, dy: Column, both: Column) -> Column:
    """Return the square [m^2] of the inner tangent of two circles; < 0: there is none."""
    square = dx * dx + dy * dy - both * both
    return where(np.abs(square) <= ROUND_OFF * both * both, 0.0, square)


def opening_of(length: Column, c: Circles) -> Column:
    """Return the angle [rad] from the line of centres to the middle circle's."""
    half = least(0.5 * length / (c.rl + c.rr), 1.0)
    return arctan2(np.sqrt((1.0 - half) * (1.0 + half)), half)


def three_right(line: Line, c: Circles) -> Path:
    """Return RLR, infinitely long where the middle circle cannot touch both others."""
    opening = opening_of(line.length, c)
    to_middle = line.angle - opening
    first = turn(0.5 * math.pi - to_middle)
    middle = math.pi + 2.0 * opening
    last = turn(line.angle + opening + 0.5 * math.pi - c.yaw)
    path = path_of(RLR, c.rr * first, c.rl * middle, c.rr * last)
    return possible(path, touches(line, c))


def three_left(line: Line, c: Circles) -> Path:
    """Return LRL, infinitely long where the middle circle cannot touch both others."""
    opening = opening_of(line.length, c)
    to_middle = line.angle + opening
    first = turn(to_middle + 0.5 * math.pi)
    middle = math.pi + 2.0 * opening
    last = turn(c.yaw - line.angle + opening + 0.5 * math.pi)
    path = path_of(LRL, c.rl * first, c.rr * middle, c.rl * last)
    return possible(path, touches(line, c))


def touches(line: Line, c: Circles) -> Flag:
    """Return whether a middle circle can touch both others."""
    return line.length <= 2.0 * (1.0 + ROUND_OFF) * (c.rl + c.rr)


def possible(path: Path, holds: Flag) -> Path:
    """Return a path, infinitely long unless a condition ``holds``."""
    length = where(holds, path.length, math.inf)
    return Path(length, path.word, path.first, path.middle, path.last)
