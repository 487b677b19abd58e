"""One arm that is driven by joint torques: its model, its executor, its joint path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pushpressslide.arms.model import ArmModel, at_rest
from pushpressslide.control.joint_reference import path_reference
from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    JointCommand,
    TipCommand,
    TipState,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.task import Task
from pushpressslide.execution.arm import ArmDynamics, ArmExecutor
from pushpressslide.execution.torque import LimitedTorque
from pushpressslide.robots.tool import ToolAttitude

FELT_FORCE = 0.3  # [N] from which a contact point can be told from the force
RATE_TIME = 0.05  # [s] over which the rate of the joint reference is smoothed
NO_POINT = [math.nan] * 3


class TorqueArm:
    """One arm: its model, its executor, and its joint path."""

    def __init__(
        self, model: ArmModel, tip_radius: float, joint_stiffness: float = 0.0
    ) -> None:
        """Take the arm of a model, with a tip of a radius [m]; ``joint_stiffness``
        [N m/rad] is as of ``control.execution.Execution``.
        """
        self.model = model
        self._radius = tip_radius
        self._stiffness = joint_stiffness
        # (n,) [rad/s] of the reference
        self._fastest = margins.POSTURE_SPEED * model.facts.velocity_limit
        self.state: ArmDynamics
        self.path: JointPath
        self._limited: LimitedTorque | None = None  # of the tick before
        self._reference = np.zeros(0)  # (n,) [rad]
        self._rate = np.zeros(0)  # (n,) [rad/s] of the reference, smoothed

    @property
    def limits(self) -> ArmLimits:
        """The maker's limits of its joints."""
        facts = self.model.facts
        return ArmLimits(
            facts.lower,
            facts.upper,
            facts.velocity_limit,
            facts.effort_limit,
            facts.torque_rate_limit,
        )

    def follow(self, task: Task, path: JointPath, attitude: ToolAttitude) -> None:
        """Take ``path`` as the joint reference, with the tool held as in ``attitude``."""
        facts = self.model.facts
        self.path = path
        self._executor = ArmExecutor(
            facts.lower,
            facts.upper,
            facts.effort_limit,
            facts.torque_rate_limit,
            attitude.rotation_at,
            path.tool_yaw_offset,
            self._stiffness,
            task.motion.control_period,
            task.support.frame,
        )

    def sense(self, x: Array) -> None:
        """Take joint positions and velocities ``x`` (2 n,) as measured."""
        self.state = self.model.state_at(x)

    def execute(self, command: ArmCommand) -> None:
        """Compute the torque for a command."""
        if isinstance(command, BrakeCommand):
            weight = self.model.state_at(at_rest(self.state.q)).bias
            self._limited = self._executor.brake(self.state, weight, self.torque)
            return
        if isinstance(command, TipCommand):
            posture = command.posture
            if posture is None:
                posture = path_reference(self.path, command.progress)
            self._take_posture(posture)
            self._limited = self._executor.contact(
                self.state, command, self._reference, self._rate, self.torque
            )
            return
        self._rate = np.zeros(0)
        if command is None:
            start = path_reference(self.path, 0.0)
            command = JointCommand(start, np.zeros_like(start))
        self._reference = command.position
        self._limited = self._executor.free(
            self.state, command.position, command.velocity, self.torque
        )

    @property
    def torque(self) -> Array:
        """Torques (n,) [N m] as last applied; before the first, those of an arm that is
        held at rest.
        """
        return self.state.bias if self._limited is None else self._limited.torque

    @property
    def reading(self) -> ArmReading:
        """What the joints do, and what the last command asked of them."""
        state = self.state
        if self._limited is None:
            return ArmReading(state.q, state.v)
        asked = self._limited
        return ArmReading(state.q, state.v, asked.share, asked.rate_share)

    def _take_posture(self, posture: Array) -> None:
        """Lead the reference to ``posture`` (n,) [rad], and note how it changes: what is
        planned anew under way may be far from it.
        """
        if len(self._rate) == 0:
            self._rate = np.zeros_like(posture)
        if len(self._reference) == 0:
            self._reference = posture
        dt = self._executor.dt
        most = self._fastest
        wanted = (posture - self._reference) / dt
        change = np.minimum(np.maximum(wanted, -most), most)
        self._rate = self._rate + dt / RATE_TIME * (change - self._rate)
        self._reference = self._reference + dt * change

    def row(self) -> ArmRow:
        """Return what is recorded of this arm in a tick, once its torque is applied."""
        assert self._limited is not None
        return ArmRow(self.state.q, self.state.v, self._reference, self._limited)

    def contact_point(self, tip: TipState) -> Sequence[float]:
        """Return where the tip's sphere is touched [m], by the direction of the force;
        NaN where it is too small.
        """
        size = math.hypot(*tip.force)
        if size <= FELT_FORCE:
            return NO_POINT
        return [
            p + self._radius * f / size
            for p, f in zip(tip.position, tip.force, strict=True)
        ]


class ArmRow(NamedTuple):
    """What an arm did in a tick."""

    q: Array  # (n,) [rad]
    v: Array  # (n,) [rad/s]
    reference: Array  # (n,) [rad]
    limited: LimitedTorque  # as applied

    def arrays(self, index: int) -> dict[str, Any]:
        """Return the rows of the arm's arrays in the record; ``index`` is its number."""
        return {
            f"joint_position_{index}": self.q,
            f"joint_velocity_{index}": self.v,
            f"joint_torque_{index}": self.limited.torque,
            f"joint_reference_{index}": self.reference,
            f"torque_share_{index}": self.limited.share,
            f"torque_rate_share_{index}": self.limited.rate_share,
        }
