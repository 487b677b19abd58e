"""An environment of single pushes: the agent chooses where to touch the object, in
which direction to push, and how far.
"""

from __future__ import annotations

import math
from bisect import bisect
from itertools import accumulate
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Task
from pushpressslide.learning.options import METADATA, checked_mode, poses_asked
from pushpressslide.learning.picture import Camera, Pixels
from pushpressslide.learning.push_task import (
    PERIOD,
    Threshold,
    faces_of,
    push_task,
)
from pushpressslide.learning.pushing import (
    Outcome,
    Pushing,
    checked_poses,
    errors,
    goal_of,
    outcome,
    wrapped_poses,
)
from pushpressslide.learning.registration import MISSING

try:
    import gymnasium
except ImportError as error:
    raise ImportError(MISSING) from error

SPREAD = (0.15, 0.15, math.pi)
"""Largest offset of a random start from the task's start, to either side: x, y [m] and
yaw [rad].
"""
THRESHOLD = (0.02, math.radians(10.0))
"""Default errors of a successful episode: position [m] and yaw [rad]."""
# largest angle of a push from the face's normal, to either side
LEAN = math.radians(60.0)
LONGEST = 0.1  # [m] length of the longest push
TICKS = 20  # number of steps per push
PUSHES = 40  # longest episode
ONE = np.zeros(1, dtype=np.intp)


class ChoiceEnv(gymnasium.Env):
    """One object that a tip pushes to a goal, with one push per step.

    An action (3,) in [-1, 1] gives the place along the flat faces that can be pushed,
    joined end to end; the angle from the inward normal, up to 60 degrees; and the
    length, up to 0.1 m. An observation (6,) is the pose of G and the goal. Reward,
    ``success`` and the ellipsoid of each face are as in ``environment.PushEnv``. A push
    ends when the tip passes an end of its face.
    """

    metadata: ClassVar[dict[str, Any]] = {**METADATA, "render_fps": 1}

    def __init__(
        self,
        task: Task | str | Path = "rear-push-rear",
        render_mode: str | None = None,
        threshold: Threshold | None = THRESHOLD,
    ) -> None:
        """Prepare a task as ``environment.PushEnv`` does."""
        push = push_task(task, threshold)
        self.render_mode = checked_mode(render_mode)
        self.push = push
        self._camera = Camera(push, spread=SPREAD[0])
        self._faces = [Pushing(face, 1) for face in faces_of(push)]
        lengths = [face.push.ends[1] - face.push.ends[0] for face in self._faces]
        self._ends = list(accumulate(lengths))
        far = push.reach + PUSHES * LONGEST
        high = np.array([far, far, math.pi] * 2)
        self.observation_space = gymnasium.spaces.Box(-high, high, dtype=np.float64)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (3,), dtype=np.float64)
        self._goal = goal_of(push)
        self._last = np.zeros(8)  # observation of the last push
        self._pushes = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start an episode up to 0.15 m from the task's start, at any yaw.

        ``start`` and ``goal`` in ``options`` are as in ``environment.PushEnv``.
        """
        super().reset(seed=seed)
        asked = poses_asked(options, 1)
        start = self._random_start() if asked.start is None else asked.start[0]
        self._goal = goal_of(self.push)
        if asked.goal is not None:
            self._goal = wrapped_poses(asked.goal[0])
        self._pushes = 0
        self._place(self._faces[0], wrapped_poses(start), 0.0)
        return self._last[:6], _info(self._last, False)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Make one push."""
        out = self.pushed(self._last[:3], action)
        self._last = out.observations[0]
        self._pushes += 1
        success = bool(out.success[0])
        late = self._pushes >= PUSHES and not success
        info = _info(self._last, success)
        return self._last[:6], float(out.rewards[0]), success, late, info

    def pushed(self, pose: Array, action: Array) -> Outcome:
        """Outcome of a push from a pose X_WG (3,), without a change of the episode."""
        place, lean, length = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        along = 0.5 * (float(place) + 1.0) * self._ends[-1]
        number = min(bisect(self._ends, along), len(self._ends) - 1)
        pushing = self._faces[number]
        low, high = pushing.push.ends
        pushing.place(
            ONE, pose, self._goal, low + along - (self._ends[number] - high + low)
        )
        nx, ny = pushing.push.normal
        direction = float(pose[2]) + math.atan2(ny, nx) + LEAN * float(lean)
        speed = 0.5 * (float(length) + 1.0) * LONGEST / (TICKS * PERIOD)
        velocity = np.array([[math.cos(direction), math.sin(direction)]]) * speed
        for _ in range(TICKS):
            out = pushing.step(velocity)
            if out.terminated[0]:
                break
        no = np.zeros(1, dtype=np.bool_)
        return outcome(self.push, out.observations, no, no)

    def render(self) -> Pixels | None:
        """Picture (96, 96, 3) after the last push. None if the environment has no
        render mode.
        """
        if self.render_mode is None:
            return None
        return self._camera.picture(self._last)

    def _place(self, pushing: Pushing, pose: Array, along: float) -> None:
        pushing.place(ONE, pose, self._goal, along)
        self._last = pushing.observations()[0]

    def _random_start(self) -> Array:
        """A random start X_WG (3,)."""
        start = self.push.task.true_start
        offset = self.np_random.uniform(-1.0, 1.0, 3) * SPREAD
        own = np.array([start.x, start.y, start.yaw]) + offset
        return np.asarray(checked_poses(own, 1)[0])


def _info(observation: Array, success: bool) -> dict[str, Any]:
    distance, turn = errors(observation)
    return {"success": success, "distance": float(distance), "angle": float(turn)}
