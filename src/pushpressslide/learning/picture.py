"""Pictures of a pushed object from above, in NumPy alone, for policies with vision."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.learning.push_task import SPREAD, PushTask

Pixels = NDArray[np.uint8]
SIDE = 96
"""Pixels along a side of a picture."""
GROUND = (255, 255, 255)
GOAL = (170, 220, 170)
OBJECT = (80, 110, 170)
HEADING = (30, 50, 100)  # of a dot ahead, which tells the sides apart
TIP = (200, 60, 40)
DOT = 0.15  # of the object's radius
AHEAD = 0.5  # of its radius, from G's origin along x


class Camera:
    """Camera looking down on a task: x to the right, y up, start and goal inside."""

    def __init__(self, push: PushTask, side: int = SIDE) -> None:
        """Prepare square pictures of ``side`` pixels."""
        task = push.task
        self._outline = np.array(task.object.shape.outline())
        self._radius = task.object.radius
        self._tip = task.robots[0].tip_radius
        self._normal = np.array(push.normal)
        xs = (task.true_start.x, task.goal.x)
        ys = (task.true_start.y, task.goal.y)
        margin = self._radius + 2.0 * (self._tip + SPREAD[0])
        width = max(max(xs) - min(xs), max(ys) - min(ys)) + 2.0 * margin
        across = ((np.arange(side) + 0.5) / side - 0.5) * width
        self._x = 0.5 * sum(xs) + across[None, :]  # (1, side) [m] of pixels
        self._y = 0.5 * sum(ys) - across[:, None]  # (side, 1) from the top down

    def picture(self, observation: Array) -> Pixels:
        """Picture (side, side, 3) of an observation (8,): goal, object with a dot
        towards its front, tip.
        """
        x, y, yaw, goal_x, goal_y, goal_yaw, tip_x, tip_y = observation.tolist()
        X_WG = Pose2(x, y, yaw)
        out = np.empty(
            (*np.broadcast_shapes(self._x.shape, self._y.shape), 3), np.uint8
        )
        out[:] = GROUND
        out[self._covered(Pose2(goal_x, goal_y, goal_yaw))] = GOAL
        out[self._covered(X_WG)] = OBJECT
        dot = X_WG.apply((AHEAD * self._radius, 0.0))
        out[self._disc(*dot, DOT * self._radius)] = HEADING
        nx, ny = X_WG.rotate((float(self._normal[0]), float(self._normal[1])))
        out[self._disc(tip_x - self._tip * nx, tip_y - self._tip * ny, self._tip)] = TIP
        return out

    def _disc(self, x: float, y: float, radius: float) -> NDArray[np.bool_]:
        """Pixels of a disc."""
        out: NDArray[np.bool_] = (self._x - x) ** 2 + (self._y - y) ** 2 <= radius**2
        return out

    def _covered(self, X_WG: Pose2) -> NDArray[np.bool_]:
        """Pixels that the shape covers at a pose: those with an odd number of edges to
        their right.
        """
        corners = np.array([X_WG.apply((x, y)) for x, y in self._outline.tolist()])
        inside = np.zeros((self._y.shape[0], self._x.shape[1]), dtype=np.bool_)
        for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, 0), strict=True):
            if ay == by:
                continue
            between = (ay > self._y) != (by > self._y)
            crossing = ax + (self._y - ay) * (bx - ax) / (by - ay)
            inside ^= between & (self._x < crossing)
        return inside
