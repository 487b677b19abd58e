"""From a tip command to joint torques of one arm (the lower half of the paper's eq.
27).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.impedance import tip_force, tip_moment
from pushpressslide.execution.torque import (
    LimitedTorque,
    braked,
    joint_torque,
    kept_inside,
    limited,
    task_inertia,
    task_torque,
    yielding,
)

ROTATION_STIFFNESS = 60.0
ROTATION_DAMPING = 6.0  # [N m/rad], [N m s/rad] of the tool's orientation
# [N m/rad], [N m s/rad] of the joints, felt in the null space only
POSTURE_STIFFNESS = 50.0
POSTURE_DAMPING = 14.0
# [N m s/rad] per root of the joint-tracking stiffness: half of critical at 1 kg m^2 of
# arm and rotor. Less lets the spring bounce the tip off the face
JOINT_DAMPING = 1.0
FREE_RATE = 15.0  # [1/s] of the joint tracking in free space
# [s] in which a tip comes to its reference's velocity, however much it weighs: an arm
# that is nearly stretched weighs hundreds of kilograms along itself, and coasts on
SERVO_TIME = 0.03


@dataclass(frozen=True, slots=True)
class ArmState:
    """What is known of one arm at a tick; world axes, tip = centre of the tip's sphere."""

    q: Array  # (n,) [rad]
    v: Array  # (n,) [rad/s]
    position: Vector3  # [m]
    rotation: Array  # (3, 3) R_WT
    velocity: Vector3  # [m/s]
    angular_velocity: Array  # (3,) [rad/s]
    J: Array  # (6, n) rows [angular; linear]
    M: Array  # (n, n) mass matrix
    bias: Array  # (n,) [N m] gravity and Coriolis compensation
    # (6,) [rad/s^2; m/s^2] of a tip whose joints turn at constant rates
    drift: Array


@dataclass(frozen=True, slots=True)
class ArmExecutor:
    """Impedance, joint tracking and limits of one arm."""

    lower: Array  # (n,) [rad]
    upper: Array  # (n,) [rad]
    effort: Array  # (n,) [N m]
    rate: Array  # (n,) [N m/s]
    rotation: Callable[[float], Array]  # R_WT (3, 3) of the tool at a tool yaw [rad]
    yaw_offset: float  # [rad] tool yaw minus object yaw
    joint_stiffness: float  # [N m/rad] of the joint-tracking term; 0 switches it off
    dt: float  # [s]
    frame: SupportFrame = TABLE  # of the commands

    def free(
        self, arm: ArmState, q_ref: Array, v_ref: Array, previous: Array
    ) -> LimitedTorque:
        """Return the torques that track joints in free space; ``previous`` (n,) [N m]
        are those of the tick before.
        """
        rate = min(FREE_RATE, 0.25 / self.dt)
        tau = joint_torque(arm.M, arm.bias, arm.q, arm.v, q_ref, v_ref, rate)
        return limited(tau, previous, self.effort, self.rate, self.dt)

    def contact(
        self,
        arm: ArmState,
        command: TipCommand,
        q_ref: Array,
        v_ref: Array,
        previous: Array,
    ) -> LimitedTorque:
        """Return the torques that execute a tip command, in the posture ``q_ref`` (n,)
        [rad] that changes by ``v_ref`` (n,) [rad/s]; ``previous`` (n,) [N m] are those
        of the tick before.
        """
        frame = self.frame
        place = frame.coordinates(arm.position)
        velocity = frame.components(arm.velocity)
        force = np.array(frame.direction(tip_force(command, place, velocity)))
        R_wanted = self.rotation(command.tool_yaw + self.yaw_offset)
        w_wanted = command.tool_yaw_rate * np.array(frame.spin_axis)
        moment = tip_moment(
            R_wanted,
            arm.rotation,
            w_wanted,
            arm.angular_velocity,
            ROTATION_STIFFNESS,
            ROTATION_DAMPING,
        )
        error = q_ref - arm.q
        damping = POSTURE_DAMPING * (v_ref - arm.v)
        posture = POSTURE_STIFFNESS * error + damping
        J = yielding(arm.J, moment, arm.q, self.lower, self.upper)
        tau = task_torque(J, moment, force, posture, arm.bias)
        tau += braked(arm.J, damping)
        tau += kept_inside(arm.J, arm.q, arm.v, self.lower, self.upper)
        tau += arm.J.T @ self._inertial(arm, command, velocity)
        if self.joint_stiffness > 0.0:
            viscosity = JOINT_DAMPING * math.sqrt(self.joint_stiffness)
            tau += self.joint_stiffness * error - viscosity * arm.v
        return limited(tau, previous, self.effort, self.rate, self.dt)

    def _inertial(self, arm: ArmState, command: TipCommand, velocity: Vector3) -> Array:
        """Return the wrench (6,), world axes, that moves the arm's own inertia as the
        command asks; ``velocity`` [m/s] of the tip, in the support's frame.

        Lambda times the acceleration of the reference: without it an arm that is
        accelerated along the support also presses on it or lifts off, by the inertia's
        coupling. Less what the tip accelerates by where its joints turn at constant
        rates: that needs no torque.
        """
        frame = self.frame
        spin = command.tool_yaw_acceleration * np.array(frame.spin_axis)
        moved = frame.direction(command.acceleration)
        inertia = task_inertia(arm.J, arm.M)
        wrench: Array = inertia @ (np.concatenate([spin, moved]) - arm.drift)
        return wrench + self._caught_up(inertia, command, velocity)

    def _caught_up(
        self, inertia: Array, command: TipCommand, velocity: Vector3
    ) -> Array:
        """Return the wrench (6,), world axes, by which a tip of ``inertia`` (6, 6) comes
        to its reference's velocity within ``SERVO_TIME``, beside its damper's force and
        with it inside the servo's cap; ``velocity`` [m/s] is its own.

        Nothing along an axis on which the damper alone is as quick, and nothing where a
        spring leads the tip, or it is not asked for.
        """
        damping = min(command.damping[:2])
        led = any(command.stiffness[:2])
        if damping == 0.0 or led or not command.catches_up:
            return np.zeros(6)
        plane = np.array(self.frame.axes)[:, :2]
        mass, axes = np.linalg.eigh(plane.T @ inertia[3:, 3:] @ plane)
        slow = np.maximum(0.0, 1.0 - damping * SERVO_TIME / mass)
        error = np.subtract(command.velocity[:2], velocity[:2])
        caught = axes @ (slow * (axes.T @ error)) / SERVO_TIME
        wrench: Array = inertia[:, 3:] @ (plane @ caught)
        size = float(np.linalg.norm(wrench[3:]))
        left = max(0.0, command.servo_cap - damping * float(np.linalg.norm(error)))
        if size > left:
            wrench *= left / size
        return wrench
