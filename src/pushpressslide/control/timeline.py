"""The first plan of a placement over time: the reference from which errors are
measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Pose2


@dataclass(frozen=True, slots=True)
class Timeline:
    """The planned segments of a placement, in sequence without a pause."""

    segments: Sequence[Segment]

    def body_pose(self, elapsed: float) -> Pose2:
        """Planned X_WB ``elapsed`` [s] after the motion began. After the end, the goal."""
        for segment in self.segments[:-1]:
            duration = segment.profile.duration
            if elapsed < duration:
                return _pose(segment, elapsed)
            elapsed -= duration
        return _pose(self.segments[-1], elapsed)


def _pose(segment: Segment, elapsed: float) -> Pose2:
    return segment.body_pose(segment.profile.state_at(elapsed)[0])
