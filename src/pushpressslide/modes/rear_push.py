"""Mode rear_push: one arm pushes a side face, and the object moves as a rear-steer car
tracked at its virtual front axle (docs/mechanics.md, section 3).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from pushpressslide.allocation.allocator import Allocator
from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.core import margins
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, refusal_of
from pushpressslide.core.scene import Scene
from pushpressslide.identification.center import CenterIdentifier, doubt
from pushpressslide.identification.drag import DragIdentifier
from pushpressslide.identification.online import (
    OFF_RHO,
    AxleEstimate,
    AxleIdentifier,
    window_of,
)
from pushpressslide.mechanics.faces import Face
from pushpressslide.modes.base import Candidate, Continuation, Measured, Mode
from pushpressslide.planning.either_arm import either_arm
from pushpressslide.planning.nudge import Nudge, nudge
from pushpressslide.planning.rear_car import (
    HARDER,
    cone_margin,
    contact_refusal,
    resume_route,
    route,
    shortest_length,
    turning_refusal,
)
from pushpressslide.planning.rear_car_fit import FittedFace, fitted_faces
from pushpressslide.planning.segments import (
    describe_points,
    remaining_ends,
    run_time,
    segment,
)
from pushpressslide.planning.side_contacts import (
    drag_refusal,
    lone_contact_height,
    pushable,
    side_contact,
    untouchable,
)
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_car import RearPushTracker
from pushpressslide.tracking.rear_stanley import rear_stanley

Drives = Mapping[float, RearSteerDrive]
"""Drives of a face's cars. Each key is the factor by which the paths of a car turn
harder than planned.
"""


NUDGED_AT = (0.25, 0.5, 1.0)
"""Contacts of short pushes, as shares of the way from a face's foot to its ends."""


class RearPush(Mode[RearSteerDrive]):
    """One arm pushes a side face from behind."""

    name = "rear_push"
    arms = 1
    reduced_model = "rear-steer car"
    tracking_point = "virtual front axle"
    cop_steering = False
    carries_weight = False
    pushed_faces = 1
    drives = (RearSteerDrive,)

    def candidate_contacts(self, query: MotionQuery) -> list[Contact]:
        """Midpoints of the faces that can be pushed."""
        scene = query.scene
        height = lone_contact_height(scene, query.motion)
        arm = scene.arms[0]
        return [
            Contact(arm, "side", face.foot, face.normal, height)
            for face in pushable(scene, height, query.motion.face)
        ]

    def least_time(self, query: MotionQuery) -> float:
        """Time [s] at full speed along the shortest path that a car can drive, over all
        faces.

        Infinite if no face has a car.
        """
        lengths = [
            shortest_length(query.body_ends, drive)
            for fitted in fitted_faces(query.scene, query.motion)
            for drive in _drives(query.scene, fitted).values()
        ]
        return min(lengths, default=math.inf) / query.motion.speed

    def candidates(self, query: MotionQuery) -> list[Candidate | Choice]:
        """One candidate per face."""
        height = lone_contact_height(query.scene, query.motion)
        if not pushable(query.scene, height):
            return [Choice(self.name, refusal=untouchable(query.scene, height))]
        return [
            Candidate(0.0, partial(self._push, query, fitted), contacts=(contact,))
            for fitted, contact in zip(
                fitted_faces(query.scene, query.motion),
                self.candidate_contacts(query),
                strict=True,
            )
        ]

    def nudges(self, query: MotionQuery) -> list[Candidate]:
        """One candidate for each place of each face. A push beside the line through the
        CoM turns the object whatever the friction.
        """
        height = lone_contact_height(query.scene, query.motion)
        arm = query.scene.arms[0]
        return [
            Candidate(0.0, partial(self._nudge, query, fitted, contact))
            for fitted in fitted_faces(query.scene, query.motion)
            for contact in _nudged_places(query, fitted.face, arm, height)
        ]

    def _nudge(
        self,
        query: MotionQuery,
        fitted: FittedFace,
        contact: Contact,
        evaluated: bool,
    ) -> list[Choice]:
        """Evaluate a short push at a ``contact``, without a check of the arms' reach."""
        scene = query.scene
        face = fitted.face
        label = f"short push on face {face.index} at {describe_points([contact.point])}"
        choice = Choice(self.name, label, (contact,))
        refusal = drag_refusal(query, (face,), 1, contact.height) or fitted.refusal
        if refusal is not None or not fitted.cars:
            return [choice.refused(refusal)]
        planned, shift = fitted.cars[HARDER[-1]]
        try:
            car = replace(
                planned, contact=contact.point, normal=contact.normal, bounds=None
            )
        except ValueError as error:
            return [choice.refused(refusal_of(error, "offset_contact"))]
        drive = RearSteerDrive(
            car,
            scene.max_friction(),
            shift,
            curvature_share=margins.NUDGE_STEERING,
            nudges=True,
        )
        start, _ = query.body_ends
        best = nudged(query, drive, start, query.touch_travel)
        if best.off > margins.NUDGED_WITHIN:
            text = "ends {figure:.2f} tolerances beside the goal, allowed {allowed:.2f}"
            refusal = Refusal("nudge", text, best.off, margins.NUDGED_WITHIN)
        unsure = _unsure_turn(scene, contact, best.path)
        if unsure > query.tolerance.yaw:
            text = "turns by {figure:deg.1f} more or less, allowed {allowed:deg.1f}"
            refusal = Refusal("nudge", text, unsure, query.tolerance.yaw)
        one_segment = nudge_segment(query, choice.contacts, drive, best)
        made = replace(
            choice,
            segments=(one_segment,),
            time=run_time(query.motion, (one_segment,)),
            summary=f"{best.path.length * 1e3:.0f} mm",
            refusal=refusal,
        )
        return either_arm(scene, query.body_ends, made)

    def _push(
        self, query: MotionQuery, fitted: FittedFace, evaluated: bool
    ) -> list[Choice]:
        """Evaluate a push on a face, without a check of the arms' reach."""
        scene = query.scene
        face = fitted.face
        height = lone_contact_height(scene, query.motion)
        contact = Contact(scene.arms[0], "side", face.foot, face.normal, height)
        label = f"face {face.index}"
        if (
            scene.body.shape.section(height).edges and not face.flat
        ):  # an arc, in one direction
            label += f" at {describe_points([face.foot])}"
        choice = Choice(self.name, label, (contact,))
        refusal = contact_refusal(query, face, height)
        refusal = refusal or fitted.refusal
        if not fitted.cars:
            return [choice.refused(refusal)]
        driven = self._driven(query, choice, _drives(scene, fitted))
        return either_arm(
            scene, query.body_ends, driven.refused(refusal or driven.refusal)
        )

    def _driven(self, query: MotionQuery, choice: Choice, drives: Drives) -> Choice:
        """Choice with the path of a car. Refused if the path turns too much."""
        best, looped = route(query, drives)
        car = best.drive.car
        low, high = car.curvature_limits
        path = best.path
        share = best.curvature_share
        margin = cone_margin(car, path)
        one_segment = segment(
            query,
            self.name,
            choice.contacts,
            replace(best.drive, curvature_share=share, run_in=best.run_in),
            path,
            speed=best.speed,
            cone_margin=margin,
        )
        loop = ", with a loop" if looped else ""
        summary = (
            f"path {path.length:.3f} m, tightest radius "
            f"{1.0 / max(high * share, -low * share):.3f} m, "
            f"steering keeps {math.degrees(margin):.1f} deg inside the friction cone"
            f"{loop}"
        )
        return replace(
            choice,
            segments=(one_segment,),
            time=run_time(query.motion, (one_segment,)),
            summary=summary,
            refusal=turning_refusal(path),
        )

    def tracker(self, query: MotionQuery, segment: Segment) -> RearPushTracker:
        """Rear Stanley law for a segment."""
        drive = self.drive_of(segment)
        car = drive.car
        low, high = car.steering_limits
        reserve = margins.STEERING_RESERVE * 0.5 * (high - low)
        bounds = (low + reserve, high - reserve)
        law = rear_stanley(car.effective_wheelbase, bounds, query.motion.tracking_gain)
        return RearPushTracker(law, car, drive.X_BV, drive.max_friction)

    def identifier(self, query: MotionQuery, segment: Segment) -> AxleIdentifier | None:
        """Online identifier of the virtual axle. None unless rho was given, since the
        rho computed from the shape is accurate enough.
        """
        if query.scene.rho is None:
            return None
        drive = self.drive_of(segment)
        car = drive.car
        ex, ey = car.axis
        cop = car.cop[0] * ex + car.cop[1] * ey
        wheelbase = car.effective_wheelbase
        return AxleIdentifier(
            car.X_BV.yaw,
            AxleEstimate(cop + wheelbase, wheelbase, drive.max_friction),
            -car.lever,
            cop=cop,
            off=OFF_RHO,
            window=window_of(query.sensing, segment.profile.speed, car.lever),
        )

    def reach(self, segment: Segment) -> float:
        """Planned distance [m] from the contact to the virtual axle."""
        drive = self.drive_of(segment)
        return math.dist(drive.X_BV.position, drive.car.contact)

    def center_identifier(
        self, query: MotionQuery, segment: Segment, center: Point = (0.0, 0.0)
    ) -> CenterIdentifier:
        """Online identifier of the CoM across the heading axis.

        An offset along the axis would only change the effective wheelbase.
        """
        drive = self.drive_of(segment)
        (contact,) = segment.contacts
        car = drive.car
        reach = car.effective_wheelbase
        return CenterIdentifier(
            drive.X_BV,
            contact.point,
            center,
            doubt(query.scene, contact.point, car.lever, reach, contact.height),
            window_of(query.sensing, segment.profile.speed, math.hypot(*contact.point)),
        )

    def drag_identifier(
        self, query: MotionQuery, segment: Segment
    ) -> DragIdentifier | None:
        """Online identifier of the drag. None if anything but friction resists."""
        if not query.resisted_by_friction_alone:
            return None
        car = self.drive_of(segment).car
        window = window_of(query.sensing, segment.profile.speed, car.lever)
        return DragIdentifier(math.sqrt(car.effective_wheelbase * car.lever), window)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m], the identified CoM. ``rho`` [m]
        weights moment errors (default: half the lever).
        """
        (contact,) = contacts
        point = (contact.point[0] - cop[0], contact.point[1] - cop[1])
        if rho is None:
            rho = 0.5 * math.hypot(*point)
        return one_contact_allocator(point, contact.normal, friction, rho)

    def retry(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> tuple[Segment, ...]:
        """A short push onwards that ends within the tolerances. No segments if there is
        none: a single push cannot back up.
        """
        car = self._measured_car(query, segment, measured)
        if car is None:
            return ()
        drive = replace(self.drive_of(segment), car=car, nudges=True)
        best = nudged(query, drive, measured.X_WB)
        if best.off > margins.NUDGED_WITHIN:
            return ()
        return (nudge_segment(query, measured.contacts, drive, best),)

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation with the measured contact and the identified CoM."""
        planned = self.drive_of(segment)
        car = self._measured_car(query, segment, measured)
        if car is None:
            return None
        contact = replace(measured.contacts[0], normal=car.normal)
        drive = replace(planned, car=car)
        if drive.nudges:
            path = nudged(query, drive, measured.X_WB).path
            return Continuation((contact,), drive, path)
        ends = remaining_ends(query.body, segment, measured.X_WB, drive.X_BV)
        turning = segment.arcs.turning
        route_on = resume_route(ends, drive, measured.longest, turning)
        return None if route_on is None else Continuation((contact,), drive, route_on)

    def _measured_car(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> RearSteerCar | None:
        """Car of the measured contact and the identified CoM. None if there is none, or
        if it has to drive straight, and cannot.

        It keeps its rho unless rho was given or the axle was identified. Its heading
        axis leads from the measured contact through the identified CoM.
        """
        planned = self.drive_of(segment)
        (contact,) = measured.contacts
        # a tip that rolls round a round side takes the normal along
        planned_at = segment.contacts[0].point
        com = query.body.center_of_mass
        section = query.body.shape.section(contact.height)
        side = section.side(planned_at, contact.normal, com)
        normal = side.normal_at(contact.point)
        old = planned.car
        try:
            center = measured.estimates.center
            rho = query.scene.rho or old.rho
            car = replace(
                old, contact=contact.point, normal=normal, cop=center, rho=rho
            )
            if measured.estimates.reach is not None:
                car = car.reaching(measured.estimates.reach - planned.shift)
        except ValueError:
            return None
        low, high = car.curvature_limits
        return car if low < 0.0 < high or planned.nudges else None


def _nudged_places(
    query: MotionQuery, face: Face, arm: int, height: float
) -> list[Contact]:
    """Contacts of an ``arm`` on a ``face`` at ``height`` [m] from which it is nudged."""
    middle = Contact(arm, "side", face.foot, face.normal, height)
    if not face.flat:
        return [middle]
    right, left = face.ends
    inset = query.scene.inset
    furthest = margins.NUDGE_BESIDE * face.depth
    ends = (max(right + inset, -furthest), min(left - inset, furthest))
    places = [middle]
    for end, side in zip(ends, (-1.0, 1.0), strict=True):
        if side * (end - face.offset) > margins.ARM.slid_side:
            offsets = (face.offset + k * (end - face.offset) for k in NUDGED_AT)
            places += [side_contact(arm, face, at, height) for at in offsets]
    return places


def nudged(
    query: MotionQuery, drive: RearSteerDrive, X_WB: Pose2, touch: float = 0.0
) -> Nudge:
    """Best short push of a ``drive`` from ``X_WB`` towards the goal. A ``touch`` moves
    the object by this length [m] before it is noticed.
    """
    low, high = drive.car.steering_limits
    middle = 0.5 * (low + high)
    half = 0.5 * drive.curvature_share * (high - low)
    right, left = (drive.car.curvature(middle + side * half) for side in (1.0, -1.0))
    return nudge(
        X_WB.compose(drive.X_BV),
        query.goal,
        query.X_GB.compose(drive.X_BV).inverse(),
        (right, left),
        query.tolerance,
        margins.NUDGE * query.body.radius,
        touch,
    )


def _unsure_turn(scene: Scene, contact: Contact, path: ArcPath) -> float:
    """Standard deviation [rad] of the turns along a ``path`` if the centre of mass may
    be anywhere in its circle: along the lever of a ``contact``, half the radius.
    """
    turns = math.fsum(abs(bend * length) for bend, length in path.sections)
    return 0.5 * turns * scene.center_error / math.hypot(*contact.point)


def nudge_segment(
    query: MotionQuery,
    contacts: Sequence[Contact],
    drive: RearSteerDrive,
    best: Nudge,
) -> Segment:
    """Segment along a short push."""
    speed = margins.NUDGE_SPEED * query.motion.speed
    margin = cone_margin(drive.car, best.path)
    led = segment(
        query, MODE.name, contacts, drive, best.path, speed=speed, cone_margin=margin
    )
    end = best.path.end.compose(drive.X_BV.inverse()).compose(query.X_GB.inverse())
    return replace(led, goal=end)


def _drives(scene: Scene, fitted: FittedFace) -> Drives:
    """Drives of the cars of a fitted face."""
    most = scene.max_friction()
    return {
        harder: RearSteerDrive(car, most, shift)
        for harder, (car, shift) in fitted.cars.items()
    }


MODE = RearPush()
allocator = MODE.allocator
