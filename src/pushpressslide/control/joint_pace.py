"""Speed along a path that keeps every joint of an arm below its speed limit."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pushpressslide.control.limits import ArmLimits
from pushpressslide.core.plan import JointPath

SHARE = 0.85
"""Largest share of a joint's speed limit that a followed path may use.

The rest is for corrections.
"""
NEIGHBOURS = 1
"""Number of neighbouring samples, on either side, whose speed limits also apply to a
sample.
"""


@dataclass(frozen=True)
class JointPace:
    """Largest speed along the planned paths of several arms, by arc length."""

    arc_length: tuple[float, ...]  # (k,) [m]
    speed: tuple[float, ...]  # (k - 1,) [m/s] between two of them

    def speed_at(self, progress: float) -> float:
        """Largest speed [m/s] at an arc length ``progress`` [m]."""
        i = bisect_right(self.arc_length, progress) - 1
        return self.speed[min(max(i, 0), len(self.speed) - 1)]


def joint_pace(
    paths: Sequence[JointPath], limits: Sequence[ArmLimits]
) -> JointPace | None:
    """Pace of arms along their joint paths, within a share of their speed limits.

    None without arms, and for paths of a single sample.
    """
    paces = [_pace(path, arm) for path, arm in zip(paths, limits, strict=True)]
    found = [pace for pace in paces if pace is not None]
    if not found:
        return None
    if len(found) == 1:
        return found[0]
    places = sorted({s for pace in found for s in pace.arc_length})
    middles = [0.5 * (a + b) for a, b in pairwise(places)]
    speeds = tuple(min(pace.speed_at(s) for pace in found) for s in middles)
    return JointPace(tuple(places), speeds)


def _pace(path: JointPath, limits: ArmLimits) -> JointPace | None:
    steps = np.diff(path.arc_length)
    if not len(steps) or not (steps > 0.0).all():
        return None
    rates = np.abs(np.diff(path.move, axis=0)) / steps[:, None]
    with np.errstate(divide="ignore"):
        speeds = (SHARE * limits.velocity / rates).min(axis=1)
    wide = np.pad(speeds, NEIGHBOURS, constant_values=math.inf)
    windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * NEIGHBOURS + 1)
    return JointPace(
        tuple(path.arc_length.tolist()), tuple(windows.min(axis=1).tolist())
    )
