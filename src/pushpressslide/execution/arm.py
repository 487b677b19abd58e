"""Joint torques of one arm from a tip command (the lower half of the paper's eq. 27)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.pose import Point
from pushpressslide.core.support_frame import TABLE, SupportFrame
from pushpressslide.execution.impedance import servo, tip_moment
from pushpressslide.execution.torque import (
    Gains,
    Impedance,
    LimitedTorque,
    Unfelt,
    braked,
    gains,
    held_for_a_tick,
    joint_torque,
    kept_inside,
    limited,
    near_limit,
    steady_share,
    task_inertia,
    unfelt,
    yielding,
)

TIP_FREEDOMS = 6  # freedoms of a tip: an arm with more joints has a choice of posture
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
# [s] in which catching up fades that does not help: it takes a few SERVO_TIMEs, and the
# moment that keeps a tool's attitude meanwhile tilts a tool whose tip is held back
HELD_BACK = 10.0 * SERVO_TIME
BRAKE_SHARE = 0.4  # share of a joint's speed that a braking arm loses in a tick
# of a momentum times the rate of a torque, the square of the braking torque that can be
# taken back until the joint rests: 2, less what a tick's delay costs
TAKEN_BACK = 1.5
# [rad^2], squared and summed over the joints, in which the posture's share of them hardly
# changes: of a posture's 2 N m the tip feels some 0.05 N
TURNED = 0.005**2
TINY = 1e-9  # [N m s] momentum of a joint that counts as zero


@dataclass(frozen=True, slots=True)
class ArmDynamics:
    """Kinematics and dynamics of one arm at a tick, in world axes. The tip is the
    centre of the tip's sphere.
    """

    q: Array  # (n,) [rad]
    v: Array  # (n,) [rad/s]
    position: Vector3  # [m]
    rotation: Array  # (3, 3) R_WT
    velocity: Vector3  # [m/s]
    angular_velocity: Vector3  # [rad/s]
    J: Array  # (6, n) rows [angular; linear]
    M: Array  # (n, n) mass matrix
    # (n,) [N m] compensation of gravity, Coriolis forces and the joints' own damping
    bias: Array
    # (6,) [rad/s^2; m/s^2] of a tip whose joints turn at constant rates
    drift: Array


class PostureShare(NamedTuple):
    """The part of the joint motion that the posture's impedance controls, at the joint
    positions ``q``.
    """

    q: Array  # (n,) [rad]
    unfelt: Array  # (n, n) of a torque, see ``execution.torque.Unfelt``
    braked: Array | None  # (n, n) as of ``execution.torque.braked``
    added: Array  # (n, n) [kg m^2] of the posture's gains, see ``Impedance``


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
    delay: float = 0.0  # [s] until a torque acts
    _torque_limits: tuple[float, ...] = field(init=False)  # (n,) [N m] of a torque
    # (n,) [N m] largest change of a torque in a tick
    _most_change: tuple[float, ...] = field(init=False)
    _plane: Array = field(
        init=False
    )  # (3, 2) directions in the world along the support
    _spin_axis: Vector3 = field(init=False)  # in the world, of the tool's yaw
    _axes: Array = field(init=False)  # (3, 3) x, y and height as columns in the world
    _upright: bool = field(init=False)  # whether height is the world's
    _flat: bool = field(init=False)  # whether all three axes are
    _lower: tuple[float, ...] = field(init=False)
    _upper: tuple[float, ...] = field(init=False)
    _rotation: Gains = field(init=False)  # of the tool's attitude
    _turning: Vector3 = field(init=False)  # [kg m^2] that these add, about each axis
    _posture: Gains = field(init=False)
    _tracking: Gains = field(init=False)
    _largest_share: float = field(init=False)  # share of a speed that a tick may take
    _share: PostureShare | None = None  # share of the joints at the last update
    # [m/s^2] mean acceleration to catch up, see HELD_BACK
    _persisting: Point = (0.0, 0.0)

    def __post_init__(self) -> None:
        self._torque_limits = tuple(self.effort.tolist())
        self._most_change = tuple((self.rate * self.dt).tolist())
        self._largest_share = steady_share(round(self.delay / self.dt))
        self._axes = np.array(self.frame.axes)
        self._upright = bool(self._axes[2, 2] == 1.0)
        self._flat = bool((self._axes == np.eye(3)).all())
        self._plane = self._axes[:, :2]
        self._lower = tuple(self.lower.tolist())
        self._upper = tuple(self.upper.tolist())
        self._rotation = gains(ROTATION_STIFFNESS, ROTATION_DAMPING, self.dt)
        self._turning = (self._rotation.added,) * 3
        self._posture = gains(POSTURE_STIFFNESS, POSTURE_DAMPING, self.dt)
        viscosity = JOINT_DAMPING * math.sqrt(self.joint_stiffness)
        self._tracking = gains(self.joint_stiffness, viscosity, self.dt)
        self._spin_axis = self.frame.spin_axis

    def free(
        self, arm: ArmDynamics, q_ref: Array, v_ref: Array, previous: Array
    ) -> LimitedTorque:
        """Torques that track joints in free space. ``previous`` (n,) [N m] are those of
        the previous tick.
        """
        rate = min(FREE_RATE, 0.5 * self._largest_share / self.dt)
        tau = joint_torque(arm.M, arm.bias, arm.q, arm.v, q_ref, v_ref, rate)
        return limited(tau, previous, self._torque_limits, self._most_change)

    def brake(self, arm: ArmDynamics, weight: Array, previous: Array) -> LimitedTorque:
        """Torques that hold the arm's ``weight`` (n,) [N m] and stop its joints as fast
        as its torques allow.

        ``previous`` (n,) [N m] are those of the previous tick. All joints lose the same
        fraction of their speed, so that a torque clipped by the limits still takes
        energy from the arm. The torque is bounded so that, at its allowed rate of
        change, it can return to zero by the time the arm is at rest.
        """
        momentum = arm.M @ arm.v
        size = np.maximum(np.abs(momentum), TINY)
        left = np.maximum(self.effort - np.abs(weight), 0.0)
        in_time = np.sqrt(TAKEN_BACK * self.rate * size)
        braking = float(np.min(np.minimum(left, in_time) / size))
        share = min(BRAKE_SHARE, self._largest_share)
        tau = weight - min(share / self.dt, braking) * momentum
        return limited(tau, previous, self._torque_limits, self._most_change)

    def contact(
        self,
        arm: ArmDynamics,
        command: TipCommand,
        q_ref: Array,
        v_ref: Array,
        previous: Array,
    ) -> LimitedTorque:
        """Torques that execute a tip command.

        The reference of the posture is ``q_ref`` (n,) [rad], which changes at ``v_ref``
        (n,) [rad/s]. ``previous`` (n,) [N m] are those of the previous tick.
        """
        velocity = self.frame.components(arm.velocity)
        J = arm.J
        near = near_limit(arm.q, self._lower, self._upper)
        moment = self._moment(arm, command)
        if near:
            J = yielding(J, moment, arm.q, self.lower, self.upper)
        torque, added = self._of_tip(arm, J, command, moment, velocity)
        posture = self._of_posture(arm, J, q_ref - arm.q, v_ref - arm.v)
        torque += posture.torque
        added += posture.added
        if near:
            lower = self.lower
            kept = kept_inside(arm.J, arm.q, arm.v, lower, self.upper, self.dt)
            torque += kept.torque
            added += kept.added
        wrench = self._inertial(arm, command, velocity)
        wrench[3:] += self.frame.direction(command.force)
        tau = arm.bias + arm.J.T @ wrench
        tau += held_for_a_tick(Impedance(torque, added), arm.M, self._largest_share)
        return limited(tau, previous, self._torque_limits, self._most_change)

    def _of_tip(
        self,
        arm: ArmDynamics,
        J: Array,
        command: TipCommand,
        moment: Vector3,
        velocity: Vector3,
    ) -> Impedance:
        """Impedance of the tip and of the tool's attitude.

        ``moment`` [N m] holds the attitude. ``velocity`` [m/s] is that of the tip, in
        the support's frame. ``J`` (6, n) may be reduced as by ``yielding``.
        """
        place = self.frame.coordinates(arm.position)
        own = servo(command, place, velocity, self.dt)
        force = self.frame.direction(own.force)
        along = J
        if not (own.isotropic and self._upright):
            along = np.vstack((J[:3], self._contact_axes(command.normal_yaw) @ J[3:]))
        weights = np.array((*self._turning, *own.added))
        return Impedance(J.T @ (moment + force), (along.T * weights) @ along)

    def _contact_axes(self, yaw: float) -> Array:
        """Axes n, t and height of a contact frame at a ``yaw`` [rad], as rows (3, 3) in
        the world.
        """
        c = math.cos(yaw)
        s = math.sin(yaw)
        axes: Array = np.array(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)))
        return axes @ self._axes.T

    def _of_posture(
        self, arm: ArmDynamics, J: Array, error: Array, speed: Array
    ) -> Impedance:
        """Impedance of the joints about their reference.

        ``error`` (n,) [rad] and ``speed`` (n,) [rad/s] are the deviations from the
        reference. The impedance acts only on joint motion that exerts no force at the
        tip or hardly moves the tip. ``J`` (6, n) may be reduced as by ``yielding``.
        """
        share = self._share
        if share is None or share.braked is not None or J is not arm.J:
            share = self._posture_share(arm, J)
        else:
            turned = arm.q - share.q
            if turned @ turned > TURNED:
                share = self._posture_share(arm, J)
        self._share = share if J is arm.J else None
        _, left, brake, growth = share
        spring, damper, _ = self._posture
        slowing = damper * speed
        torque = left @ (spring * error + slowing)
        if brake is not None:
            torque = torque + brake @ slowing
        if self.joint_stiffness > 0.0:
            spring, damper, added = self._tracking
            torque = torque + spring * error - damper * arm.v
            growth = growth + added * np.eye(len(error))
        return Impedance(torque, growth)

    def _posture_share(self, arm: ArmDynamics, J: Array) -> PostureShare:
        """Part of the joint motion left to the posture, at the present joint positions.

        ``J`` (6, n) is the arm's Jacobian, which may be reduced as by ``yielding``.
        """
        n = len(arm.q)
        JJt = J @ J.T
        none = np.zeros((n, n))
        left = unfelt(J, JJt) if n > TIP_FREEDOMS else Unfelt(none, none)
        brake = braked(arm.J, JJt if J is arm.J else arm.J @ arm.J.T)
        felt = left.damper if brake is None else left.damper + brake
        return PostureShare(arm.q, left.share, brake, self._posture.added * felt)

    def _moment(self, arm: ArmDynamics, command: TipCommand) -> Vector3:
        """Moment [N m], world axes, that holds the tool's attitude."""
        return tip_moment(
            self.rotation(command.tool_yaw + self.yaw_offset),
            arm.rotation,
            _times(command.tool_yaw_rate, self._spin_axis),
            arm.angular_velocity,
            ROTATION_STIFFNESS,
            self._rotation.damping,
        )

    def _inertial(
        self, arm: ArmDynamics, command: TipCommand, velocity: Vector3
    ) -> Array:
        """Wrench (6,), in world axes, that accelerates the arm's own inertia as
        commanded.

        ``velocity`` [m/s] is that of the tip, in the support's frame. The wrench is
        Lambda times the acceleration of the reference. Without it, an arm that
        accelerates along the support would also press on the object or lift off,
        because its inertia is coupled. The tip's acceleration at constant joint rates
        is subtracted, since it needs no torque.
        """
        spin = _times(command.tool_yaw_acceleration, self._spin_axis)
        moved = self.frame.direction(command.acceleration)
        inertia = task_inertia(arm.J, arm.M)
        wrench: Array = inertia @ (np.array(spin + moved) - arm.drift)
        damping = min(command.damping[:2])
        led = any(command.stiffness[:2])
        if damping > 0.0 and command.catches_up and not led:
            self._catch_up(wrench, inertia, damping, command, velocity)
        else:
            self._persisting = (0.0, 0.0)
        return wrench

    def _catch_up(
        self,
        total: Array,
        inertia: Array,
        damping: float,
        command: TipCommand,
        velocity: Vector3,
    ) -> None:
        """Add to the ``total`` wrench (6,), in world axes, a wrench that brings the tip
        to its reference's velocity within ``SERVO_TIME``.

        It applies only to tips without stiffness. ``inertia`` (6, 6) and ``velocity``
        [m/s] are those of the tip; ``damping`` [N s/m] is that of the damper. Together
        with the damper's force, the added wrench stays within the servo's cap. It is
        zero along axes on which the damper alone reaches that velocity in time.
        """
        # wrenches (6, 2) of accelerations along x and y, and their forces (2, 2) there
        if self._flat:
            wrenches = inertia[:, 3:5]
            forces = wrenches[3:5]
        else:
            wrenches = inertia[:, 3:] @ self._plane
            forces = self._plane.T @ wrenches[3:]
        (xx, xy), (_, yy) = forces.tolist()
        # the share that is left to do of an error along each principal axis
        light, heavy, toward = _principal(xx, xy, yy)
        along = _left(heavy, damping)
        if along == 0.0:
            self._persisting = (0.0, 0.0)
            return
        across = _left(light, damping)
        ex = command.velocity[0] - velocity[0]
        ey = command.velocity[1] - velocity[1]
        c, s = toward
        part = (along - across) * (c * ex + s * ey)
        ax = (across * ex + part * c) / SERVO_TIME
        ay = (across * ey + part * s) / SERVO_TIME
        left = self._unheld(ax, ay)
        wrench: Array = left * (wrenches @ (ax, ay))
        size = math.hypot(*wrench[3:].tolist())
        slack = max(0.0, command.servo_cap - damping * math.hypot(ex, ey))
        if size > slack:
            wrench *= slack / size
        total += wrench

    def _unheld(self, ax: float, ay: float) -> float:
        """Share left of an acceleration [m/s^2] to catch up, after what lasts of it."""
        lx, ly = self._persisting
        fresh = self.dt / HELD_BACK
        self._persisting = (lx + fresh * (ax - lx), ly + fresh * (ay - ly))
        size = ax * ax + ay * ay
        if size == 0.0:
            return 1.0
        return 1.0 - min(1.0, max(0.0, (lx * ax + ly * ay) / size))


def _times(factor: float, v: Vector3) -> Vector3:
    return (factor * v[0], factor * v[1], factor * v[2])


def _principal(xx: float, xy: float, yy: float) -> tuple[float, float, Point]:
    """Smaller and larger eigenvalue of a symmetric 2 x 2 matrix, and the unit
    eigenvector of the larger.
    """
    mean = 0.5 * (xx + yy)
    half = 0.5 * (xx - yy)
    radius = math.hypot(half, xy)
    angle = 0.5 * math.atan2(xy, half)
    return mean - radius, mean + radius, (math.cos(angle), math.sin(angle))


def _left(mass: float, damping: float) -> float:
    """Fraction of a velocity error of a ``mass`` [kg] that remains after ``SERVO_TIME``
    under a damper [N s/m].
    """
    caught = damping * SERVO_TIME  # [kg] that it leaves nothing of
    return 1.0 - caught / mass if mass > caught else 0.0
