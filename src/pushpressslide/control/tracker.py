"""Where poses of the object come from."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from pushpressslide.core.pose import Pose2


class StampedPose(NamedTuple):
    """A measured pose of the object, and when it was measured."""

    time: float  # [s]
    X_WG: Pose2


class ObjectTracker(Protocol):
    """A simulator, a camera, a topic: whatever sees the object.

    It is read once a tick, and must not wait for a new pose.
    """

    def read(self) -> StampedPose | None:
        """The newest pose X_WG with the time [s] of the cell's clock at which it was
        seen; None where there is none since the last call.
        """
