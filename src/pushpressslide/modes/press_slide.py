"""Mode press_slide: one arm presses on top and slides the object, driven as a unicycle
about its virtual axle (docs/mechanics.md, sections 2 and 4).

The line through centre of pressure and contact is the heading axis. If the object is
pulled, the contact leads; if it is pushed, the contact follows; in a spin, the force is
across the axis. The friction disc under the tip has no preferred direction, so all
three are possible with any contact that the press holds. If no path of a single vehicle
leads to the goal, a manoeuvre is tried: turns by forces at several angles.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import RefusedError
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.center import CenterIdentifier, doubt
from pushpressslide.identification.online import (
    OFF,
    OFF_RHO,
    AxleEstimate,
    AxleIdentifier,
    window_of,
)
from pushpressslide.identification.parameter_estimates import dragged_friction
from pushpressslide.mechanics.pressing import pressed_cop
from pushpressslide.modes.base import (
    ENOUGH,
    NO_PLACEMENT,
    Allocator,
    Candidate,
    Continuation,
    Feasibility,
    Measured,
    Mode,
    ranking_key,
    search,
)
from pushpressslide.planning.either_arm import either_arm, nearest_arms
from pushpressslide.planning.pressed.driven import (
    DIRECTIONS,
    driven_anew,
    steered_path,
    vehicle_choices,
    with_turns,
)
from pushpressslide.planning.pressed.manoeuvre import (
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed.manoeuvre_choices import manoeuvre_choices
from pushpressslide.planning.pressed.placements import (
    PressPlacements,
    press_placements,
)
from pushpressslide.planning.pressed.resumed_turns import (
    pressed_at,
    resume_turns,
    run_in_missed,
)
from pushpressslide.planning.segments import remaining_ends
from pushpressslide.robots.contact_reach import UNKNOWN, span_refusal
from pushpressslide.rom.drives import (
    ORIGIN,
    PressedDrive,
    SpinDrive,
    SteeredDrive,
    TurnDrive,
    UnicycleDrive,
)
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, UnicycleTracker

# [rad] largest turns of the object in a retry: the arm keeps its contact, and a larger
# turn leaves its joints less room
RETRY_SWINGS = (1.0, 2.0, math.pi, math.inf)


class PressSlide(Mode[UnicycleDrive | TurnDrive | SpinDrive]):
    """One arm presses on top and slides the object."""

    name = "press_slide"
    arms = 1
    reduced_model = "unicycle / car / forklift"
    tracking_point = "virtual axle"
    evaluation_cost = 4
    cop_steering = True
    carries_weight = False
    pushed_faces = 0
    drives = (UnicycleDrive, TurnDrive, SpinDrive)
    vehicles = tuple(DIRECTIONS)

    def candidate_contacts(self, query: MotionQuery) -> Sequence[Contact]:
        """All places where the object may be pressed."""
        try:
            return press_placements(query).contacts
        except RefusedError:
            return ()

    def choices(
        self,
        query: MotionQuery,
        enough: int = ENOUGH,
        feasibility: Feasibility | None = None,
    ) -> list[Choice]:
        """Choices, with feasible and quick ones first.

        Alternatives are evaluated in order until one of them has a feasible choice.
        """
        try:
            placements = press_placements(query)
        except RefusedError as error:
            return [Choice(self.name, refusal=error.refusal)]
        feasibility = feasibility or Feasibility(query)
        contacts = _those_held(placements.contacts, feasibility.held_contacts)
        if not contacts:
            return [Choice(self.name, refusal=NO_PLACEMENT)]
        if feasibility.arms:
            near = _reached if query.from_search else _in_span
            contacts = tuple(c for c in contacts if near(feasibility, c))
        if not contacts:
            (arm, *_) = nearest_arms(query.scene, query.body_ends, ORIGIN)
            nearest = replace(placements.contacts[0], arm=arm)
            beyond = span_refusal(query.scene, nearest, query.body_ends)
            return [Choice(self.name, refusal=beyond or UNKNOWN)]
        placements = replace(placements, contacts=contacts)
        found: dict[str, list[Choice]] = {}
        for kind, choices in self._alternatives(feasibility, placements, enough):
            found[kind] = choices
            if any(choice.feasible for choice in choices):
                break
        else:
            found = {
                k: _name_believed_rho(query.scene.rho, choices)
                for k, choices in found.items()
            }
        manoeuvres = found.get("manoeuvre", [])
        if "vehicle" not in found:
            return manoeuvres
        return sorted([*found["vehicle"], *manoeuvres], key=ranking_key)

    def _alternatives(
        self, feasibility: Feasibility, placements: PressPlacements, enough: int
    ) -> Iterator[tuple[str, list[Choice]]]:
        """Yield the alternatives in order: manoeuvres and paths of a vehicle that
        steers well, then paths of any vehicle.

        Manoeuvres come first unless the task prescribes the contacts.
        """

        query = feasibility.query

        def manoeuvres() -> list[Choice]:
            """Manoeuvre choices."""
            return manoeuvre_choices(
                query, self.name, placements, enough, feasibility.refusal
            )

        def vehicles(min_angle: float) -> list[Choice]:
            """Choices of vehicles that can be steered by ``min_angle`` [rad] or more."""
            return search(_steered(query, straight, min_angle), enough, feasibility)

        free = query.motion.vehicle is None and query.tool is None
        given = bool(query.motion.contacts)
        if free and not given:
            yield "manoeuvre", manoeuvres()
        straight = vehicle_choices(query, self.name, placements)
        straight.sort(key=ranking_key)
        yield "vehicle", vehicles(margins.CORRECTING)
        if free and given:
            yield "manoeuvre", manoeuvres()
        yield "vehicle", vehicles(0.0)

    def tracker(
        self, query: MotionQuery, segment: Segment
    ) -> UnicycleTracker | PivotTracker:
        """Look-ahead law for a segment, or the law of a spin."""
        drive = self.drive_of(segment)
        if isinstance(drive, SpinDrive):
            return PivotTracker(drive)
        return UnicycleTracker(LookAheadAlignment(drive.look_ahead, math.inf), drive)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m]. ``rho`` [m] weights moment
        errors (default: half the lever).
        """
        (contact,) = contacts
        if rho is None:
            rho = 0.5 * math.hypot(*contact.point) or 1.0
        return one_press_allocator(contact.point, contact.load, friction, rho, cop)

    def identifier(self, query: MotionQuery, segment: Segment) -> AxleIdentifier:
        """Online identifier of the virtual axle."""
        drive = self.drive_of(segment)
        car = drive.car
        predicted = AxleEstimate(
            car.axle, abs(car.effective_wheelbase), drive.max_friction
        )
        stiffness = None if isinstance(drive, SpinDrive) else drive.stiffness
        ex, ey = car.axis
        cop = car.cop[0] * ex + car.cop[1] * ey
        off = OFF if query.scene.rho is None else OFF_RHO
        return AxleIdentifier(
            car.X_BV.yaw,
            predicted,
            car.lever,
            stiffness,
            cop,
            off,
            window_of(query.sensing, segment.profile.speed, abs(car.lever)),
        )

    def center_identifier(
        self, query: MotionQuery, segment: Segment, center: Point = ORIGIN
    ) -> CenterIdentifier | None:
        """Online identifier of the CoM across the line to the contact.

        None for a spin and for a press at the CoM. Also None if rho is given, since its
        error may exceed the identifier's tolerance.
        """
        drive = self.drive_of(segment)
        (contact,) = segment.contacts
        if isinstance(drive, SpinDrive) or contact.point == ORIGIN:
            return None
        if query.scene.rho is not None:
            return None
        scene = query.scene
        car = drive.car
        reach = math.dist(drive.X_BV.position, car.cop)
        height = scene.body.shape.top_height
        return CenterIdentifier(
            drive.X_BV,
            contact.point,
            center,
            doubt(scene, contact.point, abs(car.lever), reach, height),
            window_of(query.sensing, segment.profile.speed, math.hypot(*contact.point)),
        )

    def retry(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> tuple[Segment, ...]:
        """Segments that back up and then lead to the goal. Empty for a spin, or if the
        object would tip.
        """
        (contact,) = measured.contacts
        center = measured.estimates.center
        query = dragged(query, contact, measured.estimates.drag)
        if center != ORIGIN:
            there = _seen_from(query, (segment,), measured)
            made = self._retry(there.query, there.segments[0], there.measured)
            return _shifted(made, center)
        return self._retry(query, segment, measured)

    def _retry(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> tuple[Segment, ...]:
        drive = self.drive_of(segment)
        if isinstance(drive, SpinDrive):
            return ()
        X_WB = measured.X_WB
        here = replace(query, start=X_WB.compose(query.X_GB.inverse()))
        (contact,) = measured.contacts
        if isinstance(drive, UnicycleDrive):
            choice = driven_anew(here, self.name, contact, drive)
            if choice.feasible:
                return choice.segments
        for swing in RETRY_SWINGS:
            found = pressed_manoeuvres(here, X_WB, measured.contacts, swing)
            if found:  # the quickest with the contact that the arm has
                return found[0].choice(here, self.name).segments
        return ()

    def replan(
        self, query: MotionQuery, segments: Sequence[Segment], measured: Measured
    ) -> tuple[Segment, ...]:
        """Continuation of the first of ``segments``, or of all turns of a manoeuvre."""
        center = measured.estimates.center
        if center != ORIGIN:
            there = _seen_from(query, segments, measured)
            return _shifted(self.replan(*there), center)
        (contact,) = measured.contacts
        if contact.point == ORIGIN:
            return ()
        query = dragged(query, contact, measured.estimates.drag)
        drive = segments[0].drive
        if isinstance(drive, SpinDrive) and measured.estimates.axle is not None:
            spun = self._spun(query, segments, measured)
            if spun:
                return spun
        if isinstance(drive, TurnDrive) and not drive.last:
            mine, others = _of_first_leg(segments)
            turns = resume_turns(
                query.scene, query.motion.speed, mine, measured.X_WB, contact
            )
            return (*turns, *others) if turns[0].path.length <= measured.longest else ()
        return super().replan(query, segments, measured)

    def misses(
        self, query: MotionQuery, segments: Sequence[Segment], X_WB: Pose2
    ) -> bool:
        """Whether the turns of a manoeuvre end too far from its run-in."""
        mine, _ = _of_first_leg(segments)
        if not isinstance(mine[-1].drive, TurnDrive):
            return False
        radius = query.body.radius
        return run_in_missed(mine, X_WB, radius) > margins.MISSED * radius

    def _spun(
        self, query: MotionQuery, segments: Sequence[Segment], measured: Measured
    ) -> tuple[Segment, ...]:
        """Manoeuvre in place of a spin whose pivot is not measured where it was
        planned. Empty if the spin still leads to the goal.
        """
        first, *others = segments
        drive = first.drive
        assert isinstance(drive, SpinDrive)
        X_BV = _pivot(drive, measured.estimates.axle)
        start, goal = remaining_ends(query.body, first, measured.X_WB, X_BV)
        if math.dist(start.position, goal.position) <= query.tolerance.position:
            return ()
        X_WB = measured.X_WB
        there = replace(query, goal=first.goal)
        manoeuvres = pressed_manoeuvres(there, X_WB, measured.contacts)
        if not manoeuvres:
            return ()
        pieces = manoeuvres[0].choice(there, self.name).segments
        return (*(replace(segment, leg=first.leg) for segment in pieces), *others)

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation with the measured contact and the identified axle."""
        (contact,) = measured.contacts
        drive = self.drive_of(segment)
        if isinstance(drive, TurnDrive):
            (segment,) = pressed_at(
                query.scene, query.motion.speed, (segment,), contact
            )
            drive = self.drive_of(segment)
        cop = pressed_cop(contact.point, contact.load, query.scene.weight_on)
        car = replace(drive.car, contact=contact.point, cop=cop)
        if isinstance(drive, SpinDrive):
            X_BV = _pivot(drive, measured.estimates.axle)
            ends = remaining_ends(query.body, segment, measured.X_WB, X_BV)
            radius = math.dist(contact.point, X_BV.position)
            spin = TwistPath.between(ends, radius)
            return Continuation((contact,), replace(drive, car=car, X_BV=X_BV), spin)
        if isinstance(drive, UnicycleDrive) and query.scene.rho is not None:
            car = replace(car, rho=query.scene.rho)
        steered = _steered_by(drive, car, measured.estimates.axle)
        ends = remaining_ends(query.body, segment, measured.X_WB, steered.X_BV)
        path = steered_path(
            query.body, ends, steered, measured.longest, segment.arcs.turning
        )
        return Continuation((contact,), steered, path)


def _of_first_leg(
    segments: Sequence[Segment],
) -> tuple[tuple[Segment, ...], tuple[Segment, ...]]:
    """Segments of the first segment's leg, and segments of the later legs."""
    leg = segments[0].leg
    mine = tuple(segment for segment in segments if segment.leg == leg)
    return mine, tuple(segments[len(mine) :])


def _name_believed_rho(rho: float | None, choices: Sequence[Choice]) -> list[Choice]:
    """The refused choices, with a refusal that also names the believed rho, if there is
    one.
    """
    if rho is None:
        return list(choices)
    return [
        choice.refused(
            replace(refusal, text=f"{refusal.text}, with belief.rho {rho:g} m")
        )
        for choice in choices
        if (refusal := choice.refusal) is not None
    ]


def _steered(
    query: MotionQuery, straight: Sequence[Choice], min_angle: float
) -> list[Candidate | Choice]:
    """Choices planned with the axle of their turns, in order.

    A choice is refused if it can be steered like a unicycle only by less than
    ``min_angle`` [rad].
    """

    def make(choice: Choice, evaluated: bool) -> list[Choice]:
        """The choice with its steering, for each arm that may touch the object."""
        steered = with_turns(query, choice, min_angle) if evaluated else choice
        return either_arm(query.scene, query.body_ends, steered)

    return [
        Candidate(float(i), partial(make, choice), ordered=True)
        if choice.feasible
        else choice
        for i, choice in enumerate(straight)
    ]


def dragged(query: MotionQuery, contact: Contact, drag: float | None) -> MotionQuery:
    """Query with the support friction implied by the measured ``drag`` [N], if that
    contradicts the belief.

    The drag acts at another height than the contact and shifts the pressure. Friction
    therefore also shifts the axle of a turn.
    """
    if drag is None:
        return query
    scene = query.scene
    friction = dragged_friction(scene, contact.load, drag)
    if friction == scene.support.friction:
        return query
    support = replace(scene.support, friction=friction)
    return replace(query, scene=replace(scene, support=support))


class _MeasuredLeg(NamedTuple):
    """A query, its segments and the measured state, with B's origin at the identified
    CoM.
    """

    query: MotionQuery
    segments: tuple[Segment, ...]
    measured: Measured


def _seen_from(
    query: MotionQuery, segments: Sequence[Segment], measured: Measured
) -> _MeasuredLeg:
    """Query, segments and measured state with B's origin moved to the identified CoM."""
    x, y = measured.estimates.center
    back = (-x, -y)
    scene = query.scene
    gx, gy = scene.body.center_of_mass
    body = replace(scene.body, center_of_mass=(gx + x, gy + y))
    axle = measured.estimates.axle
    if axle is not None:
        drive = segments[0].drive
        assert isinstance(drive, PressedDrive)
        ex, ey = drive.car.axis
        axle = axle._replace(axle=axle.axle - x * ex - y * ey)
    estimates = measured.estimates._replace(axle=axle, center=ORIGIN)
    return _MeasuredLeg(
        replace(query, scene=replace(scene, body=body)),
        _shifted(segments, back),
        replace(
            measured,
            X_WB=measured.X_WB.compose(Pose2(x, y, 0.0)),
            contacts=tuple(contact.shifted(back) for contact in measured.contacts),
            estimates=estimates,
        ),
    )


def _shifted(segments: Sequence[Segment], offset: Point) -> tuple[Segment, ...]:
    """The ``segments`` in a body frame with its origin at -``offset`` [m] in the
    original frame. Their paths and goals stay in place.
    """
    out = []
    for segment in segments:
        drive = segment.drive
        assert isinstance(drive, PressedDrive)
        contacts = tuple(contact.shifted(offset) for contact in segment.contacts)
        out.append(replace(segment, contacts=contacts, drive=drive.shifted(offset)))
    return tuple(out)


def _pivot(drive: SpinDrive, identified: AxleEstimate | None) -> Pose2:
    """X_BV at the pivot, displaced along the heading axis to the identified axle."""
    if identified is None:
        return drive.X_BV
    X_BV = drive.X_BV
    planned = X_BV.x * math.cos(X_BV.yaw) + X_BV.y * math.sin(X_BV.yaw)
    return X_BV.compose(Pose2(identified.axle - planned, 0.0, 0.0))


def _steered_by(
    drive: SteeredDrive, car: Unicycle, identified: AxleEstimate | None
) -> SteeredDrive:
    """``drive`` with its car replaced: by a car with the ``identified`` axle, or by
    ``car`` if no axle is identified.
    """
    max_friction = drive.max_friction
    if identified is not None:
        car = car.with_axle(identified.axle, identified.effective_wheelbase)
        max_friction = identified.drag
    if isinstance(drive, TurnDrive):
        drive = replace(drive, X_BV=car.X_BV)
    return replace(drive, car=car, max_friction=max_friction)


MODE = PressSlide()
allocator = MODE.allocator


def _those_held(
    contacts: tuple[Contact, ...], held_contacts: Sequence[Contact] | None
) -> tuple[Contact, ...]:
    """The members of ``contacts`` that are among ``held_contacts``. All of them if
    ``held_contacts`` is None.
    """
    if held_contacts is None:
        return contacts
    points = [contact.point for contact in held_contacts]
    return tuple(contact for contact in contacts if [contact.point] == points)


def _reached(feasibility: Feasibility, contact: Contact) -> bool:
    """Whether any arm reaches a contact at start and goal, according to the reach
    tables.
    """
    each = (replace(contact, arm=arm) for arm in feasibility.query.scene.arms)
    return any(map(feasibility.reach_ends, each))


def _in_span(feasibility: Feasibility, contact: Contact) -> bool:
    """Whether any arm is long enough for a contact at start and goal."""
    query = feasibility.query
    each = (replace(contact, arm=arm) for arm in query.scene.arms)
    return any(span_refusal(query.scene, one, query.body_ends) is None for one in each)
