"""Many pushed objects as one vectorised Gymnasium environment."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pushpressslide.batch import fast
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.task import Task
from pushpressslide.learning.options import METADATA, checked_mode, poses_asked
from pushpressslide.learning.picture import Camera, Pixels
from pushpressslide.learning.push_task import Threshold, push_task
from pushpressslide.learning.pushing import Flags, Indices, Pushing, drawn_start, errors
from pushpressslide.learning.registration import MISSING, SLOW

try:
    from gymnasium.utils.seeding import np_random
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space
except ImportError as error:
    raise ImportError(MISSING) from error

from pushpressslide.learning.spaces import action_space, observation_space


class PushVectorEnv(VectorEnv):
    """Many objects of one task, each as in ``environment.PushEnv``.

    An episode that has ended restarts in the next step, and the action of this step is
    ignored. Each object has its own random numbers: with a seed s, object i behaves
    like a single environment with the seed s + i.
    """

    metadata: ClassVar[dict[str, Any]] = {
        **METADATA,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        task: Task | str | Path = "rear-push-rear",
        render_mode: str | None = None,
        threshold: Threshold | None = None,
    ) -> None:
        """Prepare ``num_envs`` objects of a task. ``threshold`` replaces the task's
        tolerance: position [m] and yaw [rad].

        Raises MissingPackageError without numba, and TaskError for a task that is not
        one push.
        """
        if fast.installed() is None:
            raise MissingPackageError(SLOW)
        push = push_task(task, threshold)
        self.render_mode = checked_mode(render_mode)
        self._camera = Camera(push)
        self.push = push
        self.num_envs = num_envs
        self.single_observation_space = observation_space(push)
        self.single_action_space = action_space(push)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._pushing = Pushing(push, num_envs)
        self._rngs = self._seeded(None)
        self._ended = np.zeros(num_envs, dtype=np.bool_)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Array, dict[str, Any]]:
        """Start all episodes.

        ``options["start"]`` is one start (3,), or one start per object (n, 3): x, y [m]
        and yaw [rad] of X_WG. ``options["goal"]`` has the same form. An episode that
        restarts has the task's goal.
        """
        asked = poses_asked(options, self.num_envs)
        if seed is not None:
            self._rngs = self._seeded(seed)
        self._ended[:] = False
        everyone = np.arange(self.num_envs, dtype=np.intp)
        starts = self._random_starts(everyone) if asked.start is None else asked.start
        self._pushing.place(everyone, starts, asked.goal)
        observations = self._pushing.observations()
        return observations, _info(observations, np.zeros_like(self._ended))

    def step(self, actions: Array) -> tuple[Array, Array, Flags, Flags, dict[str, Any]]:
        """Move all tips for one period at the velocities ``actions`` (n, 2) [m/s]."""
        begun = np.flatnonzero(self._ended)
        observations, rewards, terminated, truncated, success = self._pushing.step(
            actions
        )
        if begun.size:
            self._pushing.place(begun, self._random_starts(begun))
            observations[begun] = self._pushing.observations()[begun]
            rewards[begun] = 0.0
            for flags in (terminated, truncated, success):
                flags[begun] = False
        self._ended = terminated | truncated
        return (
            observations,
            rewards,
            terminated,
            truncated,
            _info(observations, success),
        )

    def render(self) -> tuple[Pixels, ...] | None:
        """A picture of each object. None if the environment has no render mode."""
        if self.render_mode is None:
            return None
        return tuple(map(self._camera.picture, self._pushing.observations()))

    def _random_starts(self, rows: Indices) -> Array:
        """Random starts (n, 3) near the task's start."""
        return np.array([drawn_start(self.push, self._rngs[i]) for i in rows.tolist()])

    def _seeded(
        self, seed: int | Sequence[int | None] | None
    ) -> list[np.random.Generator]:
        """Random generator of each object."""
        seeds: Sequence[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, int | np.integer):
            seeds = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = seed
        if len(seeds) != self.num_envs:
            raise ValueError(
                f"{len(seeds)} seeds are not allowed; allowed: {self.num_envs}, one each"
            )
        return [np_random(one)[0] for one in seeds]


def _info(observations: Array, success: Flags) -> dict[str, Any]:
    distance, turn = errors(observations)
    info: dict[str, Any] = {"success": success, "distance": distance, "angle": turn}
    everyone = np.ones(len(success), dtype=np.bool_)
    return info | {f"_{name}": everyone for name in tuple(info)}
