"""A disturbance: another body pushes the object aside while the arms move it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Knock:
    """Time, place and distance of a push by another body."""

    share: float  # share of the direct path, turns included, covered before the knock
    side: int  # 1: beside the centre of mass so that it turns to the left; -1: right
    moved: float = 0.03  # [m] displacement of the object
    turned: float = math.radians(15.0)  # [rad] approximate turn of the object
