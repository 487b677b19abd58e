"""Watches: what ends a run besides its controller.

A watch sees every tick and returns an Ending, or None to go on.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.control.recording import Tick
from pushpressslide.core.record import Ending

Watch = Callable[[Tick], Ending | None]

FORCE_OVERRUN = 1.5  # times limits.normal_force, for FORCE_TIME, ends the run
FORCE_TIME = 0.05  # [s]


class ForceWatch:
    """Ends a run whose contact force stays too large; the approach is not watched."""

    def __init__(self, limit: float, period: float) -> None:
        """Allow FORCE_OVERRUN times ``limit`` [N]; ticks are ``period`` [s] apart."""
        self._limit = limit
        self._period = period
        self._overrun = 0.0  # [s] so far

    def __call__(self, tick: Tick) -> Ending | None:
        """Return the ending "force_limit" once the overrun has lasted FORCE_TIME."""
        largest = max(math.hypot(*tip.force) for tip in tick.truth.tips)
        in_contact = tick.log.phase != "approach"
        if not in_contact or largest <= FORCE_OVERRUN * self._limit:
            self._overrun = 0.0
            return None
        self._overrun += self._period
        if self._overrun <= FORCE_TIME:
            return None
        return Ending(
            "force_limit",
            f"{largest:.1f} N measured, limits.normal_force is {self._limit:g} N",
        )
