"""Source of the object's measured poses."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from pushpressslide.core.pose import Pose2


class StampedPose(NamedTuple):
    """A measured pose of the object, and its time."""

    time: float  # [s]
    X_WG: Pose2
    pictures: int = 1  # of an object at rest, of which it is the middle

    @property
    def is_finite(self) -> bool:
        """Whether the pose consists of numbers."""
        return math.isfinite(self.X_WG.x + self.X_WG.y + self.X_WG.yaw)


class ObjectTracker(Protocol):
    """Any source of the object's pose: a simulator, a camera, a topic.

    It is read once a tick, and must not wait for a new pose.
    """

    def read(self) -> StampedPose | None:
        """The newest pose X_WG, with its time [s] on the cell's clock. None if there is
        no new pose since the last call.
        """
