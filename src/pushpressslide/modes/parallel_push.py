"""Mode parallel_push: two arms push one face side by side (docs/mechanics.md, section
5).

By their normal forces alone they drive the object as a forward car with bounded
curvature and its axle at the centre of pressure. With equal forces they drive it as a
rear-steer car. The exact allocator combines both, and drives every twist of a cone: the
object may move sideways where a car would have to drive a loop.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from math import atan

from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.core import margins
from pushpressslide.core.motion import Motion, Vehicle
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, literal, refusal_of
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.faces import Face
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import (
    Allocator,
    Candidate,
    Continuation,
    Measured,
    Tracker,
)
from pushpressslide.modes.shared.twist_pushes import (
    TwistPushes,
    driven_by_twists,
    exact_margin,
    in_free_arms,
    largest_push,
    within_reach,
)
from pushpressslide.planning.face_placements import (
    Contacts,
    side_by_side,
    side_by_side_refusal,
)
from pushpressslide.planning.in_cone import (
    ConeGoal,
    describe_cone_margin,
)
from pushpressslide.planning.overhead import path_time
from pushpressslide.planning.pushed_car import (
    car_path,
    gentle_path,
    least_lengths,
    pushed_cars,
    run_ins,
)
from pushpressslide.planning.segments import (
    describe_points,
    remaining_ends,
    run_time,
    segment,
)
from pushpressslide.planning.side_contacts import (
    contact_height,
    push_refusal,
    pushable,
    untouchable,
)
from pushpressslide.robots.contact_reach import UNKNOWN
from pushpressslide.rom.drives import ORIGIN, CarDrive, TwistDrive
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.tracking.axle import AxleTracker
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

VEHICLES: tuple[Vehicle, ...] = ("differential", "synchronised", "mixed")
# order for motion.vehicle null: the mixed drive corrects an error in any direction at
# once, a car needs some look-aheads of straight path
EITHER: tuple[Vehicle, ...] = ("mixed", "differential")

Cars = Callable[[Face, bool], dict[Contacts, PushedCar]]


class ParallelPush(TwistPushes):
    """Two arms push one face side by side."""

    name = "parallel_push"
    arms = 2
    reduced_model = "rear-steer car / forward differential car"
    tracking_point = "virtual front axle / centre of pressure"
    cop_steering = False
    carries_weight = False
    pushed_faces = 1
    drives = (CarDrive, TwistDrive)
    vehicles = VEHICLES

    def candidates(self, query: MotionQuery) -> list[Candidate | Choice]:
        """One candidate for each pair of contacts on each face."""
        scene = query.scene
        motion = query.motion
        height = contact_height(scene, motion)
        pushed = pushable(scene, height, motion.face)
        if not pushed:
            return [Choice(self.name, refusal=untouchable(scene, height))]
        flat = [face for face in pushed if face.flat]
        if not flat:
            text = "there is no flat face for two tips side by side"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed = [
            (face, contacts)
            for face in flat
            for contacts in within_reach(query, side_by_side(scene, face, height))
        ]
        if not placed:
            return [Choice(self.name, refusal=UNKNOWN)]

        @cache
        def cars(face: Face, synchronised: bool) -> dict[Contacts, PushedCar]:
            """Car for each pair of contacts on a face."""
            contacts = [pair for other, pair in placed if other == face]
            halves = [(face, 0.5 * math.dist(a.point, b.point)) for a, b in contacts]
            made = pushed_cars(scene, motion, halves, synchronised)
            return dict(zip(contacts, made, strict=True))

        return [
            Candidate(
                _least_time(query, face),
                partial(self._push, query, face, contacts, cars),
                contacts=contacts,
            )
            for face, contacts in placed
        ]

    def _push(
        self,
        query: MotionQuery,
        face: Face,
        contacts: Contacts,
        cars: Cars,
        evaluated: bool,
    ) -> list[Choice]:
        """Evaluate contacts on a face, without a check of the arms' reach: one choice
        for each assignment to arms.
        """
        places = describe_points(contact.point for contact in contacts)
        choice = Choice(self.name, f"face {face.index} at {places}", contacts)
        if not evaluated:
            return [replace(choice, time=_least_time(query, face))]
        refusal = side_by_side_refusal(query, face, contacts)
        if refusal is not None:
            return [choice.refused(refusal)]
        reason = []
        for kind in _vehicles(query.motion):
            try:
                if kind == "mixed":
                    driven = self._by_twists(query, choice)
                else:
                    car = cars(face, kind == "synchronised")[contacts]
                    driven = self._as_car(query, choice, car)
            except ValueError as error:
                driven = choice.refused(refusal_of(error, "tipping"))
            if driven.segments:
                driven = replace(driven, label=f"{choice.label}, {kind}")
                return (
                    in_free_arms(query.scene, driven) if driven.feasible else [driven]
                )
            reason.append(f"{kind}: {driven.refusal}")
        return [choice.refused(Refusal("no_path", literal("; ".join(reason))))]

    def _as_car(self, query: MotionQuery, choice: Choice, car: PushedCar) -> Choice:
        """``choice`` with a segment on which the contacts drive the object as a car.

        Raises ValueError if the car has no path to the goal.
        """
        curvature = query.motion.curvature_margin * car.tightest
        path = car_path(query, car, curvature)
        tightest = max((abs(k) for k, _ in path.sections), default=0.0)
        mu = query.scene.contact_friction
        margin = atan(mu) - atan(car.effective_wheelbase * tightest)
        drive = CarDrive(car, query.scene.max_friction(), curvature)
        one_segment = segment(
            query, self.name, choice.contacts, drive, path, cone_margin=margin
        )
        summary = (
            f"path {path.length:.3f} m, {tightest / car.tightest:.2f} of the tightest "
            "curve used"
        )
        time = run_time(query.motion, (one_segment,))
        # on the tightest curve of a car only one contact pushes
        push = 0.5 * (1.0 + tightest / car.tightest) * drive.max_friction
        refusal = push_refusal(push, query.limits, drive.max_friction)
        driven = replace(choice, segments=(one_segment,), time=time, summary=summary)
        return driven.refused(refusal)

    def _by_twists(self, query: MotionQuery, choice: Choice) -> Choice:
        """``choice`` with a path made of twists in the cone of its contacts."""
        cone_goal = ConeGoal.between(query.body_ends, query.body.radius)
        height = choice.contacts[0].height
        surface = push_surface(query.scene, height, Twist(*cone_goal.direct))
        cone = TwistCone(choice.contacts, query.scene.least_contact_friction, surface)
        path = cone_goal.path(cone, exact_margin(query.scene, choice.contacts))
        if path is not None:
            friction = query.scene.contact_friction
            allocate = self.allocator(choice.contacts, friction, surface.rho)
            push = largest_push(path, cone, allocate)
            refusal = push_refusal(push, query.limits, surface.max_force)
            return driven_by_twists(query, choice, path, cone).refused(refusal)
        margin = cone.angle(*cone_goal.direct)
        text = (
            f"the direct path is {describe_cone_margin(margin)}; "
            f"no curved path of {cone_goal.longest:.2f} m"
        )
        return choice.refused(
            Refusal("outside_cone", text, margin, margins.CONE_MARGIN, "rad")
        )

    def tracker(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Tracking law of a segment: look-ahead alignment for a car, the holonomic law
        for twists.
        """
        drive = segment.drive
        if not isinstance(drive, CarDrive):
            return super().tracker(query, segment)
        look_ahead = query.motion.look_ahead
        if look_ahead is None:
            shortest = margins.ARM.shortest(segment.profile.speed)
            look_ahead = margins.CAR_LOOK_AHEAD * shortest
        tightest = margins.STEERING_SHARE * drive.car.tightest
        law = LookAheadAlignment(look_ahead, tightest)
        return AxleTracker(law, drive.car, drive.max_friction)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM. ``rho`` [m]
        weights moment errors (default: half the distance between the contacts).
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        if rho is None:
            rho = 0.5 * math.dist(*points)
        return parallel_push_allocator(points, contacts[0].normal, friction, rho)

    def retry(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> tuple[Segment, ...]:
        """Segment for the remaining displacement. Empty if the displacement is outside
        the cone, and for a car, which cannot back up.
        """
        if isinstance(segment.drive, CarDrive):
            return ()
        return super().retry(query, segment, measured)

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation with the measured contacts. The object's reduced model remains
        as planned.
        """
        drive = segment.drive
        if not isinstance(drive, CarDrive):
            return super().continue_from(query, segment, measured)
        ends = remaining_ends(query.body, segment, measured.X_WB, drive.X_BV)
        straight = run_ins(query.motion)
        path = gentle_path(
            ends, drive.curvature, measured.longest, straight, segment.arcs.turning
        )
        return Continuation(measured.contacts, drive, path)


def _vehicles(motion: Motion) -> tuple[Vehicle, ...]:
    """Vehicles as which the object may be driven, in the order to try them."""
    return EITHER if motion.vehicle is None else (motion.vehicle,)


def _least_time(query: MotionQuery, face: Face) -> float:
    """Lower bound [s] of the time of a push on a face.

    The push is assumed to lead almost straight to the goal.
    """
    by_twists, as_car = least_lengths(query.body_ends, query.body.radius, face)
    lengths = {"mixed": by_twists, "differential": as_car, "synchronised": as_car}
    least = min(lengths[kind] for kind in _vehicles(query.motion))
    return path_time(query.motion, least)


MODE = ParallelPush()
allocator = MODE.allocator
