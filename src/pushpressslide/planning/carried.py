"""Motion of obstacles that the object pushes along its path."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from pushpressslide.core.footprint import gaps, overlap_area
from pushpressslide.core.pose import Pose2
from pushpressslide.core.scene import Obstacle
from pushpressslide.geometry.shapes import Shape

MET = 1e-8  # [m^2] of overlap from which an obstacle counts as met


def carried_ways(
    shape: Shape, yielding: Sequence[Obstacle], poses: Sequence[Pose2]
) -> dict[str, list[Pose2]]:
    """Poses (n each), by name, of the ``yielding`` obstacles that an object meets along
    n ``poses`` X_WG.

    Such an obstacle is assumed to stick to the object until the object moves away from
    it. In reality it may slide off earlier.
    """
    out = {}
    for obstacle in yielding:
        if gaps(shape, poses, [obstacle.footprint]).min() == 0.0:
            out[obstacle.name] = _carried(shape, obstacle, poses)
    return out


def _carried(shape: Shape, obstacle: Obstacle, poses: Sequence[Pose2]) -> list[Pose2]:
    X = obstacle.pose
    out = [X]
    for before, now in pairwise(poses):
        if overlap_area(shape, now, obstacle.shape, X) > MET:
            X = now.compose(before.inverse()).compose(X)
        out.append(X)
    return out
