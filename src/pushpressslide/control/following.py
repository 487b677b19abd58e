"""The followed segment with its closed-form laws, the progress along it, and the
segments ahead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pushpressslide.control.correction import (
    sides_of,
    surely_touched,
    touched_points,
)
from pushpressslide.control.pressed_body import PressedBody
from pushpressslide.core.control import TipState
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.geometry.sides import Side
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.drag import DragIdentifier
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
    sides: tuple[Side | None, ...]  # sides of the object with the contacts

    def contact_points(
        self, X_WB: Pose2, tips: Sequence[TipState]
    ) -> tuple[Point, ...]:
        """Points [m] in B at which the tips touch the object."""
        return touched_points(self.segment.contacts, self.sides, X_WB, tips)

    def sure_contact_points(
        self, X_WB: Pose2, tips: Sequence[TipState], place: float
    ) -> tuple[Point, ...]:
        """``contact_points`` [m] where they are surely elsewhere than planned, of an
        object whose place has the standard deviation ``place`` [m].
        """
        points = self.contact_points(X_WB, tips)
        return surely_touched(self.segment.contacts, points, place)


def bind_laws(scene: Scene, segment: Segment, tracker: Tracker) -> BoundLaws:
    """Laws of a segment's mode for its contacts, led by ``tracker``."""
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
    """Predictions of a plan that measurements may contradict."""

    axle: AxleIdentifier | None = None  # compares with its virtual axle
    center: CenterIdentifier | None = None  # compares with its CoM
    followed_center: Point = (0.0, 0.0)  # p_BCom [m] of the plan that is followed
    drag: DragIdentifier | None = None  # for the result alone


class Following(NamedTuple):
    """The followed segment and the progress along it. Every segment has its own
    instance.
    """

    binding: BoundLaws  # now
    segment: Segment  # as planned, before any replanning
    ahead: tuple[Segment, ...]  # the segments that come after it
    prediction: Prediction = Prediction()
    progress: float = 0.0  # [m] on the binding's path
    clock_start: float = 0.0  # [s] time zero of the binding's profile
    # [s] start of the placement's motion, after its first touch
    began: float | None = None
    # followed segment as first planned
    reference: Segment | None = None
    reference_start: float = 0.0  # [s] its time zero
    joint_start: float = 0.0  # [m] of joint path before this segment
    # where the binding's path was begun: [m] of the joint path beyond ``joint_start``,
    # and of the binding's path
    joint_offset: float = 0.0
    path_offset: float = 0.0
    rho: float | None = None  # [m] used in replans; None: that of the task
    body: PressedBody | None = None  # the same; None: as believed

    @property
    def left(self) -> float:
        """Remaining length [m] of the path."""
        return self.binding.segment.path.length - self.progress

    def begun(self, time: float) -> Following:
        """Copy whose motion starts at ``time`` [s], unless it has already started."""
        following = self
        if self.reference is None:
            reference = self.binding.segment
            following = self._replace(reference=reference, reference_start=time)
        return following if self.began is not None else following._replace(began=time)

    def replanned(
        self,
        binding: BoundLaws,
        ahead: tuple[Segment, ...],
        progress: float,
        X_WB: Pose2,
    ) -> Following:
        """Copy on another path of the same segment, with its ``progress`` [m], that is
        begun at ``X_WB``.
        """
        joints = self.joint_progress(X_WB) - self.joint_start
        return self._replace(
            binding=binding,
            ahead=ahead,
            progress=progress,
            joint_offset=joints,
            path_offset=progress,
        )

    def delayed(self, passed: float) -> Following:
        """Copy with its clock and reference delayed by ``passed`` [s]."""
        return self._replace(
            clock_start=self.clock_start + passed,
            reference_start=self.reference_start + passed,
        )

    def joint_progress(self, X_WB: Pose2) -> float:
        """Arc length [m] on the planned path at which to read the joint reference.

        What is left of it shrinks with what is left of the current path. If a spin was
        replanned as arcs, the lengths of the two paths refer to different points; the
        planned pose nearest to the object at ``X_WB`` is then used.
        """
        planned = self.segment
        path = planned.path
        if self.replanned_as_arcs(self.binding.segment):
            assert isinstance(path, TwistPath)
            here = path.nearest(X_WB.compose(planned.X_BV), 0.0)
            return self.joint_start + min(here, path.length)
        most = path.length - self.joint_offset
        left = min(max(0.0, self.joint_rate * self.left), most)
        return self.joint_start + max(0.0, path.length - left)

    @property
    def joint_rate(self) -> float:
        """Length of joint path for each length of the followed path."""
        way = self.binding.segment.path.length - self.path_offset
        if way <= 0.0:
            return 0.0
        return (self.segment.path.length - self.joint_offset) / way

    def replanned_as_arcs(self, segment: Segment) -> bool:
        """Whether ``segment`` follows arcs although its leg was planned along twists."""
        planned = self.segment
        twists = isinstance(planned.path, TwistPath)
        same_leg = segment.leg == planned.leg
        return twists and isinstance(segment.path, ArcPath) and same_leg

    def joint_reference(self, here: float, time: float, timed: bool) -> float:
        """Arc length [m] on the planned path at which to read the joint reference
        during the move.

        A ``timed`` reference is the planned one at ``time`` [s], the paper's q(t). It
        is at most JOINT_LEAD from the object, whose ``joint_progress`` [m] is ``here``.
        """
        reference = self.reference
        if not timed or reference is None:
            return here
        elapsed = time - self.reference_start
        planned = reference.profile.state_at(elapsed)[0] - reference.path.length
        planned += self.joint_start + self.segment.path.length
        return max(0.0, min(max(planned, here - JOINT_LEAD), here + JOINT_LEAD))
