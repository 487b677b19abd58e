"""Limits that the run loop enforces on every plant: joint speed, joint position, torque
and its rate, contact force, and jumps of a reference.

A guard checks every tick before its commands reach the arms. On a breach it returns the
ending, and the run loop stops the arms safely.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import compress

import numpy as np

from pushpressslide.core import margins
from pushpressslide.core.arrays import Array, minimum
from pushpressslide.core.control import (
    ArmCommand,
    Commands,
    JointCommand,
    TipCommand,
)
from pushpressslide.core.record import Ending

POSITION_MARGIN = 0.01  # [rad] or [m] of a joint to its limit: half of what plans keep
POSITION_PLAY = 0.005  # [rad] or [m] by which a joint may come nearer to it again
# [s] in which a joint may not reach the margin at its speed. Planned motions that brake at
# 15 rad/s2 before the margin of plans stay below
STOPPING_TIME = 0.03
TORQUE_TIME = 0.1  # [s] without a pause that an arm may ask for more than its torque
MEAN_TIME = 0.02  # [s] over which limits.normal_force bounds the mean contact force
NOISY = 0.95  # smallest share of the limit that is allowed because of noise
PEAK = 1.5  # bound of a single sample, over limits.normal_force
JUMP = 0.02  # [m] largest change of a tip's reference in a tick
# bound of a joint's change in a tick, over its change at the speed limit
JOINT_JUMP = 2.0


@dataclass(frozen=True, slots=True)
class ArmLimits:
    """Limits of one arm's n joints. Those of sliding joints are in [m], [m/s], [N] and
    [N/s].
    """

    lower: Array  # (n,) [rad]
    upper: Array  # (n,) [rad]
    velocity: Array  # (n,) [rad/s]
    effort: Array  # (n,) [N m]
    torque_rate: Array  # (n,) [N m/s]; infinite where the maker states none


@dataclass(frozen=True, slots=True)
class ArmReading:
    """Joint state of one arm at a tick, and the arm's previous command."""

    q: Array  # (n,) [rad]
    v: Array  # (n,) [rad/s]
    # largest demanded torque, and change of a torque, as shares of their limits
    torque_share: float = 0.0
    rate_share: float = 0.0


@dataclass(slots=True)
class _Memory:
    """State of a guard for one arm."""

    forces: deque[float]
    overload: int = 0  # ticks so far with a command above its torque limit
    # [rad] or [m] that its joints have been from their limits, at the farthest
    limit_distance: float | None = None
    reference: ArmCommand = None


@dataclass(slots=True)
class Guard:
    """Checks every tick of one run against the limits."""

    normal_force: float  # [N] limits.normal_force
    period: float  # [s]
    arms: Sequence[ArmLimits]  # none on a plant without joints
    # after a recovery: an arm that begins near a limit may move away from it
    anew: bool = False
    noise: float = 0.0  # [N] by which a measured force may be too small
    _memories: dict[int, _Memory] = field(default_factory=dict)
    # [rad] or [m] that each arm's joints had when it was asked first whether it is near a limit
    _first_rooms: list[float] | None = None
    _speeds: list[list[float]] = field(init=False)  # [rad/s] limits of each arm

    def __post_init__(self) -> None:
        self._speeds = [arm.velocity.tolist() for arm in self.arms]

    def forget_references(self) -> None:
        """Forget the references, because a new placement starts with other ones."""
        self._first_rooms = None
        for memory in self._memories.values():
            memory.reference = None

    def successor(self, normal_force: float, held_commands: Commands) -> Guard:
        """Guard for the run after a recovery, with a new limit ``normal_force`` [N].

        Its first commands are compared with ``held_commands``, which hold the arms in
        the meantime.
        """
        other = Guard(normal_force, self.period, self.arms, True, self.noise)
        for arm, command in enumerate(held_commands):
            other._memory(arm).reference = command
        return other

    def breach(
        self,
        forces: Sequence[float],
        readings: Sequence[ArmReading],
        commands: Commands,
    ) -> Ending | None:
        """First limit that is broken, or None.

        ``forces`` [N] are the normal forces measured at the tips, one per robot;
        ``commands`` are those about to be applied.
        """
        found = None
        for i, force in enumerate(forces):
            pushed = self._force(i, force)
            found = found or pushed
        for i, reading in enumerate(readings):
            fast = self._speed(i, reading)
            near = self._position(i, reading)
            strong = self._torque(i, reading)
            found = found or fast or near or strong
        for i, command in enumerate(commands):
            jump = self._jump(i, command)
            found = found or jump
        return found

    def near_joint_limit(self, readings: Sequence[ArmReading]) -> bool:
        """Whether a joint of a retreating arm has come too near to its limit.

        The smallest allowed distance is that of the limit's repulsion zone, or the
        joint's initial distance if that is smaller.
        """
        spaces = [
            minimum(_limit_distances(limits, reading))
            for limits, reading in zip(self.arms, readings, strict=True)
        ]
        if self._first_rooms is None:
            self._first_rooms = spaces
        return any(
            margin < min(margins.ARM.joint_buffer, first - POSITION_PLAY)
            for margin, first in zip(spaces, self._first_rooms, strict=True)
        )

    def _speed(self, arm: int, reading: ArmReading) -> Ending | None:
        allowed = self._speeds[arm]
        speeds = zip(reading.v.tolist(), allowed, strict=True)
        if all(-most <= v <= most for v, most in speeds):
            return None
        worst = int((np.abs(reading.v) - allowed).argmax())
        return Ending(
            "joint_limit",
            f"arm {arm}: joint {worst + 1} at {abs(float(reading.v[worst])):.2f} rad/s, "
            f"allowed {allowed[worst]:g} rad/s",
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
        # where the true force may be at its limit
        seen = max(limit - self.noise, NOISY * limit)
        if not force <= PEAK * limit:  # or no number
            text = f"{force:.1f} N in one sample, allowed {PEAK:g} times"
        elif len(recent) == recent.maxlen and math.fsum(recent) > seen * len(recent):
            mean = math.fsum(recent) / len(recent)
            text = f"{mean:.1f} N over {MEAN_TIME * 1e3:.0f} ms, allowed"
            if seen < limit:
                text += f" {limit - seen:g} N, for its noise, below"
        else:
            return None
        return Ending(
            "force_limit", f"tip {arm}: {text} limits.normal_force of {limit:g} N"
        )

    def _position(self, arm: int, reading: ArmReading) -> Ending | None:
        memory = self._memory(arm)
        left = _limit_distances(self.arms[arm], reading)
        worst = int(left.argmin())  # the first that is not a number, if any
        margin = float(left[worst])
        if memory.limit_distance is None:
            memory.limit_distance = margin if self.anew else math.inf
        allowed = min(POSITION_MARGIN, memory.limit_distance - POSITION_PLAY)
        memory.limit_distance = max(memory.limit_distance, margin)
        if margin < allowed:
            return Ending(
                "joint_limit",
                f"arm {arm}: joint {worst + 1} is {margin:.3f} rad from its limit, "
                f"allowed from {POSITION_MARGIN:g} rad",
            )
        return self._approach(arm, reading, left, allowed)

    def _approach(
        self, arm: int, reading: ArmReading, left: Array, allowed: float
    ) -> Ending | None:
        """Ending if a joint, now ``left`` (n,) [rad] from its limit, moves too fast to stop
        at the ``allowed`` distance [rad].
        """
        if left.min() > allowed + STOPPING_TIME * np.abs(reading.v).max():
            return None
        limits = self.arms[arm]
        lower_is_nearer = reading.q - limits.lower < limits.upper - reading.q
        speed = np.where(lower_is_nearer, -reading.v, reading.v)
        ahead = left - STOPPING_TIME * speed
        worst = int(ahead.argmin())
        if ahead[worst] >= allowed:
            return None
        return Ending(
            "joint_limit",
            f"arm {arm}: joint {worst + 1} approaches its limit at {speed[worst]:.2f} "
            f"rad/s, {left[worst]:.3f} rad before it",
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
            if not jump <= JUMP:  # or no number
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


def _limit_distances(limits: ArmLimits, reading: ArmReading) -> Array:
    """Distances (n,) [rad; m of slides] of the joints from the nearer ends of their
    ranges.
    """
    out: Array = np.minimum(reading.q - limits.lower, limits.upper - reading.q)
    return out


def _tip_jump(before: TipCommand, command: TipCommand) -> float:
    """Jump [m] of a tip's reference along the axes held both before and after."""
    x0, y0, z0 = before.position
    x1, y1, z1 = command.position
    dx, dy = x1 - x0, y1 - y0
    c = math.cos(command.normal_yaw)
    s = math.sin(command.normal_yaw)
    held = [
        one > 0.0 and other > 0.0
        for one, other in zip(before.stiffness, command.stiffness, strict=True)
    ]
    along = (c * dx + s * dy, c * dy - s * dx, z1 - z0)
    return math.hypot(*compress(along, held))
