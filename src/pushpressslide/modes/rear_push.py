"""Single-arm rear push: one side contact, a rear-steer car tracked at its virtual front
axle (MECHANICS, section 3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pushpressslide.allocation.one_contact import Allocator, one_contact_allocator
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.dragging import DraggedBase
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.virtual_axle import turned
from pushpressslide.modes.base import ENOUGH, followed
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.side_contacts import contact_height, drag_problem
from pushpressslide.rom.rear_steer_car import RearSteerCar
from pushpressslide.tracking.rear_car import RearPushTracker
from pushpressslide.tracking.rear_stanley import rear_stanley

Array = NDArray[np.float64]

GRAVITY = 9.81  # [m/s^2]

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
# curvature that the path uses, and on the speed: near the cone's edge the contact's
# sideways jumps, which grow with it, must be smaller.
COMFORT = (
    (1.0, 1.0, 1.0),
    (0.6, 1.0, 1.0),
    (0.6, 1.2, 0.8),
    (0.35, 1.2, 0.7),
    (0.25, 1.35, 0.6),
    (0.1, 1.35, 0.5),
    (0.0, 1.35, 0.5),
)


def _angles(task: Task) -> tuple[float, float]:
    """Force angles [rad]: at which the path turns, and at the cone's edge."""
    edge = math.atan(task.believed.contact_friction)
    return task.motion.curvature_margin * edge, edge


def _goal_path(
    start: Pose2, goal: Pose2, left: float, right: float, run_in: float
) -> ArcPath:
    """Return the shortest path that ends with ``run_in`` [m] of straight line."""
    path = shortest_path(start, advance(goal, 0.0, -run_in), left, right)
    pieces = (*path.pieces, (0.0, run_in)) if run_in > 0.0 else path.pieces
    return ArcPath(start, tuple(piece for piece in pieces if piece[1] > 0.0))


class RearPush:
    """One arm pushes a side face from behind."""

    name = "rear_push"
    arms = 1
    reduced_model = "rear-steer car"
    tracking_point = "virtual front axle"
    cop_steering = False
    walls = False
    pushed_faces = 1

    def _car(
        self, task: Task, face: Face, height: float, twists: Array
    ) -> tuple[RearSteerCar, float]:
        """Return the reduced model of a push on ``face`` at ``height`` [m], and how far
        ahead of the CoM its CoP is [m].

        On the exact limit surface, under the load that the push itself shifts, both the
        axle's place and the ratio of tan(force angle) to curvature change with the
        force angle. The car has those of the angle at which the path turns, the first
        of ``twists``; its friction is lowered by the ratio's growth up to the cone's
        edge, so that its tightest curve is the object's. Raises ValueError where the
        object tips.
        """
        belief = task.believed
        mu = belief.contact_friction
        shift = height * belief.support_friction
        if belief.rho is not None:
            return RearSteerCar(
                face.foot, face.normal, (0.0, 0.0), belief.rho, mu
            ), shift
        if np.isnan(twists).any():
            raise ValueError(f"a push at {height * 1e3:.0f} mm tips the object")
        lever = math.hypot(*face.foot)
        ex = -face.foot[0] / lever
        ey = -face.foot[1] / lever

        def car_like(twist: Array, angle: float) -> tuple[float, float]:
            """Distance of the axle from the CoM, and tan(angle) / curvature."""
            vx, vy, w = (float(part) for part in twist)
            axle = (ey * vx - ex * vy) / w
            ratio = -math.tan(angle) * (vx * ex + vy * ey) / w
            # on an ellipsoid about the shifted CoP the two would agree; the longer is
            # the stable side
            return axle, max(ratio, axle - shift)

        used, edge = _angles(task)
        axle, turning = car_like(twists[0], used)
        _, tightest = car_like(twists[1], edge)
        friction = mu * min(1.0, turning / tightest)
        rho = math.sqrt(lever * turning)
        return RearSteerCar(
            face.foot, face.normal, (0.0, 0.0), rho, friction
        ), axle - turning

    def _contact_problem(self, task: Task, face: Face, height: float) -> str | None:
        """What stands against pushing there at all: the contact's place, tipping, the
        force.
        """
        mu = task.believed.contact_friction
        if abs(face.offset) >= mu * face.depth:
            return (
                f"a straight push needs the contact within {mu * face.depth * 1e3:.0f} "
                "mm of the line "
                f"through the CoM, it is {abs(face.offset) * 1e3:.0f} mm off"
            )
        return drag_problem(task, (face,), height)

    def _draft(
        self, task: Task, face: Face, twists: Array, judged: bool
    ) -> list[Choice]:
        """Judge a push on a face but for the arm's reach."""
        belief = task.believed
        height = contact_height(task)
        contact = Contact(0, "side", face.foot, face.normal, height)
        weight = belief.mass * GRAVITY
        level = belief.support_friction * weight

        problem = self._contact_problem(task, face, height)
        try:
            car, shift = self._car(task, face, height, twists)
        except ValueError as error:
            return [
                Choice(
                    self.name,
                    False,
                    f"face {face.index}: {problem or error}",
                    (contact,),
                )
            ]
        low, high = car.curvature_limits
        if not low < 0.0 < high:
            straight_only = (
                f"cannot drive straight: curvature is in [{low:.2f}, {high:.2f}] 1/m"
            )
            return [
                Choice(
                    self.name,
                    False,
                    f"face {face.index}: {problem or straight_only}",
                    (contact,),
                )
            ]
        X_BV = self._frame(car, shift)
        X_GB = task.object.X_GB
        start, goal = (X.compose(X_GB).compose(X_BV) for X in (task.start, task.goal))
        straight = math.hypot(goal.x - start.x, goal.y - start.y)
        longest = LOOP_RATIO * straight + 0.02
        tried = []
        for run_share, harder, slower in COMFORT:
            run_in = run_share * task.motion.run_in
            use = min(1.0, harder * task.motion.curvature_margin)
            path = _goal_path(start, goal, high * use, -low * use, run_in)
            tried.append((run_in, use, slower * task.motion.speed, path))
            if path.length <= longest:
                break
        run_in, use, speed, path = tried[-1]
        if path.length > longest:
            run_in, use, speed, path = min(tried, key=lambda t: t[3].length)
        speed = min(
            speed,
            TURN_RATE
            / max((abs(k) for k, _ in path.pieces if k), default=TURN_RATE / speed),
        )
        steering = [car.steering(k) for k, _ in path.pieces] or [0.0]
        bounds = car.steering_limits
        margin = min(min(bounds[1] - a, a - bounds[0]) for a in steering)
        time = SpeedProfile(
            path.length, speed, task.motion.acceleration
        ).duration + overhead(task)
        parameters = {
            "face": float(face.index),
            "lever": car.lever,
            "rho": car.rho,
            "wheelbase": car.wheelbase,
            "axle_from_com": math.hypot(X_BV.x, X_BV.y),
            "height_shift": shift,
            "contact_height": height,
            "curvature_left": high * use,
            "curvature_right": -low * use,
            "curvature_max_left": high,
            "curvature_max_right": -low,
            "curvature_share": use,
            "effective_friction": car.mu,
            "run_in": run_in,
            "speed": speed,
            "push_force": level,
        }
        looped = path.length > longest
        problem = problem or self._turning_problem(path)
        reason = f"face {face.index}: " + (
            problem
            or f"path {path.length:.3f} m, tightest radius {1.0 / max(high * use, -low * use):.3f} m, "
            f"steering keeps {math.degrees(margin):.1f} deg inside the friction cone"
            + (", with a loop" if looped else "")
        )
        feasible = problem is None
        return [
            Choice(
                self.name,
                feasible,
                reason,
                (contact,),
                path.length,
                time,
                margin,
                parameters,
                path,
            )
        ]

    @staticmethod
    def _frame(car: RearSteerCar, shift: float) -> Pose2:
        """X_BV, the height term's advance of the CoP included."""
        X = car.X_BV
        return Pose2(
            X.x + shift * math.cos(X.yaw), X.y + shift * math.sin(X.yaw), X.yaw
        )

    @staticmethod
    def _turning_problem(path: ArcPath) -> str | None:
        """What stands against following the path's arcs."""
        turning = sum(abs(k) * length for k, length in path.pieces)
        allowed = math.degrees(TURNING_LIMIT)
        if turning > TURNING_LIMIT:
            return f"the path turns by {math.degrees(turning):.0f} deg, allowed {allowed:.0f} deg"
        return None

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return one choice per face, feasible ones first, the quickest first."""
        candidates = faces(task.object, CORNER_CLEARANCE)
        if task.motion.face is not None:
            candidates = tuple(
                face for face in candidates if face.index == task.motion.face
            )
        feet = np.repeat([face.foot for face in candidates], 2, axis=0)
        axes = [
            turned((-x / math.hypot(x, y), -y / math.hypot(x, y)), angle)
            for x, y in (face.foot for face in candidates)
            for angle in _angles(task)
        ]
        base = DraggedBase(
            task.object,
            contact_height(task) * task.believed.support_friction,
            RESOLUTION,
        )
        twists = base.slide(np.zeros_like(feet), feet, np.array(axes)).twists.reshape(
            -1, 2, 3
        )
        drafts = [
            (0.0, partial(self._draft, task, face, of))
            for face, of in zip(candidates, twists, strict=True)
        ]
        return followed(
            task,
            drafts,
            self.vehicle_frame,
            enough,
            lambda reason, why: f"{reason.split(':')[0]}: {why}",
        )

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the virtual front axle, x along the heading axis from
        the contact through the CoM.
        """
        p = choice.contacts[0].point
        reach = choice.parameters["axle_from_com"]
        yaw = math.atan2(-p[1], -p[0])
        return Pose2(reach * math.cos(yaw), reach * math.sin(yaw), yaw)

    def tracker(self, plan: Plan) -> RearPushTracker:
        """Return the rear Stanley law for a plan."""
        figures = plan.choice.parameters
        contact = plan.choice.contacts[0]
        car = RearSteerCar(
            contact.point,
            contact.normal,
            (0.0, 0.0),
            figures["rho"],
            figures["effective_friction"],
        )
        low, high = car.steering_limits
        reserve = STEERING_RESERVE * 0.5 * (high - low)
        law = rear_stanley(
            car.wheelbase,
            (low + reserve, high - reserve),
            plan.task.motion.tracking_gain,
        )
        return RearPushTracker(
            law, car, figures["axle_from_com"], figures["push_force"]
        )

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about the CoM, wherever the ``cop`` is;
        ``rho`` [m] weighs torque errors (default: half the lever).
        """
        (contact,) = contacts
        return one_contact_allocator(
            contact.point,
            contact.normal,
            friction,
            rho if rho is not None else 0.5 * math.hypot(*contact.point),
        )

    def identifier(self, plan: Plan) -> None:
        """Return nothing: the car's length is not identified."""

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> None:
        """Return nothing: a push does not go back."""

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from the object's true pose and the true contact; None if its
        path is longer than ``longest`` [m].

        The car's own length is kept: what changes is its heading axis, from the true
        contact through the CoM.
        """
        task = plan.task
        figures = plan.choice.parameters
        old = plan.choice.contacts[0]
        normal = old.normal
        # a tip that rolls round it takes its face along
        if isinstance(task.object.shape, Cylinder):
            x, y = (
                c - p
                for c, p in zip(
                    task.object.X_GB.inverse().position, touched[0], strict=True
                )
            )
            normal = (x / math.hypot(x, y), y / math.hypot(x, y))
        try:
            car = RearSteerCar(
                touched[0],
                normal,
                (0.0, 0.0),
                figures["rho"],
                figures["effective_friction"],
            )
        except ValueError:
            return None
        low, high = car.curvature_limits
        if not low < 0.0 < high:
            return None
        X_BV = self._frame(car, figures["height_shift"])
        start = X_WB.compose(X_BV)
        goal = task.goal.compose(task.object.X_GB).compose(X_BV)
        for share in (
            figures["curvature_share"],
            0.5 * (1.0 + figures["curvature_share"]),
        ):
            for run_in in (figures["run_in"], 0.5 * figures["run_in"]):
                path = _goal_path(start, goal, share * high, -share * low, run_in)
                if path.length <= longest:
                    choice = replace(
                        plan.choice,
                        contacts=(replace(old, point=touched[0], normal=normal),),
                        path=path,
                        path_length=path.length,
                        parameters={
                            **figures,
                            "lever": car.lever,
                            "wheelbase": car.wheelbase,
                            "axle_from_com": math.hypot(X_BV.x, X_BV.y),
                        },
                    )
                    profile = SpeedProfile(
                        path.length, plan.profile.speed, plan.profile.acceleration
                    )
                    return Plan(task, choice, path, profile, X_BV, plan.following)
        return None


MODE = RearPush()
allocator = MODE.allocator
