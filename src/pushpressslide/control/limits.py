"""The limits that the run loop enforces, whatever the plant: joint speed, joint
position, torque and its rate, contact force, and jumps of a reference.

A guard sees every tick before its commands reach the arms. On a breach it returns the
ending, and the run loop stops the arms safely.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array, least
from pushpressslide.core.control import (
    ArmCommand,
    Commands,
    JointCommand,
    TipCommand,
)
from pushpressslide.core.record import Ending

POSITION_MARGIN = 0.01  # [rad] or [m] of a joint to its limit: half of what plans keep
POSITION_PLAY = 0.005  # of that distance, by which a joint may come nearer again
TORQUE_TIME = 0.1  # [s] without a pause that an arm may ask for more than its torque
MEAN_TIME = 0.02  # [s] over which limits.normal_force bounds the mean contact force
PEAK = 1.5  # times limits.normal_force: bound of a single sample
JUMP = 0.02  # [m] of a tip's reference between two ticks
JOINT_JUMP = 2.0  # times what a joint could move in a tick at its speed limit


@dataclass(frozen=True, slots=True)
class ArmLimits:
    """Limits of one arm's n joints; of slides in [m], [m/s], [N]."""

    lower: Array  # (n,) [rad]
    upper: Array  # (n,) [rad]
    velocity: Array  # (n,) [rad/s]
    effort: Array  # (n,) [N m]
    torque_rate: Array  # (n,) [N m/s]; infinite where the maker states none


@dataclass(frozen=True, slots=True)
class ArmReading:
    """What one arm's joints do at a tick, and what the tick before asked of them."""

    q: Array  # (n,) [rad]
    v: Array  # (n,) [rad/s]
    # largest demanded torque, and change of a torque, as shares of their limits
    torque_share: float = 0.0
    rate_share: float = 0.0


@dataclass(slots=True)
class _Memory:
    """What a guard remembers of one arm."""

    forces: deque[float]
    overload: int = 0  # ticks so far at which more than its torque was asked
    # [rad] or [m] that its joints have been from their limits, at the farthest
    room: float | None = None
    reference: ArmCommand = None


@dataclass(slots=True)
class Guard:
    """Judges every tick of one run by the limits."""

    normal_force: float  # [N] limits.normal_force
    period: float  # [s]
    arms: Sequence[ArmLimits]  # none on a plant without joints
    # after a recovery: an arm that begins near a limit may move away from it
    anew: bool = False
    _memories: dict[int, _Memory] = field(default_factory=dict)
    # [rad] or [m] that each arm's joints had when it was asked first whether it is cramped
    _rooms: list[float] | None = None

    def begin(self) -> None:
        """Forget the references: a new placement begins, with references of its own."""
        self._rooms = None
        for memory in self._memories.values():
            memory.reference = None

    def successor(self, normal_force: float, held: Commands) -> Guard:
        """Guard of what follows a recovery, with another limit of the normal force [N]:
        it knows the commands that the arms are ``held`` by till then.
        """
        other = Guard(normal_force, self.period, self.arms, anew=True)
        for arm, command in enumerate(held):
            other._memory(arm).reference = command
        return other

    def breach(
        self,
        forces: Sequence[float],
        readings: Sequence[ArmReading],
        commands: Commands,
    ) -> Ending | None:
        """Return the first limit that is broken, None if all hold.

        ``forces`` [N] are the normal forces measured at the tips, one per robot;
        ``commands`` are those about to be applied.
        """
        found = [self._force(i, force) for i, force in enumerate(forces)]
        for i, (limits, reading) in enumerate(zip(self.arms, readings, strict=True)):
            found.append(_speed(i, limits, reading))
            found.append(self._position(i, limits, reading))
            found.append(self._torque(i, reading))
        found += [self._jump(i, command) for i, command in enumerate(commands)]
        return next((ending for ending in found if ending is not None), None)

    def cramped(self, readings: Sequence[ArmReading]) -> bool:
        """Return whether a joint has come as near to its limit as an arm that draws back
        may bring it: to where it is held off, or nearer than it was at first.
        """
        rooms = [
            least(_rooms(limits, reading))
            for limits, reading in zip(self.arms, readings, strict=True)
        ]
        if self._rooms is None:
            self._rooms = rooms
        return any(
            room < min(margins.ARM.joint_buffer, first - POSITION_PLAY)
            for room, first in zip(rooms, self._rooms, strict=True)
        )

    def _memory(self, arm: int) -> _Memory:
        if arm not in self._memories:
            count = max(1, round(MEAN_TIME / self.period))
            self._memories[arm] = _Memory(deque(maxlen=count))
        return self._memories[arm]

    def _force(self, arm: int, force: float) -> Ending | None:
        recent = self._memory(arm).forces
        recent.append(force)
        limit = self.normal_force
        if force > PEAK * limit:
            text = f"{force:.1f} N in one sample, allowed {PEAK:g} times"
        elif len(recent) == recent.maxlen and math.fsum(recent) > limit * len(recent):
            mean = math.fsum(recent) / len(recent)
            text = f"{mean:.1f} N over {MEAN_TIME * 1e3:.0f} ms, allowed"
        else:
            return None
        return Ending(
            "force_limit", f"tip {arm}: {text} limits.normal_force of {limit:g} N"
        )

    def _position(
        self, arm: int, limits: ArmLimits, reading: ArmReading
    ) -> Ending | None:
        memory = self._memory(arm)
        left = _rooms(limits, reading)
        worst = int(left.argmin())
        room = float(left[worst])
        if memory.room is None:
            memory.room = room if self.anew else math.inf
        allowed = min(POSITION_MARGIN, memory.room - POSITION_PLAY)
        memory.room = max(memory.room, room)
        if room >= allowed:
            return None
        return Ending(
            "joint_limit",
            f"arm {arm}: joint {worst + 1} is {room:.3f} rad from its limit, allowed "
            f"from {POSITION_MARGIN:g} rad",
        )

    def _torque(self, arm: int, reading: ArmReading) -> Ending | None:
        memory = self._memory(arm)
        largest = max(reading.torque_share, reading.rate_share)
        memory.overload = memory.overload + 1 if largest > 1.0 else 0
        if memory.overload * self.period <= TORQUE_TIME:
            return None
        what = "torque"
        if reading.rate_share >= reading.torque_share:
            what = "change of torque"
        return Ending(
            "torque_limit",
            f"arm {arm}: asked for {largest:.2f} times its {what} for "
            f"{TORQUE_TIME * 1e3:.0f} ms",
        )

    def _jump(self, arm: int, command: ArmCommand) -> Ending | None:
        memory = self._memory(arm)
        before = memory.reference
        memory.reference = command
        if isinstance(command, TipCommand) and isinstance(before, TipCommand):
            jump = _tip_jump(before, command)
            if jump > JUMP:
                return Ending(
                    "reference_jump",
                    f"tip {arm}: its reference jumps by {jump * 1e3:.0f} mm, allowed "
                    f"{JUMP * 1e3:.0f} mm",
                )
        if isinstance(command, JointCommand) and isinstance(before, JointCommand):
            return self._joint_jump(arm, before, command)
        return None

    def _joint_jump(
        self, arm: int, before: JointCommand, command: JointCommand
    ) -> Ending | None:
        allowed = JOINT_JUMP * self.period * self.arms[arm].velocity
        jumps = np.abs(command.position - before.position)
        worst = int(np.argmax(jumps / allowed))
        if jumps[worst] <= allowed[worst]:
            return None
        return Ending(
            "reference_jump",
            f"arm {arm}: the reference of joint {worst + 1} jumps by "
            f"{jumps[worst]:.3f} rad, allowed {allowed[worst]:.3f} rad",
        )


def _rooms(limits: ArmLimits, reading: ArmReading) -> Array:
    """Return how far each joint is from the nearer end of its range (n,)."""
    out: Array = np.minimum(reading.q - limits.lower, limits.upper - reading.q)
    return out


def _speed(arm: int, limits: ArmLimits, reading: ArmReading) -> Ending | None:
    speeds = zip(reading.v.tolist(), limits.velocity.tolist(), strict=True)
    if all(-most <= v <= most for v, most in speeds):
        return None
    worst = int((np.abs(reading.v) - limits.velocity).argmax())
    return Ending(
        "joint_limit",
        f"arm {arm}: joint {worst + 1} at {abs(float(reading.v[worst])):.2f} rad/s, "
        f"allowed {limits.velocity[worst]:g} rad/s",
    )


def _tip_jump(before: TipCommand, command: TipCommand) -> float:
    """Return how far [m] a reference jumps along the axes that hold the tip in both."""
    step = [b - a for a, b in zip(before.position, command.position, strict=True)]
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    along = (c * step[0] + s * step[1], c * step[1] - s * step[0], step[2])
    return math.hypot(
        *(
            d
            for d, old, new in zip(
                along, before.stiffness, command.stiffness, strict=True
            )
            if old > 0.0 and new > 0.0
        )
    )
