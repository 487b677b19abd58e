"""Options of a log: names, units and frames that its file does not state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

FORCE_FRAMES = ("world", "tip")
FORCE_SIDES = ("object", "tip")


@dataclass(frozen=True)
class LogOptions:
    """Names, units and frames of a log."""

    # quantity, as ``object_x``: name of its column
    columns: Mapping[str, str] = field(default_factory=dict)
    # quantity or group, as ``object`` or ``yaw``: its unit
    units: Mapping[str, str] = field(default_factory=dict)
    # ``object``, ``tip`` or ``force``: name of its topic
    topics: Mapping[str, str] = field(default_factory=dict)
    force_frame: Literal["world", "tip"] = "world"  # axes of the force
    force_on: Literal["object", "tip"] = "object"  # body that the force acts on
    tip_height: float | None = None  # [m] of the tip above the support
    tip_radius: float | None = None  # [m]; None: that of the task's first robot
    offset: float | None = None  # [s] added to pose stamps; None: estimated
