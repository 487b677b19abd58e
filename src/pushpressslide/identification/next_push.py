"""The most informative next push, for the less certain of the two parameters.

On an ellipsoid, a push perpendicular to a face with a lever d causes a motion in a
direction a with tan a = LENGTH d / rho^2. The derivative of a with respect to the
logarithm of rho is -sin 2a. Its magnitude is largest at d = rho^2 / LENGTH. Friction is
best identified without a lever, since the force then does not depend on rho.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pushpressslide.core.pose import Point
from pushpressslide.identification.intervals import Intervals
from pushpressslide.identification.pairs import LENGTH, Pairs
from pushpressslide.identification.push_sets import PushSet

PLACES = 41  # points compared along each side
INSET = 0.1  # share of a side that stays free at either end
MORE = 5  # number of pushes for which the interval is predicted


@dataclass(frozen=True)
class NextPush:
    """A push perpendicular to the outline of the base."""

    parameter: Literal["friction", "rho"]
    point: Point  # [m] in G
    direction: Point  # unit, in G
    lever: float  # [m] lever of its line of action about the centre of mass
    narrowed: float  # share of the interval that remains after ``MORE`` such pushes


def next_push(push_set: PushSet, known: Intervals) -> NextPush:
    """Push that narrows the wider of the two relative intervals most."""
    rho = known.rho.value
    by_rho = known.rho.relative >= known.friction.relative
    cx, cy = push_set.body.center_of_mass
    corners = push_set.base
    best: tuple[float, Point, Point, float] | None = None
    for a, b in zip(corners, (*corners[1:], *corners[:1]), strict=True):
        ends = np.array([a, b])
        along = ends[1] - ends[0]
        normal = np.array([-along[1], along[0]]) / np.hypot(*along)
        for share in np.linspace(INSET, 1.0 - INSET, PLACES):
            x, y = ends[0] + share * along
            lever = float(x * normal[1] - y * normal[0])
            merit = sensitivity(lever, rho) if by_rho else -abs(lever)
            if best is None or merit > best[0] + 1e-9:
                foot = (float(x) + cx, float(y) + cy)
                best = (merit, foot, (float(normal[0]), float(normal[1])), lever)
    if best is None:
        raise ValueError("a base has corners")
    merit, point, direction, lever = best
    left = _left(push_set, rho, merit) if by_rho else _left_of_mean(push_set)
    return NextPush("rho" if by_rho else "friction", point, direction, lever, left)


def sensitivity(lever: float, rho: float) -> float:
    """Sensitivity [rad] of the direction of motion to the logarithm of rho, for a push
    with a ``lever`` [m].
    """
    angle = math.atan(LENGTH * abs(lever) / rho**2)
    return math.sin(2.0 * angle)


def _left(push_set: PushSet, rho: float, merit: float) -> float:
    """Share of the interval of rho that remains after ``MORE`` pushes with the
    sensitivity ``merit``.
    """
    pairs: Pairs = push_set.pairs
    levers = pairs.wrenches[:, 2] / np.hypot(*pairs.wrenches[:, :2].T).clip(1e-9)
    seen = np.array([sensitivity(float(lever), rho) ** 2 for lever in levers])
    whole = float(seen.mean()) * push_set.count
    return math.sqrt(whole / (whole + MORE * merit**2)) if whole else 0.0


def _left_of_mean(push_set: PushSet) -> float:
    """Share of the interval of a mean that remains after ``MORE`` pushes."""
    return math.sqrt(push_set.count / (push_set.count + MORE))
