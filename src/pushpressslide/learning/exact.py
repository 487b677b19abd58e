"""One pushed object on the exact limit surface.

The planar engine with a rigid tip takes the place of ``pushing.Pushing``.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Belief
from pushpressslide.learning.push_task import PERIOD, PushTask
from pushpressslide.learning.pushing import (
    Indices,
    Outcome,
    clipped,
    goal_of,
    outcome,
    steps_to,
    wrapped,
    wrapped_poses,
)
from pushpressslide.planar.world import World

TICKS = 5  # ticks of the engine per step
RIGID = 1e5  # [N s/m] damping of the tip: a force of 10 N slows it by 0.1 mm/s
POINT = 1e-6  # [m] radius of the tip
BEHIND = 1e-3  # [m] behind the face at which a tip counts as past it


class ExactPushing:
    """One object of a task with its tip."""

    count = 1

    def __init__(self, push: PushTask) -> None:
        """Put the object at the task's start."""
        self.push = push
        tip = replace(push.task.robots[0], tip_radius=POINT)
        task = replace(push.task, robots=(tip,), belief=Belief())
        self._contact = push.contact
        self._X_GB = task.object.X_GB
        self._world = World(task, (push.contact,), PERIOD / TICKS)
        start = push.task.true_start
        self.place(np.zeros(1, dtype=np.intp), (start.x, start.y, start.yaw))

    def place(
        self, rows: Indices, start_poses: ArrayLike, goals: Array | None = None
    ) -> None:
        """Start an episode with the object at ``start_poses`` (..., 3) X_WG and the tip
        at the middle of its face.

        ``rows`` has no effect, since there is only one object. ``goals`` (..., 3) X_WG
        are those of the task by default.
        """
        self._goal = goal_of(self.push)
        self._most_steps = self.push.steps
        if goals is not None:
            self._goal = wrapped_poses(np.reshape(goals, 3))
            self._most_steps = int(np.max(steps_to(self.push, start_poses, goals)))
        x, y, yaw = np.reshape(np.asarray(start_poses, dtype=np.float64), 3).tolist()
        X_WG = Pose2(x, y, yaw)
        self._now = self._world.start(X_WG, X_WG, 0.0)
        self._steps = 0

    def observations(self) -> Array:
        """Observations (1, 8)."""
        X_WG = self._now.X_WB.compose(self._X_GB.inverse())
        x, y, _ = self._now.tips[0].position
        seen = np.array([[X_WG.x, X_WG.y, X_WG.yaw, *self._goal, x, y]])
        seen[:, 2] = wrapped(seen[:, 2])
        return seen

    def step(self, velocities: ArrayLike) -> Outcome:
        """Move the tip for one period, as ``pushing.Pushing.step`` does."""
        ((vx, vy),) = clipped(self.push, velocities).tolist()
        for _ in range(TICKS):
            self._now = self._world.step(self._now, (self._command((vx, vy)),))
        self._steps += 1
        passed = np.array([self._passed()])
        over = np.array([self._steps >= self._most_steps])
        return outcome(self.push, self.observations(), passed, over)

    def _command(self, velocity: Point) -> TipCommand:
        """Command of a tip that moves at a given velocity, whatever the resistance."""
        nx, ny = self._contact.normal
        return TipCommand(
            force=(0.0, 0.0, 0.0),
            position=self._now.tips[0].position,
            velocity=(*velocity, 0.0),
            stiffness=(0.0, 0.0, 0.0),
            damping=(RIGID, RIGID, RIGID),
            normal_yaw=self._now.X_WB.yaw + math.atan2(ny, nx),
            tool_yaw=0.0,
            tool_yaw_rate=0.0,
            servo_cap=math.inf,
            progress=0.0,
        )

    def _passed(self) -> bool:
        """Whether the tip is behind the line of its face."""
        x, y, _ = self._now.tips[0].position
        px, py = self._now.X_WB.unapply((x, y))
        (fx, fy), (nx, ny) = self._contact.point, self._contact.normal
        return (px - fx) * nx + (py - fy) * ny > BEHIND
