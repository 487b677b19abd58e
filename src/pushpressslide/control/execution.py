"""Options of a run beyond its task: the usual control laws, or the laws of an
experiment.
"""

from __future__ import annotations

from dataclasses import dataclass

from pushpressslide.core.plan import Segment
from pushpressslide.core.query import MotionQuery
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Tracker

FORCE_ALONE = 1.05  # factor on the friction for a push driven by its force alone


@dataclass(frozen=True, slots=True)
class Execution:
    """The laws that an experiment may change. By default they are the laws of an
    ordinary run.
    """

    servo: bool = True  # whether a velocity servo is added to the feed-forward force
    # factor on that force; with a factor, only the servo is added to it
    force_gain: float | None = None
    # [N m/rad] of a joint impedance about the planned joint path, felt at the tip
    # (paper, sec. IV-A); 0: none
    joint_stiffness: float = 0.0

    def tracker(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Tracking law of a segment of ``query``, as defined by the segment's mode."""
        return MODES[segment.mode].tracker(query, segment)

    @property
    def gain(self) -> float:
        """Factor on the feed-forward force."""
        if self.force_gain is not None:
            return self.force_gain
        return 1.0 if self.servo else FORCE_ALONE

    @property
    def changed(self) -> str | None:
        """Description of the changed laws for the record, or None if none is changed."""
        return None if self == USUAL else repr(self)


USUAL = Execution()
