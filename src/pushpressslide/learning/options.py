"""Options of an environment and of its reset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pushpressslide.core.arrays import Array
from pushpressslide.learning.push_task import PERIOD
from pushpressslide.learning.pushing import checked_starts

MODES = ("rgb_array",)
METADATA = {"render_modes": list(MODES), "render_fps": round(1.0 / PERIOD)}


def checked_mode(mode: str | None) -> str | None:
    """A valid render mode. Raises ValueError for an unknown one."""
    if mode is not None and mode not in MODES:
        allowed = ", ".join(MODES)
        raise ValueError(f"render_mode {mode!r} is not allowed; allowed: {allowed}")
    return mode


def start_asked(options: Mapping[str, Any] | None, count: int) -> Array | None:
    """Starts (count, 3) X_WG in a reset's options. None if the options contain no
    starts.

    Raises ValueError for any option except ``start``.
    """
    for name in options or {}:
        if name != "start":
            raise ValueError(f"option {name!r} is not allowed; allowed: start")
    start = (options or {}).get("start")
    return None if start is None else checked_starts(start, count)
