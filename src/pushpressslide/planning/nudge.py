"""Short pushes that end with an object inside its goal's tolerances, not at the goal."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2, wrap_angle

LENGTHS = 48  # of a path's first section that are tried
BENDS = 5  # curvatures that are tried
YAWS = (-0.25, 0.0, 0.25)  # final errors of yaw, as shares of the tolerance
SHORTEST = 5e-4  # [m] first section

Poses = tuple[Array, Array, Array]
"""Coordinates [m] and heading [rad] of an axle, in its frame at the start."""


class Nudge(NamedTuple):
    """A short push of a car's axle."""

    path: ArcPath
    off: float  # final error, as a share of the goal's tolerances


def nudge(
    start: Pose2,
    goal: Pose2,
    X_VG: Pose2,
    curvatures: tuple[float, float],
    tolerance: Tolerance,
    longest: float,
    touch: float = 0.0,
) -> Nudge:
    """The path of two arcs or lines whose end is nearest to the ``goal`` X_WG.

    ``start`` is the pose X_WV of a car's axle, ``X_VG`` that of the shape in it. The
    ``curvatures`` [1/m] are the least and the greatest. No section is longer than
    ``longest`` [m]. Of the paths that end within ``margins.NUDGED`` of the
    ``tolerance``, the shortest is taken. A ``touch`` moves the object by this length
    [m] before it is noticed, at the middle curvature.
    """
    target = start.inverse().compose(goal)
    turn = wrap_angle(target.yaw - X_VG.yaw)
    bends = np.linspace(*curvatures, BENDS)
    first, second, length, yaw = np.meshgrid(
        bends if touch == 0.0 else bends[BENDS // 2, None],
        bends,
        touch + np.linspace(SHORTEST, longest, LENGTHS),
        turn + np.array(YAWS) * tolerance.yaw,
    )
    begun = _advanced(first, length)
    rest = _rests(begun, second, yaw, _remaining(begun, X_VG, target), longest)
    ends = _further(begun, _advanced(second, rest))
    dx, dy = _remaining(ends, X_VG, target)
    place = np.hypot(dx, dy) / tolerance.position
    off = np.maximum(place, np.abs(ends[2] - turn) / tolerance.yaw).ravel()
    counted = np.maximum(off, margins.NUDGED)
    best = int(np.lexsort(((length + rest).ravel(), counted))[0])
    sections = (
        (float(first.flat[best]), float(length.flat[best])),
        (float(second.flat[best]), float(rest.flat[best])),
    )
    path = ArcPath(start, tuple(one for one in sections if one[1] > 0.0))
    return Nudge(path, float(off[best]))


def _remaining(poses: Poses, X_VG: Pose2, target: Pose2) -> tuple[Array, Array]:
    """Vector [m] from the shape's frame, with the axle at ``poses``, to the goal."""
    x, y, heading = poses
    c = np.cos(heading)
    s = np.sin(heading)
    return (
        target.x - x - c * X_VG.x + s * X_VG.y,
        target.y - y - s * X_VG.x - c * X_VG.y,
    )


def _rests(
    begun: Poses,
    bends: Array,
    yaws: Array,
    remaining: tuple[Array, Array],
    longest: float,
) -> Array:
    """Lengths [m] of second sections: a line ends beside the goal, an arc at its yaw. 0
    where this is behind, or too far.
    """
    _, _, heading = begun
    dx, dy = remaining
    ahead = dx * np.cos(heading) + dy * np.sin(heading)
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = np.where(bends == 0.0, ahead, (yaws - heading) / bends)
    return np.where((rest >= 0.0) & (rest <= longest), rest, 0.0)


def _further(before: Poses, step: Poses) -> Poses:
    """Poses after a ``step`` in the frames of ``before``."""
    x, y, heading = before
    dx, dy, turn = step
    c = np.cos(heading)
    s = np.sin(heading)
    return x + c * dx - s * dy, y + s * dx + c * dy, heading + turn


def _advanced(curvature: Array, length: Array) -> Poses:
    """Poses after a ``length`` [m] at a ``curvature`` [1/m]."""
    half = 0.5 * curvature * length
    chord = length * np.sinc(half / math.pi)
    return chord * np.cos(half), chord * np.sin(half), 2.0 * half
