"""A stop in levels: the reaction of the arms to a broken limit.

    draw back   the controller leads the tips away, while the arms obey
    hold        an arm that does not obey stays where it is
    brake       an arm whose joints run away: its weight is held, its joints are damped

A level is never left for a lower one. An arm that runs away brakes, and the others
hold.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from pushpressslide.control.limits import TORQUE_TIME, ArmLimits, ArmReading
from pushpressslide.core import margins
from pushpressslide.core.control import ArmCommand, BrakeCommand, Commands, JointCommand

# changes of a joint's direction from tick to tick, one after the other, each time at
# this share of its speed limit or more: a commanded motion takes tens of ticks to turn
FLIPS = 3
FLIP_SPEED = 0.05
# ticks in each of which a joint becomes faster, by this share of its speed limit or more:
# three times as much as in any tick in which the arms are driven or meet an object
GROWTH_TICKS = 3
CALM = 0.06
BEYOND = 1.5  # ratio to its speed limit above which a joint no longer obeys
GRACE = 0.1  # [s] in which an arm that draws back may still be too fast
REST_SPEED = 0.01  # share of its speed limit below which a joint counts as at rest
REST_TIME = 0.05  # [s] for which all joints have to be at rest
LONGEST = 1.5  # [s] longest wait for this, after an arm stops drawing back


class StopLevel(IntEnum):
    """Level of a stop for one arm."""

    DRAW_BACK = 0
    HOLD = 1
    BRAKE = 2


def own_rates(limits: ArmLimits, reading: ArmReading) -> list[float]:
    """Speeds (n,) [rad/s] of an arm's joints. 0 of one that is on its way back from an
    end of its range, from which the arm's law pushes it away.
    """
    q, v = reading.q, reading.v
    near = margins.ARM.joint_buffer
    if np.minimum(q - limits.lower, limits.upper - q).min() > near:
        speeds: list[float] = v.tolist()
        return speeds
    back = ((q < limits.lower + near) & (v > 0.0)) | (
        (q > limits.upper - near) & (v < 0.0)
    )
    rates: list[float] = np.where(back, 0.0, v).tolist()
    return rates


@dataclass(slots=True)
class JointWatch:
    """Watches one arm's joints for uncommanded speeds.

    Such speeds grow from tick to tick, change sign from tick to tick, or are far above
    their limit.
    """

    limits: Sequence[float]  # (n,) [rad/s]
    _calm: list[float] = field(init=False)  # (n,) [rad/s] of a change that counts
    _before: list[float] = field(init=False)  # (n,) [rad/s] at the last tick
    _grown: list[int] = field(init=False)  # (n,) ticks of growth so far
    _flips: list[int] = field(init=False)  # (n,) changes of direction so far

    def __post_init__(self) -> None:
        n = len(self.limits)
        self._calm = [CALM * limit for limit in self.limits]
        self._before = [0.0] * n
        self._grown = [0] * n
        self._flips = [0] * n

    def step(self, rates: list[float]) -> str | None:
        """Description of the first joint that runs away, from its ``rates`` (n,)
        [rad/s] at this tick, or None.
        """
        before = self._before
        self._before = rates
        found = None
        for j, (rate, was, calm) in enumerate(
            zip(rates, before, self._calm, strict=True)
        ):
            change = rate - was
            if -calm < change < calm:  # or else no number
                self._grown[j] = 0
                self._flips[j] = 0
                continue
            grows = abs(rate) > abs(was)
            self._grown[j] = self._grown[j] + 1 if grows else 0
            slowest = min(abs(rate), abs(was))
            flips = rate * was < 0.0 and slowest > FLIP_SPEED * self.limits[j]
            self._flips[j] = self._flips[j] + 1 if flips else 0
            if found is None:
                found = self._complaint(j, abs(rate))
        return found

    def _complaint(self, j: int, speed: float) -> str | None:
        """Description of a joint ``j`` that runs away at ``speed`` [rad/s], or None."""
        limit = self.limits[j]
        name = f"joint {j + 1}"
        if not speed <= BEYOND * limit:  # or no number
            return f"{name} at {speed:.2f} rad/s, allowed {limit:g} rad/s"
        if self._flips[j] >= FLIPS:
            return f"{name} turns about at each of {FLIPS} ticks, at {speed:.2f} rad/s"
        if self._grown[j] >= GROWTH_TICKS:
            grown = GROWTH_TICKS * self._calm[j]
            return (
                f"{name} became faster by over {grown:.2f} rad/s in {GROWTH_TICKS} "
                f"ticks, to {speed:.2f} rad/s"
            )
        return None


@dataclass(slots=True)
class Stop:
    """One stop: the level of each arm, and the commands at that level."""

    arms: Sequence[ArmLimits]
    began: float  # [s]
    period: float  # [s]
    levels: list[StopLevel] = field(init=False)
    _hold_commands: list[JointCommand | None] = field(init=False)  # where an arm holds
    _overload: list[int] = field(init=False)  # ticks of too much torque, of each arm
    _resting: int = 0  # ticks that all joints have been at rest
    # [s] since when an arm no longer draws back; before that, when the stop began
    _waiting: float = field(init=False)

    def __post_init__(self) -> None:
        self.levels = [StopLevel.DRAW_BACK] * len(self.arms)
        self._hold_commands = [None] * len(self.arms)
        self._overload = [0] * len(self.arms)
        self._waiting = self.began

    @property
    def took_over(self) -> bool:
        """Whether the stop itself commands at least one arm, because that arm no longer
        draws back.
        """
        return any(self.levels)

    def hold(self) -> None:
        """Let no arm draw back any farther."""
        self.levels = [max(level, StopLevel.HOLD) for level in self.levels]

    def step(
        self,
        time: float,
        readings: Sequence[ArmReading],
        runaways: Sequence[str | None],
        commands: Commands,
    ) -> Commands:
        """Commands at ``time`` [s], one per robot: the controller's ``commands`` of
        arms that draw back, and those of the arm's level otherwise.

        ``runaways`` describe the uncommanded joint motion of each arm.
        """
        if not readings:
            return commands
        drew_back = not self.took_over
        for i, (reading, runaway) in enumerate(zip(readings, runaways, strict=True)):
            self.levels[i] = max(self.levels[i], self._level(i, time, reading, runaway))
        if StopLevel.BRAKE in self.levels:
            self.hold()
        if drew_back and self.took_over:
            self._waiting = time
        self._watch_rest(readings)
        return tuple(
            self._command(i, reading, command)
            for i, (reading, command) in enumerate(zip(readings, commands, strict=True))
        )

    def at_rest(self, time: float) -> bool:
        """Whether a stop that took over is complete at ``time`` [s].

        All joints are at rest, or the waiting time is over.
        """
        rested = self._resting * self.period >= REST_TIME
        return rested or time - self._waiting > LONGEST

    def _level(
        self, arm: int, time: float, reading: ArmReading, runaway: str | None
    ) -> StopLevel:
        """Required level of an arm at ``time`` [s]."""
        if runaway is not None:
            return StopLevel.BRAKE
        asked = reading.torque_share  # a stop itself changes torques quickly
        self._overload[arm] = self._overload[arm] + 1 if asked > 1.0 else 0
        overloaded = self._overload[arm] * self.period > TORQUE_TIME
        shares = np.abs(reading.v) / self.arms[arm].velocity
        fast = time - self.began > GRACE and float(shares.max()) > 1.0
        return StopLevel.HOLD if overloaded or fast else StopLevel.DRAW_BACK

    def _command(
        self, arm: int, reading: ArmReading, command: ArmCommand
    ) -> ArmCommand:
        level = self.levels[arm]
        if level is StopLevel.BRAKE:
            return BrakeCommand()
        if level is StopLevel.DRAW_BACK:
            return command
        held = self._hold_commands[arm]
        if held is None:
            held = JointCommand(reading.q, np.zeros_like(reading.q))
            self._hold_commands[arm] = held
        return held

    def _watch_rest(self, readings: Sequence[ArmReading]) -> None:
        fastest = max(
            float((np.abs(reading.v) / limits.velocity).max())
            for reading, limits in zip(readings, self.arms, strict=True)
        )
        at_rest = math.isfinite(fastest) and fastest < REST_SPEED
        self._resting = self._resting + 1 if at_rest else 0
