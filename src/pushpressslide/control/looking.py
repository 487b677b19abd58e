"""The pose of an object at rest, from many pictures."""

from __future__ import annotations

from collections import deque
from statistics import median

from pushpressslide.control.tracker import StampedPose
from pushpressslide.core.pose import Pose2, wrap_angle

MOST = 100
"""Number of the last pictures that are used."""


class RestingPose:
    """The middle of the last pictures, which a few wrong ones do not move."""

    def __init__(self) -> None:
        """Start without a picture."""
        self._pictures: deque[StampedPose] = deque(maxlen=MOST)

    def add(self, pose: StampedPose) -> None:
        """Take a picture, unless it repeats the last one."""
        if not self._pictures or self._pictures[-1].X_WG != pose.X_WG:
            self._pictures.append(pose)

    def middle(self, last: StampedPose) -> StampedPose:
        """Medians of x, y and yaw, with the stamp of the ``last`` picture.

        The last picture itself if there is no other.
        """
        poses = [one.X_WG for one in self._pictures]
        if not poses:
            return last
        around = poses[0].yaw
        turns = [wrap_angle(pose.yaw - around) for pose in poses]
        x = median(pose.x for pose in poses)
        y = median(pose.y for pose in poses)
        pose = Pose2(x, y, around + median(turns))
        return StampedPose(last.time, pose, len(poses))
