"""Mode rear_push: one arm pushes a side face, a rear-steer car tracked at its virtual
front axle (docs/mechanics.md, section 3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pushpressslide.allocation.one_contact import Allocator, one_contact_allocator
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.task import GRAVITY, Cylinder, Task
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.virtual_axle import turned
from pushpressslide.modes.base import (
    ENOUGH,
    Course,
    Draft,
    Mode,
    run_time,
    search,
    segment,
)
from pushpressslide.planning.run_in import with_run_in
from pushpressslide.planning.side_contacts import contact_height, drag_refusal
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_car import RearPushTracker
from pushpressslide.tracking.rear_stanley import rear_stanley

Array = NDArray[np.float64]

# share of the cone's half angle kept from its edge, for the servo and the model
STEERING_RESERVE = 0.12
# a path longer than this times the straight distance has turned a loop
LOOP_RATIO = 1.5
# [rad/s] of the object at most: beyond it the tip slips where the steering jumps
TURN_RATE = 0.8
TURNING_LIMIT = math.radians(360.0)  # of all arcs together: one loop, no spiral
CORNER_CLEARANCE = 0.01  # [m] between the contact and a corner of the face
RESOLUTION = 6  # of the base
# From comfortable to hard: factors on the run-in, on the share of the friction-limited
# curvature that the path uses, and on the speed. Near the cone's edge the contact's
# sideways jumps must be smaller: they grow with the speed.
COMFORT = (
    (1.0, 1.0, 1.0),
    (0.6, 1.0, 1.0),
    (0.6, 1.2, 0.8),
    (0.35, 1.2, 0.7),
    (0.25, 1.35, 0.6),
    (0.1, 1.35, 0.5),
    (0.0, 1.35, 0.5),
)


class _Route(NamedTuple):
    """One path of the virtual front axle."""

    path: ArcPath
    run_in: float  # [m]
    curvature_share: float
    speed: float  # [m/s]


class RearPush(Mode):
    """One arm pushes a side face from behind."""

    name = "rear_push"
    arms = 1
    reduced_model = "rear-steer car"
    tracking_point = "virtual front axle"
    cop_steering = False
    walls = False
    drives = (RearSteerDrive,)

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the choices of all placements."""
        return search(task, self._drafts(task), enough)

    def _drafts(self, task: Task) -> list[Draft | Choice]:
        """Return one draft per face."""
        pushed = [
            face
            for face in faces(task.object, CORNER_CLEARANCE)
            if task.motion.face in (None, face.index)
        ]
        feet = np.repeat([face.foot for face in pushed], 2, axis=0)
        axes = [
            turned((-x / math.hypot(x, y), -y / math.hypot(x, y)), angle)
            for x, y in (face.foot for face in pushed)
            for angle in _angles(task)
        ]
        lift = contact_height(task) * task.believed.support_friction
        base = DraggedBase(task.object, lift, RESOLUTION)
        slid = base.slide(np.zeros_like(feet), feet, np.array(axes))
        twists = slid.twists.reshape(-1, 2, 3)
        return [
            Draft(0.0, partial(self._push, task, face, pair))
            for face, pair in zip(pushed, twists, strict=True)
        ]

    def _push(
        self, task: Task, face: Face, twists: Array, evaluated: bool
    ) -> list[Choice]:
        """Judge a push on a face but for the arm's reach."""
        height = contact_height(task)
        contact = Contact(0, "side", face.foot, face.normal, height)
        choice = Choice(self.name, f"face {face.index}", (contact,))
        refusal = _contact_refusal(task, face, height)
        try:
            car, shift = _car(task, face, height, twists)
        except ValueError as error:
            return [choice.refused(refusal or refusal_of(error, "tipping"))]
        low, high = car.curvature_limits
        if not low < 0.0 < high:
            straight = (
                f"cannot drive straight: curvature is in [{low:.2f}, {high:.2f}] 1/m"
            )
            return [choice.refused(refusal or Refusal("not_straight", straight))]
        belief = task.believed
        max_friction = belief.support_friction * (belief.mass * GRAVITY)
        drive = RearSteerDrive(car, shift, max_friction)
        route, looped = _route(task, drive)
        share = route.curvature_share
        drive = replace(drive, curvature_share=share, run_in=route.run_in)
        margin = _cone_margin(car, route.path)
        piece = segment(
            task,
            self.name,
            (contact,),
            drive,
            route.path,
            speed=route.speed,
            cone_margin=margin,
        )
        merits = (
            f"path {route.path.length:.3f} m, tightest radius "
            f"{1.0 / max(high * share, -low * share):.3f} m, "
            f"steering keeps {math.degrees(margin):.1f} deg inside the friction cone"
            f"{', with a loop' if looped else ''}"
        )
        return [
            Choice(
                self.name,
                choice.label,
                (contact,),
                (piece,),
                run_time(task, (piece,)),
                merits,
                refusal or _turning_refusal(route.path),
            )
        ]

    def tracker(self, task: Task, segment: Segment) -> RearPushTracker:
        """Return the rear Stanley law for a segment."""
        drive = segment.drive
        assert isinstance(drive, RearSteerDrive)
        car = drive.car
        low, high = car.steering_limits
        reserve = STEERING_RESERVE * 0.5 * (high - low)
        bounds = (low + reserve, high - reserve)
        law = rear_stanley(car.wheelbase, bounds, task.motion.tracking_gain)
        axle = math.hypot(*drive.X_BV.position)
        return RearPushTracker(law, car, axle, drive.max_friction)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about the CoM, wherever the ``cop`` is.

        ``rho`` [m] weighs torque errors (default: half the lever).
        """
        (contact,) = contacts
        if rho is None:
            rho = 0.5 * math.hypot(*contact.point)
        return one_contact_allocator(contact.point, contact.normal, friction, rho)

    def again(
        self, task: Task, segment: Segment, X_WB: Pose2, touched: Sequence[Point]
    ) -> tuple[Segment, ...]:
        """Return nothing: a push does not go back."""
        return ()

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by the true contact; the car keeps its own length, what
        changes is its heading axis, from the true contact through the CoM.
        """
        planned = segment.drive
        assert isinstance(planned, RearSteerDrive)
        (contact,) = contacts
        if isinstance(
            task.object.shape, Cylinder
        ):  # a tip that rolls takes its face along
            contact = _facing(contact, task.object.X_GB.inverse().position)
        old = planned.car
        try:
            car = RearSteerCar(contact.point, contact.normal, ORIGIN, old.rho, old.mu)
        except ValueError:
            return None
        low, high = car.curvature_limits
        if not low < 0.0 < high:
            return None
        drive = replace(planned, car=car)
        share = drive.curvature_share
        run_in = drive.run_in
        start = X_WB.compose(drive.X_BV)
        goal = segment.goal.compose(task.object.X_GB).compose(drive.X_BV)
        for used in (share, 0.5 * (1.0 + share)):
            for straight in (run_in, 0.5 * run_in):
                path = with_run_in(start, goal, used * high, -used * low, straight)
                if path.length <= longest:
                    return Course((contact,), drive, path)
        return None


def _angles(task: Task) -> tuple[float, float]:
    """Force angles [rad]: at which the path turns, and at the cone's edge."""
    edge = math.atan(task.believed.contact_friction)
    return task.motion.curvature_margin * edge, edge


def _car(
    task: Task, face: Face, height: float, twists: Array
) -> tuple[RearSteerCar, float]:
    """Return the reduced model of a push on ``face`` at ``height`` [m], and how far
    ahead of the CoM its CoP is [m].

    On the exact limit surface, under the load that the push itself shifts, both the
    axle's place and the effective wheelbase change with the force angle. The car has
    those of the angle at which the path turns, the first of ``twists``; its friction is
    lowered by the wheelbase's growth up to the cone's edge, so that its tightest curve
    is the object's. Raises RefusedError where the object tips.
    """
    belief = task.believed
    mu = belief.contact_friction
    shift = height * belief.support_friction
    if belief.rho is not None:
        return RearSteerCar(face.foot, face.normal, ORIGIN, belief.rho, mu), shift
    if np.isnan(twists).any():
        text = "a push at {figure:mm.0f} tips the object"
        raise RefusedError(Refusal("tipping", text, height, unit="m"))
    lever = math.hypot(*face.foot)
    ex = -face.foot[0] / lever
    ey = -face.foot[1] / lever

    def car_like(twist: Array, angle: float) -> tuple[float, float]:
        """Distance of the axle from the CoM, and the effective wheelbase [m]."""
        vx, vy, w = (float(part) for part in twist)
        axle = (ey * vx - ex * vy) / w
        wheelbase = -math.tan(angle) * (vx * ex + vy * ey) / w
        # an ellipsoid about the shifted CoP has both equal; the longer one is stable
        return axle, max(wheelbase, axle - shift)

    planned_angle, edge = _angles(task)
    axle, wheelbase = car_like(twists[0], planned_angle)
    _, tightest = car_like(twists[1], edge)
    friction = mu * min(1.0, wheelbase / tightest)
    rho = math.sqrt(lever * wheelbase)
    car = RearSteerCar(face.foot, face.normal, ORIGIN, rho, friction)
    return car, axle - wheelbase


def _route(task: Task, drive: RearSteerDrive) -> tuple[_Route, bool]:
    """Return the most comfortable path without a loop, and False; the shortest one and
    True where each has a loop.
    """
    motion = task.motion
    X_GB = task.object.X_GB
    start = task.start.compose(X_GB).compose(drive.X_BV)
    goal = task.goal.compose(X_GB).compose(drive.X_BV)
    low, high = drive.car.curvature_limits
    straight = math.hypot(goal.x - start.x, goal.y - start.y)
    longest = LOOP_RATIO * straight + 0.02
    routes = []
    for run_share, harder, slower in COMFORT:
        run_in = run_share * motion.run_in
        share = min(1.0, harder * motion.curvature_margin)
        path = with_run_in(start, goal, high * share, -low * share, run_in)
        routes.append(_Route(path, run_in, share, slower * motion.speed))
        if path.length <= longest:
            break
    route = routes[-1]
    looped = route.path.length > longest
    if looped:
        route = min(routes, key=lambda one: one.path.length)
    turns = [abs(k) for k, _ in route.path.pieces if k]
    if turns:
        route = route._replace(speed=min(route.speed, TURN_RATE / max(turns)))
    return route, route.path.length > longest


def _cone_margin(car: RearSteerCar, path: ArcPath) -> float:
    """Return how far inside the friction cone the path's forces stay [rad]."""
    low, high = car.steering_limits
    steering = [car.steering(curvature) for curvature, _ in path.pieces] or [0.0]
    return min(min(high - angle, angle - low) for angle in steering)


def _contact_refusal(task: Task, face: Face, height: float) -> Refusal | None:
    """What stands against pushing there at all: the contact's place, tipping, the
    force.
    """
    allowed = task.believed.contact_friction * face.depth
    offset = abs(face.offset)
    if offset >= allowed:
        text = (
            "a straight push needs the contact within {allowed:mm.0f} of the line "
            "through the CoM, it is {figure:mm.0f} off"
        )
        return Refusal("offset_contact", text, offset, allowed, "m")
    return drag_refusal(task, (face,), height)


def _turning_refusal(path: ArcPath) -> Refusal | None:
    """What stands against following the path's arcs."""
    turning = sum(abs(curvature) * length for curvature, length in path.pieces)
    if turning <= TURNING_LIMIT:
        return None
    text = "the path turns by {figure:deg.0f}, allowed {allowed:deg.0f}"
    return Refusal("turning", text, turning, TURNING_LIMIT, "rad")


def _facing(contact: Contact, center: Point) -> Contact:
    """Return a contact on a round side, its normal towards ``center`` [m] in B."""
    x = center[0] - contact.point[0]
    y = center[1] - contact.point[1]
    size = math.hypot(x, y)
    return replace(contact, normal=(x / size, y / size))


MODE = RearPush()
allocator = MODE.allocator
