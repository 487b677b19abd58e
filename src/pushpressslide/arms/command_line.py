"""The way of commands to an arm, on which they may be late or get lost."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np

from pushpressslide.control.sensing import DelayLine
from pushpressslide.core.truth import Truth

T = TypeVar("T")
STREAM = 1
"""Second entry of the seeds of arms: their draws are not those of the sensors."""


def random_streams(seed: int, arm: int) -> list[np.random.Generator]:
    """Separate random streams of the encoders, motors and commands of one arm."""
    return np.random.default_rng((seed, STREAM, arm)).spawn(3)


class CommandLine(Generic[T]):
    """Commands that arrive late. In place of a lost one the last one is repeated."""

    def __init__(
        self,
        truth: Truth,
        random: np.random.Generator,
        dt: float,
        known_delay: float = 0.0,
    ) -> None:
        """Delay by the ``command_delay`` of ``truth``, in ticks of ``dt`` [s], after the
        ``known_delay`` [s].
        """
        self._line: DelayLine[T] = DelayLine(known_delay + truth.command_delay, dt)
        self._missed = truth.missed_ticks
        self._random = random
        self._last: T | None = None

    def through(self, command: T) -> T:
        """Command that the arm executes in a tick in which ``command`` is sent."""
        arriving = self._line.through(command)
        if self._missed == 0.0:
            return arriving
        lost = float(self._random.random()) < self._missed
        if self._last is None or not lost:
            self._last = arriving
        return self._last
