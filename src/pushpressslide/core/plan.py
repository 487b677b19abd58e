"""Results of selection and planning: contacts, segments, a choice, a plan."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from pushpressslide.core.control import Vector3
from pushpressslide.core.drive import Drive
from pushpressslide.core.notebook import html_of
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import SKIPPED, Refusal
from pushpressslide.core.task import Restart, Task
from pushpressslide.core.twist_path import TwistPath

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MotionPath = ArcPath | TwistPath

ENOUGH = 8
"""Number of feasible choices of one mode after which no other choice of the mode is
evaluated.
"""


@dataclass(frozen=True, slots=True)
class Contact:
    """Contact of one arm with the object."""

    arm: int  # index into the task's robots
    kind: Literal["side", "top"]
    point: Point  # [m] in B
    # unit, in B: inward face normal of a side contact; (0, 0) for a top contact
    normal: Point
    height: float  # [m] of the contact above the support
    load: float = 0.0  # [N] planned normal force of a top contact

    def same_place(self, other: Contact) -> bool:
        """Whether the same arm touches the same place, with any load."""
        return replace(self, load=0.0) == replace(other, load=0.0)

    def shifted(self, offset: Point) -> Contact:
        """The contact with its point displaced by ``offset`` [m]."""
        x, y = self.point
        return replace(self, point=(x + offset[0], y + offset[1]))

    def direction(self, X_WB: Pose2) -> Vector3:
        """Unit vector from the tip into the object, in the support's frame."""
        if self.kind == "top":
            return (0.0, 0.0, -1.0)
        x, y = X_WB.rotate(self.normal)
        return (x, y, 0.0)

    def tip_place(self, radius: float, gap: float = 0.0) -> tuple[Point, float]:
        """Position [m] in B, and height [m] above the support, of the centre of a tip
        of ``radius`` [m] that is ``gap`` [m] before the contact.
        """
        out = radius + gap
        if self.kind == "top":
            return self.point, self.height + out
        nx, ny = self.normal
        return (self.point[0] - out * nx, self.point[1] - out * ny), self.height


def same_places(first: Sequence[Contact], second: Sequence[Contact]) -> bool:
    """Whether two sets of contacts agree, apart from their loads."""
    if len(first) != len(second):
        return False
    return all(a.same_place(b) for a, b in zip(first, second, strict=True))


@dataclass(frozen=True)
class Segment:
    """One motion: one mode, its contacts, one reduced model, one timed path."""

    mode: str
    contacts: tuple[Contact, ...]
    drive: Drive
    path: MotionPath  # of the vehicle frame V in the world
    profile: SpeedProfile
    goal: Pose2  # X_WG at its end
    # [rad] smallest distance of the forces from a cone's edge
    cone_margin: float | None = None
    leg: int = 0  # index of its leg in the task

    @cached_property
    def X_BV(self) -> Pose2:
        """Pose of the vehicle frame in the body frame."""
        return self.drive.X_BV

    @cached_property
    def X_VB(self) -> Pose2:
        """Pose of the body frame in the vehicle frame."""
        return self.X_BV.inverse()

    @property
    def arcs(self) -> ArcPath:
        """Path of a segment along arcs.

        Raises TypeError for another kind of path.
        """
        if not isinstance(self.path, ArcPath):
            raise TypeError(f"a segment of {self.mode} is not along arcs")
        return self.path

    def same_placement(self, other: Segment) -> bool:
        """Whether two segments have the same mode and the same contacts."""
        return self.mode == other.mode and same_places(self.contacts, other.contacts)

    def body_pose(self, s: float) -> Pose2:
        """Planned X_WB at arc length ``s`` [m]."""
        return self.path.pose(s).compose(self.X_VB)

    def follows(self, path: MotionPath) -> Segment:
        """The segment along another path, at the same speed."""
        profile = replace(self.profile, length=path.length)
        return replace(self, path=path, profile=profile)


@dataclass(frozen=True, slots=True)
class Choice:
    """One mode at one placement of its contacts, evaluated for a task."""

    mode: str
    label: str = ""  # description of the placement; no code reads it
    contacts: tuple[Contact, ...] = ()
    segments: tuple[Segment, ...] = ()  # empty: no path was found or looked for
    time: float | None = None  # [s] estimated
    summary: str = ""  # notes for the user; no code reads them
    refusal: Refusal | None = None  # None: it can do the task
    leg: int = 0  # first leg of the task

    @property
    def feasible(self) -> bool:
        """Whether the choice can do the task."""
        return self.refusal is None

    @property
    def evaluated(self) -> bool:
        """Whether the choice was evaluated. False if it was skipped."""
        return self.refusal is None or self.refusal.code != SKIPPED

    @property
    def verdict(self) -> str:
        """Decision in one or two words."""
        if self.feasible:
            return "possible"
        return "refused" if self.evaluated else "skipped"

    @property
    def reason(self) -> str:
        """Label of the choice, with its summary or its refusal, in one line."""
        text = self.summary if self.refusal is None else str(self.refusal)
        return f"{self.label}: {text}" if self.label and text else self.label or text

    @property
    def path_length(self) -> float | None:
        """Distance [m] that the tracking point covers."""
        if not self.segments:
            return None
        return sum(segment.path.distance for segment in self.segments)

    @property
    def friction_margin(self) -> float | None:
        """Smallest angle [rad] of the planned forces from a cone's edge."""
        return self.segments[0].cone_margin if self.segments else None

    def __repr__(self) -> str:
        """Mode, verdict, time and reason, in one line."""
        time = "" if self.time is None else f", {self.time:.1f} s"
        return f"Choice({self.mode}: {self.verdict}{time}; {self.reason})"

    def refused(self, refusal: Refusal | None) -> Choice:
        """The choice with another refusal, or with none."""
        return replace(self, refusal=refusal)


@dataclass(frozen=True, slots=True)
class Plan:
    """A task and its segments, in order. The plan of a run also contains its replans."""

    task: Task
    # empty: nothing is planned, or nothing has to move
    segments: tuple[Segment, ...] = ()
    # state from which the task continues; None: its start
    restart: Restart | None = None
    from_search: bool = False  # whether the legs come from a search, not from the task
    may_push: bool = False  # whether the object pushes movable obstacles on its way
    # plans that replaced the rest after recoveries, in order
    later: tuple[Plan, ...] = ()

    @property
    def queries(self) -> tuple[MotionQuery, ...]:
        """One motion query for each leg."""
        return self.task.queries(from_search=self.from_search, may_push=self.may_push)

    @property
    def query(self) -> MotionQuery:
        """Motion query of the first leg."""
        return self.queries[self.segments[0].leg if self.segments else 0]

    @property
    def at_goal(self) -> bool:
        """Whether nothing has to move because the object is at its goal already."""
        task = self.task
        free = not (self.segments or task.legs or task.goals or self.restart)
        return free and task.query.at_goal

    @property
    def first(self) -> int:
        """Index of the first leg that remains after the restart."""
        return 0 if self.restart is None else self.restart.leg

    def of_choices(self, chosen: Sequence[Choice]) -> Plan:
        """Plan made of the segments of one choice per placement, in order."""
        segments = tuple(segment for choice in chosen for segment in choice.segments)
        return replace(self, segments=segments)

    @property
    def placements(self) -> tuple[tuple[Segment, ...], ...]:
        """Groups of segments during which the arms do not let go."""
        groups: list[list[Segment]] = []
        for segment in self.segments:
            if groups and groups[-1][-1].same_placement(segment):
                groups[-1].append(segment)
            else:
                groups.append([segment])
        return tuple(tuple(group) for group in groups)

    @property
    def by_placement(self) -> tuple[Plan, ...]:
        """One plan for each placement, including its replanned segments."""
        own = tuple(
            replace(self, segments=group, restart=None, later=())
            for group in self.placements
        )
        return sum((plan.by_placement for plan in self.later), own)

    def begun(self, count: int, rest: Plan) -> Plan:
        """Plan of the first ``count`` placements, continued with ``rest``."""
        groups = self.placements[:count]
        segments = tuple(segment for group in groups for segment in group)
        return replace(self, segments=segments).followed(rest)

    def followed(self, rest: Plan) -> Plan:
        """The plan continued with ``rest``."""
        return replace(self, later=(*self.later, replace(rest, later=()), *rest.later))

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of the first segment."""
        return self.segments[0].contacts if self.segments else ()

    @property
    def goal(self) -> Pose2:
        """X_WG at the end."""
        return self.segments[-1].goal if self.segments else self.task.goal

    @property
    def true_start(self) -> Pose2:
        """True X_WG of the object at the start."""
        later = bool(self.segments) and self.segments[0].leg > 0
        return self.query.start if later else self.task.true_start

    def object_pose(self, segment: Segment, s: float) -> Pose2:
        """Planned X_WG at arc length ``s`` [m] of a segment."""
        return segment.body_pose(s).compose(self.task.X_GB.inverse())

    def chosen(self, choices: Sequence[Choice]) -> list[Choice]:
        """The choices among ``choices`` that the plan consists of."""
        return [choice for choice in choices if self._holds(choice.segments)]

    def _holds(self, segments: Sequence[Segment]) -> bool:
        """Whether ``segments`` occur consecutively in the plan."""
        count = len(segments)
        starts = range(len(self.segments) - count + 1)
        runs = (self.segments[i : i + count] for i in starts)
        return count > 0 and tuple(segments) in runs

    @property
    def duration(self) -> float:
        """Time [s] of all segments, without approach and release."""
        return sum(segment.profile.duration for segment in self.segments)

    def __repr__(self) -> str:
        """Summary in one line."""
        modes = ", ".join(segment.mode for segment in self.segments) or "at its goal"
        return f"Plan({self.task.name!r}: {modes}; {self.duration:.1f} s)"

    def _repr_html_(self) -> str:
        """Picture of the plan for a notebook."""
        return html_of(self, "plan_html")


def arms_kept(before: Sequence[Segment], after: Sequence[Segment]) -> frozenset[int]:
    """Arms that keep their contacts from one placement to the next."""
    return frozenset(
        contact.arm
        for contact in before[0].contacts
        for other in after[0].contacts
        if contact.same_place(other)
    )


@dataclass(frozen=True, slots=True)
class JointPath:
    """Samples of the joint positions of one arm: by time on the approach, by arc length
    along the contact's path.
    """

    approach_time: NDArray[np.float64]  # (m,) [s]
    approach: NDArray[np.float64]  # (m, n) [rad]
    arc_length: NDArray[np.float64]  # (k,) [m]
    move: NDArray[np.float64]  # (k, n) [rad]
    tool_yaw_offset: float  # [rad] tool yaw minus object yaw while in contact
    joint_margin: float  # [rad] smallest distance from a joint limit
    condition: float  # largest condition number of the tip's 6 x n Jacobian
    # [m] smallest distance of the arm from table, object and obstacles
    clearance: float
    gap: float  # [m] gap that the approach leaves before the touch
    # (g, n) [rad] across that gap, evenly spaced, the last in contact; None: not known
    touch: NDArray[np.float64] | None = None
    # (b, n) [rad] as the tip is drawn back from the end of the path, evenly spaced, the
    # first in contact; None: not known
    back: NDArray[np.float64] | None = None
    max_retreat: float = math.inf  # [m] longest retreat
    # share of what an unsure object asks for in joint margin and in the links' distance
    # from it, at most 1
    margin_share: float = 1.0
