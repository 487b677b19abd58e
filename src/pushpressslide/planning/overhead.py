"""Estimated time of approach, touch and release.

It is the same for all modes, so that a comparison of modes depends only on their
motions.
"""

from __future__ import annotations

from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.path import SpeedProfile


def overhead(motion: Motion, pressed: bool = False) -> float:
    """Typical time [s] of a run besides its motion."""
    arm = margins.ARM
    touching = motion.approach_distance / arm.touch_speed
    return arm.approach + touching + arm.pressing * pressed + arm.settling


def path_time(motion: Motion, length: float, pressed: bool = False) -> float:
    """Estimated time [s] of a run along a path of ``length`` [m]."""
    profile = SpeedProfile(length, motion.speed, motion.acceleration)
    return profile.duration + overhead(motion, pressed)
