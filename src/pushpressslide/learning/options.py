"""What a reset is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pushpressslide.core.arrays import Array
from pushpressslide.learning.pushing import checked_starts


def start_asked(options: Mapping[str, Any] | None, count: int) -> Array | None:
    """Return the starts (count, 3) X_WG of a reset's options; None if it has none.

    Raises ValueError for another option than ``start``.
    """
    for name in options or {}:
        if name != "start":
            raise ValueError(f"option {name!r} is not allowed; allowed: start")
    start = (options or {}).get("start")
    return None if start is None else checked_starts(start, count)
