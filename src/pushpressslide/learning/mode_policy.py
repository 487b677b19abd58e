"""Controller of any mode as a policy, from an observation to an action."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.control.controller import Controller
from pushpressslide.control.state import ControllerState
from pushpressslide.core.arrays import Array
from pushpressslide.learning.command_rows import row_measurement

if TYPE_CHECKING:
    from pushpressslide.learning.command_env import CommandEnv


class ModePolicy:
    """Policy of an environment's plan: its mode's controller, through touch, motion and
    release.
    """

    def __init__(self, env: CommandEnv) -> None:
        """Prepare the policy. Call ``reset`` after each reset of the environment."""
        self._env = env
        self._controller: Controller | None = None
        self._state: ControllerState | None = None

    def reset(self) -> None:
        """Take the controller of the environment's current plan."""
        self._controller = None
        self._state = None

    def __call__(self, observation: Array) -> Array:
        """Commands (25 A,) of the tips for an observation (7 + 9 A,)."""
        measurement = row_measurement(np.asarray(observation))
        if self._controller is None or self._state is None:
            loop = self._env.loop
            self._controller = loop.controller
            self._state = self._controller.init(measurement, loop.approach.held)
        step = self._controller.step(self._state, measurement)
        self._state = step.state
        if step.event is not None:
            self._state = self._controller.supervisor.step(step.event)
        rows = [self._env.scale.row(command) for command in step.commands]
        return np.concatenate(rows)
