"""Mode press_slide: one arm presses on top and slides the object, driven as a unicycle
about its virtual axle (docs/mechanics.md, sections 2 and 4).

The line of centre of pressure and contact is the heading axis. Pulled, the contact
leads; pushed, it follows; turned on the spot, the force is across. The friction disc
under the tip has no direction of its own, so that any of these goes with any contact
that the press holds. Where no path of one vehicle leads to the goal, a manoeuvre of
turns by forces at several angles does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError
from pushpressslide.core.task import Task, Vehicle
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import press_loads, pressed_cop
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.modes.base import (
    ENOUGH,
    NOT_EVALUATED,
    Allocator,
    Course,
    Draft,
    Mode,
    arms_refusal,
    promptness,
    search,
)
from pushpressslide.planning.held_twist import EDGE
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pressed.driven import (
    Press,
    driven_choice,
    ends_onward,
    steered_path,
)
from pushpressslide.planning.pressed.manoeuvre import (
    CORRECTING,
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed.onward import onward, pressed_at
from pushpressslide.planning.pressed.ranking import by_time, soonest
from pushpressslide.planning.pressed.turns import steering_of
from pushpressslide.planning.pressed.vehicle import (
    BACK_UPS,
    PLANNED,
    axle_ahead,
    press_of,
)
from pushpressslide.planning.tool_drag import tool_load
from pushpressslide.rom.drives import (
    ORIGIN,
    SpinDrive,
    SteeredDrive,
    TurnDrive,
    UnicycleDrive,
)
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, UnicycleTracker

# [rad] that a retry may turn the object: the arm keeps its contact, so its joint range
# limits it
MAX_RETRY_YAW = 1.0
# whether a vehicle is driven backward, with the contact behind its axle
DIRECTIONS: Mapping[Vehicle, tuple[bool, ...]] = {
    "unicycle": (False, True),
    "car": (False,),
    "forklift": (True,),
    "pivot": (False,),
}


@dataclass(frozen=True, slots=True)
class _Placements:
    """The places and loads that a task allows for the press."""

    contacts: tuple[Contact, ...]  # without loads, one for each arm and place
    loads: tuple[float, ...]  # [N], the safest first


class PressSlide(Mode):
    """One arm presses on top and slides the object."""

    name = "press_slide"
    arms = 1
    reduced_model = "unicycle / car / forklift"
    tracking_point = "virtual axle"
    cop_steering = True
    carries_weight = False
    pushed_faces = 0
    drives = (UnicycleDrive, TurnDrive, SpinDrive)
    vehicles = tuple(DIRECTIONS)

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return choices, feasible and quick ones first.

        Alternatives are evaluated in order until one has a feasible choice. Where a
        believed rho leads every path out of bounds, that of the object's shape is
        planned with.
        """
        judged = self._judged(task, enough)
        rho = task.believed.rho
        if rho is None or any(choice.feasible for choice in judged):
            return judged
        belief = replace(task.believed, rho=None)
        note = (
            f"; planned with the shape's rho, belief.rho {rho:g} m leads out of bounds"
        )
        of_shape = self._judged(replace(task, belief=belief), enough)
        return [
            replace(choice, merits=choice.merits + note)
            for choice in of_shape
            if choice.feasible
        ] or judged

    def _judged(self, task: Task, enough: int) -> list[Choice]:
        """Return the choices of all alternatives up to the first feasible one."""
        try:
            placements = _placements(task)
        except RefusedError as error:
            return [Choice(self.name, refusal=error.refusal)]
        found: dict[str, list[Choice]] = {}
        for kind, choices in self._alternatives(task, placements, enough):
            found[kind] = choices
            if any(choice.feasible for choice in choices):
                break
        manoeuvres = found.get("manoeuvre", [])
        if "vehicle" not in found:
            return manoeuvres
        return sorted([*found["vehicle"], *manoeuvres], key=promptness)

    def _alternatives(
        self, task: Task, placements: _Placements, enough: int
    ) -> Iterator[tuple[str, list[Choice]]]:
        """Yield what to try, in order: a manoeuvre before or after a path of one vehicle
        that is well steered; last a path of a vehicle however steered.
        """
        free = task.motion.vehicle is None and task.tool is None
        given = bool(task.motion.contacts)
        if free and not given:
            yield "manoeuvre", self._manoeuvres(task, placements, enough)
        drafts = self._vehicles(task, placements)
        yield "vehicle", self._steered(task, drafts, CORRECTING, enough)
        if free and given:
            yield "manoeuvre", self._manoeuvres(task, placements, enough)
        yield "vehicle", self._steered(task, drafts, 0.0, enough)

    def _vehicles(self, task: Task, placements: _Placements) -> list[Choice]:
        """Return for each contact and direction the choice with the safest load that
        does not tip the object, steered straight; the quickest first.
        """
        out = []
        directions = DIRECTIONS[task.motion.vehicle or "unicycle"]
        for contact, backward in product(placements.contacts, directions):
            for load in placements.loads:  # a lighter press tips less
                press = Press(replace(contact, load=load), backward)
                choice = driven_choice(task, self.name, press)
                if choice.feasible:
                    break
            out.append(choice)
        return sorted(out, key=promptness)

    def _steered(
        self, task: Task, drafts: Sequence[Choice], least: float, enough: int
    ) -> list[Choice]:
        """Return drafts planned with the axle of their turns, judged in order.

        Refused are those that are steered like a unicycle by less than ``least`` [rad].
        """
        return search(
            task,
            [
                Draft(float(i), partial(self._with_turns, task, draft, least), True)
                if draft.feasible
                else draft
                for i, draft in enumerate(drafts)
            ],
            enough,
        )

    def _with_turns(
        self, task: Task, draft: Choice, least: float, evaluated: bool
    ) -> list[Choice]:
        """Return a draft planned with the axle of its turns."""
        drive = draft.segments[-1].drive
        given = task.believed.rho is not None
        if given or not evaluated or not isinstance(drive, UnicycleDrive):
            return [draft]
        (contact,) = draft.contacts
        backward = drive.car.backward
        steering = math.inf
        if least > 0.0 and task.tool is None:
            steering = steering_of(press_of(task, contact), backward)
        if steering < least:
            text = (
                "it is steered like a unicycle only up to {figure:deg.1f}, needed "
                "{allowed:degg}"
            )
            return [draft.refused(Refusal("steering", text, steering, least, "rad"))]
        angle = PLANNED * min(drive.steepest, steering)
        return [
            driven_choice(task, self.name, Press(contact, backward, angle, steering))
        ]

    def _manoeuvres(
        self, task: Task, placements: _Placements, enough: int
    ) -> list[Choice]:
        """Return manoeuvres until ``enough`` are feasible, those of the safest press
        first: one per contact, then others; then the contacts that were skipped.
        """
        X_WB = task.start.compose(task.object.X_GB)
        out: list[Choice] = []
        skipped: list[Choice] = []
        missing = enough
        inside = [
            contact
            for contact in placements.contacts
            if contact.point != ORIGIN and inside_top(task.object, contact.point, EDGE)
        ]
        for load in placements.loads:
            contacts = [replace(contact, load=load) for contact in inside]
            ranked = by_time(task, X_WB, contacts)
            wanted = min(missing, ENOUGH)
            for manoeuvre in soonest(task, X_WB, list(ranked)):
                choice = manoeuvre.choice(task, self.name)
                choice = choice.refused(arms_refusal(task, choice))
                out.append(choice)
                wanted -= choice.feasible
                if wanted == 0:
                    break
            missing = enough - sum(choice.feasible for choice in out)
            if missing < enough and not skipped:
                tried = {choice.contacts[0] for choice in out}
                skipped = [
                    self._skipped(task, contact, time)
                    for contact, time in ranked.items()
                    if contact not in tried
                ]
            # lighter presses only where more are asked for
            if missing == 0 or missing < enough <= ENOUGH:
                break
        return sorted(out, key=lambda choice: not choice.feasible) + skipped

    def _skipped(self, task: Task, contact: Contact, time: float) -> Choice:
        """Return the choice of a contact for which no manoeuvre was planned; it takes
        about ``time`` [s].
        """
        x, y = contact.point
        return Choice(
            self.name,
            f"manoeuvre at ({x:.3f}, {y:.3f})",
            (contact,),
            time=time + overhead(task, pressed=True),
            refusal=NOT_EVALUATED,
        )

    def tracker(self, task: Task, segment: Segment) -> UnicycleTracker | PivotTracker:
        """Return the look-ahead law for a segment, or that of a turn on the spot."""
        drive = segment.drive
        if isinstance(drive, SpinDrive):
            return PivotTracker(drive)
        assert isinstance(drive, SteeredDrive)
        path = segment.path
        assert isinstance(path, ArcPath)
        fixed = path.end if task.motion.fixed_target else None
        law = LookAheadAlignment(drive.look_ahead, math.inf, fixed)
        return UnicycleTracker(law, drive)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m]; ``rho`` [m] weighs torque
        errors (default: half the lever).
        """
        (contact,) = contacts
        if rho is None:
            rho = 0.5 * max(math.hypot(*contact.point), EDGE)
        return one_press_allocator(contact.point, contact.load, friction, rho, cop)

    def identifier(self, segment: Segment) -> AxleIdentifier:
        """Return what identifies the virtual axle on the way."""
        drive = segment.drive
        assert isinstance(drive, UnicycleDrive | TurnDrive | SpinDrive)
        car = drive.car
        predicted = Identified(
            axle_ahead(car), abs(car.effective_wheelbase), drive.max_friction
        )
        stiffness = None if isinstance(drive, SpinDrive) else drive.stiffness
        return AxleIdentifier(car.X_BV.yaw, predicted, car.lever, stiffness)

    def again(
        self, task: Task, segment: Segment, X_WB: Pose2, touched: Sequence[Point]
    ) -> tuple[Segment, ...]:
        """Return segments that go back and then to the goal; none for a turn on the
        spot, or where the object would tip.
        """
        drive = segment.drive
        if isinstance(drive, SpinDrive):
            return ()
        assert isinstance(drive, SteeredDrive)
        here = replace(task, start=X_WB.compose(task.object.X_GB.inverse()))
        contact = replace(segment.contacts[0], point=touched[0])
        if isinstance(drive, UnicycleDrive):
            steepest = drive.steepest
            press = Press(
                contact,
                drive.car.backward,
                PLANNED * steepest,
                steepest,
                BACK_UPS[1:],
            )
            choice = driven_choice(here, self.name, press)
            if choice.feasible:
                return choice.segments
        for manoeuvre in pressed_manoeuvres(here, X_WB, [contact]):
            if manoeuvre.swing < MAX_RETRY_YAW:
                return manoeuvre.choice(here, self.name).segments
        return ()

    def replan(
        self,
        task: Task,
        segments: Sequence[Segment],
        X_WB: Pose2,
        touched: Sequence[Point],
        longest: float,
        identified: Identified | None = None,
    ) -> tuple[Segment, ...]:
        """Return ``segments`` replanned: the first one, or all turns of a manoeuvre."""
        first = segments[0]
        contact = replace(first.contacts[0], point=touched[0])
        if contact.point == ORIGIN:
            return ()
        drive = first.drive
        if isinstance(drive, TurnDrive) and not drive.last:
            led = onward(task, segments, X_WB, contact)
            return led if led[0].path.length <= longest else ()
        return super().replan(task, segments, X_WB, touched, longest, identified)

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by the true contact; ``identified``: the axle as it was
        seen to be.
        """
        (contact,) = contacts
        drive = segment.drive
        if isinstance(drive, TurnDrive):
            (segment,) = pressed_at(task, (segment,), contact)
            drive = segment.drive
        weight = task.scene.weight_on
        cop = pressed_cop(contact.point, contact.load, weight)
        assert isinstance(drive, UnicycleDrive | TurnDrive | SpinDrive)
        car = replace(drive.car, contact=contact.point, cop=cop)
        if isinstance(drive, SpinDrive):
            start, goal = ends_onward(task, segment, X_WB, drive.X_BV)
            radius = math.dist(contact.point, drive.X_BV.position)
            spin = TwistPath.between((start, goal), radius)
            course = Course(contacts, replace(drive, car=car), spin)
        else:
            steered = _steered_by(drive, car, identified)
            path = steered_path(task, segment, X_WB, steered, longest)
            course = Course(contacts, steered, path)
        return course if course.path.length <= longest else None


def _placements(task: Task) -> _Placements:
    """Return where and how hard to press. Raises RefusedError where no press holds."""
    belief = task.believed
    motion = task.motion
    loads = press_loads(
        task.scene.weight_on,
        belief.support_friction,
        belief.contact_friction,
        task.limits.normal_force,
        motion.press_force,
        tool_load(task, 0.0)[0],
    )
    com = task.object.center_of_mass
    places: Sequence[Point] = top_places(task.object, EDGE)
    if motion.contacts:
        x, y = motion.contacts[0]
        places = [(x - com[0], y - com[1])]
    height = task.object.shape.height
    contacts = tuple(
        Contact(arm, "top", place, ORIGIN, height)
        for arm, place in product(range(len(task.robots)), places)
    )
    return _Placements(contacts, tuple(loads))


def _steered_by(
    drive: SteeredDrive, car: Unicycle, identified: Identified | None
) -> SteeredDrive:
    """Return a drive with ``car``, or with the axle that was identified."""
    max_friction = drive.max_friction
    if identified is not None:
        rho = math.sqrt(identified.effective_wheelbase * abs(car.lever))
        car = replace(car, rho=rho, shift=0.0)
        car = replace(car, shift=identified.axle - axle_ahead(car))
        max_friction = identified.drag
    if isinstance(drive, TurnDrive):
        drive = replace(drive, X_BV=car.X_BV)
    return replace(drive, car=car, max_friction=max_friction)


MODE = PressSlide()
allocator = MODE.allocator
