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
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import pressed_cop
from pushpressslide.modes.base import (
    ENOUGH,
    Allocator,
    Course,
    Draft,
    Measured,
    Mode,
    arms_refusal,
    promptness,
    search,
)
from pushpressslide.planning.held_twist import EDGE
from pushpressslide.planning.pressed.driven import (
    DIRECTIONS,
    driven_again,
    steered_path,
    vehicle_choices,
    with_turns,
)
from pushpressslide.planning.pressed.manoeuvre import (
    CORRECTING,
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed.manoeuvre_choices import manoeuvre_choices
from pushpressslide.planning.pressed.onward import pressed_at, turns_onward
from pushpressslide.planning.pressed.placements import (
    PressPlacements,
    press_placements,
)
from pushpressslide.planning.segments import ends_onward
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
            placements = press_placements(task)
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
        self, task: Task, placements: PressPlacements, enough: int
    ) -> Iterator[tuple[str, list[Choice]]]:
        """Yield what to try, in order: a manoeuvre before or after a path of one vehicle
        that is well steered; last a path of a vehicle however steered.
        """

        def manoeuvres() -> list[Choice]:
            """Return the choices of manoeuvres."""
            refusal = partial(arms_refusal, task)
            return manoeuvre_choices(task, self.name, placements, enough, refusal)

        free = task.motion.vehicle is None and task.tool is None
        given = bool(task.motion.contacts)
        if free and not given:
            yield "manoeuvre", manoeuvres()
        straight = vehicle_choices(task, self.name, placements)
        straight.sort(key=promptness)
        yield "vehicle", search(task, _steered(task, straight, CORRECTING), enough)
        if free and given:
            yield "manoeuvre", manoeuvres()
        yield "vehicle", search(task, _steered(task, straight, 0.0), enough)

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
            car.axle, abs(car.effective_wheelbase), drive.max_friction
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
            choice = driven_again(here, self.name, contact, drive)
            if choice.feasible:
                return choice.segments
        for manoeuvre in pressed_manoeuvres(here, X_WB, [contact]):
            if manoeuvre.swing < MAX_RETRY_YAW:
                return manoeuvre.choice(here, self.name).segments
        return ()

    def onward(
        self, task: Task, segments: Sequence[Segment], measured: Measured
    ) -> tuple[Segment, ...]:
        """Return ``segments`` led on: the first one, or all turns of a manoeuvre."""
        (contact,) = measured.contacts
        if contact.point == ORIGIN:
            return ()
        drive = segments[0].drive
        if isinstance(drive, TurnDrive) and not drive.last:
            turns = turns_onward(task.scene, segments, measured.X_WB, contact)
            return turns if turns[0].path.length <= measured.longest else ()
        return super().onward(task, segments, measured)

    def course(self, task: Task, segment: Segment, measured: Measured) -> Course | None:
        """Return the course by the true contact, with the axle as it was seen to be."""
        (contact,) = measured.contacts
        drive = segment.drive
        if isinstance(drive, TurnDrive):
            (segment,) = pressed_at(task.scene, (segment,), contact)
            drive = segment.drive
        cop = pressed_cop(contact.point, contact.load, task.scene.weight_on)
        assert isinstance(drive, UnicycleDrive | TurnDrive | SpinDrive)
        car = replace(drive.car, contact=contact.point, cop=cop)
        if isinstance(drive, SpinDrive):
            ends = ends_onward(task.object, segment, measured.X_WB, drive.X_BV)
            radius = math.dist(contact.point, drive.X_BV.position)
            spin = TwistPath.between(ends, radius)
            return Course((contact,), replace(drive, car=car), spin)
        steered = _steered_by(drive, car, measured.identified)
        ends = ends_onward(task.object, segment, measured.X_WB, steered.X_BV)
        path = steered_path(ends, steered, measured.longest)
        return Course((contact,), steered, path)


def _steered(
    task: Task, straight: Sequence[Choice], least: float
) -> list[Draft | Choice]:
    """Return choices to be planned with the axle of their turns, in order; refused
    those that are steered like a unicycle by less than ``least`` [rad].
    """

    def make(choice: Choice, evaluated: bool) -> list[Choice]:
        """Return a choice as it is steered."""
        return [with_turns(task, choice, least) if evaluated else choice]

    return [
        Draft(float(i), partial(make, choice), ordered=True)
        if choice.feasible
        else choice
        for i, choice in enumerate(straight)
    ]


def _steered_by(
    drive: SteeredDrive, car: Unicycle, identified: Identified | None
) -> SteeredDrive:
    """Return a drive with ``car``, or with the axle that was identified."""
    max_friction = drive.max_friction
    if identified is not None:
        car = car.with_axle(identified.axle, identified.effective_wheelbase)
        max_friction = identified.drag
    if isinstance(drive, TurnDrive):
        drive = replace(drive, X_BV=car.X_BV)
    return replace(drive, car=car, max_friction=max_friction)


MODE = PressSlide()
allocator = MODE.allocator
