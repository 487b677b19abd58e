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
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from math import atan

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.path import ArcPath, advance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.task import GRAVITY, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import friction_use, press_loads, pressed_cop
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
    run_time,
    search,
    segment,
    tool_load,
)
from pushpressslide.planning.held_twist import EDGE
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pressed.manoeuvre import (
    CORRECTED,
    CORRECTING,
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed.onward import onward, pressed_at
from pushpressslide.planning.pressed.ranking import by_time, soonest
from pushpressslide.planning.pressed.turns import steering_of
from pushpressslide.planning.pressed.vehicle import (
    BACK_UPS,
    LOOP,
    PLANNED,
    RUN_INS,
    SHORT_RUN_INS,
    SWING,
    PressedVehicle,
    axle_ahead,
    backing_up,
    press_of,
    pressed_vehicle,
    turns,
    way_back,
    way_to,
)
from pushpressslide.planning.run_in import gentlest
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

# half widths inside the base's edge from which on the object is driven at full speed
SAFE_MARGIN = 0.5
TOOL_SKEW = math.radians(2.0)  # of the motion from the normal of a tool's face
# [rad] that a retry may turn the object: the arm keeps its contact, so its joint range
# limits it
MAX_RETRY_YAW = 1.0
# share of the speed when pushed: what is ahead of the contact swings more
PUSHED_SPEED = 0.8
# whether a vehicle is driven backward, with the contact behind its axle
DIRECTIONS = {
    "unicycle": (False, True),
    "car": (False,),
    "forklift": (True,),
    "pivot": (False,),
}


@dataclass(frozen=True, slots=True)
class _Press:
    """One contact with its load, and how it drives the object."""

    contact: Contact
    backward: bool
    angle: float = 0.0  # [rad] of the force in turns
    steepest: float = math.inf  # [rad] that it may be steered with
    back_ups: Sequence[float] = BACK_UPS  # [m] to go back straight first, to try


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
    walls = False
    drives = (UnicycleDrive, TurnDrive, SpinDrive)

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
                press = _Press(replace(contact, load=load), backward)
                choice = self._driven(task, press)
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
        return [self._driven(task, _Press(contact, backward, angle, steering))]

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

    def _driven(self, task: Task, press: _Press) -> Choice:
        """Judge one press and direction but for the arm's reach."""
        contact = press.contact
        backward = press.backward
        pivots = task.motion.vehicle == "pivot"
        how = "pushed" if backward else "pulled"
        if pivots:
            how = "turned on the spot"
        x, y = contact.point
        choice = Choice(self.name, f"{how} at ({x:.3f}, {y:.3f})", (contact,))
        if not inside_top(task.object, contact.point, EDGE):
            text = "the contact must be {allowed:mm.0f} inside the object's top"
            return choice.refused(Refusal("off_top", text, None, EDGE, "m"))
        try:
            vehicle = pressed_vehicle(
                task, contact, backward, press.angle, press.steepest
            )
            back = None if pivots else way_back(task, vehicle.press, not backward)
            pushed = _tool_drag(task, vehicle)
            # where it cannot go back there is no retry: only with a long run-in
            returns = back is not None
            segments: Sequence[Segment] = (
                [self._spin(task, contact, vehicle)]
                if pivots
                else self._drive(task, press, vehicle, returns)
            )
        except ValueError as error:
            return choice.refused(refusal_of(error, "tipping"))
        belief = task.believed
        mu = belief.contact_friction
        used = friction_use(
            contact.load, vehicle.press.weight, belief.support_friction, mu, pushed
        )
        margin = atan(mu) - atan(used * mu)
        segments = tuple(replace(piece, cone_margin=margin) for piece in segments)
        last = segments[-1]
        distance = math.dist(vehicle.X_BV.position, vehicle.car.cop)
        merits = (
            f"{contact.load:.1f} N, path {last.path.length:.3f} m, virtual axle "
            f"{1e3 * distance:.0f} mm from the centre of pressure, {used:.2f} of the "
            "tip's friction used"
        )
        for piece in segments[:-1]:
            merits += f", {piece.path.length:g} m back first"
        time = run_time(task, segments, pressed=True)
        return replace(choice, segments=segments, time=time, merits=merits)

    def _spin(self, task: Task, contact: Contact, vehicle: PressedVehicle) -> Segment:
        """Return the segment that turns the object on the spot. Raises RefusedError
        where the goal is elsewhere.
        """
        X_BV = vehicle.X_BV
        start, goal = _ends(task, X_BV)
        path = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position))
        moved = math.dist(start.position, goal.position)
        allowed = task.tolerance.position
        if moved > allowed:
            text = (
                "the point about which it turns has to stay in its place, from start "
                "to goal it moves by {figure:mm.1f}, allowed {allowed:mmg}"
            )
            raise RefusedError(Refusal("pin_moves", text, moved, allowed, "m"))
        drive = SpinDrive(vehicle.car, _max_friction(task, contact), X_BV)
        speed = task.motion.speed * min(1.0, vehicle.room / SAFE_MARGIN)
        return segment(task, self.name, (contact,), drive, path, speed=speed)

    def _drive(
        self, task: Task, press: _Press, vehicle: PressedVehicle, returns: bool
    ) -> tuple[Segment, ...]:
        """Return the segments of a path of one vehicle; ``returns``: it can go back.
        Raises RefusedError where there is only a loop.
        """
        motion = task.motion
        car = vehicle.car
        contact = press.contact
        start, goal = _ends(task, vehicle.X_BV)
        look_ahead = motion.look_ahead or min(max(0.35 * car.length, 0.04), 0.10)
        straight = 0.0 if task.tool is None else task.tool.straight
        tried = RUN_INS if returns else RUN_INS[:2]
        run_ins = [straight + k * look_ahead for k in tried]
        back_ups = press.back_ups if returns else (0.0,)
        way = way_to(start, goal, vehicle, run_ins, back_ups)
        # where a loop is too long a manoeuvre is better, if one is allowed
        loop = LOOP if motion.vehicle or task.tool else 0.0
        if way.too_long > loop:
            text = (
                f"only by a loop of {way.path.length:.2f} m, {{figure:m.2f}} too long, "
                "allowed {allowed:mg}"
            )
            raise RefusedError(Refusal("loop", text, way.too_long, loop, "m"))
        speed = motion.speed * min(1.0, vehicle.room / SAFE_MARGIN)
        speed *= PUSHED_SPEED if press.backward else 1.0
        speed *= min(1.0, SWING / (car.length * way.curvature))
        drive = UnicycleDrive(
            car,
            _max_friction(task, contact),
            vehicle.steepest,
            look_ahead,
            way.curvature,
            way.run_in,
        )
        piece = segment(task, self.name, (contact,), drive, way.path, speed=speed)
        if not way.back_up:
            return (piece,)
        return (backing_up(task, vehicle, piece, way.back_up), piece)

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
        predicted = Identified(axle_ahead(car), abs(car.reach), drive.max_friction)
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
            press = _Press(
                contact,
                drive.car.backward,
                PLANNED * steepest,
                steepest,
                BACK_UPS[1:],
            )
            choice = self._driven(here, press)
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
        weight = task.believed.mass * GRAVITY
        cop = pressed_cop(contact.point, contact.load, weight)
        assert isinstance(drive, UnicycleDrive | TurnDrive | SpinDrive)
        car = replace(drive.car, contact=contact.point, cop=cop)
        if isinstance(drive, SpinDrive):
            start, goal = _ends_from(task, segment, X_WB, drive.X_BV)
            radius = math.dist(contact.point, drive.X_BV.position)
            spin = TwistPath.between((start, goal), radius)
            course = Course(contacts, replace(drive, car=car), spin)
        else:
            steered = _steered_by(drive, car, identified)
            path = _steered_path(task, segment, X_WB, steered, longest)
            course = Course(contacts, steered, path)
        return course if course.path.length <= longest else None


def _placements(task: Task) -> _Placements:
    """Return where and how hard to press. Raises RefusedError where no press holds."""
    belief = task.believed
    motion = task.motion
    loads = press_loads(
        belief.mass * GRAVITY,
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


def _max_friction(task: Task, contact: Contact) -> float:
    """Friction of the support [N] under a press."""
    belief = task.believed
    return belief.support_friction * (belief.mass * GRAVITY + contact.load)


def _tool_drag(task: Task, vehicle: PressedVehicle) -> float:
    """Return what a body pushed by the object adds to the drag [N]. Raises RefusedError
    where the object drives askew to its pushing face.
    """
    drag, skew = tool_load(task, vehicle.X_BV.yaw)
    if skew > TOOL_SKEW:
        text = (
            "it drives {figure:deg.1f} off the normal of tool.face, allowed "
            "{allowed:degg}"
        )
        raise RefusedError(Refusal("tool_skew", text, skew, TOOL_SKEW, "rad"))
    return drag


def _ends(task: Task, X_BV: Pose2) -> tuple[Pose2, Pose2]:
    """Return V at the task's start and goal."""
    X_GB = task.object.X_GB
    return task.start.compose(X_GB).compose(X_BV), task.goal.compose(X_GB).compose(X_BV)


def _ends_from(
    task: Task, segment: Segment, X_WB: Pose2, X_BV: Pose2
) -> tuple[Pose2, Pose2]:
    """Return V at the object's pose and at a segment's goal."""
    goal = segment.goal.compose(task.object.X_GB).compose(X_BV)
    return X_WB.compose(X_BV), goal


def _steered_by(
    drive: SteeredDrive, car: Unicycle, identified: Identified | None
) -> SteeredDrive:
    """Return a drive with ``car``, or with the axle that was identified."""
    max_friction = drive.max_friction
    if identified is not None:
        rho = math.sqrt(identified.reach * abs(car.lever))
        car = replace(car, rho=rho, shift=0.0)
        car = replace(car, shift=identified.axle - axle_ahead(car))
        max_friction = identified.drag
    if isinstance(drive, TurnDrive):
        drive = replace(drive, X_BV=car.X_BV)
    return replace(drive, car=car, max_friction=max_friction)


def _steered_path(
    task: Task, segment: Segment, X_WB: Pose2, drive: SteeredDrive, longest: float
) -> MotionPath:
    """Return the gentlest path of ``drive`` to a segment's goal; straight ahead where
    steering along a run-in is enough.
    """
    start, goal = _ends_from(task, segment, X_WB, drive.X_BV)
    ahead, left = goal.unapply(start.position)
    if isinstance(drive, TurnDrive) and ahead < 0.0 and abs(left) < CORRECTED:
        return ArcPath(advance(goal, 0.0, ahead), ((0.0, -ahead),))
    car = drive.car
    tightest = math.tan(PLANNED * drive.steepest) / abs(car.reach)
    run_ins = [k * drive.look_ahead for k in SHORT_RUN_INS]
    return gentlest(start, goal, turns(car, tightest), run_ins, longest)[2]


MODE = PressSlide()
allocator = MODE.allocator
