"""One arm that takes joint positions or velocities, in a simulation: its servo follows
them late, and its motors follow the servo.
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.arms.command_line import CommandLine
from pushpressslide.arms.joint_arm import JointArm
from pushpressslide.arms.lag import RobotServo
from pushpressslide.arms.model import ArmModel, Drives, PositionDrives
from pushpressslide.control.cell import Applied, Interface
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import (
    ArmCommand,
    BrakeCommand,
    TipCommand,
)
from pushpressslide.core.scene import Robot
from pushpressslide.execution.admittance import Admittance
from pushpressslide.execution.impedance import rotation_error
from pushpressslide.execution.joint_velocity import JointVelocities
from pushpressslide.execution.torque import LimitedTorque, limited

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

    def __init__(
        self,
        model: ArmModel,
        drives: Drives,
        robot: Robot,
        line: CommandLine[tuple[Array, Array]] | None = None,
    ) -> None:
        """Build the arm from a model. ``robot`` has its interface and its delays.
        Commands come through ``line``, if there is one.
        """
        super().__init__(model, drives)
        self.interface: Interface = robot.interface
        self._robot = robot
        self._line = line
        self._admittance = Admittance(robot.reaction)
        facts = model.facts
        self._joints = JointVelocities(facts.lower, facts.upper, facts.velocity_limit)
        self._effort = tuple(facts.effort_limit.tolist())  # (n,) [N m]
        self._servo: RobotServo | None = None
        self._position = np.zeros(0)  # (n,) [rad] as commanded
        self._velocity = np.zeros(0)  # (n,) [rad/s] as commanded
        self._loops: PositionDrives | None = None
        if robot.interface == "position" and isinstance(drives, PositionDrives):
            self._loops = drives

    def _take_path(self) -> None:
        """Begin the first path at rest."""
        if self._servo is not None:
            return
        start: Array = self.path.approach[0]
        self._position = start.copy()
        self._velocity = np.zeros_like(start)
        self._servo = RobotServo(self._robot, start, self.period, self._line)

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
        free = self.take_free_motion(command)
        if self.interface == "velocity":
            out: Array = free.velocity + PATH_RATE * (free.position - self.state.q)
            return out
        # the position that is commanded now is reached after the reaction time
        ahead = free.position + self._robot.reaction * free.velocity
        out = (ahead - self._position) / self.period
        return out

    def _of_tip(self, command: TipCommand) -> Array:
        """Wanted joint velocities (n,) [rad/s] that execute a tip command."""
        self.take_posture(command)
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
        before = servo.reached
        speed = servo.step(self._position, self._velocity)
        loops = self._loops
        if loops is None:
            self.limited = self._within_effort(self._torque(servo.reached, speed))
            self.drives.drive(self.limited.torque)
        else:
            torque = loops.follow(self.state, before, speed)
            self.limited = self._within_effort(torque)

    def _torque(self, reached: Array, speed: Array) -> Array:
        """Torques (n,) [N m] with which the joints follow the servo, which has
        ``reached`` (n,) [rad] at a ``speed`` (n,) [rad/s], whatever the tip touches.
        """
        state = self.state
        spring = SERVO_RATE**2 * (reached - state.q)
        damper = 2.0 * SERVO_RATE * (speed - state.v)
        force = np.array(self.frame.direction(self.tip.force))
        out: Array = state.bias + state.M @ (spring + damper) + state.J[3:].T @ force
        return out

    def _within_effort(self, torque: Array) -> LimitedTorque:
        """``torque`` (n,) [N m] within the effort limits. Its rate is free: the maker's
        own loop is quicker than the limit of commanded torque rates.
        """
        free = (math.inf,) * len(self._effort)
        return limited(torque, self.last_torque(), self._effort, free)
