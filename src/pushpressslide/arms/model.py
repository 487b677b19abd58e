"""Interface of a torque-driven arm: its dynamics, encoders and motors."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.robots.facts import RobotFacts


class ArmModel(Protocol):
    """Kinematics and dynamics of one arm, implemented by any library of rigid bodies."""

    @property
    def facts(self) -> RobotFacts:
        """The manufacturer's joint limits."""

    @property
    def size(self) -> int:
        """Number n of joints."""

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
        """Present joint positions and velocities (2 n,) [rad, rad/s]."""

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        """Present force [N] of the tip ON the object, in world axes. The joints of
        ``arm`` must be the last ones read.
        """

    def drive(self, torque: Array) -> None:
        """Apply joint torques (n,) [N m] until the next call."""


@runtime_checkable
class PositionDrives(Drives, Protocol):
    """Drives with position loops of their own."""

    def follow(self, arm: ArmDynamics, start: Array, speed: Array) -> Array:
        """Let the joints follow positions that are ``start`` (n,) [rad] now and change
        by ``speed`` (n,) [rad/s] until the next call.

        Returns the torques (n,) [N m] applied last. The joints of ``arm`` must be the
        last ones read.
        """


def at_rest(q: Array) -> Array:
    """State (2 n,) of resting joints at positions ``q`` (n,)."""
    return np.concatenate([q, np.zeros_like(q)])
