"""A servo that follows its commands late: at its own rate, after a delay, with a lag."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from pushpressslide.arms.command_line import CommandLine
from pushpressslide.core.arrays import Array
from pushpressslide.core.scene import Robot


class LaggingServo:
    """First-order lag behind commands that arrive late."""

    def __init__(
        self,
        start: Array,
        rate: float,
        delay: float,
        lag: float,
        dt: float,
        *,
        interpolates: bool = False,
    ) -> None:
        """Rest at ``start`` (n,), with ticks of ``dt`` [s]. Commands are taken at a
        ``rate`` [Hz], obeyed after a ``delay`` [s] and followed with a ``lag`` [s].

        With ``interpolates`` the servo goes from one command to the next in a straight
        line over the time between them, as makers do with positions.
        """
        self.output = np.array(start, dtype=float)  # (n,) as reached
        self._target = self.output.copy()
        self._aim = self.output.copy()  # (n,) on its way to the target
        self._interpolates = interpolates
        self._left = 0  # ticks to the target
        self._gain = 1.0 if lag <= 0.0 else -math.expm1(-dt / lag)
        self._delay = max(0, round(delay / dt))  # ticks
        self._every = max(1, round(1.0 / (rate * dt)))  # ticks
        self._tick = 0
        self._waiting: deque[tuple[int, Array]] = deque()

    def step(self, command: Array) -> Array:
        """Value (n,) that is reached at the end of a tick with ``command`` (n,)."""
        if self._tick % self._every == 0:
            self._waiting.append((self._tick + self._delay, np.array(command)))
        while self._waiting and self._waiting[0][0] <= self._tick:
            _, self._target = self._waiting.popleft()
            self._left = self._every if self._interpolates else 1
        self._tick += 1
        if self._left > 0:
            self._aim = self._aim + (self._target - self._aim) / self._left
            self._left -= 1
        self.output = self.output + self._gain * (self._aim - self.output)
        return self.output


class RobotServo:
    """Positions that a robot's servo reaches by commands of the robot's interface."""

    def __init__(
        self,
        robot: Robot,
        start: Array,
        dt: float,
        line: CommandLine[tuple[Array, Array]] | None = None,
    ) -> None:
        """Rest at ``start`` (n,), with ticks of ``dt`` [s]. Commands come through
        ``line``, if there is one.
        """
        self._line = line
        self.reached = np.array(start, dtype=float)  # (n,)
        self._takes_positions = robot.interface == "position"
        self._dt = dt
        first = start if self._takes_positions else np.zeros_like(start)
        self._servo = robot_servo(robot, first, dt)

    def step(self, position: Array, velocity: Array) -> Array:
        """Mean velocity (n,) of the servo in a tick, under a commanded ``position`` (n,)
        or, by the interface, ``velocity`` (n,).
        """
        if self._line is not None:
            position, velocity = self._line.through((position, velocity))
        before = self.reached
        if self._takes_positions:
            self.reached = self._servo.step(position)
        else:
            self.reached = before + self._dt * self._servo.step(velocity)
        out: Array = (self.reached - before) / self._dt
        return out


def robot_servo(robot: Robot, start: Array, dt: float) -> LaggingServo:
    """Servo of a robot with ticks of ``dt`` [s]. ``start`` (n,) is the first position,
    or the first velocity if the robot takes velocities.
    """
    takes_positions = robot.interface == "position"
    return LaggingServo(
        start, robot.rate, robot.delay, robot.lag, dt, interpolates=takes_positions
    )
