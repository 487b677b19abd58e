"""Mode press_and_push: one arm presses a point of the top and pins it, the other pushes
a side face, and the object turns about the pinned point (docs/mechanics.md, sections
1.2 and 7).

An arm that does not press transmits no friction, and under two presses the object turns
best between them. To turn it about a point near its edge the second arm pushes from the
side, where it has the longest lever; the press holds what drag and push leave over.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import atan, hypot

from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.osculating import dragged_ellipsoid, pressures
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.mechanics.top import inside_top, room_inside
from pushpressslide.modes.base import (
    CROSSING,
    ENOUGH,
    Allocator,
    Course,
    Draft,
    Mode,
    search,
)
from pushpressslide.planning.held_twist import (
    DECAY,
    EDGE,
    path_onward,
    tipping_refusal,
    twist_at,
    utilisation,
)
from pushpressslide.planning.levers import LEAST_LEVER, Lever, levers
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.segments import segment
from pushpressslide.planning.side_contacts import assignments, contact_height
from pushpressslide.rom.drives import ORIGIN, PinnedDrive
from pushpressslide.tracking.eased import EasedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker

# shares of the press's friction that holding the pivot may take, best first
UTILISATION = (0.5, 0.6, 0.7, 0.8, 0.9)
LEAST_PRESS = 3.0  # [N] below which contact is not felt for sure
HALVINGS = 8  # of the interval of presses
LEAST_TURN = math.radians(3.0)  # of a goal

Pair = tuple[Contact, Contact]


@dataclass(frozen=True, slots=True)
class _Drag:
    """A press and a push that drag the object with one twist."""

    surface: DraggedSurface  # the limit surface near that twist
    forces: Allocation
    friction_utilisation: float  # of the press
    cop: Point  # [m] in B, centre of pressure
    tipping_margin: float  # half widths


@dataclass(frozen=True, slots=True)
class _Turn:
    """The turn about the pin that the task asks for."""

    pin: Point  # [m] in B
    path: TwistPath  # of the pin
    time: float  # [s] of the whole run


class PressAndPush(Mode):
    """One arm pins a point, the other turns the object about it."""

    name = "press_and_push"
    arms = 2
    reduced_model = "pivot about a pressed point"
    tracking_point = "the pressed point"
    cop_steering = True
    carries_weight = False
    pushed_faces = None
    drives = (PinnedDrive,)

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the choices of all placements."""
        return search(task, self._drafts(task), enough)

    def _drafts(self, task: Task) -> list[Draft | Choice]:
        """Return one draft per place to push, those with the longest lever first."""
        try:
            pin = _pin(task)
        except RefusedError as error:
            return [Choice(self.name, refusal=error.refusal)]
        turn = math.remainder(task.goal.yaw - task.start.yaw, 2.0 * math.pi)
        places = levers(task.object, pin, math.copysign(1.0, turn), task.motion.face)
        if not places:
            text = "no face has a lever of {allowed:mm.0f} about the pressed point"
            refusal = Refusal("lever", text, None, LEAST_LEVER, "m")
            return [Choice(self.name, refusal=refusal)]
        motion = task.motion
        radius = max(math.dist(pin, place.point) for place in places)
        X_GB = task.object.X_GB
        X_BV = Pose2(*pin)
        start, goal = (X.compose(X_GB).compose(X_BV) for X in (task.start, task.goal))
        path = TwistPath.between((start, goal), radius)
        profile = SpeedProfile(path.length, motion.speed, motion.acceleration)
        time = profile.duration + overhead(task, pressed=True)
        turning = _Turn(pin, path, time)
        return [
            Draft(time, partial(self._pushed, task, turning, place)) for place in places
        ]

    def _pushed(
        self, task: Task, turn: _Turn, lever: Lever, evaluated: bool
    ) -> list[Choice]:
        """Judge one place to push but for the arms' reach: one choice for each way to
        give the two contacts to the arms.
        """
        top = task.object.shape.height
        height = contact_height(task)
        press = Contact(0, "top", turn.pin, ORIGIN, top)
        push = Contact(1, "side", lever.point, lever.face.normal, height)
        label = (
            "pressed at ({:.3f}, {:.3f}), ".format(*turn.pin)
            + f"pushed on face {lever.face.index} at "
            + "({:.3f}, {:.3f})".format(*lever.point)
        )
        choice = Choice(self.name, label, (press, push), time=turn.time)
        if height >= top:
            text = "the push is at {figure:mm.0f}, the object is {allowed:mm.0f} high"
            return [choice.refused(Refusal("above_object", text, height, top, "m"))]
        if not evaluated:
            return [choice]
        path = turn.path
        X_VB = Pose2(*turn.pin).inverse()
        poses = [path.pose(0.25 * i * path.length).compose(X_VB) for i in range(5)]
        ways = assignments(task.scene.bases, (turn.pin, lever.point), poses)
        if not ways:
            text = f"{CROSSING}, whichever takes which contact"
            return [choice.refused(Refusal(CROSSING.code, text))]
        try:
            load, drag = self._press(task, (press, push), twist_at(path, turn.pin))
        except ValueError as error:
            tips = f"the object would tip: {refusal_of(error, 'tipping')}"
            return [choice.refused(Refusal("tipping", tips))]
        driven = self._driven(task, choice, turn, lever, load, drag)
        return [_in_arms(driven, arms) for arms in ways]

    def _driven(
        self,
        task: Task,
        choice: Choice,
        turn: _Turn,
        lever: Lever,
        load: float,
        drag: _Drag,
    ) -> Choice:
        """Return the choice with a press of ``load`` [N]."""
        press, push = choice.contacts
        contacts = (replace(press, load=load), push)
        used = drag.friction_utilisation
        mu = task.believed.contact_friction
        piece = segment(
            task,
            self.name,
            contacts,
            _drive(drag, turn.path.radius, contacts),
            turn.path,
            cone_margin=atan(mu) - atan(used * mu),
        )
        merits = (
            f"{load:.1f} and {drag.forces.normals[1]:.1f} N, lever "
            f"{lever.length * 1e3:.0f} mm, path {turn.path.length:.3f} m, {used:.2f} of "
            "the press's friction used"
        )
        return replace(
            choice,
            contacts=contacts,
            segments=(piece,),
            merits=merits,
            refusal=_drag_refusal(task, load, drag),
        )

    def _press(self, task: Task, contacts: Pair, twist: Twist) -> tuple[float, _Drag]:
        """Return the load to press with [N], the least that is safe, and what dragging
        is like then.

        Raises ValueError where the object tips.
        """
        press, push = contacts

        def dragged(load: float) -> _Drag:
            """Return what dragging with a press of ``load`` [N] is like."""
            return self._drag(task, (replace(press, load=load), push), twist)

        given = task.motion.press_force
        cap = task.limits.normal_force
        if given is not None:
            return given, dragged(given)
        drag = dragged(cap)
        hardest = drag.friction_utilisation
        used = next((share for share in UTILISATION if hardest <= share), None)
        if used is None:
            return cap, drag
        low = LEAST_PRESS
        high = cap
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            lighter = dragged(middle)
            if lighter.friction_utilisation <= used:
                high = middle
                drag = lighter
            else:
                low = middle
        return high, drag

    def _drag(self, task: Task, contacts: Sequence[Contact], twist: Twist) -> _Drag:
        """Return what dragging with ``twist`` is like. Raises ValueError where the
        object tips.
        """
        belief = task.believed
        press, push = contacts
        weight = task.scene.weight_on
        mu = belief.contact_friction
        load = weight + press.load

        def forces(wrench: Wrench) -> Allocation:
            """Return the contact forces of a wrench."""
            allocate = self.allocator(contacts, mu, None, wrench.about)
            return allocate(wrench.fx, wrench.fy, wrench.tau)

        def shift(wrench: Wrench) -> Point:
            """Return how far [m] the contact forces move the centre of pressure."""
            (ax, ay), (bx, by) = forces(wrench).forces
            h1 = press.height / load
            h2 = push.height / load
            return (h1 * ax + h2 * bx, h1 * ay + h2 * by)

        resting = center_of_pressure(weight, ORIGIN, [press.load], [press.point])
        surface, cop = dragged_ellipsoid(
            pressures(task.scene), belief.support_friction, load, resting, twist, shift
        )
        given = forces(surface.wrench(twist))
        pressed = hypot(*given.forces[0]) / (mu * press.load)
        used = utilisation(pressed, given, surface)
        return _Drag(surface, given, used, cop, room_inside(task.object, cop))

    def tracker(self, task: Task, segment: Segment) -> EasedTracker:
        """Return the holonomic law for a segment, within what the contacts hold."""
        drive = segment.drive
        assert isinstance(drive, PinnedDrive)
        law = HolonomicTracker(drive.X_BV, drive.surface, decay=DECAY)
        mu = task.believed.contact_friction
        allocate = self.allocator(segment.contacts, mu, drive.rho, drive.center)
        return EasedTracker(law, allocate)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], press first; ``rho`` is
        of no use.
        """
        press, push = contacts
        return press_and_push_allocator(
            press.point, press.load, push.point, push.normal, friction, cop
        )

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by one twist about the pin as it is; None where the push
        would have to pull.
        """
        planned = segment.drive
        assert isinstance(planned, PinnedDrive)
        pin = contacts[0].point
        X_BV = Pose2(*pin)
        path = path_onward(task, X_WB, X_BV, segment.goal, planned.radius, longest)
        if path is None:
            return None
        try:
            drag = self._drag(task, contacts, twist_at(path, pin))
        except ValueError:
            return None
        if drag.forces.status != "ok":
            return None
        return Course(contacts, _drive(drag, planned.radius, contacts), path)


def _drive(drag: _Drag, radius: float, contacts: Sequence[Contact]) -> PinnedDrive:
    press, push = contacts
    return PinnedDrive(
        drag.surface,
        radius,
        press.point,
        drag.cop,
        drag.friction_utilisation,
        push.point,
        push.normal,
    )


def _in_arms(choice: Choice, arms: Sequence[int]) -> Choice:
    """Return a choice with its contacts, press first, given to ``arms``."""
    contacts = tuple(
        replace(contact, arm=arm)
        for contact, arm in zip(choice.contacts, arms, strict=True)
    )
    segments = tuple(replace(piece, contacts=contacts) for piece in choice.segments)
    return replace(choice, contacts=contacts, segments=segments)


def _drag_refusal(task: Task, load: float, drag: _Drag) -> Refusal | None:
    """Return what stands against a press of ``load`` [N]; None if nothing."""
    cap = task.limits.normal_force
    used = drag.friction_utilisation
    push = drag.forces.normals[1]
    if load > cap:
        text = "motion.press_force of {figure:Ng}, limits.normal_force is {allowed:Ng}"
        return Refusal("normal_force", text, load, cap, "N")
    if drag.forces.status != "ok" or used > UTILISATION[-1]:
        text = (
            f"pressed with {load:.1f} N the tip slips: holding the pivot takes "
            "{figure:.2f} of its friction, allowed {allowed:g}; limits.normal_force is "
            f"{cap:g} N"
        )
        return Refusal("friction", text, used, UTILISATION[-1])
    if push > cap:
        text = "needs a push of {figure:N.1f}, limits.normal_force is {allowed:Ng}"
        return Refusal("normal_force", text, push, cap, "N")
    return tipping_refusal("drag tips the object", drag.tipping_margin)


def _pin(task: Task) -> Point:
    """The point to press [m] in B; raises RefusedError where the goal is not turned
    about one that can be.
    """
    body = task.object
    start = task.start.compose(body.X_GB)
    goal = task.goal.compose(body.X_GB)
    vx, vy, w = screw(start, goal)
    if abs(w) < LEAST_TURN:
        text = "the goal is turned by {figure:deg.1f}, allowed from {allowed:degg}"
        raise RefusedError(Refusal("turn", text, w, LEAST_TURN, "rad"))
    pin = (-vy / w, vx / w)
    given = task.motion.contacts
    if given is not None:
        com = body.center_of_mass
        pin = (given[0][0] - com[0], given[0][1] - com[1])
        apart = math.dist(start.apply(pin), goal.apply(pin))
        allowed = task.tolerance.position
        if apart > allowed:
            text = (
                "the pressed point has to stay in its place, start and goal have it "
                "{figure:mm.1f} apart, allowed {allowed:mmg}"
            )
            raise RefusedError(Refusal("pin_moves", text, apart, allowed, "m"))
    if not inside_top(body, pin, EDGE):
        text = (
            f"the goal is turned about ({pin[0]:.3f}, {pin[1]:.3f}), which would have "
            "to be pressed: it is {figure:mm.0f} inside the top, allowed from "
            "{allowed:mm.0f}"
        )
        depth = body.shape.depth(body.X_GB.apply(pin))
        raise RefusedError(Refusal("off_top", text, depth, EDGE, "m"))
    return pin


MODE = PressAndPush()
allocator = MODE.allocator
