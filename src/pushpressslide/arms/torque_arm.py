"""One torque-driven arm: its model, its executor, its joint path."""

from __future__ import annotations

import numpy as np

from pushpressslide.arms.command_line import CommandLine
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import ArmModel, Drives, at_rest
from pushpressslide.control.cell import Applied, ArmState, Interface
from pushpressslide.control.sensing import DelayLine
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    TipCommand,
)
from pushpressslide.execution.arm import ArmExecutor
from pushpressslide.execution.torque import LimitedTorque
from pushpressslide.execution.torque_error import TorqueErrorObserver


class TorqueArm(JointArm):
    """One torque-driven arm: its model, its drives, its executor, and its joint path."""

    interface: Interface = "torque"

    def __init__(
        self,
        model: ArmModel,
        drives: Drives,
        joint_stiffness: float = 0.0,
        line: CommandLine[Array] | None = None,
        delay: float = 0.0,
    ) -> None:
        """Build the arm from a model. ``joint_stiffness`` [N m/rad] is that of
        ``control.execution.Execution``. Torques come through ``line``, if there is one,
        and are believed to act ``delay`` [s] late.
        """
        super().__init__(model, drives)
        self._stiffness = joint_stiffness
        self._line = line
        self._delay = delay
        self._observer = TorqueErrorObserver(model.facts.effort_limit)
        self._sent = 0.0  # [s] when the present torque was sent

    def _take_path(self) -> None:
        facts = self.model.facts
        self._executor = ArmExecutor(
            facts.lower,
            facts.upper,
            facts.effort_limit,
            facts.torque_rate_limit,
            self.attitude.rotation_at,
            self.path.tool_yaw_offset,
            self._stiffness,
            self.period,
            self.frame,
            self._delay,
        )
        self._acting: DelayLine[Array] = DelayLine(self._delay, self.period)

    def read(self) -> ArmState:
        """Joint state, and the tip's position, velocity and force derived from it."""
        out = super().read()
        self._observer.observe(self.state, out.time - self._sent)
        return out

    def send(self, command: ArmCommand) -> Applied:
        """Apply the torque that executes a command, at the last measured state."""
        limited = self._limited_torque(command)
        self.limited = limited
        torque = limited.torque
        force = np.array(self.frame.direction(self.tip.force))
        self._observer.acted(self.state, self._acting.through(torque), force)
        self._sent = self.drives.time
        if self._line is not None:
            torque = self._line.through(torque)
        self.drives.drive(torque)
        return Applied(
            limited.torque, self.reference, limited.share, limited.rate_share
        )

    def _limited_torque(self, command: ArmCommand) -> LimitedTorque:
        torque = self.last_torque()
        arm = self._observer.corrected(self.state)
        if isinstance(command, BrakeCommand):
            at_rest_there = self.model.state_at(at_rest(self.state.q))
            weight = self._observer.corrected(at_rest_there).bias
            return self._executor.brake(arm, weight, torque)
        if isinstance(command, TipCommand):
            self.take_posture(command)
            return self._executor.contact(
                arm, command, self.reference, self.rate, torque
            )
        free = self.take_free_motion(command)
        return self._executor.free(arm, free.position, free.velocity, torque)
