"""What is followed: a segment with its closed-form laws, how far it has come, and what
comes after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.control.correction import sides_of, touched_points
from pushpressslide.core.control import TipState
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.geometry.sides import Side
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.online import AxleIdentifier
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Allocator, Tracker

# [m] that the joint reference may be ahead of the object or behind it: a spring
# stretched round a bend would pull the tip sideways off its face
JOINT_LEAD = 0.03


@dataclass(frozen=True, slots=True)
class BoundLaws:
    """A segment with its closed-form laws.

    Every replan makes a new one.
    """

    segment: Segment
    tracker: Tracker
    allocate: Allocator
    tip_points: tuple[Point, ...]  # [m] in B, of the tips' centres, one per contact
    sides: tuple[Side | None, ...]  # of the object, that the contacts are on

    def contact_points(
        self, X_WB: Pose2, tips: Sequence[TipState]
    ) -> tuple[Point, ...]:
        """Return where the tips touch the object [m], in B."""
        return touched_points(self.segment.contacts, self.sides, X_WB, tips)


def bind_laws(scene: Scene, segment: Segment, tracker: Tracker) -> BoundLaws:
    """Return the laws of a segment's mode for its contacts, led by ``tracker``."""
    mode = MODES[segment.mode]
    contacts = segment.contacts
    tip_points = tuple(
        contact.tip_place(scene.robots[contact.arm].tip_radius)[0]
        for contact in contacts
    )
    allocate = mode.allocator_of(segment, scene.contact_friction)
    return BoundLaws(
        segment, tracker, allocate, tip_points, sides_of(scene.body, contacts)
    )


class Prediction(NamedTuple):
    """What a plan says of the object that measurements may contradict."""

    axle: AxleIdentifier | None = None  # compares with its virtual axle
    center: CenterIdentifier | None = None  # compares with its CoM
    followed_center: Point = (0.0, 0.0)  # p_BCom [m] of the plan that is followed


class Following(NamedTuple):
    """What is followed; another segment is another one of these."""

    binding: BoundLaws  # now
    segment: Segment  # as planned, before any replanning
    ahead: tuple[Segment, ...]  # the segments that come after it
    prediction: Prediction = Prediction()
    progress: float = 0.0  # [m] on the binding's path
    clock_start: float = 0.0  # [s] time zero of the binding's profile
    began: float | None = None  # [s] of the placement's motion, after its first touch
    # what is being followed, as planned when it began
    reference: Segment | None = None
    reference_start: float = 0.0  # [s] its time zero
    joint_start: float = 0.0  # [m] of joint path before this segment
    rho: float | None = None  # [m] that replanning believes; None: as it was told

    @property
    def left(self) -> float:
        """Rest of the binding's path [m]."""
        return self.binding.segment.path.length - self.progress

    def begun(self, time: float) -> Following:
        """The same, whose motion begins at a ``time`` [s] if it has not begun."""
        following = self
        if self.reference is None:
            reference = self.binding.segment
            following = self._replace(reference=reference, reference_start=time)
        return following if self.began is not None else following._replace(began=time)

    def delayed(self, passed: float) -> Following:
        """The same that goes on ``passed`` [s] later."""
        return self._replace(
            clock_start=self.clock_start + passed,
            reference_start=self.reference_start + passed,
        )

    def joint_progress(self, X_WB: Pose2) -> float:
        """Place on the PLANNED path [m] at which the joint reference is taken: as far
        from the end as the object is on its own path.

        Where a turn on the spot goes on as arcs, whose lengths are another point's, it
        is the nearest place to the object at ``X_WB``.
        """
        planned = self.segment
        path = planned.path
        if self.replanned_as_arcs(self.binding.segment):
            assert isinstance(path, TwistPath)
            here = path.nearest(X_WB.compose(planned.X_BV), 0.0)
            return self.joint_start + min(here, path.length)
        return self.joint_start + max(0.0, path.length - self.left)

    def replanned_as_arcs(self, segment: Segment) -> bool:
        """Whether ``segment`` drives along arcs where its leg was planned along
        twists.
        """
        planned = self.segment
        twists = isinstance(planned.path, TwistPath)
        same_leg = segment.leg == planned.leg
        return twists and isinstance(segment.path, ArcPath) and same_leg

    def joint_reference(self, X_WB: Pose2, time: float, timed: bool) -> float:
        """Place on the planned path [m] at which the joint reference is taken in the
        move; a ``timed`` one is where it is planned at this ``time`` [s], the paper's
        q(t), at most JOINT_LEAD from the object at ``X_WB``.
        """
        here = self.joint_progress(X_WB)
        reference = self.reference
        if not timed or reference is None:
            return here
        elapsed = time - self.reference_start
        planned = reference.profile.state_at(elapsed)[0] - reference.path.length
        planned += self.joint_start + self.segment.path.length
        return max(0.0, min(max(planned, here - JOINT_LEAD), here + JOINT_LEAD))
