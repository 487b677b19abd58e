"""What an arm needs to know of its own dynamics."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.robots.facts import RobotFacts


class ArmModel(Protocol):
    """Kinematics and dynamics of one arm; any library of rigid bodies can fill it in."""

    @property
    def facts(self) -> RobotFacts:
        """The maker's limits of its joints."""

    @property
    def size(self) -> int:
        """Number of its joints, n."""

    def state_at(self, x: Array) -> ArmDynamics:
        """Pose and velocity of the tip, Jacobian, mass matrix and bias torques at joint
        positions and velocities ``x`` (2 n,) [rad, rad/s].
        """


def at_rest(q: Array) -> Array:
    """State (2 n,) of joints at rest at positions ``q`` (n,)."""
    return np.concatenate([q, np.zeros_like(q)])
