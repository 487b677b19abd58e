"""One pushed object as a Gymnasium environment."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.task import Task
from pushpressslide.learning.exact import ExactPushing
from pushpressslide.learning.options import METADATA, checked_mode, poses_asked
from pushpressslide.learning.picture import Camera, Pixels
from pushpressslide.learning.push_task import Threshold, push_task
from pushpressslide.learning.pushing import Pushing, drawn_start, errors
from pushpressslide.learning.registration import MISSING

try:
    import gymnasium
except ImportError as error:
    raise ImportError(MISSING) from error

from pushpressslide.learning.spaces import action_space, observation_space

ONE = np.zeros(1, dtype=np.intp)


class PushEnv(gymnasium.Env):
    """One object that a tip pushes to a goal.

    Observations (8,) are laid out as ``pushing.OBSERVATION``; actions (2,) are
    velocities [m/s] of the tip in the world. The reward [m] is the negative sum of the
    distance to the goal and rho times the angle to the goal. ``success`` in ``info``
    says that the object is within the task's tolerance. Success ends the episode, and
    so does a tip that leaves its face.
    """

    metadata: ClassVar[dict[str, Any]] = METADATA

    def __init__(
        self,
        task: Task | str | Path = "rear-push-rear",
        exact: bool = False,
        render_mode: str | None = None,
        threshold: Threshold | None = None,
    ) -> None:
        """Prepare a task, given directly, by the name of a shipped task, or by the path
        of a file.

        With ``exact``, the planar engine simulates the object on its exact limit
        surface instead of an ellipsoid. ``render_mode`` is None, or "rgb_array" for
        pictures by ``picture.Camera``. ``threshold`` replaces the task's tolerance:
        position [m] and yaw [rad].
        """
        push = push_task(task, threshold)
        self.render_mode = checked_mode(render_mode)
        self._camera = Camera(push)
        self.push = push
        self.observation_space = observation_space(push)
        self.action_space = action_space(push)
        self._pushing = ExactPushing(push) if exact else Pushing(push, 1)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Start an episode near the task's start, or at ``options["start"]``: x, y [m]
        and yaw [rad] of X_WG. ``options["goal"]`` replaces the task's goal.
        """
        super().reset(seed=seed)
        asked = poses_asked(options, 1)
        starts = asked.start
        if starts is None:
            starts = drawn_start(self.push, self.np_random)
        self._pushing.place(ONE, starts, asked.goal)
        observation = self._pushing.observations()
        return observation[0], _info(observation, False)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Move the tip for one period."""
        out = self._pushing.step(np.reshape(action, (1, 2)))
        return (
            out.observations[0],
            float(out.rewards[0]),
            bool(out.terminated[0]),
            bool(out.truncated[0]),
            _info(out.observations, bool(out.success[0])),
        )

    def render(self) -> Pixels | None:
        """Picture (96, 96, 3) of the current state. None if the environment has no
        render mode.
        """
        if self.render_mode is None:
            return None
        return self._camera.picture(self._pushing.observations()[0])


def _info(observations: Array, success: bool) -> dict[str, Any]:
    distance, turn = errors(observations)
    return {
        "success": success,
        "distance": float(distance[0]),
        "angle": float(turn[0]),
    }
