"""One placement of a plan, with everything that stays constant while it is executed."""

from __future__ import annotations

import math
from collections.abc import Callable

from pushpressslide.control.correction import Replanner
from pushpressslide.control.following import BoundLaws, bind_laws
from pushpressslide.control.insertion import insertion_of
from pushpressslide.core import margins
from pushpressslide.core.motion import Tolerance
from pushpressslide.core.plan import Plan, Segment, arms_kept
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.query import MotionQuery
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.drag import DragIdentifier
from pushpressslide.identification.online import AxleIdentifier
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured, Tracker
from pushpressslide.planning.workspace import poses_along


class Placement:
    """The segments of one placement, with their queries and bound laws."""

    def __init__(
        self,
        plan: Plan,
        number: int,
        tracker: Callable[[MotionQuery, Segment], Tracker],
    ) -> None:
        """Take the ``number``th placement of ``plan``. ``tracker`` makes the tracking
        law of a segment.
        """
        placements = plan.placements
        self._tracker = tracker
        self.segments = placements[number]
        self.planned_poses = [
            X for segment in self.segments for X in poses_along(segment)
        ]
        self.queries = plan.queries
        self.query = self.queries[self.segments[0].leg]
        self.last = self.queries[self.segments[-1].leg]
        self.scene = plan.task.scene
        self.object = self.scene.body
        self.replanner = Replanner(self.queries)
        # into an opening of the support
        self.entry = insertion_of(self.scene, self.last.goal, self.segments[0].contacts)
        final = number == len(placements) - 1
        # to the end of the run, since nothing else carries the object at its goal
        self.holds = final and not self.scene.carried(self.last.goal)
        self.waits = self.entry is not None or self.holds
        self.looks = not self.query.sensing.every_pose
        # nothing but a retry can mend a miss
        self.reaches_far = self.waits or self.query.motion.recoveries == 0
        self.kept_arms: frozenset[int] = frozenset()
        if not final:
            self.kept_arms = arms_kept(self.segments, placements[number + 1])

    def axle_identifier(self, segment: Segment) -> AxleIdentifier | None:
        """Identifier of the virtual axle in a segment."""
        query = self.queries[segment.leg]
        return MODES[segment.mode].identifier(query, segment)

    def center_identifier(
        self, segment: Segment, center: Point
    ) -> CenterIdentifier | None:
        """Identifier of the CoM in a segment that was planned with the CoM at
        ``center``.
        """
        query = self.queries[segment.leg]
        return MODES[segment.mode].center_identifier(query, segment, center)

    def drag_identifier(self, segment: Segment) -> DragIdentifier | None:
        """Identifier of the drag in a segment."""
        query = self.queries[segment.leg]
        return MODES[segment.mode].drag_identifier(query, segment)

    def bound_laws(self, segment: Segment) -> BoundLaws:
        """Control laws bound to a segment."""
        query = self.queries[segment.leg]
        return bind_laws(self.scene, segment, self._tracker(query, segment))

    def pace(self, spread: tuple[float, float], left: float) -> float:
        """Share of the planned speed at which an object may be led, with ``left`` [m] of
        its way to go, whose pose is known with the standard deviations ``spread`` [m],
        [rad]: a slower one shows itself in more pictures. An uncertain centre is best
        learnt on a long way, and lets an object be slow only at its end.
        """
        unsure = self.unsure(spread)
        near = left < margins.ARM.slow_way or self.scene.center_error == 0.0
        allowed = margins.PACED if near else margins.PACED_AHEAD
        return 1.0 if unsure <= allowed else max(allowed / unsure, margins.SLOWEST)

    def unsure(self, spread: tuple[float, float]) -> float:
        """Standard deviations ``spread`` [m], [rad] of a pose, as a share of the last
        goal's tolerances.
        """
        tolerance = self.last.tolerance
        place, yaw = spread
        return max(place / tolerance.position, yaw / tolerance.yaw)

    def at_goal(self, X_WG: Pose2, spread: tuple[float, float]) -> bool:
        """Whether an object seen at ``X_WG``, with standard deviations ``spread`` [m],
        [rad], counts as being at the last goal.
        """
        off = share_of_tolerance(X_WG, self.last.goal, self.last.tolerance)
        return off < margins.retry_above(margins.RETRY_ABOVE, self.unsure(spread))


def share_of_tolerance(pose: Pose2, goal: Pose2, tolerance: Tolerance) -> float:
    """Error of an object at ``pose``, X_WG, from its goal, as a fraction of the
    tolerance.
    """
    off = math.dist(pose.position, goal.position) / tolerance.position
    turned = abs(wrap_angle(pose.yaw - goal.yaw)) / tolerance.yaw
    return max(off, turned)


def leads_on(placement: Plan, X_WG: Pose2) -> bool:
    """Whether a path like the planned one leads a ``placement`` to its goal from an
    object at ``X_WG``, which is elsewhere than planned.
    """
    query = placement.query
    first = placement.segments[0]
    planned = placement.object_pose(first, 0.0)
    if share_of_tolerance(X_WG, planned, query.tolerance) <= 1.0:
        return True
    radius = query.scene.body.radius
    longest = margins.longest(margins.TOUCH_DETOUR, first.path.length, radius)
    replanner = Replanner(placement.queries)

    def path_from(pose: Pose2) -> bool:
        X_WB = pose.compose(query.X_GB)
        measured = Measured(X_WB, first.contacts, longest)
        return bool(replanner.replan(placement.segments, measured))

    # a mode that never continues from another pose tells nothing
    return path_from(X_WG) or not path_from(planned)
