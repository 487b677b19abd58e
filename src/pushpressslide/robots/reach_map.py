"""Precomputed tables of an arm's reach for given tool attitudes.

An upright arm that turns about its vertical axis reaches the same distances in all
directions, if the tool leans the same way as seen from the base. A search along one
radial line therefore covers the whole table.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Robot
from pushpressslide.robots.arm_files import arm_kinematics, at_origin
from pushpressslide.robots.inverse import default_seeds, solve_ik
from pushpressslide.robots.reach import (
    HOPELESS,
    QUICK,
    QUICK_SEEDS,
    REACH_MARGIN,
    first_look,
    short_by,
)
from pushpressslide.robots.tool import TOOL_TILTS, ToolAttitude

STEP = 0.02  # [m] between the distances that are searched
FARTHEST = 1.1  # [m]
LEANS = 16  # directions of a tool's lean, seen from the base, that are searched
DISTANCES = np.arange(STEP, FARTHEST, STEP)


class _Table:
    """Reach of a robot at the origin at one height, with its tool tilted by one angle,
    at DISTANCES.

    There is one radial line for each direction of the lean, computed on demand.
    """

    def __init__(self, robot: Robot, height: float, tilt: float) -> None:
        """Start with an empty table."""
        self._robot = robot
        self._height = height
        self.tilt = tilt
        self._known = np.full(LEANS, False)
        self.ok = np.full((LEANS, len(DISTANCES)), False)
        # [rad] of the first joint
        self.turned = np.zeros((LEANS, len(DISTANCES)))

    def know(self, leans: NDArray[np.intp]) -> None:
        """Compute the missing lines for the given ``leans``."""
        for k in set(leans[~self._known[leans]].tolist()):
            self.ok[k], self.turned[k] = self._line(k)
            self._known[k] = True

    def _line(self, lean: int) -> tuple[NDArray[np.bool_], Array]:
        """Reach at all distances straight ahead, and the first joint's angle [rad] at
        each distance.
        """
        kin = arm_kinematics(self._robot)
        points = np.zeros((len(DISTANCES), 3))
        points[:, 0] = DISTANCES
        points[:, 2] = self._height
        hold = ToolAttitude(self.tilt, 2.0 * math.pi * lean / LEANS)
        ok = np.full(len(points), False)
        turned = np.zeros(len(points))
        axes = np.broadcast_to(hold.axis, points.shape)
        near = np.flatnonzero(short_by(kin, points, axes) <= 0.0)
        if len(near) == 0:
            return ok, turned
        first = first_look(kin, points[near], hold)
        ok[near] = first.ok
        turned[near] = first.q[:, 0]
        near = near[~first.ok & (first.miss < HOPELESS)]
        if len(near) == 0:
            return ok, turned
        seeds = default_seeds(kin, points[near])[:, QUICK_SEEDS]
        again = solve_ik(kin, points[near], hold, None, seeds, REACH_MARGIN, QUICK)
        ok[near] = again.converged
        turned[near] = again.q[:, 0]
        return ok, turned


def surely_reached(
    robot: Robot,
    points: Sequence[tuple[float, float, float]],
    holds: Sequence[ToolAttitude],
) -> bool:
    """Whether, according to the tables, one of ``holds`` brings a robot's tip to all
    ``points`` [m] in the world.

    The points are at one height. False if the tables do not cover them. The holds are
    relative to the world's axes, and do not turn with the object.
    """
    if not has_tables(robot):
        return False
    p = np.array(points, dtype=np.float64)
    x, y, z = robot.base
    out = p[:, :2] - (x, y)
    distance = np.hypot(out[:, 0], out[:, 1])
    bearing = np.arctan2(out[:, 1], out[:, 0]) - robot.base_yaw
    bearing = np.remainder(bearing + math.pi, 2.0 * math.pi) - math.pi
    height = float(p[0, 2]) - z
    standing = at_origin(robot)
    first = bearing * arm_kinematics(standing).turning
    for hold in holds:
        lean = hold.azimuth - robot.base_yaw - bearing
        table = _table(standing, height, hold.tilt)
        if _reached_with_tilt(table, _first_joint(standing), distance, first, lean):
            return True
    return False


def each_reached(robot: Robot, points: Array, azimuths: Array) -> NDArray[np.bool_]:
    """Mask (m,) of the ``points`` (m, 3) [m] in the world that a robot's tip reaches
    according to the tables.

    The points are at one height. The tool is upright, or leans towards one of the
    point's ``azimuths`` (m, k) [rad]. False for points that the tables do not cover.
    """
    out = np.full(len(points), False)
    if not has_tables(robot) or len(points) == 0:
        return out
    x, y, z = robot.base
    ahead = points[:, :2] - (x, y)
    bearing = np.arctan2(ahead[:, 1], ahead[:, 0]) - robot.base_yaw
    bearing = np.remainder(bearing + math.pi, 2.0 * math.pi) - math.pi
    cell = np.rint(np.hypot(ahead[:, 0], ahead[:, 1]) / STEP).astype(int) - 1
    covered = (cell >= 0) & (cell < len(DISTANCES))
    cell = np.clip(cell, 0, len(DISTANCES) - 1)
    lean = azimuths - robot.base_yaw - bearing[:, None]
    leans = np.rint(lean * (LEANS / (2.0 * math.pi))).astype(int) % LEANS
    standing = at_origin(robot)
    right, left = _first_joint(standing)
    height = float(points[0, 2]) - z
    first = bearing * arm_kinematics(standing).turning
    for tilt in TOOL_TILTS:
        table = _table(standing, height, tilt)
        columns = [np.zeros(len(points), dtype=int)] if tilt == 0.0 else list(leans.T)
        for column in columns:
            asked = covered & ~out
            table.know(column[asked])
            turned = table.turned[column, cell] + first
            inside = (turned >= right) & (turned <= left)
            out |= asked & table.ok[column, cell] & inside
    return out


def _reached_with_tilt(
    table: _Table,
    first_joint: tuple[float, float],
    distance: Array,
    first: Array,
    lean: Array,
) -> bool:
    """Whether all places (m,) are reached, according to the neighbouring cells of a
    table.

    ``first`` [rad] is the turn of the first joint from straight ahead to each place.
    """
    row = distance / STEP - 1.0
    low = np.floor(row).astype(int)
    if low.min() < 0 or low.max() + 1 >= len(DISTANCES):
        return False
    leans = [np.zeros(len(row), dtype=int)]
    if table.tilt > 0.0:
        around = lean * (LEANS / (2.0 * math.pi))
        leans = [
            np.floor(around).astype(int) % LEANS,
            np.ceil(around).astype(int) % LEANS,
        ]
    right, left = first_joint
    for column in leans:
        table.know(column)
        for near in (low, low + 1):
            turned = table.turned[column, near] + first
            inside = (turned >= right) & (turned <= left)
            if not (table.ok[column, near] & inside).all():
                return False
    return True


@lru_cache(maxsize=64)
def _first_joint(robot: Robot) -> tuple[float, float]:
    """Allowed range [rad] of the robot's first joint."""
    facts = arm_kinematics(robot).facts
    return facts.lower[0] + REACH_MARGIN, facts.upper[0] - REACH_MARGIN


_table = lru_cache(maxsize=1024)(_Table)


def has_tables(robot: Robot) -> bool:
    """Whether the robot is an arm whose first joint turns it about the vertical."""
    return robot.model != "hand" and arm_kinematics(robot).turning != 0.0
