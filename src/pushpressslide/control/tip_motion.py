"""Tip commands during the motion, from contact forces and the object's twist."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.control.insertion import braking
from pushpressslide.control.state import (
    SERVO_CAP,
    TipContext,
    TipMemory,
    averaged,
    contact_yaw,
    pressed,
    sunk,
)
from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import (
    NormalForceRegulator,
    NormalForceState,
)
from pushpressslide.kernels.leading import approached

# [N/m], [N s/m] of a pushing tip along its height
HEIGHT_STIFFNESS = 2000.0
HEIGHT_DAMPING = 300.0
HEIGHT_EASING = 0.5  # [s] in which the spring along the height relaxes
HEIGHT_SLACK = 0.002  # [m] distance from the contact's height within which it relaxes
# [N s/m] of a pressing tip along its normal, which is force controlled
PRESS_DAMPING = 150.0
RETURN_RATE = 5.0  # [1/s] at which a tip that slid along its face is moved back
# [m/s^2] of the tips' reference: a jump of the steering must not jerk the contact
TIP_ACCELERATION = {"side": 0.5, "top": 1.0}
# [s] in which the drag of a press may turn about, from one side of its disc of friction
# to the other: a jump shakes the arm, and with it the normal force
TURNABOUT = 0.12
PUSH_SHARE = 0.95  # of the force limit, within which a push is kept
TOOL_ACCELERATION = 5.0  # [rad/s^2] the same of the tool's turning


class Felt(NamedTuple):
    """Measured state of a tip's contact."""

    lost: bool
    friction_utilisation: float
    # whether it is not felt now: told sooner than a loss, and not as surely
    absent: bool = False


class ContactKeeping(NamedTuple):
    """Correction that keeps a pushing tip at its contact while another tip pushes too."""

    place: Point  # [m] of the tip's centre, as planned, in B
    min_force: float  # [N] normal force below which the tip is advanced


class TipTask(NamedTuple):
    """Task of a tip at a tick."""

    twist: Twist  # of the object, in B
    center: Point  # [m] of the tip's centre, in B
    force: Point  # [N] along the support, in B
    load: float  # [N] planned load of a press
    entry_speed: float | None = None  # [m/s] of a press whose object enters an opening
    # where one of several pushing tips is moved back to if it slides or separates
    hold: ContactKeeping | None = None


class _Normal(NamedTuple):
    """Command of a tip along the height axis."""

    height: float  # [m] of the reference
    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    push: float = 0.0  # [N] into the support
    acceleration: float = 0.0  # [m/s^2] of the reference


@dataclass(frozen=True, slots=True)
class TipMover:
    """Moves a tip by feed-forward of its contact force and a velocity servo along the
    contact's motion.

    The normal force of a press is regulated.
    """

    damping: float  # [N s/m] of the servo
    friction: float  # of the pair end effector/object, as believed
    threshold: float  # [N] force above which a contact is detected
    noise: float  # [N] standard deviation of a measured force, as stated
    regulator: NormalForceRegulator
    radii: tuple[float, ...]  # [m] of the robots' tips
    # [m] lower than it rests on top, at which a pressing tip has slid off
    sunk: float = margins.ARM.sunk
    felt_samples: int = 1  # measurements of a force that are averaged
    unfelt: bool = False  # whether a push may be too weak to be felt: it is not missed

    def samples(self, contact: Contact) -> int:
        """Number of measurements of the normal force that are averaged to detect a loss
        of contact.

        It makes the standard error of the mean margins.LOSS_SIGMAS times smaller than
        the drop that counts as a loss.
        """
        if self.noise == 0.0:
            return 1
        drop = max(
            margins.KEPT_SHARE * self.threshold,
            (1.0 - margins.LOSS_SHARE) * contact.load,
        )
        return math.ceil(0.5 * ((margins.LOSS_SIGMAS * self.noise / drop) ** 2 + 1.0))

    def holds(
        self, planned: Sequence[Contact], normals: Sequence[float]
    ) -> list[ContactKeeping | None]:
        """Contact keeping of two pushing tips at their ``planned`` contacts. None for
        other contacts.

        ``normals`` [N] are the allocated normal forces.
        """
        if sum(contact.kind == "side" for contact in planned) < 2:
            return [None] * len(planned)
        least = max(margins.HELD_SHARE * math.fsum(normals), self.threshold)
        places = (c.tip_place(self.radii[c.arm])[0] for c in planned)
        return [ContactKeeping(place, least) for place in places]

    def step(
        self, memory: TipMemory, context: TipContext, task: TipTask
    ) -> tuple[TipCommand, TipMemory, Felt]:
        """Command of the tip, its next state, and its measured contact."""
        contact = context.contact
        X_WB = context.X_WB
        tip = context.tip
        direction = contact.direction(X_WB)
        normal_force = pressed(tip.force, direction)
        mean = averaged(memory.mean_force, tip.force, self.felt_samples)
        mean_normal = pressed(mean, direction)
        kept = averaged(memory.kept_force, tip.force, self.samples(contact))
        radius = self.radii[contact.arm]
        absent = pressed(kept, direction) < self._loss_threshold(contact)
        if self.unfelt and contact.kind == "side":
            absent = False
        felt = Felt(
            absent or sunk(contact, tip, radius, self.sunk + memory.lowered),
            self._utilisation(mean, direction, mean_normal),
            mean_normal < margins.KEPT_SHARE * self.threshold and not self.unfelt,
        )
        force = X_WB.rotate(task.force)
        velocity, (ax, ay) = self._motion(memory, context, task)
        turn, spin = _turning(memory.turn, task.twist.w, context.dt)
        normal, regulator, height = self._along_height(
            memory, context, task, normal_force
        )
        drag = memory.drag
        if task.entry_speed is not None:  # only the damper holds it back
            felt = Felt(False, 0.0)
            force = _within(force, self.friction * max(normal_force, 0.0))
        elif contact.kind == "top":
            most = 2.0 * self.friction * task.load * context.dt / TURNABOUT
            force = drag = approached(drag, force, most)
        vx, vy = velocity
        if task.hold is not None:
            speed = math.hypot(vx, vy)
            back_x, back_y = _reseating_velocity(context, task.hold, mean_normal, speed)
            vx += back_x
            vy += back_y
        if contact.kind == "side":
            vx, vy = self._within_limit((vx, vy), force, direction, tip.velocity)
        command = TipCommand(
            force=(force[0], force[1], -normal.push),
            position=(tip.position[0], tip.position[1], normal.height),
            velocity=(vx, vy, 0.0),
            stiffness=(0.0, 0.0, normal.stiffness),
            damping=(self.damping, self.damping, normal.damping),
            normal_yaw=contact_yaw(contact, X_WB),
            tool_yaw=context.tool_yaw,
            tool_yaw_rate=turn,
            servo_cap=max(SERVO_CAP, normal.push),  # the damper of an entry bears it
            progress=context.joint_progress,
            acceleration=(ax, ay, normal.acceleration),
            tool_yaw_acceleration=spin,
            catches_up=task.entry_speed is None,  # one that drops in may hold nothing
        )
        memory = memory._replace(
            regulator=regulator,
            velocity=velocity,
            turn=turn,
            mean_force=mean,
            kept_force=kept,
            height=height,
            drag=drag,
        )
        return command, memory, felt

    def _within_limit(
        self, velocity: Point, force: Point, direction: Vector3, measured: Vector3
    ) -> Point:
        """Velocity [m/s] with which the servo's damper, added to the fed-forward
        ``force`` [N], keeps a push within the limit of its normal force.

        ``direction`` is that of the push, ``measured`` [m/s] the tip's velocity. The
        servo may always hold the tip back.
        """
        if self.damping == 0.0:
            return velocity
        nx, ny, _ = direction
        vx, vy = velocity
        most = PUSH_SHARE * (self.regulator.f_max - self.noise)
        room = max(0.0, most - (force[0] * nx + force[1] * ny)) / self.damping
        ahead = (vx - measured[0]) * nx + (vy - measured[1]) * ny
        over = max(0.0, ahead - room)
        return vx - over * nx, vy - over * ny

    def _along_height(
        self,
        memory: TipMemory,
        context: TipContext,
        task: TipTask,
        normal_force: float,
    ) -> tuple[_Normal, NormalForceState, float | None]:
        """Command of the tip along the height axis, the next state of its regulator, and
        the height [m] at which a pushing tip is held. ``normal_force`` [N] is measured.
        """
        contact = context.contact
        tip = context.tip
        regulator = memory.regulator
        height = memory.height
        if task.entry_speed is not None:
            speed = task.entry_speed
            down = braking(-tip.velocity[2], speed)
            damping = task.load / speed
            normal = _Normal(tip.position[2], 0.0, damping, task.load, down)
            return normal, regulator, height
        if contact.kind == "top":
            push, regulator = self.regulator.step(
                regulator, task.load, normal_force, context.dt
            )
            normal = _Normal(tip.position[2], 0.0, PRESS_DAMPING, push)
            return normal, regulator, height
        height = eased_height(height, tip.position[2], contact.height, context.dt)
        return _Normal(height, HEIGHT_STIFFNESS, HEIGHT_DAMPING), regulator, height

    def _loss_threshold(self, contact: Contact) -> float:
        """Normal force [N] below which a contact counts as lost."""
        return max(
            margins.KEPT_SHARE * self.threshold, margins.LOSS_SHARE * contact.load
        )

    def _utilisation(
        self, force: Vector3, normal: Vector3, normal_force: float
    ) -> float:
        """Least friction utilisation, as far as the mean ``force`` tells.

        ``normal_force`` [N] is its part along the ``normal``.
        """
        shear = math.hypot(
            force[0] - normal_force * normal[0], force[1] - normal_force * normal[1]
        )
        doubt = margins.DOUBT * self.noise / math.sqrt(2.0 * self.felt_samples - 1.0)
        least = max(shear - doubt, 0.0)
        return least / (self.friction * max(normal_force, self.threshold))

    def _motion(
        self, memory: TipMemory, context: TipContext, task: TipTask
    ) -> tuple[Point, Point]:
        """Velocity [m/s] and acceleration [m/s^2] of the tip's reference along the
        support.
        """
        at_tip = task.twist.moved_to(task.center)
        before = memory.velocity or (0.0, 0.0)
        wanted = context.X_WB.rotate((at_tip.vx, at_tip.vy))
        dt = context.dt
        velocity = approached(
            before, wanted, TIP_ACCELERATION[context.contact.kind] * dt
        )
        if dt <= 0.0:
            return velocity, (0.0, 0.0)
        ax = (velocity[0] - before[0]) / dt
        ay = (velocity[1] - before[1]) / dt
        return velocity, (ax, ay)


def _turning(before: float, wanted: float, dt: float) -> tuple[float, float]:
    """Yaw rate [rad/s] and acceleration [rad/s^2] of the tool's reference after a tick
    of ``dt`` [s].

    The rate changes from ``before`` towards ``wanted``, within the allowed
    acceleration.
    """
    most = TOOL_ACCELERATION * dt
    turn = min(max(wanted, before - most), before + most)
    return turn, (turn - before) / dt if dt > 0.0 else 0.0


def _reseating_velocity(
    context: TipContext, hold: ContactKeeping, normal_force: float, speed: float
) -> Point:
    """Velocity [m/s], along the support, that returns a pushing tip to its contact.

    It moves the tip along the face to the planned place. A tip that presses with less
    than ``hold.least`` also moves into the face. ``normal_force`` [N] is measured;
    ``speed`` [m/s] is the tip's speed without this correction. The correction is needed
    because the servo follows the wanted twist: if the object turns differently, the
    friction of a lightly loaded tip cannot hold the tip in place. It is limited to a
    fraction of ``speed``, because a tip that sticks to the face turns the object while
    it moves back.
    """
    nx, ny, _ = context.contact.direction(context.X_WB)
    x, y = context.X_WB.apply(hold.place)
    px, py, _ = context.tip.position
    slid = (x - px) * -ny + (y - py) * nx
    beyond = max(0.0, abs(slid) - margins.ARM.slid_side)
    back = min(RETURN_RATE * beyond, margins.ARM.return_share * speed)
    along = math.copysign(back, slid)
    lacking = min(max(1.0 - normal_force / hold.min_force, 0.0), 1.0)
    on = margins.ARM.led_on * lacking
    return (on * nx - along * ny, on * ny + along * nx)


def eased_height(height: float | None, tip: float, wanted: float, dt: float) -> float:
    """Height [m] at which a pushing tip is held after a tick of ``dt`` [s], near the
    height ``wanted``.

    ``height`` is the result of the previous tick. The result follows the measured
    height ``tip``, at which friction holds the tip on the face. A spring to a fixed
    height would load the face with 0.1 N per 0.05 mm, which exhausts the friction of a
    light object.
    """
    if height is None:
        height = tip
    height += (tip - height) * min(1.0, dt / HEIGHT_EASING)
    return min(max(height, wanted - HEIGHT_SLACK), wanted + HEIGHT_SLACK)


def _within(force: Point, limit: float) -> Point:
    """``force`` limited to ``limit`` [N]."""
    size = math.hypot(*force)
    if size <= limit:
        return force
    return (force[0] * limit / size, force[1] * limit / size)


def missing(
    felt: Sequence[Felt], contacts: Sequence[Contact], normals: Sequence[float]
) -> bool:
    """Whether a required contact is lost.

    All presses are required, and all pushes with a considerable fraction of the sum of
    ``normals`` [N].
    """
    if not any(one.lost for one in felt):
        return False
    least = margins.LEAST_SHARE * math.fsum(normals)
    return any(
        one.lost and (contact.kind == "top" or normal >= least)
        for one, contact, normal in zip(felt, contacts, normals, strict=True)
    )
