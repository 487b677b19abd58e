"""The paper's own methods of executing a plan."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pushpressslide.control.execution import Execution
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Segment
from pushpressslide.core.query import MotionQuery
from pushpressslide.modes.base import Tracker
from pushpressslide.rom.drives import TurnDrive, UnicycleDrive
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import UnicycleTracker


@dataclass(frozen=True, slots=True)
class FixedTarget(Execution):
    """Alignment of pressed objects with a target that is fixed beyond the goal instead
    of moving along the path.

    This is the literal reading of the paper.
    """

    def tracker(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Tracking law of a segment of ``query``, with the fixed target."""
        drive = segment.drive
        path = segment.path
        if isinstance(drive, UnicycleDrive | TurnDrive) and isinstance(path, ArcPath):
            law = LookAheadAlignment(drive.look_ahead, math.inf, path.end)
            return UnicycleTracker(law, drive)
        return Execution.tracker(self, query, segment)
