"""One arm with joints: its model, its drives, and its joint path."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from pushpressslide.arms.faults import FaultyDrives
from pushpressslide.arms.model import ArmModel, Drives
from pushpressslide.control.cell import Applied, ArmState, Driverless, Interface
from pushpressslide.control.joint_reference import path_reference
from pushpressslide.control.limits import ArmLimits, ArmReading
from pushpressslide.core import margins
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    JointCommand,
    TipCommand,
    TipState,
    Vector3,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.arm import ArmDynamics
from pushpressslide.execution.torque import LimitedTorque
from pushpressslide.robots.facts import RobotFacts
from pushpressslide.robots.tool import ToolAttitude

RATE_TIME = 0.05  # [s] over which the rate of the joint reference is smoothed


class JointArm(Driverless, ABC):
    """Base of arms that are read the same way and differ in how they are driven."""

    interface: Interface

    def __init__(self, model: ArmModel, drives: Drives) -> None:
        """Build the arm from a model."""
        self.model = model
        self.limits = arm_limits(model.facts)
        self.drives = drives
        self.frame = TABLE  # of the support
        # (n,) [rad/s] of the reference
        self._fastest = margins.POSTURE_SPEED * model.facts.velocity_limit
        self.state: ArmDynamics  # as read last
        self.tip: TipState  # the same
        self.path: JointPath
        self.attitude: ToolAttitude
        self.period = 0.0  # [s] of control
        self.limited: LimitedTorque | None = None  # of the tick before
        self.reference = np.zeros(0)  # (n,) [rad]
        self.rate = np.zeros(0)  # (n,) [rad/s] of the reference, smoothed

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
        self.path = path
        self.attitude = attitude
        self.period = period
        self.frame = frame
        self._take_path()

    @abstractmethod
    def _take_path(self) -> None:
        """Prepare to be driven along the path just taken."""

    def read(self) -> ArmState:
        """Joint state, and the tip's position, velocity and force derived from it."""
        state = self.model.state_at(self.drives.joints())
        self.state = state
        self.tip = tip_state(state, self.drives.tip_force(state), self.frame)
        return ArmState(self.drives.time, self.tip, self._reading())

    @property
    def true_tip(self) -> TipState:
        """The tip where it really was at the last reading."""
        drives = self.drives
        if not isinstance(drives, FaultyDrives):
            return self.tip
        return tip_state(drives.state, drives.force, self.frame)

    @property
    def start(self) -> Array:
        """True joint positions (n,) [rad] where the encoders show the start of the
        path.
        """
        first: Array = self.path.approach[0]
        drives = self.drives
        if not isinstance(drives, FaultyDrives):
            return first
        return first - drives.encoder_bias

    @abstractmethod
    def send(self, command: ArmCommand) -> Applied:
        """Obey ``command`` until the next one. Returns what was really applied."""

    def _reading(self) -> ArmReading:
        """Joint state, and the reference of the last command."""
        state = self.state
        if self.limited is None:
            return ArmReading(state.q, state.v)
        asked = self.limited
        return ArmReading(state.q, state.v, asked.share, asked.rate_share)

    def last_torque(self) -> Array:
        """Torques (n,) [N m] last applied. Before the first command, those that hold
        the arm at rest.
        """
        return self.state.bias if self.limited is None else self.limited.torque

    def take_free_motion(self, command: JointCommand | None) -> JointCommand:
        """Set the reference to that of a free motion. None: rest at the start of the
        path along the contact.
        """
        self.rate = np.zeros(0)
        if command is None:
            start = path_reference(self.path, 0.0)
            command = JointCommand(start, np.zeros_like(start))
        self.reference = command.position
        return command

    def take_posture(self, command: TipCommand) -> None:
        """Set the reference to the posture of a tip command, and note its change, which
        may be large after a replan.
        """
        posture = command.posture
        if posture is None:
            posture = path_reference(self.path, command.progress)
        if len(self.rate) == 0:
            self.rate = np.zeros_like(posture)
        if len(self.reference) == 0:
            self.reference = posture
        dt = self.period
        upper = self._fastest
        wanted = (posture - self.reference) / dt
        change = np.minimum(np.maximum(wanted, -upper), upper)
        self.rate = self.rate + dt / RATE_TIME * (change - self.rate)
        self.reference = self.reference + dt * change


def tip_state(arm: ArmDynamics, force: Vector3, frame: SupportFrame) -> TipState:
    """State of an arm's tip in a support's frame. ``force`` [N] is in world axes."""
    return TipState(
        frame.coordinates(arm.position),
        frame.components(arm.velocity),
        frame.components(force),
    )


def arm_limits(facts: RobotFacts) -> ArmLimits:
    """Limits of a robot's joints."""
    return ArmLimits(
        facts.lower,
        facts.upper,
        facts.velocity_limit,
        facts.effort_limit,
        facts.torque_rate_limit,
    )
