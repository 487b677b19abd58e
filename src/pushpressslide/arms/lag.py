"""A servo that follows its commands late: at its own rate, after a delay, with a lag."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from pushpressslide.core.arrays import Array


class LaggingServo:
    """First-order lag behind commands that arrive late."""

    def __init__(
        self, start: Array, rate: float, delay: float, lag: float, dt: float
    ) -> None:
        """Rest at ``start`` (n,), with ticks of ``dt`` [s]. Commands are taken at a
        ``rate`` [Hz], obeyed after a ``delay`` [s] and followed with a ``lag`` [s].
        """
        self.output = np.array(start, dtype=float)  # (n,) as reached
        self._target = self.output.copy()
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
        self._tick += 1
        self.output = self.output + self._gain * (self._target - self.output)
        return self.output
