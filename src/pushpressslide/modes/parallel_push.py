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
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import ENOUGH, beside, followed
from pushpressslide.planning.in_cone import least_spare, path_in_cone, told
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pushed_car import PushedCar, gentle_path, pushed_cars
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
    drag_problem,
    farthest_corner,
    given_to,
    least_distance,
    span,
)
from pushpressslide.tracking.axle import AxleTracker
from pushpressslide.tracking.holonomic import HolonomicTracker
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

ORIGIN = (0.0, 0.0)
GRAVITY = 9.81  # [m/s^2]
# [m] of the contacts from the CoM's line that are tried
HALF_WIDTHS = (0.16, 0.12, 0.09, 0.07, 0.05)
CORNER_CLEARANCE = 0.015  # [m] between a contact and a corner of the face
DRIVES = {
    "differential": ("differential",),
    "synchronised": ("synchronised",),
    "mixed": ("mixed",),
}
# in this order, where motion.vehicle is none of these: both mixed correct an error any
# way at once, a car takes some look-aheads of straight way for it
EITHER = ("mixed", "differential")
LOOK_AHEAD = 0.08  # [m]
STEERING_SHARE = 0.85  # of the tightest curve that steering may ask for
SPARE = math.radians(6.0)
REPLAN_SPARE = math.radians(2.0)  # inside the cone: of a plan, and of one made anew
KEPT = 0.9  # of the friction: what corrections may use
LOOP_RATIO = 1.25
SLACK = 0.03  # times the straight way, and [m]: a longer path has turned a loop

Cars = Callable[[Face, bool], dict[tuple[Contact, ...], PushedCar]]


class ParallelPush:
    """Two arms push one face side by side."""

    name = "parallel_push"
    arms = 2
    reduced_model = "rear-steer car / forward differential car"
    tracking_point = "virtual front axle / centre of pressure"
    cop_steering = False
    walls = False
    pushed_faces = 1

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the ways to push each face, feasible ones first, the quickest first."""
        if isinstance(task.object.shape, Cylinder):
            return [
                Choice(
                    self.name,
                    False,
                    "a cylinder has no flat face for two tips side by side",
                )
            ]
        pushed = [
            f
            for f in faces(task.object, CORNER_CLEARANCE)
            if task.motion.face in (None, f.index)
        ]
        places = [
            (face, contacts) for face in pushed for contacts in _places(task, face)
        ]

        @cache
        def cars(
            face: Face, synchronised: bool
        ) -> dict[tuple[Contact, ...], PushedCar]:
            contacts = [c for f, c in places if f == face]
            halves = [(face, 0.5 * math.dist(a.point, b.point)) for a, b in contacts]
            made = pushed_cars(task, halves, contact_height(task), synchronised)
            return dict(zip(contacts, made, strict=True))

        drafts = [
            (_least_time(task, face), partial(self._drafts, task, face, contacts, cars))
            for face, contacts in places
        ]
        return followed(task, drafts, self.vehicle_frame, enough, beside)

    def _drafts(
        self,
        task: Task,
        face: Face,
        contacts: tuple[Contact, ...],
        cars: Cars,
        judged: bool,
    ) -> list[Choice]:
        """Judge contacts on a face but for the arms' reach: one choice for each way to
        give them to arms.
        """
        left, right = (c.point for c in contacts)
        height = contacts[0].height
        what = f"face {face.index} at ({left[0]:.3f}, {left[1]:.3f}) and ({right[0]:.3f}, {right[1]:.3f})"
        if not judged:
            return [
                Choice(self.name, True, what, contacts, time=_least_time(task, face))
            ]
        apart = math.dist(left, right)
        needed = least_distance(task)
        problem = drag_problem(task, (face,), height)
        if apart < needed:
            problem = f"contacts {apart * 1e3:.0f} mm apart, two tools need {needed * 1e3:.0f} mm"
        elif abs(face.offset) > 1e-9:
            problem = "no contact on the other side of the line through the CoM"
        if problem is not None:
            return [Choice(self.name, False, f"{what}: {problem}", contacts)]
        why = []
        for drive in DRIVES.get(task.motion.vehicle or "", EITHER):
            try:
                if drive == "mixed":
                    choice = self._mixed(task, contacts)
                else:
                    choice = self._as_car(
                        task, cars(face, drive == "synchronised")[contacts]
                    )
            except ValueError as error:
                choice = Choice(self.name, False, str(error))
            why.append(f"{drive}: {choice.reason}")
            if choice.path is not None:
                return self._given(
                    task,
                    replace(choice, reason=f"{what}, {why[-1]}"),
                    contacts,
                    choice.path,
                )
        return [Choice(self.name, False, f"{what}: {'; '.join(why)}", contacts)]

    def _given(
        self,
        task: Task,
        choice: Choice,
        contacts: tuple[Contact, ...],
        path: MotionPath,
    ) -> list[Choice]:
        """Return one choice for each way to give the contacts to the arms, with what
        all drives have in common.
        """
        X_VB = self.vehicle_frame(choice).inverse()
        motion = task.motion
        time = SpeedProfile(
            path.length, motion.speed, motion.acceleration
        ).duration + overhead(task)
        common = {"speed": motion.speed, "contact_height": contacts[0].height}
        choice = replace(
            choice,
            contacts=contacts,
            path_length=path.length,
            time=time,
            parameters={**choice.parameters, **common},
        )
        poses = [
            path.pose(share * path.length).compose(X_VB) for share in (0.0, 0.5, 1.0)
        ]
        ways = assignments(task.bases, [c.point for c in contacts], poses)
        if not ways:
            return [
                replace(
                    choice,
                    feasible=False,
                    reason=f"{choice.reason}; the arms would cross",
                )
            ]
        return [replace(choice, contacts=given_to(contacts, arms)) for arms in ways]

    def _as_car(self, task: Task, car: PushedCar) -> Choice:
        """Return the choice to push as a car, without what all drives have in common."""
        start, goal = (
            X.compose(task.object.X_GB).compose(car.X_BV)
            for X in (task.start, task.goal)
        )
        curvature = task.motion.curvature_margin * car.tightest
        longest = LOOP_RATIO * math.hypot(goal.x - start.x, goal.y - start.y) + SLACK
        path = gentle_path(start, goal, curvature, longest)
        if path.length > longest:
            turns = f"a loop of {path.length:.2f} m with radii of {1.0 / curvature:.3f} m and no way back"
            return Choice(self.name, False, f"{turns}, allowed {longest:.2f} m")
        used = max((abs(k) for k, _ in path.pieces), default=0.0)
        reason = f"path {path.length:.3f} m, {used / car.tightest:.2f} of the tightest curve used"
        level = task.believed.support_friction * task.believed.mass * GRAVITY
        return Choice(
            self.name,
            True,
            reason,
            path=path,
            friction_margin=atan(task.believed.contact_friction)
            - atan(car.lead * used),
            parameters={**car.figures, "push_force": level, "curvature": curvature},
        )

    def _mixed(self, task: Task, contacts: Sequence[Contact]) -> Choice:
        """Return the choice to drive twists of the contacts' cone, without what all
        drives have in common.
        """
        start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
        direct = screw(start, goal)
        radius = farthest_corner(task.object)
        surface = push_surface(task, contacts[0].height, Twist(*direct))
        cone = TwistCone(contacts, task.believed.contact_friction, surface)
        longest = LOOP_RATIO * TwistPath.between((start, goal), radius).length + SLACK
        path = path_in_cone(start, goal, cone, SPARE, radius, longest)
        if path is None:
            return Choice(
                self.name,
                False,
                f"the direct way is {told(cone.angle(*direct), SPARE)}; no three "
                f"twists of {longest:.2f} m",
            )
        spare = least_spare(path, cone)
        reason = f"path {path.length:.3f} m of {len(path.pieces)} twist(s), {told(spare, SPARE)}"
        return Choice(
            self.name,
            True,
            reason,
            friction_margin=spare,
            path=path,
            parameters={**cone.figures, "radius": radius},
        )

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: at a car's axle, x along the pushes; else B itself."""
        figures = choice.parameters
        return PushedCar.remembered(figures).X_BV if "axle" in figures else Pose2()

    def tracker(self, plan: Plan) -> AxleTracker | HolonomicTracker:
        """Return the law for a plan: look-ahead alignment of a car; else the holonomic
        one, corrected within the cone of KEPT of the friction.
        """
        figures = plan.choice.parameters
        motion = plan.task.motion
        if isinstance(plan.path, TwistPath):
            friction = KEPT * plan.task.believed.contact_friction
            cone = TwistCone.remembered(figures, plan.choice.contacts, friction)
            return HolonomicTracker(plan.X_BV, cone.surface, cone.nearest)
        car = PushedCar.remembered(figures)
        law = LookAheadAlignment(
            motion.look_ahead or LOOK_AHEAD, STEERING_SHARE * car.tightest
        )
        return AxleTracker(
            law, car.heading, car.axle, car.lead, car.rho, figures["push_force"]
        )

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM;
        ``rho`` [m] weighs torque errors (default: half the distance of the contacts).
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        rho = rho if rho is not None else 0.5 * math.dist(*points)
        return parallel_push_allocator(points, contacts[0].normal, friction, rho)

    def identifier(self, plan: Plan) -> None:
        """Return nothing: two contacts hold the object, wherever its axle is."""

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return the plan for what is left of the way; None where that is not within
        the cone, or for a car, which does not go back.
        """
        return (
            self.replan(plan, X_WB, touched, math.inf)
            if isinstance(plan.path, TwistPath)
            else None
        )

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from the object's true pose and the true contacts; None if
        its path is longer than ``longest`` [m]. How the object moves is believed as
        before.
        """
        figures = plan.choice.parameters
        pairs = zip(plan.choice.contacts, touched, strict=True)
        contacts = tuple(replace(contact, point=point) for contact, point in pairs)
        start = X_WB.compose(plan.X_BV)
        goal = plan.goal.compose(plan.task.object.X_GB).compose(plan.X_BV)
        path: MotionPath | None
        if isinstance(plan.path, TwistPath):
            cone = TwistCone.remembered(
                figures, contacts, plan.task.believed.contact_friction
            )
            path = path_in_cone(
                start, goal, cone, REPLAN_SPARE, figures["radius"], longest
            )
        else:
            path = gentle_path(start, goal, figures["curvature"], longest)
        if path is None or path.length > longest:
            return None
        choice = replace(
            plan.choice, contacts=contacts, path=path, path_length=path.length
        )
        profile = SpeedProfile(
            path.length, plan.profile.speed, plan.profile.acceleration
        )
        return replace(plan, choice=choice, path=path, profile=profile)


def _least_time(task: Task, face: Face) -> float:
    """The least time [s] that a push on a face can take: about straight to the goal."""
    start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
    drives = DRIVES.get(task.motion.vehicle or "", EITHER)
    direct = TwistPath.between((start, goal), farthest_corner(task.object)).length
    # of a car's axle, somewhere ahead of the CoM
    (ax, ay), (bx, by) = (X.rotate(face.normal) for X in (start, goal))
    x = goal.x - start.x
    y = goal.y - start.y
    dx = bx - ax
    dy = by - ay
    square = dx * dx + dy * dy
    ahead = max(0.0, -(x * dx + y * dy) / square) if square > 0.0 else 0.0
    axle = math.hypot(x + ahead * dx, y + ahead * dy)
    least = (
        direct
        if drives == ("mixed",)
        else axle
        if "mixed" not in drives
        else min(direct, axle)
    )
    return SpeedProfile(
        least, task.motion.speed, task.motion.acceleration
    ).duration + overhead(task)


def _places(task: Task, face: Face) -> list[tuple[Contact, ...]]:
    """Return contacts left and right of the line through the CoM, the widest first."""
    low, high = span(task.object, face)
    room = max(CORNER_CLEARANCE, min(high, -low) - CORNER_CLEARANCE)
    height = contact_height(task)
    return [
        tuple(
            Contact(i, "side", on_face(face, y), face.normal, height)
            for i, y in enumerate((w, -w))
        )
        for w in dict.fromkeys(min(w, room) for w in HALF_WIDTHS)
    ]


MODE = ParallelPush()
allocator = MODE.allocator
