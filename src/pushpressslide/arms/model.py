"""What an arm that is driven by torques needs: its own dynamics, encoders and motors."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
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


class Drives(Protocol):
    """Encoders, force sensor and motors of one arm, simulated or real."""

    @property
    def time(self) -> float:
        """Time [s] of the cell's clock."""

    def joints(self) -> Array:
        """Joint positions and velocities (2 n,) [rad, rad/s] now."""

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        """Force [N] of the tip ON what it touches now, world axes, of an ``arm`` whose
        joints are where they were read last.
        """

    def drive(self, torque: Array) -> None:
        """Apply joint torques (n,) [N m] until the next call."""


def at_rest(q: Array) -> Array:
    """State (2 n,) of joints at rest at positions ``q`` (n,)."""
    return np.concatenate([q, np.zeros_like(q)])
