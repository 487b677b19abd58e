"""Mode press_slide: one arm presses on top and slides the object, driven as a unicycle about its virtual axle
(docs/mechanics.md, sections 2 and 4).

The line of centre of pressure and contact is the heading axis. Pulled, the contact leads; pushed, it follows;
turned on the spot, the force is across. The friction disc under the tip has no direction of its own, so that
any of these goes with any contact that the press holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import atan, remainder

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import (
    friction_use,
    least_load,
    pressed_cop,
    pressed_twist,
    straight_rho,
)
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.top import inside_top, room_inside, top_places
from pushpressslide.modes.base import path_problem
from pushpressslide.planning.run_in import gentlest
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, UnicycleTracker

GRAVITY = 9.81
TURN = 2.0 * math.pi
USE = (0.7, 0.8, 0.9, 0.96)  # shares of the press's friction that a motion may take, the best first
LEAST_PRESS = 2.0  # [N] below which contact is not felt for sure
EDGE = 0.012  # [m] that a contact stays away from the top's edges
TIPPING_ROOM = 0.1  # half widths that the centre of pressure stays inside the base's edge
RESOLUTION = 4  # of the pressure samples: enough for their variance
STEEPEST = math.radians(75.0)  # force angle from the axis that steering may ask for
CAR_ANGLE = math.radians(45.0)  # the same for a plan as car or forklift
SWING = 1.2  # times the speed of the virtual axle that the contact may move in a turn; tighter ones are slower
TIGHTER = (0.5, 0.75, 1.0, 2.0, 4.0)  # curvatures that are tried, in units of that turn's
LOOP_RATIO = 1.6  # times the straight way: a longer path has turned a loop
OVERHEAD = 4.0  # [s] approach and release
ENOUGH = 8  # choices that the arm can follow: slower ones are not looked at
RUN_INS = (5.0, 3.0, 1.5, 0.5, 0.0)  # straight ends that are tried, in look-aheads
PUSHED_SPEED = 0.8  # share of the speed when pushed: what is ahead of the contact swings more
DIRECTIONS = {"unicycle": (False, True), "car": (False,), "forklift": (True,), "pivot": (False,)}


class PressSlide:
    """One arm presses on top and slides the object."""

    name = "press_slide"
    arms = 1
    reduced_model = "unicycle / car / forklift"
    tracking_point = "virtual axle"
    cop_steering = True

    def choices(self, task: Task) -> list[Choice]:
        """Return one choice per contact and direction, feasible ones first, the quickest first.

        Where a believed rho leads every path out of bounds, the rho of the object's shape is planned with, and
        what is true is found out on the way.
        """
        judged = self._judged(task)
        if task.believed.rho is None or any(choice.feasible for choice in judged):
            return judged
        own = self._judged(_by_shape(task))
        told = f"; planned with the shape's rho, belief.rho {task.believed.rho:g} m leads out of bounds"
        return [
            replace(c, reason=c.reason + told, parameters={**c.parameters, "by_shape": 1.0})
            for c in own
            if c.feasible
        ] or judged

    def _judged(self, task: Task) -> list[Choice]:
        vehicle = task.motion.vehicle or "unicycle"
        problem, load = self._press(task)
        drafts = []
        for arm in range(len(task.robots)):
            for point in self._places(task, load):
                contact = Contact(arm, "top", point, (0.0, 0.0), task.object.shape.height, load)
                if problem is not None:
                    drafts.append(Choice(self.name, False, problem, (contact,)))
                else:
                    drafts += [
                        self._draft(task, contact, backward, vehicle) for backward in DIRECTIONS[vehicle]
                    ]
        out, found = [], 0
        for choice in sorted(drafts, key=lambda c: c.time if c.time is not None else math.inf):
            why = None
            if choice.feasible and found == ENOUGH:
                why = f"slower than {ENOUGH} others"
            elif choice.feasible:
                why = path_problem(task, choice, self.vehicle_frame(choice))
                found += why is None
            if why is not None:
                choice = replace(choice, feasible=False, reason=f"{choice.reason.split(' with ')[0]}: {why}")
            out.append(choice)
        return sorted(out, key=lambda c: not c.feasible)

    @staticmethod
    def _press(task: Task) -> tuple[str | None, float]:
        """Return what stands against any press, and the load [N] to press with: the least that is safe."""
        belief, most = task.believed, task.limits.normal_force
        mu_s, mu_a, weight = belief.support_friction, belief.contact_friction, belief.mass * GRAVITY
        wanted = task.motion.press_force
        if wanted is None:
            for use in USE:
                load = max(LEAST_PRESS, least_load(weight, mu_s, mu_a, use))
                if load <= most:
                    return None, load
            if mu_a <= mu_s:
                why = f"contact friction {mu_a:g} must exceed the support's, {mu_s:g}: no press drags"
                return why, LEAST_PRESS
            needed = least_load(weight, mu_s, mu_a, USE[-1])
            return f"needs a press of {needed:.1f} N, limits.normal_force is {most:g} N", LEAST_PRESS
        if wanted > most:
            return f"motion.press_force of {wanted:g} N, limits.normal_force is {most:g} N", wanted
        use = friction_use(wanted, weight, mu_s, mu_a)
        if use > USE[-1]:
            needed = mu_s * (weight + wanted) / (USE[-1] * wanted)
            return (
                f"pressed with {wanted:g} N the tip slips before the object: straight sliding takes {use:.2f} "
                f"of its friction, allowed {USE[-1]:g}; contact friction {mu_a:g}, needed {needed:.3f}"
            ), wanted
        return None, wanted

    def _places(self, task: Task, load: float) -> list[Point]:
        """Where to press, in B [m]."""
        com, given = task.object.center_of_mass, task.motion.contacts
        if given is not None:
            return [(x - com[0], y - com[1]) for x, y in given[:1]]
        return top_places(task.object, EDGE)

    def _vehicle(self, task: Task, contact: Contact, backward: bool) -> Unicycle:
        """Return the object as a vehicle, as believed.

        Raises ValueError where the object tips or the contact is at the CoM.
        """
        belief, body, point = task.believed, task.object, contact.point
        mu, height = belief.support_friction, body.shape.height
        cop = pressed_cop(point, contact.load, belief.mass * GRAVITY)

        def pressure_at(p: Point) -> PressureSamples:
            return support_pressure(body.shape, 1.0, body.center_of_mass, p, RESOLUTION)

        if belief.rho is not None:
            return Unicycle(point, cop, belief.rho, backward, height * mu)
        shift = -height * mu if backward else height * mu
        return Unicycle(point, cop, straight_rho(pressure_at, cop, point, shift), backward, height * mu)

    def _pivot(self, task: Task, contact: Contact, turn: float) -> tuple[Unicycle, Pose2]:
        """Return the object as a vehicle that turns on the spot to the side of ``turn``, and the frame at the
        point that stays where it is; the drag's height moves it off the axis. Raises as ``_vehicle`` does.
        """
        belief, body, point = task.believed, task.object, contact.point
        cop = pressed_cop(point, contact.load, belief.mass * GRAVITY)
        if belief.rho is not None:
            car = Unicycle(point, cop, belief.rho)
            return car, car.X_BV

        def pressure_at(p: Point) -> PressureSamples:
            return support_pressure(body.shape, 1.0, body.center_of_mass, p, RESOLUTION)

        (ex, ey), side = Unicycle(point, cop, 1.0).axis, math.copysign(1.0, turn)
        twist = pressed_twist(
            pressure_at, belief.support_friction, cop, point, body.shape.height, (-side * ey, side * ex)
        )
        pivot = (-twist.vy / twist.w, twist.vx / twist.w)
        back = (cop[0] - pivot[0]) * ex + (cop[1] - pivot[1]) * ey
        return Unicycle(point, cop, math.sqrt(back * math.dist(point, cop))), Pose2(*pivot, math.atan2(ey, ex))

    def _draft(self, task: Task, contact: Contact, backward: bool, vehicle: str) -> Choice:
        """Judge one contact and direction but for the arm's reach."""
        belief, body = task.believed, task.object
        drive = "turned about its axle" if vehicle == "pivot" else "pushed" if backward else "pulled"
        what = f"{drive} at ({contact.point[0]:.3f}, {contact.point[1]:.3f})"

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", (contact,))

        if not inside_top(body, contact.point, EDGE):
            return refused(f"the contact must be {EDGE * 1e3:.0f} mm inside the object's top")
        turn = remainder(task.goal.yaw - task.start.yaw, TURN)
        try:
            if vehicle == "pivot":
                car, X_BV = self._pivot(task, contact, turn)
            else:
                car = self._vehicle(task, contact, backward)
                X_BV = car.X_BV
        except ValueError as error:
            return refused(str(error))
        (ex, ey), shift = car.axis, body.shape.height * belief.support_friction
        room = room_inside(body, (car.cop[0] + shift * ex, car.cop[1] + shift * ey))
        if room < TIPPING_ROOM:
            return refused(
                f"drag at {body.shape.height:.3f} m tips the object: the centre of pressure comes within "
                f"{room:.2f} half widths of the base's edge, allowed {TIPPING_ROOM:g}"
            )
        start, goal = (X.compose(body.X_GB).compose(X_BV) for X in (task.start, task.goal))
        straight = math.hypot(goal.x - start.x, goal.y - start.y)
        look_ahead = task.motion.look_ahead or min(max(0.35 * car.swing, 0.04), 0.10)
        angle = CAR_ANGLE if vehicle in ("car", "forklift") else STEEPEST
        tightest, gentle = math.tan(angle) / abs(car.reach), SWING / car.swing
        run_in, curvature = 0.0, 0.0
        path: MotionPath
        if vehicle == "pivot":
            path = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position))
            if straight > task.tolerance.position:
                return refused(
                    f"the virtual axle has to stay in its place, goal and start have it {straight * 1e3:.1f} mm "
                    f"apart, allowed {task.tolerance.position * 1e3:g} mm"
                )
        else:
            curvatures = _curvatures(gentle, tightest)
            run_in, curvature, path = gentlest(start, goal, curvatures, [k * look_ahead for k in RUN_INS])
        speed = task.motion.speed * (PUSHED_SPEED if backward else 1.0) * min(1.0, gentle / (curvature or gentle))
        time = SpeedProfile(path.length, speed, task.motion.acceleration).duration + OVERHEAD
        use = friction_use(
            contact.load, belief.mass * GRAVITY, belief.support_friction, belief.contact_friction
        )
        margin = atan(belief.contact_friction) - atan(use * belief.contact_friction)
        level = belief.support_friction * (belief.mass * GRAVITY + contact.load)
        parameters = {
            **_figures(car, X_BV, level), "look_ahead": look_ahead, "curvature": curvature, "run_in": run_in,
            "speed": speed,
            "press_force": contact.load, "friction_use": use,
        }  # fmt: skip
        reason = (
            f"{what} with {contact.load:.1f} N: path {path.length:.3f} m, virtual axle "
            f"{1e3 * math.dist(X_BV.position, car.cop):.0f} mm from the centre of pressure, "
            f"{use:.2f} of the tip's friction used"
        )
        longest = LOOP_RATIO * straight + 4.0 / gentle
        if vehicle != "pivot" and path.length > longest:
            return refused(f"only by a loop of {path.length:.2f} m, allowed {longest:.2f} m")
        return Choice(self.name, True, reason, (contact,), path.length, time, margin, parameters, path)

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the virtual axle, x along the motion."""
        p = choice.parameters
        return Pose2(p["axle_x"], p["axle_y"], p["axle_yaw"])

    def tracker(self, plan: Plan) -> UnicycleTracker | PivotTracker:
        """Return the look-ahead law for a plan, or that of a turn on the spot."""
        figures, car = plan.choice.parameters, _car(plan.choice)
        if isinstance(plan.path, TwistPath):
            return PivotTracker(car, plan.X_BV, figures["push_force"])
        fixed = plan.path.end if plan.task.motion.fixed_target else None
        law = LookAheadAlignment(figures["look_ahead"], math.tan(STEEPEST) / abs(car.reach), fixed)
        return UnicycleTracker(law, car, figures["push_force"])

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m]; ``rho`` [m] weighs torque errors (default: half
        the lever).
        """
        (contact,) = contacts
        rho = rho if rho is not None else 0.5 * max(math.hypot(*contact.point), EDGE)
        return one_press_allocator(contact.point, contact.load, friction, rho, cop)

    def identifier(self, plan: Plan) -> AxleIdentifier:
        """Return what identifies the virtual axle on the way."""
        car = _car(plan.choice)
        predicted = Identified(_ahead(car), abs(car.reach), plan.choice.parameters["push_force"])
        return AxleIdentifier(car.X_BV.yaw, predicted, car.lever)

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from the object's true pose and the true contact; None if its path is longer than
        ``longest`` [m]. ``identified``: the axle as it was seen to be.
        """
        figures, contact = plan.choice.parameters, plan.choice.contacts[0]
        task = _by_shape(plan.task) if "by_shape" in figures else plan.task
        turning = plan.path.rate(0.0)[2] if isinstance(plan.path, TwistPath) else 0.0
        contact = replace(contact, point=touched[0])
        try:
            if turning:
                car, X_BV = self._pivot(task, contact, turning)
            else:
                car = self._vehicle(task, contact, figures["backward"] > 0.0)
        except ValueError:
            return None
        level = figures["push_force"]
        if identified is not None and not turning:
            rho = math.sqrt(identified.reach * abs(car.lever))
            car = replace(car, rho=rho, shift=0.0)
            car = replace(car, shift=identified.axle - _ahead(car))
            level = identified.drag
        X_BV = X_BV if turning else car.X_BV
        start, goal = X_WB.compose(X_BV), plan.goal.compose(task.object.X_GB).compose(X_BV)
        path: MotionPath
        if turning:
            path = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position))
        else:
            run_ins = [k * figures["look_ahead"] for k in RUN_INS]
            curvatures = _curvatures(SWING / car.swing, max(figures["curvature"], SWING / car.swing))
            path = gentlest(start, goal, curvatures, run_ins, longest)[2]
        if path.length > longest:
            return None
        choice = replace(
            plan.choice, contacts=(contact,), path=path, path_length=path.length,
            parameters={**figures, **_figures(car, X_BV, level)},
        )  # fmt: skip
        profile = SpeedProfile(path.length, plan.profile.speed, plan.profile.acceleration)
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _by_shape(task: Task) -> Task:
    """The task with nothing said of rho: the object's shape decides."""
    return replace(task, belief=replace(task.believed, rho=None))


def _curvatures(gentle: float, tightest: float) -> list[float]:
    """The curvatures that are tried [1/m], none above the tightest."""
    return sorted({min(k * gentle, tightest) for k in TIGHTER})


def _ahead(car: Unicycle) -> float:
    """Coordinate of the virtual axle on the heading axis, from the CoM [m]."""
    X_BV, (ex, ey) = car.X_BV, car.axis
    return X_BV.x * ex + X_BV.y * ey


def _figures(car: Unicycle, X_BV: Pose2, level: float) -> dict[str, float]:
    """What a choice remembers of its vehicle."""
    return {
        "backward": float(car.backward), "cop_x": car.cop[0], "cop_y": car.cop[1], "rho": car.rho,
        "height_shift": car.shift, "lever": abs(car.lever), "axle_from_com": math.hypot(*X_BV.position),
        "axle_x": X_BV.x, "axle_y": X_BV.y, "axle_yaw": X_BV.yaw,
        "push_force": level,
    }  # fmt: skip


def _car(choice: Choice) -> Unicycle:
    """The vehicle of a choice."""
    p, (contact,) = choice.parameters, choice.contacts
    return Unicycle(
        contact.point, (p["cop_x"], p["cop_y"]), p["rho"], p["backward"] > 0.0, p["height_shift"]
    )


MODE = PressSlide()
allocator = MODE.allocator
