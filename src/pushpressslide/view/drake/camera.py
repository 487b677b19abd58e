"""Camera of a run: the direction that shows the contacts, and the points that must be
in the picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.support_frame import SupportFrame
from pushpressslide.view.drake.sight import Moment, force_share, seen_share, shown_share

FIELD = math.radians(45.0)  # vertical field of view
FILL = 0.82  # largest share of a picture that its points fill
# [rad] between line of sight and support: steep enough that an object does not hide
# what is behind it, shallow enough that heights are seen
BEST_SLOPE = math.radians(38.0)
LEAST_SLOPE = math.radians(24.0)
SIDE_SLOPE = math.radians(12.0)
TURNS = 24  # directions all round that are compared
HEIGHTS = tuple(math.radians(a) for a in (0.0, 12.0, 25.0, 38.0, 52.0))
# [rad] to each side, from where the contact is to be seen too: a near camera sees parts
# of a scene from other directions
SWAY = math.radians(12.0)
# beside a hidden contact: of a force and of an object that are behind something
FORCE_COST = 0.5
BEHIND_COST = 0.5
# what a share of hidden contacts is weighed against: a far camera, a slope that is not
# the best one, and a line of sight along the push, which shortens the force
FAR_COST = 0.4
SLOPE_COST = 0.5  # of 1 rad
ALONG_COST = 0.15


@dataclass(frozen=True, eq=False)
class View:
    """Position and target of a camera, in the world [m]."""

    position: Any  # (3,); pydrake's stubs refuse every typed ndarray
    target: Any  # (3,)


class Directions:
    """Candidate directions of a camera, each with the share that is hidden from it."""

    def __init__(
        self,
        frame: SupportFrame,
        moments: Sequence[Moment],
        pushes: Array,
        points: Array,
    ) -> None:
        """Evaluate all directions in front of a support.

        ``pushes`` (K, 2) are the directions of pushes along the support. ``points`` (N,
        3) [m], in the world, must be in the picture.
        """
        self._directions = candidates(frame, SIDE_SLOPE)
        own = [np.array(frame.components(tuple(d.tolist()))) for d in self._directions]
        self._slopes = np.array([math.asin(min(1.0, float(d[2]))) for d in own])
        spreads = np.array([_spread(points, d) for d in self._directions])
        self._costs = _hidden(moments, np.array(own))
        self._costs += FAR_COST * (spreads / spreads.min() - 1.0)
        if len(pushes):
            along = [float(np.mean(np.abs(pushes @ d[:2]))) for d in own]
            self._costs += ALONG_COST * np.array(along)

    def best(self, slope: float = BEST_SLOPE) -> Array:
        """Unit vector (3,), in the world, towards the camera that sees the contacts
        best.

        The preferred angle between the line of sight and the support is ``slope``
        [rad].
        """
        costs = self._costs + SLOPE_COST * np.abs(self._slopes - slope)
        costs[self._slopes < min(LEAST_SLOPE, slope) - 1e-9] = math.inf
        return self._directions[int(np.argmin(costs))]


def _hidden(moments: Sequence[Moment], directions: Array) -> Array:
    """Weighted mean share (D,) of contacts, forces and object corners hidden from
    cameras near each of ``directions`` (D, 3), in the support's frame.
    """
    if not moments:
        return np.zeros(len(directions))
    turned = np.stack([_turned(directions, a) for a in (-SWAY, 0.0, SWAY)])
    costs = np.zeros(turned.shape[:2])
    for moment in moments:
        costs += 1.0 - seen_share(moment, turned)
        costs += FORCE_COST * (1.0 - force_share(moment, turned))
        costs += BEHIND_COST * (1.0 - shown_share(moment, turned))
    return np.asarray(costs.mean(axis=0) / len(moments))


def _turned(directions: Array, angle: float) -> Array:
    """Directions (D, 3) turned by ``angle`` [rad] about the support's normal."""
    x, y, z = directions.T
    c = math.cos(angle)
    s = math.sin(angle)
    return np.column_stack([c * x - s * y, s * x + c * y, z])


def candidates(frame: SupportFrame, min_elevation: float) -> list[Array]:
    """Unit vectors (3,), in the world, in front of a support and not below the horizon.

    They are inclined to the support by ``min_elevation`` [rad] or more.
    """
    normal = np.array(frame.normal)
    out = []
    for height in HEIGHTS:
        for turn in range(TURNS):
            angle = 2.0 * math.pi * turn / TURNS
            flat = math.cos(height)
            x = flat * math.cos(angle)
            y = flat * math.sin(angle)
            direction = np.array([x, y, math.sin(height)])
            if direction @ normal >= math.sin(min_elevation) - 1e-9:
                out.append(direction)
    return out


def top_direction(frame: SupportFrame) -> Array:
    """Unit vector (3,), in the world, out of the support. On a table it leans slightly
    towards -y, so that x points to the right in the picture.
    """
    normal = np.array(frame.normal)
    if abs(normal[2]) > 0.99:
        normal = normal + np.array([0.0, -1e-3, 0.0])
    return np.asarray(normal / np.linalg.norm(normal))


def axes(direction: Array) -> tuple[Array, Array, Array]:
    """Right, down and forward axes (3,) of an upright camera, with ``direction`` (3,)
    pointing towards it.
    """
    z = -direction / np.linalg.norm(direction)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    return x, np.cross(z, x), z


def _spread(points: Array, direction: Array) -> float:
    """Size [m] of a picture of ``points`` (N, 3) [m] taken from far away."""
    x, y, _ = axes(direction)
    return max(float(np.ptp(points @ x)), float(np.ptp(points @ y)))


def fit_view(
    points: Array, direction: Array, field: float = FIELD, aspect: float = 16.0 / 9.0
) -> View:
    """Nearest view from ``direction`` (3,) that contains ``points`` (N, 3).

    The picture is upright, with the vertical field of view ``field`` [rad] and the
    ratio ``aspect`` of width to height.
    """
    x, y, z = axes(direction)
    target = 0.5 * (points.min(axis=0) + points.max(axis=0))
    reach = math.tan(0.5 * field) * FILL
    size = float(np.linalg.norm(points - target, axis=1).max())
    distance = size / (reach * min(1.0, aspect)) + size
    # shift and distance depend on each other; a few iterations settle both
    for _ in range(20):
        ahead = (points - target) @ z + distance
        across = ((points - target) @ x) / ahead
        down = ((points - target) @ y) / ahead
        right = 0.5 * (across.max() + across.min())
        below = 0.5 * (down.max() + down.min())
        target = target + distance * (right * x + below * y)
        needed = max(float(np.ptp(across)) / aspect, float(np.ptp(down)))
        distance *= (needed / (2.0 * reach)) ** 0.7
    return View(target - distance * z, target)
