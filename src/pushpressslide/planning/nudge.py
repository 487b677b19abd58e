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
    x, y, heading = _advanced(first, length)
    place = np.array(X_VG.position)
    # a line ends beside the goal, an arc at its yaw
    c = np.cos(heading)
    s = np.sin(heading)
    gx = target.x - x - (c * place[0] - s * place[1])
    gy = target.y - y - (s * place[0] + c * place[1])
    straight = second == 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = np.where(straight, gx * c + gy * s, (yaw - heading) / second)
    rest = np.where((rest >= 0.0) & (rest <= longest), rest, 0.0)
    dx, dy, turned = _advanced(second, rest)
    x = x + c * dx - s * dy
    y = y + s * dx + c * dy
    heading = heading + turned
    c = np.cos(heading)
    s = np.sin(heading)
    away = np.hypot(
        x + c * place[0] - s * place[1] - target.x,
        y + s * place[0] + c * place[1] - target.y,
    )
    off = np.maximum(
        away / tolerance.position, np.abs(heading - turn) / tolerance.yaw
    ).ravel()
    total = (length + rest).ravel()
    best = int(np.lexsort((total, np.maximum(off, margins.NUDGED)))[0])
    sections = (
        (float(first.flat[best]), float(length.flat[best])),
        (float(second.flat[best]), float(rest.flat[best])),
    )
    path = ArcPath(start, tuple(one for one in sections if one[1] > 0.0))
    return Nudge(path, float(off[best]))


def _advanced(curvature: Array, length: Array) -> tuple[Array, Array, Array]:
    """Coordinates [m] and heading [rad] after a ``length`` [m] at a ``curvature``
    [1/m].
    """
    half = 0.5 * curvature * length
    chord = length * np.sinc(half / math.pi)
    return chord * np.cos(half), chord * np.sin(half), 2.0 * half
