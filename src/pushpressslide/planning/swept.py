"""Poses of the object along planned segments."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import ObjectModel

SWEEP_STEP = 0.5
"""Length of path between two checks of the gap, as a share of the clearance."""


def swept(
    body: ObjectModel, segments: Sequence[Segment], clearance: float
) -> list[Pose2]:
    """Poses X_WG along planned segments, closer together than the ``clearance`` [m]."""
    step = SWEEP_STEP * clearance
    poses = []
    X_BG = body.X_GB.inverse()
    for segment in segments:
        path = segment.path
        X_VG = segment.X_BV.inverse().compose(X_BG)
        steps = max(1, math.ceil(path.length / step))
        poses += [
            path.pose(path.length * i / steps).compose(X_VG) for i in range(steps + 1)
        ]
    return poses
