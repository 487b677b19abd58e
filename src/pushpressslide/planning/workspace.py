"""Check that the object's frame stays in the workspace along segments."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pushpressslide.core.motion import Limits
from pushpressslide.core.plan import MotionPath, Segment
from pushpressslide.core.pose import Pose2
from pushpressslide.core.refusal import Refusal
from pushpressslide.core.scene import ObjectModel

STEP = 0.03  # [m] of path between the checked poses


def poses_along(segment: Segment) -> list[Pose2]:
    """Poses X_WB along a segment, at most ``STEP`` apart."""
    return poses_of(segment.path, segment.X_BV)


def poses_of(path: MotionPath, X_BV: Pose2) -> list[Pose2]:
    """Poses X_WB along a path of V, at most ``STEP`` apart."""
    X_VB = X_BV.inverse()
    steps = max(3, math.ceil(path.length / STEP))
    return [path.pose(path.length * i / steps).compose(X_VB) for i in range(steps + 1)]


def workspace_refusal(
    body: ObjectModel, limits: Limits, poses: Sequence[Pose2]
) -> Refusal | None:
    """Refusal of ``poses`` X_WB along which the object's frame G leaves the workspace,
    or None.
    """
    bounds = limits.workspace
    if bounds is None:
        return None
    x_min, x_max, y_min, y_max = bounds
    X_BG = body.X_GB.inverse()
    for X_WB in poses:
        X = X_WB.compose(X_BG)
        if not (x_min <= X.x <= x_max and y_min <= X.y <= y_max):
            place = f"({X.x:.3f}, {X.y:.3f})"
            return Refusal("workspace", f"the path leaves limits.workspace at {place}")
    return None
