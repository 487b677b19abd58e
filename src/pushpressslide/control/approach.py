"""The approach: free-space motion to the start of the touch, commanded in place of the
controller.

Arms follow joint paths. On a plant without arms the tips move by themselves.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from pushpressslide.control.joint_reference import approach_reference
from pushpressslide.control.state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    SERVO_CAP,
    between,
    ramp_time,
    smooth,
    smooth_rate,
)
from pushpressslide.core.control import (
    ArmCommand,
    Commands,
    ControlLog,
    JointCommand,
    Thought,
    TipCommand,
    TipCommands,
    Vector3,
)
from pushpressslide.core.plan import JointPath
from pushpressslide.core.pose import Pose2

SETTLE = 0.2  # [s] that an arm or tip rests at the end of its approach
HALT = 0.3  # [s] in which an approach that is stopped comes to rest
TRAVEL_SPEED = 0.25  # [m/s] of a tip without an arm, at its fastest


class Approach(ABC):
    """Leads all arms or tips to a placement.

    An arm that keeps a contact from the previous placement continues to obey its last
    tip command.
    """

    def __init__(
        self, start: Pose2, held_commands: TipCommands, began: float, duration: float
    ) -> None:
        """Start at time ``began`` [s], for ``duration`` [s].

        ``start`` is the planned X_WG at the start of the placement. ``held_commands``
        holds the command of each arm that keeps its contact, and None for the others.
        """
        self._began = began
        self._halted: float | None = None  # [s]
        self._log = ControlLog("approach", 0.0, lambda: Thought(start))
        self.held = held_commands
        self.arrival = began + duration  # [s] when the touch begins

    def step(self, time: float) -> tuple[Commands, ControlLog]:
        """One command per arm at ``time`` [s], and the log of the tick."""
        elapsed, rate = self._clock(time)
        commands = tuple(
            self._command(i, held, elapsed, rate) for i, held in enumerate(self.held)
        )
        return commands, self._log

    def halt(self, time: float) -> None:
        """Slow down from ``time`` [s] on, along the same path, and stay at rest."""
        self._halted = time
        self.arrival = math.inf

    def at_rest(self, time: float) -> bool:
        """Whether the approach is at rest after a halt."""
        return self._halted is not None and time - self._halted > HALT + SETTLE

    def _clock(self, time: float) -> tuple[float, float]:
        """Time [s] along the path and its rate. The rate is 1, and falls to 0 after a
        halt.
        """
        if self._halted is None:
            return time - self._began, 1.0
        share = min((time - self._halted) / HALT, 1.0)
        past = HALT * share * (1.0 - 0.5 * share)
        return self._halted - self._began + past, 1.0 - share

    @abstractmethod
    def _command(
        self, arm: int, held_commands: TipCommand | None, elapsed: float, rate: float
    ) -> ArmCommand:
        """Command of an arm at the time ``elapsed`` [s] of its path, which is traversed
        at ``rate``.
        """


class JointApproach(Approach):
    """Moves arms along their joint paths.

    An arm that keeps its contact takes only its posture from the path.
    """

    def __init__(
        self,
        start: Pose2,
        paths: tuple[JointPath, ...],
        held_commands: TipCommands,
        began: float,
    ) -> None:
        """Follow ``paths``, one per arm. The other parameters are those of an approach."""
        longest = max(float(path.approach_time[-1]) for path in paths)
        super().__init__(start, held_commands, began, longest + SETTLE)
        self._paths = paths

    def _command(
        self, arm: int, held_commands: TipCommand | None, elapsed: float, rate: float
    ) -> ArmCommand:
        position, velocity = approach_reference(self._paths[arm], elapsed)
        if held_commands is None:
            return JointCommand(position, rate * velocity)
        return replace(held_commands, posture=position)


@dataclass(frozen=True, slots=True)
class TipPath:
    """Path of a tip through ``corners`` [m], with a stop at each of them."""

    corners: tuple[Vector3, ...]

    @property
    def duration(self) -> float:
        """Duration [s] of the path."""
        return sum(
            ramp_time(math.dist(a, b), TRAVEL_SPEED) for a, b in pairwise(self.corners)
        )

    def state_at(self, elapsed: float) -> tuple[Vector3, Vector3]:
        """Position [m] and velocity [m/s] ``elapsed`` [s] after the start."""
        for a, b in pairwise(self.corners):
            time = ramp_time(math.dist(a, b), TRAVEL_SPEED)
            if elapsed < time:
                u = elapsed / time
                rate = smooth_rate(u) / time
                dx, dy, dz = (end - start for start, end in zip(a, b, strict=True))
                return between(a, b, smooth(u)), (rate * dx, rate * dy, rate * dz)
            elapsed -= time
        return self.corners[-1], (0.0, 0.0, 0.0)


class TipApproach(Approach):
    """Moves tips without arms: up, across, and down to a point before their contacts."""

    def __init__(
        self,
        start: Pose2,
        paths: Sequence[TipPath | None],
        held_commands: TipCommands,
        began: float,
    ) -> None:
        """Follow ``paths``, one per tip. None for a tip that stays in place. The other
        parameters are those of an approach.
        """
        longest = max((p.duration for p in paths if p is not None), default=0.0)
        super().__init__(
            start, held_commands, began, longest + SETTLE if longest else 0.0
        )
        self._paths = paths

    def _command(
        self, arm: int, held_commands: TipCommand | None, elapsed: float, rate: float
    ) -> ArmCommand:
        path = self._paths[arm]
        if held_commands is not None or path is None:
            return held_commands
        position, (vx, vy, vz) = path.state_at(elapsed)
        return free_tip(position, (rate * vx, rate * vy, rate * vz))


def free_tip(position: Vector3, velocity: Vector3) -> TipCommand:
    """Command of a tip without contact, at ``position`` [m] with ``velocity`` [m/s]."""
    return TipCommand(
        force=(0.0, 0.0, 0.0),
        position=position,
        velocity=velocity,
        stiffness=FREE_STIFFNESS,
        damping=FREE_DAMPING,
        normal_yaw=0.0,
        tool_yaw=0.0,
        tool_yaw_rate=0.0,
        servo_cap=SERVO_CAP,
        progress=0.0,
    )


def tip_path(start: Vector3, end: Vector3, above: float) -> TipPath:
    """Path from ``start`` to ``end`` [m] at a height of at least ``above`` [m]."""
    height = max(above, start[2], end[2])
    up = (start[0], start[1], height)
    over = (end[0], end[1], height)
    corners = (start, up, over, end)
    kept = [corners[0]]
    kept += [b for a, b in pairwise(corners) if a != b]
    return TipPath(tuple(kept))
