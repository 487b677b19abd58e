"""What a tracking law asks of the object at one tick."""

from __future__ import annotations

from typing import NamedTuple

from pushpressslide.core.wrench import Twist, Wrench


class Guidance(NamedTuple):
    """Wanted wrench and twist, and where on the path that is."""

    progress: float  # [m] arc length of the path's nearest point
    # in B; about the CoM for pushes, about the centre of pressure for presses
    wrench: Wrench
    twist: Twist  # of the CoM, in B
    steering: float  # [rad] force angle from the heading axis
    # along [m], left [m], heading [rad]; reference minus actual
    error: tuple[float, float, float]
    saturated: bool
