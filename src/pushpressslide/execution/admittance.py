"""Tip velocity from a tip command, for an arm that takes positions or velocities.

It is the velocity at which the command's force, spring and damper balance the measured
force. An arm that reacts late needs a larger damper than the command's: the tip and
what it touches are a spring, and the loop over it has to be slower than the arm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, TipState, Vector3


@dataclass(frozen=True, slots=True)
class Admittance:
    """Motion of a tip whose arm takes ``reaction`` [s] to follow a command."""

    reaction: float

    @property
    def damping(self) -> float:
        """Smallest stable damping [N s/m], with a phase margin of about 60 degrees."""
        arm = margins.ARM
        return arm.loop_share * arm.contact_stiffness * self.reaction

    def velocity(self, command: TipCommand, tip: TipState) -> Vector3:
        """Velocity [m/s] of the tip in the support's frame.

        Along axes with a spring the tip goes to the command's place, at
        ``margins.ARM.position_rate`` in free space.
        """
        c = math.cos(command.normal_yaw)
        s = math.sin(command.normal_yaw)
        gaps = (
            command.position[0] - tip.position[0],
            command.position[1] - tip.position[1],
            command.position[2] - tip.position[2],
        )
        missing = (
            command.force[0] - tip.force[0],
            command.force[1] - tip.force[1],
            command.force[2] - tip.force[2],
        )
        added = [
            self._added(gap, force, spring, damper)
            for gap, force, spring, damper in zip(
                _in_axes(gaps, c, s),
                _in_axes(missing, c, s),
                command.stiffness,
                command.damping,
                strict=True,
            )
        ]
        along, across, up = _limited(added)
        vx, vy, vz = command.velocity
        return (vx + c * along - s * across, vy + s * along + c * across, vz + up)

    def _added(self, gap: float, force: float, spring: float, damper: float) -> float:
        """Velocity [m/s] besides the reference's along one axis."""
        added = force / max(damper, self.damping)
        if spring > 0.0:
            added += margins.ARM.position_rate * gap
        return added


def _in_axes(v: Vector3, c: float, s: float) -> Vector3:
    """Components along n, t and height of a vector in the support's frame."""
    return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])


def _limited(velocity: list[float]) -> Vector3:
    """A velocity [m/s] of at most ``margins.ARM.correction_speed``."""
    size = math.hypot(*velocity)
    share = min(1.0, margins.ARM.correction_speed / max(size, 1e-9))
    along, across, up = (share * v for v in velocity)
    return (along, across, up)
