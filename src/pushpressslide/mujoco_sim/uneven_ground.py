"""A support whose friction differs with place, speed and time, under the feet of
MuJoCo's bodies. It is set for each foot in each control period.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.mechanics.ground import Ground
from pushpressslide.mujoco_sim.free_body import planar_pose, planar_twist
from pushpressslide.mujoco_sim.scene import MujocoScene


class _Standing(NamedTuple):
    """The feet of one free body."""

    position: int  # first index among the positions
    velocity: int  # first index among the velocities
    points: Array  # (n, 2) [m] in the frame of its shape
    pairs: NDArray[np.int_]  # (n, m) of each foot with the m parts of the support
    frictions: Array  # (n, m) of these pairs on an even support


class UnevenGround:
    """Friction of the support under all feet of a scene."""

    def __init__(self, scene: MujocoScene, ground: Ground) -> None:
        """Take the pairs of a ``scene`` with their frictions."""
        self._model = scene.model
        self._frame = scene.frame
        self._ground = ground
        self._bodies = []
        for name, body in scene.bodies.items():
            ids = np.array([scene.model.pair(pair).id for pair in body.feet])
            pairs = ids.reshape(len(body.points), -1)
            frictions = scene.model.pair_friction[pairs, 0].copy()
            place = (scene.position(name), scene.velocity(name))
            self._bodies.append(_Standing(*place, body.points, pairs, frictions))

    def update(self, state: Any, time: float) -> None:
        """Set the frictions for a state and a time [s]."""
        for body in self._bodies:
            q = state.qpos[body.position : body.position + 7].tolist()
            v = state.qvel[body.velocity : body.velocity + 6].tolist()
            pose = planar_pose(q, self._frame)
            twist = planar_twist(v, self._frame)
            factors = self._ground.under(body.points, pose, twist, time)
            frictions = factors[:, None] * body.frictions
            self._model.pair_friction[body.pairs, :2] = frictions[:, :, None]
