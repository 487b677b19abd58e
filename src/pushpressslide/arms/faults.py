"""Drives of an arm that differs from the controller's model of it (``core.truth``)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pushpressslide.arms.model import ArmModel, Drives, PositionDrives
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import Vector3
from pushpressslide.core.truth import Truth
from pushpressslide.execution.arm import ArmDynamics

RIPPLES = 200.0
"""Periods of a torque's ripple in one turn of the joint: two for each turn of a motor
with a strain-wave gear of 100.
"""
SWEEPS = 10
"""Passes over the joints in which their dry frictions are found."""
CROSSING = 0.1
"""Speed [rad/s] at which a motor crosses the play of its gear."""


class JointFaults(NamedTuple):
    """Constant errors of an arm's joints."""

    encoder_bias: Array  # (n,) [rad]
    torque_factor: Array  # (n,) torque of a motor as a multiple of the commanded one
    ripple: float  # amplitude, as a share of the torque
    phase: Array  # (n,) [rad] of the ripple
    dry_friction: Array  # (n,) [N m]
    backlash: float  # [rad]


def joint_faults(
    truth: Truth,
    effort: Array,
    encoders: np.random.Generator,
    motors: np.random.Generator,
) -> JointFaults:
    """Errors of the joints of an arm with ``effort`` limits (n,) [N m], drawn from a
    stream of its encoders and one of its motors.

    A joint without a limit has no dry friction.
    """
    n = len(effort)
    friction = np.where(np.isfinite(effort), truth.coulomb_friction * effort, 0.0)
    return JointFaults(
        truth.encoder_bias * encoders.normal(size=n),
        1.0 + truth.torque_scale * motors.normal(size=n),
        truth.torque_ripple,
        2.0 * np.pi * motors.random(size=n),
        friction,
        truth.backlash,
    )


def dry_friction(
    arm: ArmDynamics, torque: Array, force: Vector3, limits: Array, dt: float
) -> Array:
    """Torques (n,) [N m], within +-``limits`` (n,) [N m], with which dry friction acts on
    the joints in a tick of ``dt`` [s].

    They take as much of the joints' energy as they can: each stops its joint, or is at
    its limit against the motion. ``torque`` (n,) [N m] is that of the motors, ``force``
    [N] that of the tip on what it touches, in world axes.
    """
    mobility = np.linalg.inv(arm.M)
    free = torque - arm.bias - arm.J[3:].T @ np.array(force)
    speed = arm.v + dt * (mobility @ free)
    own = np.diag(mobility)
    friction = np.zeros_like(limits)
    for _ in range(SWEEPS):
        for j, limit in enumerate(limits.tolist()):
            stopping = friction[j] - speed[j] / (dt * own[j])
            change = min(max(stopping, -limit), limit) - friction[j]
            friction[j] += change
            speed += dt * change * mobility[:, j]
    return friction


class FaultyDrives:
    """Drives behind encoders with errors, and with motors and joints that are not as
    the controller believes.
    """

    def __init__(
        self,
        drives: Drives,
        model: ArmModel,
        faults: JointFaults,
        dt: float,
    ) -> None:
        """Wrap the ``drives`` of an arm with the true ``model``, in ticks of ``dt`` [s]."""
        self.state: ArmDynamics  # true, as last read
        self.force: Vector3  # [N] of the tip in true world axes, as last read
        self.encoder_bias = faults.encoder_bias
        self._drives = drives
        self._model = model
        self._faults = faults
        self._dt = dt
        # (n,) [rad] of each motor before its link; None before the first torque
        self._lead: Array | None = None

    @property
    def time(self) -> float:
        """Time [s] of the cell's clock."""
        return self._drives.time

    def joints(self) -> Array:
        """Positions (n,) [rad] that the encoders show, and velocities (n,) [rad/s]."""
        x = self._drives.joints()
        self.state = self._model.state_at(x)
        bias = self.encoder_bias
        if self._lead is not None:
            bias = bias + self._lead
        shown: Array = x + np.concatenate([bias, np.zeros_like(bias)])
        return shown

    def tip_force(self, arm: ArmDynamics) -> Vector3:
        """Force [N] of the tip, measured in the tip's axes, in the world axes according
        to ``arm``, which is believed.
        """
        self.force = self._drives.tip_force(self.state)
        R_believed = arm.rotation @ self.state.rotation.T
        fx, fy, fz = (R_believed @ np.array(self.force)).tolist()
        return (fx, fy, fz)

    def drive(self, torque: Array) -> None:
        """Apply joint torques (n,) [N m] until the next call, as the motors understand
        them.
        """
        faults = self._faults
        angle = RIPPLES * self.state.q + faults.phase
        torque = torque * faults.torque_factor * (1.0 + faults.ripple * np.sin(angle))
        if faults.backlash > 0.0:
            torque = self._through_gears(torque)
        if faults.dry_friction.any():
            torque = torque + dry_friction(
                self.state, torque, self.force, faults.dry_friction, self._dt
            )
        self._drives.drive(torque)

    def _through_gears(self, torque: Array) -> Array:
        """Torque (n,) [N m] on the links: none while a motor crosses the play of its
        gear to the other side.
        """
        ends = 0.5 * self._faults.backlash * np.sign(torque)
        if self._lead is None:
            self._lead = ends
        meshed = self._lead == ends
        step = CROSSING * self._dt
        self._lead = np.clip(ends, self._lead - step, self._lead + step)
        out: Array = np.where(meshed, torque, 0.0)
        return out


class FaultyPositionDrives(FaultyDrives):
    """The same for drives with position loops of their own."""

    _drives: PositionDrives

    def follow(self, arm: ArmDynamics, start: Array, speed: Array) -> Array:
        """Let the joints follow positions, as ``arms.model.PositionDrives.follow``."""
        torque: Array = self._drives.follow(arm, start - self.encoder_bias, speed)
        return torque
