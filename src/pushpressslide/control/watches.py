"""Watches: further conditions that end a run.

A watch sees every tick and returns an Ending, or None.
"""

from __future__ import annotations

from collections.abc import Callable

from pushpressslide.control.recording import Tick
from pushpressslide.core.record import Ending

Watch = Callable[[Tick], Ending | None]
