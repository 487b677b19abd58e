"""Joint velocities from the velocity of a tip, for an arm that takes positions or
velocities.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array

SINGULAR = 1e-3
"""Square, in the Jacobian's units, that damps motions of the tip that the joints hardly
produce.
"""
POSTURE_RATE = 4.0
"""Rate [1/s] at which the joints that do not move the tip come to their reference."""
SPEED_SHARE = 0.8
"""Largest joint speed, as a share of its limit."""
RAMP_TIME = 0.2
"""Time [s] in which a joint's speed may rise from 0 to its limit."""


@dataclass(frozen=True, slots=True)
class JointVelocities:
    """Joint velocities inside the limits of an arm."""

    lower: Array  # (n,) [rad]
    upper: Array  # (n,) [rad]
    speed: Array  # (n,) [rad/s]

    def of_tip(
        self, J: Array, twist: Array, q: Array, posture: Array, rate: Array
    ) -> Array:
        """Joint velocities (n,) for a tip's ``twist`` (6,), rows [angular; linear].

        ``J`` (6, n) is the tip's Jacobian at ``q`` (n,). What does not move the tip
        follows ``posture`` (n,) with its ``rate`` (n,). Near a singular posture the
        damped inverse leaves a part of the twist undone.
        """
        J = self._without_blocked(J, q)
        inverse = J.T @ np.linalg.inv(J @ J.T + SINGULAR * np.eye(6))
        own = rate + POSTURE_RATE * (posture - q)
        wanted: Array = own + inverse @ (twist - J @ own)
        return self.limited(wanted, q)

    def _without_blocked(self, J: Array, q: Array) -> Array:
        """The Jacobian, with the columns of joints at their limits taken out."""
        buffer = margins.ARM.joint_buffer
        near = np.minimum(q - self.lower, self.upper - q) / buffer
        share: Array = np.minimum(np.maximum(near, 0.0), 1.0)
        return J * share

    def limited(self, wanted: Array, q: Array) -> Array:
        """Velocities (n,) slowed together below the speed limits, without motion beyond
        a joint limit.
        """
        largest = float(np.max(np.abs(wanted) / (SPEED_SHARE * self.speed)))
        out: Array = wanted / max(1.0, largest)
        beyond = ((q <= self.lower) & (out < 0.0)) | ((q >= self.upper) & (out > 0.0))
        return np.where(beyond, 0.0, out)

    def ramped(self, wanted: Array, before: Array, dt: float) -> Array:
        """Velocities (n,) that differ from ``before`` by no more than a ramp allows."""
        step = dt / RAMP_TIME * self.speed
        out: Array = before + np.clip(wanted - before, -step, step)
        return out
