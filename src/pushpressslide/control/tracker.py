"""Where poses of the object come from, if not from the plant."""

from __future__ import annotations

from typing import Protocol

from pushpressslide.control.estimator import StampedPose


class ObjectTracker(Protocol):
    """A camera, a topic, another process: whatever sees the object.

    A run is given one by ``RunOptions.tracker``. It is read once a tick, and must not
    wait for a new pose.
    """

    def read(self) -> StampedPose | None:
        """Return the newest pose X_WG with the time [s] of the plant's clock at which it
        was seen; None where there is none since the last call.
        """
