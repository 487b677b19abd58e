"""From a tip command to joint torques of one arm (the lower half of the paper's eq.
27).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.pose import Point
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.impedance import tip_force, tip_moment
from pushpressslide.execution.torque import (
    LimitedTorque,
    braked,
    joint_torque,
    kept_inside,
    limited,
    near_limit,
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
    angular_velocity: Vector3  # [rad/s]
    J: Array  # (6, n) rows [angular; linear]
    M: Array  # (n, n) mass matrix
    # (n,) [N m] that makes up for gravity, Coriolis forces and the joints' own damping
    bias: Array
    # (6,) [rad/s^2; m/s^2] of a tip whose joints turn at constant rates
    drift: Array


@dataclass(slots=True)
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
    _most: tuple[float, ...] = field(init=False)  # (n,) [N m] of a torque
    # (n,) [N m] that a torque may change by in a tick
    _most_change: tuple[float, ...] = field(init=False)
    _plane: Array = field(
        init=False
    )  # (3, 2) directions in the world along the support
    _spin_axis: Vector3 = field(init=False)  # in the world, of the tool's yaw

    def __post_init__(self) -> None:
        self._most = tuple(self.effort.tolist())
        self._most_change = tuple((self.rate * self.dt).tolist())
        self._plane = np.array(self.frame.axes)[:, :2]
        self._spin_axis = self.frame.spin_axis

    def free(
        self, arm: ArmState, q_ref: Array, v_ref: Array, previous: Array
    ) -> LimitedTorque:
        """Return the torques that track joints in free space; ``previous`` (n,) [N m]
        are those of the tick before.
        """
        rate = min(FREE_RATE, 0.25 / self.dt)
        tau = joint_torque(arm.M, arm.bias, arm.q, arm.v, q_ref, v_ref, rate)
        return limited(tau, previous, self._most, self._most_change)

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
        force = frame.direction(tip_force(command, place, velocity))
        moment = self._moment(arm, command)
        error = q_ref - arm.q
        damping = POSTURE_DAMPING * (v_ref - arm.v)
        posture = POSTURE_STIFFNESS * error + damping
        J = arm.J
        near = near_limit(arm.q, self.lower, self.upper)
        if near:
            J = yielding(J, moment, arm.q, self.lower, self.upper)
        tau = task_torque(J, np.array(moment + force), posture, arm.bias)
        tau += braked(arm.J, damping)
        tau += arm.J.T @ self._inertial(arm, command, velocity)
        if near:
            tau += kept_inside(arm.J, arm.q, arm.v, self.lower, self.upper)
        if self.joint_stiffness > 0.0:
            viscosity = JOINT_DAMPING * math.sqrt(self.joint_stiffness)
            tau += self.joint_stiffness * error - viscosity * arm.v
        return limited(tau, previous, self._most, self._most_change)

    def _moment(self, arm: ArmState, command: TipCommand) -> Vector3:
        """Return the moment [N m], world axes, that holds the tool's attitude."""
        return tip_moment(
            self.rotation(command.tool_yaw + self.yaw_offset),
            arm.rotation,
            _times(command.tool_yaw_rate, self._spin_axis),
            arm.angular_velocity,
            ROTATION_STIFFNESS,
            ROTATION_DAMPING,
        )

    def _inertial(self, arm: ArmState, command: TipCommand, velocity: Vector3) -> Array:
        """Return the wrench (6,), world axes, that moves the arm's own inertia as the
        command asks; ``velocity`` [m/s] of the tip, in the support's frame.

        Lambda times the acceleration of the reference: without it an arm that is
        accelerated along the support also presses on it or lifts off, by the inertia's
        coupling. Less what the tip accelerates by where its joints turn at constant
        rates: that needs no torque.
        """
        spin = _times(command.tool_yaw_acceleration, self._spin_axis)
        moved = self.frame.direction(command.acceleration)
        inertia = task_inertia(arm.J, arm.M)
        wrench: Array = inertia @ (np.array(spin + moved) - arm.drift)
        damping = min(command.damping[:2])
        led = any(command.stiffness[:2])
        if damping > 0.0 and command.catches_up and not led:
            wrench += self._caught_up(inertia, damping, command, velocity)
        return wrench

    def _caught_up(
        self, inertia: Array, damping: float, command: TipCommand, velocity: Vector3
    ) -> Array:
        """Return the wrench (6,), world axes, by which a tip of ``inertia`` (6, 6) comes
        to its reference's velocity within ``SERVO_TIME``, beside its damper's force and
        with it inside the servo's cap; ``velocity`` [m/s] is its own, ``damping``
        [N s/m] the damper's.

        Nothing along an axis on which the damper alone is as quick. For a tip that no
        spring leads.
        """
        wrenches = inertia[:, 3:] @ self._plane  # (6, 2) of accelerations along x and y
        (xx, xy), (_, yy) = (self._plane.T @ wrenches[3:]).tolist()
        ex = command.velocity[0] - velocity[0]
        ey = command.velocity[1] - velocity[1]
        # the share that is left to do of an error along each principal axis
        light, heavy, toward = _principal(xx, xy, yy)
        across = _left(light, damping)
        along = _left(heavy, damping)
        c, s = toward
        part = (along - across) * (c * ex + s * ey)
        ax = (across * ex + part * c) / SERVO_TIME
        ay = (across * ey + part * s) / SERVO_TIME
        wrench: Array = wrenches @ (ax, ay)
        size = math.hypot(*wrench[3:].tolist())
        room = max(0.0, command.servo_cap - damping * math.hypot(ex, ey))
        if size > room:
            wrench *= room / size
        return wrench


def _times(factor: float, v: Vector3) -> Vector3:
    return (factor * v[0], factor * v[1], factor * v[2])


def _principal(xx: float, xy: float, yy: float) -> tuple[float, float, Point]:
    """Return the smaller and the larger eigenvalue of a symmetric 2 x 2 matrix, and the
    unit vector that belongs to the larger.
    """
    mean = 0.5 * (xx + yy)
    half = 0.5 * (xx - yy)
    radius = math.hypot(half, xy)
    angle = 0.5 * math.atan2(xy, half)
    return mean - radius, mean + radius, (math.cos(angle), math.sin(angle))


def _left(mass: float, damping: float) -> float:
    """Return what share of a velocity's error a damper [N s/m] leaves of a ``mass`` [kg]
    after ``SERVO_TIME``.
    """
    caught = damping * SERVO_TIME  # [kg] that it leaves nothing of
    return 1.0 - caught / mass if mass > caught else 0.0
