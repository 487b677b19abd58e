"""Paths of circular arcs and lines: nearest point, smoothed curvature, and a
trapezoidal speed profile.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, inf, pi, sqrt
from typing import cast

from pushpressslide.kernels.allocation import Vector
from pushpressslide.kernels.kernel import compiled_as, kernel

TURN = 2.0 * pi

Piece = tuple[float, float, float, float, float, float, float, float]
"""One section of a path.

Every section has the arc length [m] at its start and end, and the curvature [1/m]. For
an arc, these are followed by the yaw [rad] extrapolated to arc length 0, the centre,
the radius and the side; for a line, by the yaw, the direction, and the arc length and
the offset to the left of the world's origin. Beyond the last section the path continues
as an infinite line.
"""
Bend = tuple[float, float, float]
"""A jump of the curvature: arc length [m], size [1/m], and distance [m] from the nearer
end of the path.
"""
Nearest = tuple[float, float, float, float]
"""Arc length [m] of the nearest point of a path, offset [m] of the given point to the
left, heading [rad] and curvature [1/m].
"""


def _eight(row: Sequence[float]) -> Piece:
    return row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7]


def _three(row: Sequence[float]) -> Bend:
    return row[0], row[1], row[2]


@compiled_as(_eight)
def piece_of(row: Sequence[float]) -> Piece:
    """One row of sections. Compiled code reads it from an array."""
    return cast(Piece, row)


@compiled_as(_three)
def bend_of(row: Sequence[float]) -> Bend:
    """One row of bends. Compiled code reads it from an array."""
    return cast(Bend, row)


@kernel
def wrapped(angle: float) -> float:
    """Angle [rad] wrapped to [-pi, pi], without rounding."""
    if -pi <= angle <= pi:
        return angle
    if angle > 0.0:
        rest = angle % TURN
        return rest - TURN if rest > pi else rest
    rest = -angle % TURN
    return TURN - rest if rest > pi else -rest


@kernel
def nearest(
    x: float,
    y: float,
    s: float,
    half: float,
    sections: Sequence[Sequence[float]],
    bends: Sequence[Sequence[float]],
) -> Nearest:
    """Point of a path nearest to (x, y) [m], on the section at arc length ``s`` or a
    later one.

    Heading and curvature are ``eased`` over ``half`` [m].
    """
    near = s
    left = inf
    yaw = 0.0
    bent = 0.0
    for row in sections:
        start, end, curvature, yaw_0, a, b, c, d = piece_of(row)
        if s > end:
            continue
        if curvature != 0.0:
            dx = d * (x - a)
            dy = d * (y - b)
            guess = yaw_0 + curvature * s  # of the circle's turns that one is meant
            yaw = guess + wrapped(atan2(dx, -dy) - guess)
            near = c * (yaw - yaw_0)
            left = d * sqrt(dx * dx + dy * dy) - c
        else:
            yaw = yaw_0
            near = c + a * x + b * y
            left = d + b * x - a * y
        bent = curvature
        if near <= end:
            if near - half < start or near + half > end:
                turned, more = eased(near, half, bends)
                return near, left, yaw + turned, bent + more
            return near, left, yaw, bent
        s = end  # go on with the next piece
    return near, left, yaw, bent


@kernel
def eased(s: float, half: float, bends: Sequence[Sequence[float]]) -> Vector:
    """Corrections of heading [rad] and curvature [1/m] at arc length ``s`` [m], for a
    path averaged over ``half`` [m] in either direction.
    """
    heading = 0.0
    curvature = 0.0
    before = s - half
    behind = s + half
    for row in bends:
        bend, change, slack = bend_of(row)
        if before < bend < behind:
            off = s - bend
            near = half if half < slack else slack
            left = near - (off if off > 0.0 else -off)
            if left > 0.0:
                heading += 0.25 * change * left * left / near
                share = 0.5 * left / near
                curvature += change * (share if off < 0.0 else -share)
    return heading, curvature


@kernel
def trapezoid(t: float, length: float, cruise: float, acceleration: float) -> Vector:
    """Arc length [m] and speed [m/s] at time ``t`` [s] of a motion from rest to rest,
    clamped at the ends.
    """
    if t <= 0.0 or length <= 0.0:
        return 0.0, 0.0
    total = length / cruise + cruise / acceleration
    if t >= total:
        return length, 0.0
    ramp = cruise / acceleration
    if t < ramp:
        return 0.5 * acceleration * t * t, acceleration * t
    if t > total - ramp:
        left = total - t
        return length - 0.5 * acceleration * left * left, acceleration * left
    return cruise * (t - 0.5 * ramp), cruise
