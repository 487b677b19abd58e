"""What a contact mode is, the one search for its choices, and the one replan.

A mode says which placements of its contacts there are, with which drive each would
move the object, and its closed-form laws. Search and replan are the same for all.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from itertools import count
from typing import ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.drive import Drive
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import SKIPPED, Refusal, literal
from pushpressslide.core.task import Task, Vehicle
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.planning.side_contacts import given_to
from pushpressslide.robots.reach import held_somehow_problem
from pushpressslide.robots.tool import SIDES, TOOL_TILTS, ToolAttitude

TURN = 2.0 * math.pi
# [rad] that a tool tilted away from its arm leans along the face: less is not tried,
# nor is more
ASIDE = (math.radians(20.0), math.radians(60.0))
# from behind the contact, of a tool that turns with the object
LEANS = tuple(math.radians(a) for a in (0.0, -45.0, 45.0, -75.0, 75.0))
TURNING = 0.3  # [rad] of the object on its path, from which such tools are tried
REACH_STEP = 0.03  # [m] of path between the places that are checked for reach
ENOUGH = 8  # feasible choices of one mode, after which no other is evaluated
NOT_EVALUATED = Refusal(
    SKIPPED, "not judged in full, as there is one that is no slower"
)
CROSSING = Refusal("arms_cross", "the arms would cross")

Allocator = Callable[[float, float, float], Allocation]


class Tracker(Protocol):
    """A tracking law bound to a segment; its only state is the progress, which is
    handed in and out.
    """

    def step(
        self, path: MotionPath, X_WB: Pose2, progress: float, speed: float, grip: float
    ) -> Guidance:
        """Return what the object should do at pose ``X_WB`` when the path is to be
        followed at ``speed`` [m/s].

        ``grip`` in (0, 1] is the share of the mode's steering that may be used: the
        contacts are near slipping below 1.
        """
        ...


@dataclass(frozen=True, slots=True)
class Draft:
    """The choices of one placement, made when they are asked for."""

    least_time: float  # [s] that none of its choices beats
    # makes the choices, judged but for the arms' reach; told False, it says only what
    # they would be
    make: Callable[[bool], list[Choice]]
    # whether its choices are judged in the order of the drafts, not of their own times
    ordered: bool = False


class Course(NamedTuple):
    """Where a segment is led from here."""

    contacts: tuple[Contact, ...]
    drive: Drive
    path: MotionPath


class Mode(ABC):
    """One contact topology."""

    name: ClassVar[str]
    arms: ClassVar[int]
    reduced_model: ClassVar[str]
    tracking_point: ClassVar[str]
    cop_steering: ClassVar[bool]
    # whether it can hold an object whose weight pulls it along the support
    carries_weight: ClassVar[bool]
    # neighbouring faces pushed at once in random tasks; 0: pressed; None: none are drawn
    pushed_faces: ClassVar[int | None]
    drives: ClassVar[tuple[type[Drive], ...]]  # the classes of its segments' drives
    vehicles: ClassVar[tuple[Vehicle, ...]] = ()  # that ``motion.vehicle`` may name

    @abstractmethod
    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return every placement of the contacts that was considered, best first, each
        judged feasible or not; evaluated until ``enough`` are feasible.
        """

    @abstractmethod
    def tracker(self, task: Task, segment: Segment) -> Tracker:
        """Return the tracking law for a segment of ``task``."""

    @abstractmethod
    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)``: a wrench in B to contact forces.

        About the CoM for pushes, about the centre of pressure ``cop`` [m] for presses.
        """

    @abstractmethod
    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return how a segment is led to its goal from ``X_WB`` with ``contacts`` where
        they really are; None if that takes more than ``longest`` [m].
        """

    def replan(
        self,
        task: Task,
        segments: Sequence[Segment],
        X_WB: Pose2,
        touched: Sequence[Point],
        longest: float,
        identified: Identified | None = None,
    ) -> tuple[Segment, ...]:
        """Return ``segments`` with the first one replanned from where object and
        contacts (points in B [m]) really are; none if that takes more than ``longest``
        [m]. ``identified``: what was seen of the virtual axle on the way.
        """
        first, *others = segments
        contacts = tuple(
            replace(contact, point=point)
            for contact, point in zip(first.contacts, touched, strict=True)
        )
        course = self.course(task, first, X_WB, contacts, longest, identified)
        if course is None:
            return ()
        led = replace(first, contacts=course.contacts, drive=course.drive)
        return (led.follows(course.path), *others)

    def again(
        self, task: Task, segment: Segment, X_WB: Pose2, touched: Sequence[Point]
    ) -> tuple[Segment, ...]:
        """Return the segments of another attempt at the goal, with the same contacts,
        from ``X_WB`` near it; none where the mode cannot go back.
        """
        return self.replan(task, (segment,), X_WB, touched, math.inf)

    def identifier(self, segment: Segment) -> AxleIdentifier | None:
        """Return what identifies the mode's virtual axle on the way; None where nothing
        is identified.
        """
        return None


def search(task: Task, drafts: Iterable[Draft | Choice], enough: int) -> list[Choice]:
    """Return the choices that ``drafts`` make, the feasible ones first, the quickest
    first; after ``enough`` feasible ones no other is evaluated.

    Drafts are made in the order of their least times. The arms are asked for a choice
    once no draft that is left can be quicker.
    """
    number = count()
    waiting: list[tuple[float, bool, int, Draft | Choice]] = []
    out = []
    for draft in drafts:
        if isinstance(draft, Draft):
            waiting.append((draft.least_time, True, next(number), draft))
        else:
            out.append(draft)
    heapify(waiting)
    feasible = 0
    while waiting:
        *_, item = heappop(waiting)
        if isinstance(item, Draft):
            for choice in item.make(feasible < enough):
                if not choice.feasible or choice.time is None:
                    out.append(choice)
                    continue
                due = item.least_time if item.ordered else choice.time
                heappush(waiting, (due, False, next(number), choice))
            continue
        refusal = arms_refusal(task, item) if feasible < enough else NOT_EVALUATED
        if refusal is None:
            feasible += 1
            out.append(item)
        else:
            out.append(item.refused(refusal))
    return sorted(out, key=promptness)


def with_arms(choice: Choice, arms: Sequence[int]) -> Choice:
    """Return a choice with its contacts given to ``arms``."""
    contacts = given_to(choice.contacts, arms)
    segments = tuple(replace(piece, contacts=contacts) for piece in choice.segments)
    return replace(choice, contacts=contacts, segments=segments)


def promptness(choice: Choice) -> tuple[bool, float]:
    """Return the order of choices: the feasible ones, then by time, in milliseconds."""
    time = math.inf if choice.time is None else round(choice.time, 3)
    return not choice.feasible, time


def arms_refusal(task: Task, choice: Choice) -> Refusal | None:
    """Return what stands against the path of a choice: time, workspace, reach of the
    tips; None if nothing.
    """
    limit = task.limits.time
    if not choice.segments:
        return Refusal("no_path", "no path")
    if choice.time is not None and choice.time > limit:
        text = "needs about {figure:s.0f}, limits.time is {allowed:sg}"
        return Refusal("time_limit", text, choice.time, limit, "s")
    for piece in choice.segments:
        poses = poses_along(piece)
        refusal = workspace_refusal(task, poses)
        for contact in piece.contacts:
            refusal = refusal or _reach_refusal(task, contact, poses)
        if refusal is not None:
            return refusal
    return None


def poses_along(piece: Segment) -> list[Pose2]:
    """Return X_WB along a segment, at most REACH_STEP apart."""
    path = piece.path
    X_VB = piece.X_BV.inverse()
    steps = max(3, math.ceil(path.length / REACH_STEP))
    return [path.pose(path.length * i / steps).compose(X_VB) for i in range(steps + 1)]


def workspace_refusal(task: Task, poses: Sequence[Pose2]) -> Refusal | None:
    """Return where the object's frame G would leave the workspace along ``poses``
    X_WB.
    """
    bounds = task.limits.workspace
    if bounds is None:
        return None
    x_min, x_max, y_min, y_max = bounds
    X_BG = task.object.X_GB.inverse()
    for X_WB in poses:
        X = X_WB.compose(X_BG)
        if not (x_min <= X.x <= x_max and y_min <= X.y <= y_max):
            place = f"({X.x:.3f}, {X.y:.3f})"
            return Refusal("workspace", f"the path leaves limits.workspace at {place}")
    return None


def _reach_refusal(task: Task, contact: Contact, bodies: list[Pose2]) -> Refusal | None:
    """Return why the arm of a contact cannot follow it along the body poses X_WB; None
    if it can.
    """
    robot = task.robots[contact.arm]
    frame = task.support.frame
    point, height = contact.tip_place(robot.tip_radius)
    points = [frame.point((*X_WB.apply(point), height)) for X_WB in bodies]
    middle = bodies[len(bodies) // 2]
    azimuths = tool_azimuths(contact, middle, task.scene.bases[contact.arm])
    holds: list[tuple[ToolAttitude, NDArray[np.float64] | None]] = []
    tilted = [(tilt, azimuth) for tilt in TOOL_TILTS[1:] for azimuth in azimuths]
    holds += [(ToolAttitude(*held, frame.axes), None) for held in [(0.0, 0.0), *tilted]]
    yaws = np.unwrap([X_WB.yaw for X_WB in bodies])
    if np.ptp(yaws) > TURNING:
        behind = math.atan2(contact.normal[1], contact.normal[0])
        holds += [
            (
                ToolAttitude(TOOL_TILTS[-1], side, frame.axes, turns=True),
                yaws + behind + lean - side,
            )
            for lean in LEANS
            for side in SIDES
        ]
    problem = held_somehow_problem(robot, points, holds)
    return None if problem is None else Refusal("reach", literal(problem))


def tool_azimuths(
    contact: Contact, X_WB: Pose2, base: tuple[float, float, float]
) -> tuple[float, ...]:
    """Return the azimuths [rad] at which a tilted tool is tried: behind a pushing
    contact, straight and, as far as the face allows it, away from the arm; under the
    arm, or away from it, on top.
    """
    x, y = X_WB.apply(contact.point)
    outward = math.atan2(y - base[1], x - base[0])
    if contact.kind == "top":
        return (outward, outward + math.pi)
    nx, ny = X_WB.rotate(contact.normal)
    behind = math.atan2(ny, nx)
    aside = math.remainder(outward - behind, TURN)
    if not ASIDE[0] < abs(aside) < 0.5 * math.pi:
        return (behind,)
    return (behind, behind + math.copysign(min(abs(aside), ASIDE[1]), aside))
