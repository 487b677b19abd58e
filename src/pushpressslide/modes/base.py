"""What a contact mode is: its contacts, its reduced model, its tracking point, what it
can do, and its closed-form laws.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from heapq import heapify, heappop, heappush
from itertools import count
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.robots.reach import held_somehow_problem
from pushpressslide.robots.tool import SIDES, TOOL_TILTS, ToolAttitude

GRAVITY = 9.81
TURN = 2.0 * math.pi
# [rad] that a tool tilted away from its arm leans along the face: less is not tried,
# nor is more
ASIDE = (math.radians(20.0), math.radians(60.0))
# from behind the contact, of a tool that turns with the object
LEANS = tuple(math.radians(a) for a in (0.0, -45.0, 45.0, -75.0, 75.0))
TURNING = 0.3  # [rad] of the object on its way, for which such tools are tried
REACH_STEP = 0.03  # [m] of path between the places that are checked for reach
ENOUGH = 8  # choices of one mode that the arms can follow: no other is judged in full
UNJUDGED = "not judged in full, as there is one that is no slower"

# Makes the choices of one placement, judged but for the arms' reach; or where not asked
# to judge, tells what they would be.
Draft = Callable[[bool], list[Choice]]


class Tracker(Protocol):
    """A tracking law bound to a plan; its only state is the progress, which is handed
    in and out.
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


class Mode(Protocol):
    """One contact topology."""

    name: str
    arms: int
    reduced_model: str
    tracking_point: str
    cop_steering: bool
    walls: bool  # whether it can hold an object on a wall
    # neighbouring faces pushed at once in random tasks; 0: pressed; None: none are drawn
    pushed_faces: int | None

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return every placement of the contacts that was considered, best first, each
        judged feasible or not; in full no more than it takes to find ``enough`` that
        are.
        """
        ...

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: the frame at the tracking point, x along the heading, in the
        body frame.
        """
        ...

    def tracker(self, plan: Plan) -> Tracker:
        """Return the tracking law for a plan."""
        ...

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)``: a wrench in B to contact forces.

        About the CoM for pushes, about the centre of pressure ``cop`` [m] for presses.
        """
        ...

    def identifier(self, plan: Plan) -> AxleIdentifier | None:
        """Return what identifies the mode's virtual axle on the way; None where there
        is nothing to be identified.
        """
        ...

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return a plan for another attempt at the goal, with the same contacts, from
        ``X_WB`` near it; None where the mode cannot go back.
        """
        ...

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from where object and contacts (points in B [m]) really are;
        None if that takes more than ``longest`` [m]. ``identified``: what was seen of
        the virtual axle on the way.
        """
        ...


def tool_load(task: Task, heading: float) -> tuple[float, float]:
    """Return what a body pushed by the object adds to the drag [N], and how far
    ``heading`` [rad] in B is off the pushing face's normal [rad].
    """
    shape = task.object.shape
    tool = task.tool
    if tool is None or isinstance(shape, Cylinder):
        return 0.0, 0.0
    (ax, ay), (bx, by) = (
        shape.footprint[(tool.face + i) % len(shape.footprint)] for i in (0, 1)
    )
    body = next(obstacle for obstacle in task.obstacles if obstacle.name == tool.body)
    outward = math.atan2(ax - bx, by - ay)
    return body.friction * body.mass * GRAVITY, abs(
        math.remainder(heading - outward, TURN)
    )


def followed(
    task: Task,
    drafts: Iterable[tuple[float, Draft]],
    frame: Callable[[Choice], Pose2],
    enough: int,
    told: Callable[[str, str], str],
) -> list[Choice]:
    """Return the choices that ``drafts`` make, those first that the arms can follow,
    the quickest first; after ``enough`` of them no other is judged in full.

    A draft comes with the least time [s] that its choices can take. They are made in
    that order, and the arms are asked for a choice once no draft that is left can be
    quicker. ``frame`` gives X_BV; ``told(reason, why)`` is the reason of one that is
    refused.
    """
    turn = count()
    out = []
    found = 0
    waiting: list[tuple[float, bool, int, Draft | Choice]] = [
        (t, True, next(turn), d) for t, d in drafts
    ]
    heapify(waiting)
    while waiting:
        *_, item = heappop(waiting)
        if not isinstance(item, Choice):
            for choice in item(found < enough):
                if choice.feasible and choice.time is not None:
                    heappush(waiting, (choice.time, False, next(turn), choice))
                else:
                    out.append(choice)
            continue
        why = path_problem(task, item, frame(item)) if found < enough else UNJUDGED
        found += why is None
        judged = (
            item
            if why is None
            else replace(item, feasible=False, reason=told(item.reason, why))
        )
        out.append(replace(judged, judged=why is not UNJUDGED))
    return sorted(
        out, key=lambda c: (not c.feasible, c.time if c.time is not None else math.inf)
    )


def instead(reason: str, why: str) -> str:
    """Return what was chosen and why not, in place of its merits."""
    return f"{reason.split(' with ')[0]}: {why}"


def beside(reason: str, why: str) -> str:
    """Return a choice's merits, and why not."""
    return f"{reason}; {why}"


def path_problem(task: Task, choice: Choice, X_BV: Pose2) -> str | None:
    """Return what stands against the path of a choice: time, workspace, reach of the
    tips; None if nothing.
    """
    path = choice.path
    if path is None:
        return "no path"
    if choice.time is not None and choice.time > task.limits.time:
        return f"needs about {choice.time:.0f} s, limits.time is {task.limits.time:g} s"
    X_VB = X_BV.inverse()
    X_BG = task.object.X_GB.inverse()
    count = max(3, math.ceil(path.length / REACH_STEP))
    bodies = [
        path.pose(path.length * i / count).compose(X_VB) for i in range(count + 1)
    ]
    bounds = task.limits.workspace
    if bounds is not None:
        for X_WB in bodies:
            X = X_WB.compose(X_BG)
            if not (bounds[0] <= X.x <= bounds[1] and bounds[2] <= X.y <= bounds[3]):
                return f"the path leaves limits.workspace at ({X.x:.3f}, {X.y:.3f})"
    return next(
        (
            p
            for c in choice.contacts
            if (p := _reach_problem(task, c, bodies)) is not None
        ),
        None,
    )


def _reach_problem(task: Task, contact: Contact, bodies: list[Pose2]) -> str | None:
    """Return why the arm of a contact cannot follow it along the body poses X_WB; None
    if it can.
    """
    robot = task.robots[contact.arm]
    frame = task.support.frame
    point, height = contact.tip_place(robot.tip_radius)
    points = [frame.point((*X_WB.apply(point), height)) for X_WB in bodies]
    azimuths = tool_azimuths(contact, bodies[len(bodies) // 2], task.bases[contact.arm])
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
    return held_somehow_problem(robot, points, holds)


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
