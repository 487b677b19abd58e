"""One placement of a plan: what does not change while it is run."""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.control.correction import Replanner
from pushpressslide.control.entry import entry
from pushpressslide.control.following import Binding, bind
from pushpressslide.core.plan import Plan, Segment, lasting_arms
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.task import Task
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.online import AxleIdentifier
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Tracker
from pushpressslide.planning.workspace import poses_along


class Placement:
    """The segments of one placement, their tasks as believed, and what binds their
    laws.
    """

    def __init__(
        self, plan: Plan, number: int, tracker: Callable[[Task, Segment], Tracker]
    ) -> None:
        """Take the ``number``th placement of ``plan``; ``tracker`` makes the tracking
        law of a segment.
        """
        placements = plan.placements
        self._tracker = tracker
        self.segments = placements[number]
        self.planned_poses = [X for piece in self.segments for X in poses_along(piece)]
        told = plan.task.told
        self.parts = told.parts
        self.task = self.parts[self.segments[0].leg]
        self.last = self.parts[self.segments[-1].leg]
        self.object = self.task.object
        self.replanner = Replanner(told)
        # into an opening of the support
        self.entry = entry(self.last, self.segments[0].contacts)
        final = number == len(placements) - 1
        # to the end of the run, since nothing else carries the object at its goal
        self.scene = told.scene
        self.holds = final and not self.scene.carried(self.last.goal)
        self.waits = self.entry is not None or self.holds
        # nothing but a retry can mend a miss
        self.reaches_far = self.waits or self.task.motion.recoveries == 0
        self.lasting: frozenset[int] = frozenset()
        if not final:
            self.lasting = lasting_arms(self.segments, placements[number + 1])

    def axle_identifier(self, segment: Segment) -> AxleIdentifier | None:
        """Return what identifies the virtual axle in a segment."""
        part = self.parts[segment.leg]
        return MODES[segment.mode].identifier(part, segment)

    def center_identifier(
        self, segment: Segment, center: Point
    ) -> CenterIdentifier | None:
        """Return what identifies the CoM in a segment planned with it at ``center``."""
        part = self.parts[segment.leg]
        return MODES[segment.mode].center_identifier(part, segment, center)

    def bound(self, segment: Segment) -> Binding:
        """The laws of a segment."""
        part = self.parts[segment.leg]
        return bind(part, segment, self._tracker(part, segment))


def share_of_tolerance(task: Task, pose: Pose2) -> float:
    """Return how far an object at ``pose``, X_WG, is from its goal, over the tolerance."""
    off = math.dist(pose.position, task.goal.position) / task.tolerance.position
    turned = abs(wrap_angle(pose.yaw - task.goal.yaw)) / task.tolerance.yaw
    return max(off, turned)
