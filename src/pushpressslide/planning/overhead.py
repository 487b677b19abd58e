"""How long approach, touch and release take: estimated alike for all modes, so that
their motions are compared.
"""

from __future__ import annotations

from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.task import Motion

TOUCH_SPEED = 0.03  # [m/s] of a tip on the last centimetres
PRESSING = 0.4  # [s] until a typical press has its load
# [s] typical time from the home posture to before the touch; the planar engine begins
# there
APPROACH = 5.0
SETTLING = 1.8  # [s] of lining up, believing the touch, and drawing back


def overhead(motion: Motion, pressed: bool = False) -> float:
    """Return the typical time [s] that a run takes besides its motion."""
    return (
        APPROACH
        + motion.approach_distance / TOUCH_SPEED
        + PRESSING * pressed
        + SETTLING
    )


def path_time(motion: Motion, length: float, pressed: bool = False) -> float:
    """Return the estimated time [s] of a run along a path of ``length`` [m]."""
    profile = SpeedProfile(length, motion.speed, motion.acceleration)
    return profile.duration + overhead(motion, pressed)
