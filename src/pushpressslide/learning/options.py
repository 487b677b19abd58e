"""Options of an environment and of its reset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from pushpressslide.core.arrays import Array
from pushpressslide.learning.push_task import PERIOD
from pushpressslide.learning.pushing import checked_poses

MODES = ("rgb_array",)
METADATA = {"render_modes": list(MODES), "render_fps": round(1.0 / PERIOD)}


def checked_mode(mode: str | None) -> str | None:
    """The render mode, if it is valid. Raises ValueError for an unknown one."""
    if mode is not None and mode not in MODES:
        allowed = ", ".join(MODES)
        raise ValueError(f"render_mode {mode!r} is not allowed; allowed: {allowed}")
    return mode


class ResetPoses(NamedTuple):
    """Starts and goals (count, 3) X_WG in a reset's options. None if not given."""

    start: Array | None
    goal: Array | None


def poses_asked(options: Mapping[str, Any] | None, count: int) -> ResetPoses:
    """Starts and goals in a reset's options.

    Raises ValueError for any other option, and for poses outside the field.
    """
    names = ResetPoses._fields
    asked = options or {}
    for name in asked:
        if name not in names:
            allowed = ", ".join(names)
            raise ValueError(f"option {name!r} is not allowed; allowed: {allowed}")
    given = {name: asked.get(name) for name in names}
    return ResetPoses(
        *(None if v is None else checked_poses(v, count, n) for n, v in given.items())
    )
