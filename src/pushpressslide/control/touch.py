"""Phase touch: the tips line up with their contacts and advance until they feel the
object, or until it is seen to move.

A light object slides before its force is felt. Then the normal forces settle. Contacts
from the side and from above do the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from pushpressslide.control.state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    SERVO_CAP,
    Slowing,
    TipContext,
    TipMemory,
    averaged,
    between,
    contact_yaw,
    lowered,
    pressed,
    ramp_time,
    smooth,
    sunk,
    tip_position,
)
from pushpressslide.core import margins
from pushpressslide.core.control import TipCommand, Vector3
from pushpressslide.core.plan import Contact
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState

STILL = (0.0, 0.0, 0.0)


class TouchStep(NamedTuple):
    """Result of one tip's touch at a tick."""

    command: TipCommand
    memory: TipMemory
    done: bool
    problem: str | None = None  # description of a failure


class WayBack(NamedTuple):
    """Length of a tip's retreat from its contact, with its first and second derivative."""

    distance: float  # [m]
    speed: float  # [m/s]
    acceleration: float  # [m/s^2]


@dataclass(frozen=True, slots=True)
class TipTouch:
    """The touch of one tip."""

    radius: float  # [m] of the tip
    gap: float  # [m] free path before the object
    push: float  # [N] final force on a side face
    threshold: float  # [N] force above which a contact is detected
    min_displacement: float  # [m] smallest displacement of an object that is detected
    regulator: NormalForceRegulator
    # [m] lower than it rests on top, at which a pressing tip has slid off
    sunk: float = margins.ARM.sunk
    reaction: float = 0.0  # [s] until the arm follows a command
    samples: int = 1  # measurements of the force that are averaged
    look: float = 0.0  # [s] in which noisy sensors are averaged before the advance
    noisy: bool = False  # whether forces have noise
    light: bool = False  # whether the object may slide before it is felt
    min_turn: float = math.inf  # [rad] smallest turn of a light object that is detected
    knows_place: bool = False  # whether the arm has touched this object before

    def once_more(self, contact: Contact) -> TipTouch:
        """Touch of an arm that has touched the object before. A tip beside it starts
        nearer.
        """
        gap = self.gap
        if contact.kind == "side":
            gap = min(gap, margins.ARM.gap_again)
        return replace(self, gap=gap, knows_place=True)

    def speed(self, contact: Contact) -> float:
        """Speed [m/s] of the advance. An arm that reacts late is slower: until the touch
        is confirmed and the arm stops, the tip's spring reaches the final force.
        """
        arm = margins.ARM
        if self.reaction == 0.0:
            return arm.light_speed if self.light else arm.touch_speed
        force = max(self.force_of(contact), arm.least_press)
        late = self.reaction + arm.felt_time
        speed = force / (arm.contact_stiffness * late)
        return min(arm.touch_speed, max(arm.slowest_touch, speed))

    def _depth(self, contact: Contact, duration: float) -> float:
        """Length [m] of an advance after its ``duration`` [s]. Before a light object it
        is slow only near where it may touch.
        """
        speed = self.speed(contact)
        if not self.light:
            return speed * duration
        arm = margins.ARM
        fast = max(self.gap - arm.felt_near, 0.0)
        late = duration - fast / arm.touch_speed
        if late <= 0.0:
            return arm.touch_speed * duration
        return fast + speed * late

    def align_time(self, memory: TipMemory, contact: Contact, X_WB: Pose2) -> float:
        """Time [s] for the tip to line up before its contact."""
        before = tip_position(
            contact, memory.advance_start or X_WB, self.radius, self.gap
        )
        lines_up = ramp_time(math.dist(before, memory.start))
        if self.knows_place:  # what is averaged is near what is known
            return max(lines_up, self.look) + 0.1
        return lines_up + 0.1 + self.look

    def step(
        self, memory: TipMemory, context: TipContext, elapsed: float, aligned: float
    ) -> TouchStep:
        """Command of the tip, its next state, and whether its touch is complete.

        ``elapsed`` [s] is the time since the phase began. ``aligned`` [s] is the time
        at which the advance starts; with 0 it starts at once, from the tip's position.
        """
        if memory.held_command is not None:
            return TouchStep(memory.held_command, memory, True)
        contact = context.contact
        begins = context.joint_progress <= 0.0
        if begins:
            context = context._replace(joint_progress=-self.gap)
        if elapsed < aligned:
            before = tip_position(contact, context.X_WB, self.radius, self.gap)
            slowing = memory.slowed(elapsed)
            share = smooth(elapsed / aligned)
            place = between(slowing.position, before, share)
            return TouchStep(
                slowed_down(held_at(context, place), slowing), memory, False
            )
        on_its_way = aligned > 0.0 and memory.felt is None
        deepest = self.sunk + memory.lowered
        if not on_its_way and sunk(contact, context.tip, self.radius, deepest):
            below = deepest * 1e3
            slid = f"the tip slid off the top: it is over {below:.0f} mm below it"
            command = held_at(context, context.tip.position)
            return TouchStep(command, memory, False, slid)
        # from here on what the tip does to the object does not lead the tip
        found = memory.advance_start or context.X_WB
        memory = memory._replace(advance_start=found)
        n = contact.direction(found)
        origin, depth = self._advance(memory, context, found, elapsed, aligned)
        least = self.threshold
        if memory.felt is not None:
            least *= margins.KEPT_SHARE
        mean = averaged(memory.mean_force, context.tip.force, self.samples)
        memory = memory._replace(mean_force=mean)
        here = pressed(mean, n) > least and self._near(context)
        here = here or self._pushes(context, found)
        memory = self._felt(memory, here, context, depth)
        if memory.resumed == context.time:
            return TouchStep(held_at(context, context.tip.position), memory, False)
        if begins:
            left = self.gap - (depth if memory.felt is None else memory.touch_depth)
            context = context._replace(joint_progress=-max(left, 0.0))
        felt = memory.felt
        if felt is not None and context.time - felt >= margins.ARM.felt_time:
            place = _ahead(origin, n, memory.touch_depth)
            return self._pressed(memory, context, place, context.time - felt, here)
        problem = self._too_long(elapsed - aligned, self.speed(contact))
        if depth > self.gap + margins.ARM.touch_depth:
            problem = (
                f"no contact felt {margins.ARM.touch_depth * 1e3:.0f} mm beyond where "
                "the object should be"
            )
        speed = self.speed(contact)
        velocity = (speed * n[0], speed * n[1], speed * n[2])
        command = held_at(context, _ahead(origin, n, depth), velocity)
        memory = memory._replace(regulator=NormalForceState())
        return TouchStep(command, memory, False, problem)

    def _advance(
        self,
        memory: TipMemory,
        context: TipContext,
        advance_start: Pose2,
        elapsed: float,
        aligned: float,
    ) -> tuple[Vector3, float]:
        """Start of the tip's advance [m], and length [m] of the commanded advance.

        The advance starts at the end of the free gap before the object, which was at
        ``advance_start``, X_WB. A tip that has lost its contact starts where it lost
        it.
        """
        contact = context.contact
        before = tip_position(contact, advance_start, self.radius, self.gap)
        duration = elapsed - aligned
        if memory.resumed is not None:
            duration = context.time - memory.resumed
        depth = self._depth(contact, duration)
        if aligned > 0.0 and memory.resumed is None:
            return before, depth
        n = contact.direction(advance_start)
        start = memory.start
        ahead = sum((s - b) * d for s, b, d in zip(start, before, n, strict=True))
        ahead = min(ahead, self.gap)
        return _ahead(start, n, -ahead), depth + ahead

    def _felt(
        self, memory: TipMemory, here: bool, context: TipContext, depth: float
    ) -> TipMemory:
        """Memory with the time and the ``depth`` [m] of the first contact, if the object
        is felt at this tick (``here``).

        A tip that has lost contact advances again from its present position.
        """
        felt = memory.felt
        time = context.time
        if here:
            if felt is None:
                low = lowered(context.contact, context.tip, self.radius, self.sunk)
                return memory._replace(
                    felt=time, touch_depth=depth, absent=None, lowered=low
                )
            return memory._replace(absent=None)
        if felt is None:
            return memory
        if time - felt < margins.ARM.felt_time:
            return memory._replace(felt=None)  # a knock, not the object
        if memory.absent is None:
            return memory._replace(absent=time)
        if time - memory.absent < margins.ARM.push_loss_time:
            return memory
        return memory._replace(
            start=context.tip.position,
            advance_start=context.X_WB,
            felt=None,
            absent=None,
            resumed=time,
        )

    def force_of(self, contact: Contact) -> float:
        """Final force [N] of the tip on ``contact``."""
        if contact.kind == "top":
            return contact.load
        return self.push

    def _pressed(
        self,
        memory: TipMemory,
        context: TipContext,
        place: Vector3,
        duration: float,
        here: bool,
    ) -> TouchStep:
        """Press at ``place`` [m] with a rising force.

        Contact was first felt ``duration`` [s] ago. ``here`` says whether it is felt at
        this tick.
        """
        normal = context.contact.direction(context.X_WB)
        force = self.force_of(context.contact)
        push, state = self.regulator.step(
            memory.regulator, force, pressed(context.tip.force, normal), context.dt
        )
        arm = margins.ARM
        settled = arm.felt_time + arm.settle_time + force / self.regulator.ramp
        command = held_at(context, place, push=push)
        memory = memory._replace(regulator=state)
        return TouchStep(command, memory, duration > settled and here)

    def _too_long(self, duration: float, speed: float) -> str | None:
        """Failure of a touch that is still not made ``duration`` [s] after its advance
        at ``speed`` [m/s] began, or None if there is time left.
        """
        arm = margins.ARM
        most = (self.gap + arm.touch_depth) / speed + arm.longest_touch
        if duration < most:
            return None
        return f"contact felt and lost again for {most:.1f} s"

    def _near(self, context: TipContext) -> bool:
        """Whether the tip is near its contact. What noise makes felt elsewhere is not
        the object.
        """
        if not self.noisy:
            return True
        contact = context.contact
        n = contact.direction(context.X_WB)
        touching = tip_position(contact, context.X_WB, self.radius, 0.0)
        pairs = zip(touching, context.tip.position, n, strict=True)
        apart = sum((end - place) * along for end, place, along in pairs)
        return apart < margins.ARM.felt_near

    def _pushes(self, context: TipContext, advance_start: Pose2) -> bool:
        """Whether the object is seen to move while the tip pushes it from the side.

        The object has then left its pose ``advance_start``, X_WB, and the tip is at its
        contact. A light object may also turn, and nothing else moves it: its tip is near
        the contact.
        """
        contact = context.contact
        if contact.kind == "top":
            return False
        x, y, _ = contact.direction(advance_start)
        there = advance_start.apply(contact.point)
        now = context.X_WB.apply(contact.point)
        moved = (now[0] - there[0]) * x + (now[1] - there[1]) * y
        touching = tip_position(contact, context.X_WB, self.radius, 0.0)
        px, py, _ = context.tip.position
        apart = (touching[0] - px) * x + (touching[1] - py) * y
        if moved > self.min_displacement and apart < self.min_displacement:
            return True
        turned = abs(wrap_angle(context.X_WB.yaw - advance_start.yaw))
        moves = moved > self.min_displacement or turned > self.min_turn
        return self.light and moves and apart < margins.ARM.felt_near


def held_at(
    context: TipContext,
    position: Vector3,
    velocity: Vector3 = (0.0, 0.0, 0.0),
    push: float | None = None,
) -> TipCommand:
    """Command of a tip held at ``position`` [m], moving at ``velocity`` [m/s].

    With ``push`` [N] it pushes along its normal instead.
    """
    contact = context.contact
    n = contact.direction(context.X_WB)
    force = push or 0.0
    along, across, up = FREE_STIFFNESS
    if push is not None and contact.kind == "top":
        up = 0.0
    elif push is not None:
        along = 0.0
    return TipCommand(
        force=(force * n[0], force * n[1], force * n[2]),
        position=position,
        velocity=velocity,
        stiffness=(along, across, up),
        damping=FREE_DAMPING,
        normal_yaw=contact_yaw(contact, context.X_WB),
        tool_yaw=context.tool_yaw,
        tool_yaw_rate=0.0,
        servo_cap=SERVO_CAP,
        progress=context.joint_progress,
    )


def slowed_down(command: TipCommand, slowing: Slowing) -> TipCommand:
    """The ``command`` with the motion of a tip that comes to rest added."""
    if slowing.velocity == STILL and slowing.spin == 0.0:
        return command
    x, y, z = command.velocity
    vx, vy, vz = slowing.velocity
    ax, ay, az = command.acceleration
    bx, by, bz = slowing.acceleration
    return replace(
        command,
        velocity=(x + vx, y + vy, z + vz),
        acceleration=(ax + bx, ay + by, az + bz),
        tool_yaw_rate=slowing.spin,
        tool_yaw_acceleration=slowing.spin_rate,
    )


def drawn_back(context: TipContext, start: Vector3, retreat: WayBack) -> TipCommand:
    """Command of a tip that retreats from its contact, starting at ``start`` [m]."""
    n = context.contact.direction(context.X_WB)
    position, velocity, acceleration = (
        _ahead(origin, n, -moved)
        for origin, moved in zip((start, STILL, STILL), retreat, strict=True)
    )
    command = held_at(context, position, velocity)
    return replace(command, acceleration=acceleration)


def _ahead(origin: Vector3, direction: Vector3, distance: float) -> Vector3:
    return (
        origin[0] + distance * direction[0],
        origin[1] + distance * direction[1],
        origin[2] + distance * direction[2],
    )
