"""One torque-driven arm: its model, its executor, its joint path."""

from __future__ import annotations

import numpy as np

from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.model import ArmModel, Drives, at_rest
from pushpressslide.control.cell import Applied, Interface
from pushpressslide.control.joint_reference import path_reference
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    JointCommand,
    TipCommand,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.arm import ArmExecutor
from pushpressslide.execution.torque import LimitedTorque
from pushpressslide.robots.tool import ToolAttitude


class TorqueArm(JointArm):
    """One torque-driven arm: its model, its drives, its executor, and its joint path."""

    interface: Interface = "torque"

    def __init__(
        self, model: ArmModel, drives: Drives, joint_stiffness: float = 0.0
    ) -> None:
        """Build the arm from a model. ``joint_stiffness`` [N m/rad] is that of
        ``control.execution.Execution``.
        """
        super().__init__(model, drives)
        self._stiffness = joint_stiffness

    def follow(
        self,
        path: JointPath,
        attitude: ToolAttitude,
        period: float,
        frame: SupportFrame = TABLE,
    ) -> None:
        """Take a joint path, as ``JointArm.follow``."""
        super().follow(path, attitude, period, frame)
        facts = self.model.facts
        self._executor = ArmExecutor(
            facts.lower,
            facts.upper,
            facts.effort_limit,
            facts.torque_rate_limit,
            attitude.rotation_at,
            path.tool_yaw_offset,
            self._stiffness,
            period,
            frame,
        )

    def send(self, command: ArmCommand) -> Applied:
        """Apply the torque that executes a command, at the last measured state."""
        limited = self._limited_torque(command)
        self.limited = limited
        self.drives.drive(limited.torque)
        return Applied(
            limited.torque, self.reference, limited.share, limited.rate_share
        )

    def _limited_torque(self, command: ArmCommand) -> LimitedTorque:
        torque = self.last_torque()
        if isinstance(command, BrakeCommand):
            weight = self.model.state_at(at_rest(self.state.q)).bias
            return self._executor.brake(self.state, weight, torque)
        if isinstance(command, TipCommand):
            posture = command.posture
            if posture is None:
                posture = path_reference(self.path, command.progress)
            self.take_posture(posture)
            return self._executor.contact(
                self.state, command, self.reference, self.rate, torque
            )
        self.rate = np.zeros(0)
        if command is None:
            start = path_reference(self.path, 0.0)
            command = JointCommand(start, np.zeros_like(start))
        self.reference = command.position
        return self._executor.free(
            self.state, command.position, command.velocity, torque
        )
