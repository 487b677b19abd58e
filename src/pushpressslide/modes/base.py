"""The interface of a contact mode, the search for its choices, and the replan.

A mode defines the placements of its contacts, the drive of each placement, and its
closed-form laws. Search and replan are the same for all modes.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from heapq import heapify, heappop, heappush
from itertools import count
from typing import (
    ClassVar,
    Generic,
    NamedTuple,
    Protocol,
    Self,
    TypeVar,
    cast,
)

from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.drive import Drive
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.motion import Limits, Motion, Vehicle
from pushpressslide.core.plan import ENOUGH as ENOUGH
from pushpressslide.core.plan import (
    Choice,
    Contact,
    MotionPath,
    Segment,
    same_places,
)
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import SKIPPED, Refusal, enough_feasible
from pushpressslide.core.scene import Scene
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.drag import DragIdentifier
from pushpressslide.identification.online import AxleIdentifier
from pushpressslide.identification.parameter_estimates import (
    NOTHING,
    ParameterEstimates,
)
from pushpressslide.planning.side_contacts import given_to
from pushpressslide.planning.workspace import poses_along, workspace_refusal
from pushpressslide.robots.contact_reach import UNKNOWN, contact_refusal

PATIENCE = 8  # choices out of reach after which only the reach tables are used
MOST_BLOCKED = 3 * ENOUGH  # blocked choices after which no other is evaluated
BLOCKED = Refusal(
    SKIPPED,
    "not evaluated: {figure:.0f} choices of this mode are blocked, and no more are tried",
    MOST_BLOCKED,
)
NO_PLACEMENT = Refusal("placement", "it has no placement with these contacts")
CROSSING = Refusal("arms_cross", "the arms would cross")
BOTH_CROSSING = replace(CROSSING, text=f"{CROSSING}, whichever takes which contact")

Allocator = Callable[[float, float, float], Allocation]
D = TypeVar("D", bound=Drive)


class Tracker(Protocol):
    """A tracking law bound to a segment. Its only state is the progress, which the
    caller keeps.
    """

    def step(
        self,
        path: MotionPath,
        X_WB: Pose2,
        progress: float,
        speed: float,
        steering_scale: float,
    ) -> Guidance:
        """Guidance at pose ``X_WB``, for a path followed at ``speed`` [m/s].

        ``steering_scale`` in (0, 1] is the fraction of the mode's steering that may be
        used. The fraction is below 1 while the contacts are near slipping.
        """
        ...


@dataclass(frozen=True, slots=True)
class Candidate:
    """The choices of one placement, evaluated on demand."""

    least_time: float  # [s] lower bound of the times of its choices
    # makes the choices, evaluated except for the arms' reach; with False, unevaluated
    make: Callable[[bool], list[Choice]]
    # whether its choices are evaluated in the order of the candidates, not by time
    ordered: bool = False
    # contacts of its choices, made by any arms; None: not known
    contacts: tuple[Contact, ...] | None = None


@dataclass(frozen=True, slots=True)
class Measured:
    """The measured state from which a segment is continued."""

    X_WB: Pose2
    contacts: tuple[Contact, ...]  # measured contact points
    longest: float = math.inf  # [m] longest allowed path
    estimates: ParameterEstimates = NOTHING  # parameters identified during the motion

    @classmethod
    def touching(
        cls,
        X_WB: Pose2,
        planned: Sequence[Contact],
        contact_points: Sequence[Point],
        longest: float = math.inf,
        estimates: ParameterEstimates = NOTHING,
    ) -> Self:
        """Measured state of an object whose ``planned`` contacts touch it at
        ``contact_points`` [m] in B.
        """
        contacts = tuple(
            replace(contact, point=point)
            for contact, point in zip(planned, contact_points, strict=True)
        )
        return cls(X_WB, contacts, longest, estimates)


class Continuation(NamedTuple):
    """Contacts, drive and path of a segment's continuation."""

    contacts: tuple[Contact, ...]
    drive: Drive
    path: MotionPath


class Mode(ABC, Generic[D]):
    """One contact topology, whose segments have drives ``D``."""

    name: ClassVar[str]
    arms: ClassVar[int]
    reduced_model: ClassVar[str]
    tracking_point: ClassVar[str]
    evaluation_cost: ClassVar[int] = 1
    """Cost of evaluating a motion with any contacts, relative to a push from behind. A
    search limits the sum of these costs.
    """
    cop_steering: ClassVar[bool]
    # whether it can hold an object with a weight along the support
    carries_weight: ClassVar[bool]
    # number of neighbouring faces pushed in random tasks; 0: pressed; None: no random
    # tasks
    pushed_faces: ClassVar[int | None]
    drives: ClassVar[tuple[type[Drive], ...]]  # classes of its segments' drives
    vehicles: ClassVar[tuple[Vehicle, ...]] = ()  # allowed values of ``motion.vehicle``

    def choices(
        self,
        query: MotionQuery,
        enough: int = ENOUGH,
        feasibility: Feasibility | None = None,
    ) -> list[Choice]:
        """All placements of the contacts that were considered, the best first, each
        with its feasibility.

        Choices are evaluated until ``enough`` are feasible. ``feasibility`` checks the
        paths; by default it checks only the arms' reach.
        """
        return search(self.candidates(query), enough, feasibility or Feasibility(query))

    def connect(self, query: MotionQuery, contacts: Sequence[Contact]) -> Choice:
        """Choice of the quickest motion for ``query`` with the given ``contacts``, or a
        refused choice.

        The arms' reach and obstacles are not checked.
        """
        part = replace(query, modes=(self.name,))
        held_contacts = tuple(contacts)
        found = self.choices(
            part, 1, Feasibility(part, held_contacts=held_contacts, arms=False)
        )
        if not found:
            return Choice(self.name, contacts=held_contacts, refusal=NO_PLACEMENT)
        return found[0]

    def candidate_contacts(self, query: MotionQuery) -> Sequence[Contact]:
        """All contacts by which one arm may move the object. Empty if the mode does not
        list them, as with two arms.
        """
        return ()

    def least_time(self, query: MotionQuery) -> float:
        """Lower bound [s] of the time of any choice of the mode that keeps the start
        contacts. Quick to compute.
        """
        ends = (query.start, query.goal)
        center = query.X_GB.position
        return straight_time(*ends, center, query.body.radius, query.motion)

    def candidates(self, query: MotionQuery) -> Sequence[Candidate | Choice]:
        """One candidate for each placement of the contacts, or one choice that refuses
        all placements.

        Empty if the mode overrides ``choices``.
        """
        return ()

    def nudges(self, query: MotionQuery) -> Sequence[Candidate | Choice]:
        """Candidates of short pushes that end within the goal's tolerances. Empty if the
        mode has none.
        """
        return ()

    def drive_of(self, segment: Segment) -> D:
        """Drive of one of the mode's own segments.

        Raises TypeError for a segment of any other mode.
        """
        drive = segment.drive
        if not isinstance(drive, self.drives):
            raise TypeError(
                f"{self.name}: {type(drive).__name__} is none of its drives"
            )
        return cast("D", drive)

    @abstractmethod
    def tracker(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Tracking law for a segment of ``query``."""

    @abstractmethod
    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Allocator:
        """A function ``allocate(fx, fy, tau)`` from a wrench in B to contact forces.

        The wrench is about the CoM for pushes, about the centre of pressure ``cop`` [m]
        for presses.
        """

    def allocator_of(self, segment: Segment, friction: float) -> Allocator:
        """Allocator of a segment's contacts with its drive."""
        drive = segment.drive
        return self.allocator(segment.contacts, friction, drive.rho, drive.center)

    @abstractmethod
    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation of a segment to its goal from the ``measured`` object pose and
        contacts. None if the path would be too long.
        """

    def replan(
        self, query: MotionQuery, segments: Sequence[Segment], measured: Measured
    ) -> tuple[Segment, ...]:
        """The ``segments``, with the first one replaced by its continuation from the
        ``measured`` state. Empty if there is no continuation, or if it is longer than
        allowed.
        """
        first, *others = segments
        continuation = self.continue_from(query, first, measured)
        if continuation is None or continuation.path.length > measured.longest:
            return ()
        led = replace(first, contacts=continuation.contacts, drive=continuation.drive)
        return (led.follows(continuation.path), *others)

    def retry(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> tuple[Segment, ...]:
        """Segments of a retry from near the goal, with the same contacts. Empty if the
        mode cannot go back.
        """
        return self.replan(query, (segment,), measured)

    def misses(
        self, query: MotionQuery, segments: Sequence[Segment], X_WB: Pose2
    ) -> bool:
        """Whether ``segments``, continued from ``X_WB``, miss the goal, so that a retry
        should start at once.
        """
        return False

    def identifier(self, query: MotionQuery, segment: Segment) -> AxleIdentifier | None:
        """Online identifier of the mode's virtual axle. None if nothing is identified."""
        return None

    def reach(self, segment: Segment) -> float | None:
        """Planned distance [m] from the only contact to the virtual axle. None if a
        measured one would not improve the motion.
        """
        return None

    def center_identifier(
        self, query: MotionQuery, segment: Segment, center: Point = (0.0, 0.0)
    ) -> CenterIdentifier | None:
        """Online identifier of the centre of mass, in a segment planned with the centre
        at ``center`` [m] in B. None if identification would not improve the motion.
        """
        return None

    def drag_identifier(
        self, query: MotionQuery, segment: Segment
    ) -> DragIdentifier | None:
        """Online identifier of the drag, for the result. None if forces do not tell it."""
        return None


def straight_time(
    start: Pose2, goal: Pose2, center: Point, radius: float, motion: Motion
) -> float:
    """Minimum time [s] of a contact's straight motion between two poses X_WG of an
    object.

    ``center`` [m] is the centre of mass in G. ``radius`` [m] is the largest distance of
    a contact from the centre.
    """
    first = start.apply(center)
    end = goal.apply(center)
    swept = 2.0 * radius * abs(math.sin(0.5 * (goal.yaw - start.yaw)))
    far = math.dist(first, end) - swept
    return max(far, 0.0) / (margins.CONTACT_PACE * motion.speed)


def search(
    candidates: Iterable[Candidate | Choice], enough: int, feasibility: Feasibility
) -> list[Choice]:
    """Choices of ``candidates``: the feasible ones first, and the quickest first among
    them.

    Evaluation stops after ``enough`` feasible choices. Candidates are expanded in the
    order of their minimum times. A choice is evaluated once no remaining candidate can
    be quicker.
    """
    number = count()
    held_contacts = feasibility.held_contacts
    waiting: list[tuple[float, bool, int, Candidate | Choice]] = []
    out = []
    for candidate in candidates:
        if held_contacts is not None and not _may_hold(candidate, held_contacts):
            continue
        if isinstance(candidate, Candidate):
            waiting.append((candidate.least_time, True, next(number), candidate))
        else:
            out.append(candidate)
    heapify(waiting)
    feasible = 0
    while waiting:
        *_, item = heappop(waiting)
        if isinstance(item, Candidate):
            for choice in item.make(feasible < enough):
                if held_contacts is not None and not same_places(
                    choice.contacts, held_contacts
                ):
                    continue
                if not choice.feasible or choice.time is None:
                    out.append(choice)
                    continue
                due = item.least_time if item.ordered else choice.time
                heappush(waiting, (due, False, next(number), choice))
            continue
        if feasible < enough:
            refusal = feasibility.refusal(item)
        else:
            refusal = enough_feasible(feasible)
        if refusal is None:
            feasible += 1
            out.append(item)
        else:
            out.append(item.refused(refusal))
    return sorted(out, key=ranking_key)


def _may_hold(candidate: Candidate | Choice, held_contacts: Sequence[Contact]) -> bool:
    """Whether a candidate may have a choice with ``held_contacts``, made by any arms.

    True for a choice without contacts, which represents all placements.
    """
    if not candidate.contacts:
        return True
    mine = {replace(contact, arm=0, load=0.0) for contact in candidate.contacts}
    return mine == {replace(contact, arm=0, load=0.0) for contact in held_contacts}


def in_arms(choice: Choice, assigned: Iterable[Sequence[int]]) -> list[Choice]:
    """One copy of the choice for each assignment of its contacts in ``assigned``.
    Without any assignment, the result is the choice itself with a refusal.
    """
    return [_with_arms(choice, arms) for arms in assigned] or [choice.refused(CROSSING)]


def _with_arms(choice: Choice, arms: Sequence[int]) -> Choice:
    """The choice with its contacts made by ``arms``."""
    contacts = given_to(choice.contacts, arms)
    segments = tuple(replace(segment, contacts=contacts) for segment in choice.segments)
    return replace(choice, contacts=contacts, segments=segments)


def ranking_key(choice: Choice) -> tuple[bool, float]:
    """Ranking key of choices: feasible first, then by time in milliseconds."""
    time = math.inf if choice.time is None else round(choice.time, 3)
    return not choice.feasible, time


@dataclass
class Feasibility:
    """Evaluates choices one by one: whether the arms can follow the path, and whether
    the path is clear.

    After many choices out of reach, the remaining ones are checked only by the reach
    tables. After many blocked choices the evaluation stops. In a search over sequences
    of motions, all choices are checked only by the tables.
    """

    query: MotionQuery
    # refusal of a blocked path
    blocks: Callable[[Choice], Refusal | None] | None = None
    held_contacts: tuple[Contact, ...] | None = None  # the only contacts to evaluate
    arms: bool = True  # whether the arms' reach is checked
    unreached: int = 0  # choices out of reach so far
    blocked: int = 0  # blocked choices so far
    _at_ends: dict[Contact, bool] = field(default_factory=dict)

    def refusal(self, choice: Choice) -> Refusal | None:
        """Refusal of the path of a choice, or None."""
        if self.blocked >= MOST_BLOCKED:
            return BLOCKED
        refusal = self._arms_refusal(choice) if self.arms else None
        if refusal is None and self.blocks is not None:
            refusal = self.blocks(choice)
            self.blocked += refusal is not None
        return refusal

    def _arms_refusal(self, choice: Choice) -> Refusal | None:
        """Refusal of a choice that the arms cannot follow, or None."""
        searched = self.query.from_search
        if searched and not all(map(self.reach_ends, choice.contacts)):
            return UNKNOWN
        quick = searched or self.unreached >= PATIENCE
        refusal = arms_refusal(self.query.scene, self.query.limits, choice, quick)
        self.unreached += refusal is not None and refusal.code == "reach"
        return refusal

    def reach_ends(self, contact: Contact) -> bool:
        """Whether the arm of a contact reaches it at start and goal with the same tool
        orientation, according to the reach tables.
        """
        place = replace(contact, load=0.0)
        if place not in self._at_ends:
            query = self.query
            refusal = contact_refusal(query.scene, place, query.body_ends, quick=True)
            self._at_ends[place] = refusal is None
        return self._at_ends[place]


def arms_refusal(
    scene: Scene, limits: Limits, choice: Choice, quick: bool
) -> Refusal | None:
    """Refusal of a choice whose path takes too long, leaves the workspace or is out of
    a tip's reach, or None.

    With ``quick``, reach is only looked up in the tables.
    """
    limit = limits.time
    if not choice.segments:
        return Refusal("no_path", "no path")
    if choice.time is not None and choice.time > limit:
        text = "needs about {figure:s.0f}, limits.time is {allowed:sg}"
        return Refusal("time_limit", text, choice.time, limit, "s")
    poses = []
    for segment in choice.segments:
        along = poses_along(segment)
        poses += along
        refusal = workspace_refusal(scene.body, limits, along)
        if refusal is not None:
            return refusal
    contacts = choice.segments[0].contacts
    alone = [contact.kind for contact in contacts] == ["top"]
    for contact in contacts:
        refusal = contact_refusal(scene, contact, poses, alone=alone, quick=quick)
        if refusal is not None:
            return refusal
    return None
