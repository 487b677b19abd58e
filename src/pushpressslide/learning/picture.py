"""Pictures of a pushed object from above, made with NumPy alone, for policies with
vision.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.learning.command_rows import SEEN
from pushpressslide.learning.command_rows import TIP as TIP_WIDTH
from pushpressslide.learning.push_task import SPREAD, PushTask

Pixels = NDArray[np.uint8]
Picture = Callable[[Array], Pixels]
SIDE = 96
"""Pixels along a side of a picture."""
GROUND = (255, 255, 255)
GOAL = (170, 220, 170)
OBJECT = (80, 110, 170)
HEADING = (30, 50, 100)  # colour of a dot near the front, which distinguishes the sides
TIP = (200, 60, 40)
DOT = 0.15  # radius of the dot over the object's
AHEAD = 0.5  # distance of the dot from G's origin along x, over the object's radius


class TopView:
    """Camera that looks down on a task: x to the right, y up, start and goal in the
    picture.
    """

    def __init__(self, task: Task, around: float, side: int = SIDE) -> None:
        """Prepare square pictures of ``side`` pixels that extend ``around`` [m] beyond
        the object at start and goal.
        """
        self._outline = np.array(task.object.shape.outline())
        self._radius = task.object.radius
        xs = (task.true_start.x, task.goal.x)
        ys = (task.true_start.y, task.goal.y)
        margin = self._radius + around
        width = max(max(xs) - min(xs), max(ys) - min(ys)) + 2.0 * margin
        across = ((np.arange(side) + 0.5) / side - 0.5) * width
        # (1, side) [m] positions of the pixels
        self._x = 0.5 * sum(xs) + across[None, :]
        # (side, 1) [m] positions of the pixels, from the top down
        self._y = 0.5 * sum(ys) - across[:, None]

    def view(
        self, X_WG: Pose2, goal: Pose2, tips: Sequence[Point], radius: float
    ) -> Pixels:
        """Picture (side, side, 3): goal, object with a dot towards its front, and tips
        of a ``radius`` [m].
        """
        out = np.empty(
            (*np.broadcast_shapes(self._x.shape, self._y.shape), 3), np.uint8
        )
        out[:] = GROUND
        out[self._covered(goal)] = GOAL
        out[self._covered(X_WG)] = OBJECT
        dot = X_WG.apply((AHEAD * self._radius, 0.0))
        out[self._disc(*dot, DOT * self._radius)] = HEADING
        for tip in tips:
            out[self._disc(*tip, radius)] = TIP
        return out

    def _disc(self, x: float, y: float, radius: float) -> NDArray[np.bool_]:
        """Pixels of a disc."""
        out: NDArray[np.bool_] = (self._x - x) ** 2 + (self._y - y) ** 2 <= radius**2
        return out

    def _covered(self, X_WG: Pose2) -> NDArray[np.bool_]:
        """Pixels covered by the shape at a pose: those with an odd number of edges to
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


class Camera(TopView):
    """Camera for the environments of one push."""

    def __init__(
        self, push: PushTask, side: int = SIDE, spread: float = SPREAD[0]
    ) -> None:
        """Prepare square pictures of ``side`` pixels, for starts up to ``spread`` [m]
        away from the task's start.
        """
        self._tip = push.task.robots[0].tip_radius
        self._normal = push.normal
        super().__init__(push.task, 2.0 * (self._tip + spread), side)

    def picture(self, observation: Array) -> Pixels:
        """Picture (side, side, 3) of an observation (8,)."""
        x, y, yaw, goal_x, goal_y, goal_yaw, tip_x, tip_y = observation.tolist()
        X_WG = Pose2(x, y, yaw)
        nx, ny = X_WG.rotate(self._normal)
        tip = (tip_x - self._tip * nx, tip_y - self._tip * ny)
        return self.view(X_WG, Pose2(goal_x, goal_y, goal_yaw), (tip,), self._tip)


class CommandCamera(TopView):
    """Camera for the environments with commanded tips, in the support's axes."""

    def __init__(self, task: Task, side: int = SIDE) -> None:
        """Prepare square pictures of ``side`` pixels."""
        self._tip = task.robots[0].tip_radius
        super().__init__(task, 4.0 * self._tip, side)

    def picture(self, observation: Array) -> Pixels:
        """Picture (side, side, 3) of an observation (7 + 9 A,)."""
        _, x, y, yaw, goal_x, goal_y, goal_yaw = observation[:SEEN].tolist()
        tips = observation[SEEN:].reshape(-1, TIP_WIDTH)[:, :2].tolist()
        goal = Pose2(goal_x, goal_y, goal_yaw)
        return self.view(Pose2(x, y, yaw), goal, [(a, b) for a, b in tips], self._tip)
