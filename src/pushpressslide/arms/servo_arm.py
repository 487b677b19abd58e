"""One arm that takes joint positions or velocities, in a simulation: its servo follows
them late, and its motors follow the servo.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.lag import LaggingServo
from pushpressslide.arms.model import ArmModel, Drives, PositionDrives
from pushpressslide.control.cell import Applied, Interface
from pushpressslide.control.joint_reference import path_reference
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    JointCommand,
    TipCommand,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.scene import Robot
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.admittance import Admittance
from pushpressslide.execution.impedance import rotation_error
from pushpressslide.execution.joint_velocity import JointVelocities
from pushpressslide.execution.torque import LimitedTorque, limited
from pushpressslide.robots.tool import ToolAttitude

SERVO_RATE = 80.0
"""Natural frequency [rad/s] with which the motors follow the servo: as high as control
periods of 4 ms allow.
"""
TURN_RATE = 6.0
"""Rate [1/s] at which the tool comes to its wanted attitude."""
PATH_RATE = 4.0
"""Rate [1/s] at which a velocity-controlled arm comes to its path in free space."""
LEAD = 0.05
"""Largest distance [rad] of the commanded joints from the measured ones, besides what
the reaction time explains.
"""


class ServoArm(JointArm):
    """An arm that takes positions or velocities at its own rate."""

    def __init__(self, model: ArmModel, drives: Drives, robot: Robot) -> None:
        """Build the arm from a model. ``robot`` has its interface and its delays."""
        super().__init__(model, drives)
        self.interface: Interface = robot.interface
        self._robot = robot
        self._admittance = Admittance(robot.reaction)
        facts = model.facts
        self._joints = JointVelocities(facts.lower, facts.upper, facts.velocity_limit)
        self._servo: LaggingServo | None = None
        self._position = np.zeros(0)  # (n,) [rad] as commanded
        self._velocity = np.zeros(0)  # (n,) [rad/s] as commanded
        self._reached = np.zeros(0)  # (n,) [rad] by the servo
        self._loops: PositionDrives | None = None
        if robot.interface == "position" and isinstance(drives, PositionDrives):
            self._loops = drives

    def follow(
        self,
        path: JointPath,
        attitude: ToolAttitude,
        period: float,
        frame: SupportFrame = TABLE,
    ) -> None:
        """Take a joint path, as ``JointArm.follow``. The first one is begun at rest."""
        super().follow(path, attitude, period, frame)
        if self._servo is not None:
            return
        start: Array = path.approach[0]
        self._position = start.copy()
        self._velocity = np.zeros_like(start)
        self._reached = start.copy()
        robot = self._robot
        first = start if robot.interface == "position" else self._velocity
        self._servo = LaggingServo(first, robot.rate, robot.delay, robot.lag, period)

    def send(self, command: ArmCommand) -> Applied:
        """Command joint positions or velocities, and drive the motors by one tick."""
        wanted = self._joint_velocity(command)
        dt = self.period
        wanted = self._joints.limited(wanted, self._position)
        self._velocity = self._joints.ramped(wanted, self._velocity, dt)
        lead = self._robot.reaction * self.model.facts.velocity_limit + LEAD
        q = self.state.q
        ahead = self._position + dt * self._velocity
        self._position = np.clip(ahead, q - lead, q + lead)
        self._drive()
        asked = self.limited
        assert asked is not None
        return Applied(asked.torque, self._position, asked.share, asked.rate_share)

    def _joint_velocity(self, command: ArmCommand) -> Array:
        """Wanted joint velocities (n,) [rad/s]."""
        if isinstance(command, BrakeCommand):
            return np.zeros_like(self._velocity)
        if isinstance(command, TipCommand):
            return self._of_tip(command)
        self.rate = np.zeros(0)
        if command is None:
            start = path_reference(self.path, 0.0)
            command = JointCommand(start, np.zeros_like(start))
        self.reference = command.position
        if self.interface == "velocity":
            out: Array = command.velocity + PATH_RATE * (
                command.position - self.state.q
            )
            return out
        # what is commanded now is reached after the reaction time
        ahead = command.position + self._robot.reaction * command.velocity
        out = (ahead - self._position) / self.period
        return out

    def _of_tip(self, command: TipCommand) -> Array:
        """Wanted joint velocities (n,) [rad/s] that execute a tip command."""
        posture = command.posture
        if posture is None:
            posture = path_reference(self.path, command.progress)
        self.take_posture(posture)
        state = self.state
        tip = self.frame.direction(self._admittance.velocity(command, self.tip))
        yaw = command.tool_yaw + self.path.tool_yaw_offset
        error = rotation_error(self.attitude.rotation_at(yaw), state.rotation)
        spin = self.frame.spin_axis
        turn = np.array(error) * TURN_RATE + np.array(spin) * command.tool_yaw_rate
        twist = np.concatenate([turn, tip])
        return self._joints.of_tip(state.J, twist, state.q, self.reference, self.rate)

    def _drive(self) -> None:
        """Drive the motors: the servo reacts late to the commands, and the motors follow
        it.
        """
        servo = self._servo
        assert servo is not None
        dt = self.period
        before = self._reached
        if self.interface == "position":
            self._reached = servo.step(self._position)
        else:
            self._reached = before + dt * servo.step(self._velocity)
        speed = (self._reached - before) / dt
        loops = self._loops
        if loops is None:
            self.limited = self._within_effort(self._torque(speed))
            self.drives.drive(self.limited.torque)
        else:
            torque = loops.follow(self.state, before, speed)
            self.limited = self._within_effort(torque)

    def _torque(self, speed: Array) -> Array:
        """Torques (n,) [N m] with which the joints follow the servo at its ``speed``
        (n,) [rad/s], whatever the tip touches.
        """
        state = self.state
        spring = SERVO_RATE**2 * (self._reached - state.q)
        damper = 2.0 * SERVO_RATE * (speed - state.v)
        force = np.array(self.frame.direction(self.tip.force))
        out: Array = state.bias + state.M @ (spring + damper) + state.J[3:].T @ force
        return out

    def _within_effort(self, torque: Array) -> LimitedTorque:
        """``torque`` (n,) [N m] within the effort limits. Its rate is free: the maker's
        own loop is quicker than the limit of commanded torque rates.
        """
        effort = tuple(self.model.facts.effort_limit.tolist())
        free = (math.inf,) * len(effort)
        return limited(torque, self.last_torque(), effort, free)


def joint_arm(
    robot: Robot, model: ArmModel, drives: Drives, joint_stiffness: float = 0.0
) -> JointArm:
    """Arm with a robot's interface. ``joint_stiffness`` [N m/rad] is that of
    ``control.execution.Execution``, for torques only.
    """
    from pushpressslide.arms.torque_arm import TorqueArm

    if robot.interface == "torque":
        return TorqueArm(model, drives, joint_stiffness)
    return ServoArm(model, drives, robot)
