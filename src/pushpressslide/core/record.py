"""What a run leaves behind: time series, and why it ended.

Names, shapes and units are listed in docs/record.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from pushpressslide.core.plan import Plan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

ReasonCode = Literal[
    "goal_reached",
    "goal_missed",
    "time_limit",
    "contact_lost",
    "force_limit",
    "torque_limit",
    "joint_limit",
    "reference_jump",
    "collision",
    "body_moved",
    "diverged",
    "interrupted",
]


@dataclass(frozen=True, slots=True)
class Ending:
    """Why a run ended: a code, and one line of text with the number that decided."""

    code: ReasonCode
    text: str = ""


@dataclass(frozen=True, slots=True)
class Record:
    """Time series of one run, and how it ended."""

    # (N, ...) for N ticks, by the names of docs/record.md
    arrays: Mapping[str, NDArray[np.float64]]
    reason: ReasonCode
    reason_text: str
    engine: str  # the plant's name
    seed: int
    wall_time: float  # [s] of the whole loop
    modes: tuple[str, ...]
    plan: Plan  # as it was run, with what was planned anew
    # versions, time step, joint margin, clearance, ...
    meta: Mapping[str, Any] = field(default_factory=dict)
