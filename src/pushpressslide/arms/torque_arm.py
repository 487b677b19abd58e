"""One torque-driven arm: its model, its executor, its joint path."""

from __future__ import annotations

import numpy as np

from pushpressslide.arms.model import ArmModel, Drives, at_rest
from pushpressslide.control.cell import Applied, ArmState, Driverless, Interface
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
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.arm import ArmDynamics, ArmExecutor
from pushpressslide.execution.torque import LimitedTorque
from pushpressslide.robots.facts import RobotFacts
from pushpressslide.robots.tool import ToolAttitude

RATE_TIME = 0.05  # [s] over which the rate of the joint reference is smoothed


class TorqueArm(Driverless):
    """One torque-driven arm: its model, its drives, its executor, and its joint path."""

    interface: Interface = "torque"

    def __init__(
        self, model: ArmModel, drives: Drives, joint_stiffness: float = 0.0
    ) -> None:
        """Build the arm from a model. ``joint_stiffness`` [N m/rad] is that of
        ``control.execution.Execution``.
        """
        self.model = model
        self.limits = _limits(model.facts)
        self._drives = drives
        self._frame = TABLE  # of the support
        self._stiffness = joint_stiffness
        # (n,) [rad/s] of the reference
        self._fastest = margins.POSTURE_SPEED * model.facts.velocity_limit
        self.state: ArmDynamics  # as read last
        self.tip: TipState  # the same
        self.path: JointPath
        self._limited: LimitedTorque | None = None  # of the tick before
        self._reference = np.zeros(0)  # (n,) [rad]
        self._rate = np.zeros(0)  # (n,) [rad/s] of the reference, smoothed

    def follow(
        self,
        path: JointPath,
        attitude: ToolAttitude,
        period: float,
        frame: SupportFrame = TABLE,
    ) -> None:
        """Take ``path`` as the joint reference, with the tool at ``attitude``.

        ``period`` [s] is the control period, ``frame`` the frame of the support.
        """
        facts = self.model.facts
        self.path = path
        self._frame = frame
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

    def read(self) -> ArmState:
        """Joint state, and the tip's position, velocity and force derived from it."""
        state = self.model.state_at(self._drives.joints())
        self.state = state
        frame = self._frame
        self.tip = TipState(
            frame.coordinates(state.position),
            frame.components(state.velocity),
            frame.components(self._drives.tip_force(state)),
        )
        return ArmState(self._drives.time, self.tip, self._reading())

    def send(self, command: ArmCommand) -> Applied:
        """Apply the torque that executes a command, at the last measured state."""
        limited = self._limited_torque(command)
        self._limited = limited
        self._drives.drive(limited.torque)
        return Applied(
            limited.torque, self._reference, limited.share, limited.rate_share
        )

    def _limited_torque(self, command: ArmCommand) -> LimitedTorque:
        if isinstance(command, BrakeCommand):
            weight = self.model.state_at(at_rest(self.state.q)).bias
            return self._executor.brake(self.state, weight, self._torque)
        if isinstance(command, TipCommand):
            posture = command.posture
            if posture is None:
                posture = path_reference(self.path, command.progress)
            self._take_posture(posture)
            return self._executor.contact(
                self.state, command, self._reference, self._rate, self._torque
            )
        self._rate = np.zeros(0)
        if command is None:
            start = path_reference(self.path, 0.0)
            command = JointCommand(start, np.zeros_like(start))
        self._reference = command.position
        return self._executor.free(
            self.state, command.position, command.velocity, self._torque
        )

    @property
    def _torque(self) -> Array:
        """Torques (n,) [N m] last applied. Before the first command, those that hold
        the arm at rest.
        """
        return self.state.bias if self._limited is None else self._limited.torque

    def _reading(self) -> ArmReading:
        """Joint state, and the reference of the last command."""
        state = self.state
        if self._limited is None:
            return ArmReading(state.q, state.v)
        asked = self._limited
        return ArmReading(state.q, state.v, asked.share, asked.rate_share)

    def _take_posture(self, posture: Array) -> None:
        """Set the reference to ``posture`` (n,) [rad], and note its change, which may
        be large after a replan.
        """
        if len(self._rate) == 0:
            self._rate = np.zeros_like(posture)
        if len(self._reference) == 0:
            self._reference = posture
        dt = self._executor.dt
        upper = self._fastest
        wanted = (posture - self._reference) / dt
        change = np.minimum(np.maximum(wanted, -upper), upper)
        self._rate = self._rate + dt / RATE_TIME * (change - self._rate)
        self._reference = self._reference + dt * change


def _limits(facts: RobotFacts) -> ArmLimits:
    return ArmLimits(
        facts.lower,
        facts.upper,
        facts.velocity_limit,
        facts.effort_limit,
        facts.torque_rate_limit,
    )
