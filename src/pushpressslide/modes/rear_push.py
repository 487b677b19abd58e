"""Mode rear_push: one arm pushes a side face, a rear-steer car tracked at its virtual
front axle (docs/mechanics.md, section 3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pushpressslide.allocation.one_contact import Allocator, one_contact_allocator
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, refusal_of
from pushpressslide.core.task import Task
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.virtual_axle import turned
from pushpressslide.modes.base import (
    ENOUGH,
    Course,
    Draft,
    Mode,
    search,
)
from pushpressslide.planning.rear_car import (
    cone_margin,
    fitted_car,
    planned_angles,
    route,
    turning_refusal,
)
from pushpressslide.planning.run_in import with_run_in
from pushpressslide.planning.segments import run_time, segment
from pushpressslide.planning.side_contacts import contact_height, drag_refusal
from pushpressslide.rom.drives import ORIGIN, RearSteerDrive
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_car import RearPushTracker
from pushpressslide.tracking.rear_stanley import rear_stanley

Array = NDArray[np.float64]

# share of the cone's half angle kept from its edge, for the servo and the model
STEERING_RESERVE = 0.12
CORNER_CLEARANCE = 0.01  # [m] between the contact and a corner of the face
RESOLUTION = 6  # of the base


class RearPush(Mode):
    """One arm pushes a side face from behind."""

    name = "rear_push"
    arms = 1
    reduced_model = "rear-steer car"
    tracking_point = "virtual front axle"
    cop_steering = False
    carries_weight = False
    pushed_faces = 1
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
            for angle in planned_angles(task)
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
            car, shift = fitted_car(task, face, height, twists)
        except ValueError as error:
            return [choice.refused(refusal or refusal_of(error, "tipping"))]
        low, high = car.curvature_limits
        if not low < 0.0 < high:
            straight = (
                f"cannot drive straight: curvature is in [{low:.2f}, {high:.2f}] 1/m"
            )
            return [choice.refused(refusal or Refusal("not_straight", straight))]
        belief = task.believed
        max_friction = belief.support_friction * task.scene.weight_on
        driven = self._driven(task, choice, RearSteerDrive(car, shift, max_friction))
        return [driven if refusal is None else driven.refused(refusal)]

    def _driven(self, task: Task, choice: Choice, drive: RearSteerDrive) -> Choice:
        """Return the choice with the path of a car; refused if that winds too much."""
        car = drive.car
        low, high = car.curvature_limits
        best, looped = route(task, drive)
        path = best.path
        share = best.curvature_share
        margin = cone_margin(car, path)
        piece = segment(
            task,
            self.name,
            choice.contacts,
            replace(drive, curvature_share=share, run_in=best.run_in),
            path,
            speed=best.speed,
            cone_margin=margin,
        )
        loop = ", with a loop" if looped else ""
        merits = (
            f"path {path.length:.3f} m, tightest radius "
            f"{1.0 / max(high * share, -low * share):.3f} m, "
            f"steering keeps {math.degrees(margin):.1f} deg inside the friction cone"
            f"{loop}"
        )
        return replace(
            choice,
            segments=(piece,),
            time=run_time(task, (piece,)),
            merits=merits,
            refusal=turning_refusal(path),
        )

    def tracker(self, task: Task, segment: Segment) -> RearPushTracker:
        """Return the rear Stanley law for a segment."""
        drive = segment.drive
        assert isinstance(drive, RearSteerDrive)
        car = drive.car
        low, high = car.steering_limits
        reserve = STEERING_RESERVE * 0.5 * (high - low)
        bounds = (low + reserve, high - reserve)
        law = rear_stanley(car.effective_wheelbase, bounds, task.motion.tracking_gain)
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
        # a tip that rolls round a round side takes the normal along
        planned_at = segment.contacts[0].point
        com = task.object.center_of_mass
        side = task.object.shape.side(planned_at, contact.normal, com)
        contact = replace(contact, normal=side.normal_at(contact.point))
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


MODE = RearPush()
allocator = MODE.allocator
