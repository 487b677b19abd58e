"""What was identified on the way, for the plans made there."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.pose import Point
from pushpressslide.identification.online import Identified


class Findings(NamedTuple):
    """What measurements say instead of what was believed."""

    axle: Identified | None = None  # None while the plan is not contradicted
    rho: float | None = None  # [m]; None: as believed
    center: Point = (0.0, 0.0)  # p_BCom [m]; B is at the believed centre
    # how far the centre is from where the plan that is followed has it, over its
    # distance from the only contact
    aside: float = 0.0


NOTHING = Findings()
"""Nothing contradicts what was believed."""
