"""A disturbance: another body pushes the object aside while the arms move it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Knock:
    """Time, place and distance of a push by another body."""

    share: float  # of the direct way, turns included, that the object has come by then
    side: int  # 1: beside the centre of mass so that it turns to the left; -1: right
    moved: float = 0.03  # [m] that the object is pushed
    turned: float = math.radians(15.0)  # [rad] that it is about to be turned
