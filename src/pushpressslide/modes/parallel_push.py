"""Mode parallel_push: two arms push one face side by side (docs/mechanics.md, section
5).

By their normal forces alone they drive the object as a forward car of bounded
curvature, its axle at the centre of pressure; with equal forces, as a rear-steer car.
With both mixed, as the exact allocator can, they drive every twist of a cone: where a
car would have to turn a loop, the object may go sideways.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from math import atan

from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, literal, refusal_of
from pushpressslide.core.task import Task, Vehicle
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import (
    CROSSING,
    ENOUGH,
    Allocator,
    Course,
    Draft,
    Mode,
    search,
    with_arms,
)
from pushpressslide.planning.in_cone import (
    describe_cone_margin,
    least_cone_margin,
    path_in_cone,
)
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pushed_car import gentle_path, pushed_cars
from pushpressslide.planning.segments import run_time, segment
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
    drag_refusal,
    farthest_corner,
    least_distance,
    span,
)
from pushpressslide.rom.drives import ORIGIN, CarDrive, TwistDrive
from pushpressslide.rom.pushed_car import PushedCar
from pushpressslide.tracking.axle import AxleTracker
from pushpressslide.tracking.holonomic import HolonomicTracker
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

# [m] of the contacts from the CoM's line that are tried
HALF_WIDTHS = (0.16, 0.12, 0.09, 0.07, 0.05)
CORNER_CLEARANCE = 0.015  # [m] between a contact and a corner of the face
VEHICLES: tuple[Vehicle, ...] = ("differential", "synchronised", "mixed")
# in this order, where motion.vehicle is null: both mixed correct an error any
# way at once, a car takes some look-aheads of straight path for it
EITHER: tuple[Vehicle, ...] = ("mixed", "differential")
LOOK_AHEAD = 0.08  # [m]
STEERING_SHARE = 0.85  # of the tightest curve that steering may ask for
CONE_MARGIN = math.radians(6.0)  # that a plan keeps from its cone's edges
REPLAN_MARGIN = math.radians(2.0)  # that a plan made under way keeps
CORRECTION_SHARE = 0.9  # of the friction, that corrections may use
# times the straight distance, and [m]: a longer path has turned a loop
LOOP_RATIO = 1.25
SLACK = 0.03

Contacts = tuple[Contact, ...]
Cars = Callable[[Face, bool], dict[Contacts, PushedCar]]


class ParallelPush(Mode):
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

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the choices of all placements."""
        return search(task, self._drafts(task), enough)

    def _drafts(self, task: Task) -> list[Draft | Choice]:
        """Return one draft for each pair of contacts on each face."""
        if not task.object.shape.corners:
            text = "a cylinder has no flat face for two tips side by side"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed = [
            (face, contacts)
            for face in faces(task.object, CORNER_CLEARANCE)
            if task.motion.face in (None, face.index)
            for contacts in _placements(task, face)
        ]

        @cache
        def cars(face: Face, synchronised: bool) -> dict[Contacts, PushedCar]:
            """Return the car of each pair of contacts on a face."""
            contacts = [pair for other, pair in placed if other == face]
            halves = [(face, 0.5 * math.dist(a.point, b.point)) for a, b in contacts]
            made = pushed_cars(task, halves, contact_height(task), synchronised)
            return dict(zip(contacts, made, strict=True))

        return [
            Draft(
                _least_time(task, face), partial(self._push, task, face, contacts, cars)
            )
            for face, contacts in placed
        ]

    def _push(
        self, task: Task, face: Face, contacts: Contacts, cars: Cars, evaluated: bool
    ) -> list[Choice]:
        """Judge contacts on a face but for the arms' reach: one choice for each way to
        give them to arms.
        """
        places = " and ".join("({:.3f}, {:.3f})".format(*c.point) for c in contacts)
        choice = Choice(self.name, f"face {face.index} at {places}", contacts)
        if not evaluated:
            return [replace(choice, time=_least_time(task, face))]
        refusal = _placement_refusal(task, face, contacts)
        if refusal is not None:
            return [choice.refused(refusal)]
        why = []
        vehicle = task.motion.vehicle
        for kind in EITHER if vehicle is None else (vehicle,):
            try:
                if kind == "mixed":
                    driven = self._by_twists(task, choice)
                else:
                    car = cars(face, kind == "synchronised")[contacts]
                    driven = self._as_car(task, choice, car)
            except ValueError as error:
                driven = choice.refused(refusal_of(error, "tipping"))
            if driven.segments:
                label = f"{choice.label}, {kind}"
                return self._given_to_arms(task, replace(driven, label=label))
            why.append(f"{kind}: {driven.refusal}")
        return [choice.refused(Refusal("no_path", literal("; ".join(why))))]

    def _given_to_arms(self, task: Task, choice: Choice) -> list[Choice]:
        """Return one choice for each way to give the contacts to the arms."""
        (piece,) = choice.segments
        choice = replace(choice, time=run_time(task, choice.segments))
        poses = [
            piece.body_pose(share * piece.path.length) for share in (0.0, 0.5, 1.0)
        ]
        points = [contact.point for contact in choice.contacts]
        ways = assignments(task.scene.bases, points, poses)
        if not ways:
            return [choice.refused(CROSSING)]
        return [with_arms(choice, arms) for arms in ways]

    def _as_car(self, task: Task, choice: Choice, car: PushedCar) -> Choice:
        """Return the choice to push as a car."""
        start, goal = (
            X.compose(task.object.X_GB).compose(car.X_BV)
            for X in (task.start, task.goal)
        )
        curvature = task.motion.curvature_margin * car.tightest
        longest = LOOP_RATIO * math.hypot(goal.x - start.x, goal.y - start.y) + SLACK
        path = gentle_path(start, goal, curvature, longest)
        if path.length > longest:
            text = (
                "a loop of {figure:m.2f} with radii of "
                f"{1.0 / curvature:.3f} m and no way back, allowed {{allowed:m.2f}}"
            )
            return choice.refused(Refusal("loop", text, path.length, longest, "m"))
        belief = task.believed
        used = max((abs(k) for k, _ in path.pieces), default=0.0)
        margin = atan(belief.contact_friction) - atan(car.lead * used)
        max_friction = belief.support_friction * task.scene.weight_on
        drive = CarDrive(car, max_friction, curvature)
        piece = segment(
            task, self.name, choice.contacts, drive, path, cone_margin=margin
        )
        merits = (
            f"path {path.length:.3f} m, {used / car.tightest:.2f} of the tightest "
            "curve used"
        )
        return replace(choice, segments=(piece,), merits=merits)

    def _by_twists(self, task: Task, choice: Choice) -> Choice:
        """Return the choice to drive twists of the contacts' cone."""
        start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
        direct = screw(start, goal)
        radius = farthest_corner(task.object)
        surface = push_surface(task.scene, choice.contacts[0].height, Twist(*direct))
        cone = TwistCone(choice.contacts, task.believed.contact_friction, surface)
        longest = LOOP_RATIO * TwistPath.between((start, goal), radius).length + SLACK
        path = path_in_cone(start, goal, cone, CONE_MARGIN, radius, longest)
        if path is None:
            margin = cone.angle(*direct)
            text = (
                f"the direct way is {describe_cone_margin(margin, CONE_MARGIN)}; "
                f"no three twists of {longest:.2f} m"
            )
            refusal = Refusal("outside_cone", text, margin, CONE_MARGIN, "rad")
            return choice.refused(refusal)
        margin = least_cone_margin(path, cone)
        drive = TwistDrive(surface, radius)
        piece = segment(
            task, self.name, choice.contacts, drive, path, cone_margin=margin
        )
        merits = (
            f"path {path.length:.3f} m of {len(path.pieces)} twist(s), "
            f"{describe_cone_margin(margin, CONE_MARGIN)}"
        )
        return replace(choice, segments=(piece,), merits=merits)

    def tracker(self, task: Task, segment: Segment) -> AxleTracker | HolonomicTracker:
        """Return the law for a segment: look-ahead alignment of a car; else the
        holonomic one, corrected within the cone of CORRECTION_SHARE of the friction.
        """
        drive = segment.drive
        if isinstance(drive, TwistDrive):
            friction = CORRECTION_SHARE * task.believed.contact_friction
            cone = TwistCone(segment.contacts, friction, drive.surface)
            return HolonomicTracker(drive.X_BV, cone.surface, cone.nearest)
        assert isinstance(drive, CarDrive)
        look_ahead = task.motion.look_ahead or LOOK_AHEAD
        law = LookAheadAlignment(look_ahead, STEERING_SHARE * drive.car.tightest)
        return AxleTracker(law, drive.car, drive.max_friction)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM;
        ``rho`` [m] weighs torque errors (default: half the distance of the contacts).
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        if rho is None:
            rho = 0.5 * math.dist(*points)
        return parallel_push_allocator(points, contacts[0].normal, friction, rho)

    def again(
        self, task: Task, segment: Segment, X_WB: Pose2, touched: Sequence[Point]
    ) -> tuple[Segment, ...]:
        """Return the segment for what is left; none where that is not within the cone,
        or for a car, which does not go back.
        """
        if isinstance(segment.drive, CarDrive):
            return ()
        return super().again(task, segment, X_WB, touched)

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by the true contacts; how the object moves is believed as
        before.
        """
        drive = segment.drive
        start = X_WB.compose(drive.X_BV)
        goal = segment.goal.compose(task.object.X_GB).compose(drive.X_BV)
        path: MotionPath | None
        if isinstance(drive, TwistDrive):
            cone = TwistCone(contacts, task.believed.contact_friction, drive.surface)
            path = path_in_cone(start, goal, cone, REPLAN_MARGIN, drive.radius, longest)
        else:
            assert isinstance(drive, CarDrive)
            path = gentle_path(start, goal, drive.curvature, longest)
        if path is None or path.length > longest:
            return None
        return Course(contacts, drive, path)


def _placement_refusal(task: Task, face: Face, contacts: Contacts) -> Refusal | None:
    """Return what stands against contacts on a face."""
    left, right = contacts
    apart = math.dist(left.point, right.point)
    needed = least_distance(task)
    if apart < needed:
        text = "contacts {figure:mm.0f} apart, two tools need {allowed:mm.0f}"
        return Refusal("too_close", text, apart, needed, "m")
    if abs(face.offset) > 1e-9:
        text = "no contact on the other side of the line through the CoM"
        return Refusal("offset_contact", text)
    return drag_refusal(task, (face,), left.height)


def _least_time(task: Task, face: Face) -> float:
    """The least time [s] that a push on a face can take: about straight to the goal."""
    motion = task.motion
    start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
    direct = TwistPath.between((start, goal), farthest_corner(task.object)).length
    # of a car's axle, somewhere ahead of the CoM
    ax, ay = start.rotate(face.normal)
    bx, by = goal.rotate(face.normal)
    x = goal.x - start.x
    y = goal.y - start.y
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    ahead = max(0.0, -(x * dx + y * dy) / square) if square > 0.0 else 0.0
    axle = math.hypot(x + ahead * dx, y + ahead * dy)
    vehicle = motion.vehicle
    least = min(direct, axle)
    if vehicle == "mixed":
        least = direct
    elif vehicle is not None:
        least = axle
    return SpeedProfile(least, motion.speed, motion.acceleration).duration + overhead(
        task
    )


def _placements(task: Task, face: Face) -> list[Contacts]:
    """Return contacts left and right of the line through the CoM, the widest first."""
    low, high = span(task.object, face)
    inside = max(CORNER_CLEARANCE, min(high, -low) - CORNER_CLEARANCE)
    height = contact_height(task)
    return [
        tuple(
            Contact(i, "side", on_face(face, y), face.normal, height)
            for i, y in enumerate((half_width, -half_width))
        )
        for half_width in dict.fromkeys(min(w, inside) for w in HALF_WIDTHS)
    ]


MODE = ParallelPush()
allocator = MODE.allocator
