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
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import Press, friction_use, least_load
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.modes.base import path_problem
from pushpressslide.planning.run_in import gentlest, room
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, UnicycleTracker

GRAVITY = 9.81
TURN = 2.0 * math.pi
USE = (0.7, 0.8, 0.9, 0.96)  # shares of the press's friction that a motion may take, the best first
LEAST_PRESS = 2.0  # [N] below which contact is not felt for sure
EDGE = 0.012  # [m] that a contact stays away from the top's edges
TIPPING_ROOM, SAFE_ROOM = 0.2, 0.5  # half widths that the centre of pressure stays inside the base's edge
# force angles from the motion that steering may be bounded by: the steepest that does not tip the object
STEEPEST = tuple(math.radians(a) for a in (35.0, 45.0, 60.0))
PLANNED = 0.6  # share of the bound that a plan's turns use; the rest is for corrections
# share of the vehicle's length by which the virtual axle may move between straight and a plan's turns
AXLE_PLAY = 0.45
TOOL_SKEW = math.radians(2.0)  # of the motion from the normal of the face that pushes another body
LOOP = 0.3  # [m] that a path may be longer than one without a loop
CAR_ANGLE = math.radians(45.0)  # the bound for a car or a forklift
SWING = 1.2  # times the axle's speed that the contact may move in a turn; tighter turns are slower
TIGHTER = (0.5, 0.75, 1.0, 2.0)  # curvatures that are tried, in units of that turn's
BACK_UPS = (0.0, 0.1, 0.2, 0.3)  # [m] that it first goes back straight, where the goal is too near for a plain path
OVERHEAD = 4.0  # [s] approach and release
ENOUGH = 8  # choices that the arm can follow: slower ones are not looked at
RUN_INS = (5.0, 3.0, 1.5)  # straight ends that are tried, in look-aheads
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
        told = task.believed.rho
        if told is None or any(choice.feasible for choice in judged):
            return judged
        own = self._judged(replace(task, belief=replace(task.believed, rho=None)))
        note = f"; planned with the shape's rho, belief.rho {told:g} m leads out of bounds"
        return [replace(c, reason=c.reason + note) for c in own if c.feasible] or judged

    def _judged(self, task: Task) -> list[Choice]:
        problem, loads = self._loads(task)
        if problem is not None:
            return [Choice(self.name, False, problem)]
        vehicle, com, given = task.motion.vehicle or "unicycle", task.object.center_of_mass, task.motion.contacts
        places = [(x - com[0], y - com[1]) for x, y in given[:1]] if given else top_places(task.object, EDGE)
        drafts = []
        for arm in range(len(task.robots)):
            for place in places:
                for backward in DIRECTIONS[vehicle]:
                    for load in loads:  # a lighter press tips less
                        contact = Contact(arm, "top", place, (0.0, 0.0), task.object.shape.height, load)
                        draft = self._draft(task, contact, backward)
                        if draft.feasible:
                            break
                    drafts.append(draft)
        out, found = [], 0
        for choice in sorted(drafts, key=lambda c: c.time if c.time is not None else math.inf):
            if choice.feasible and found == ENOUGH:
                what = choice.reason.split(" with ")[0]
                choice = replace(choice, feasible=False, reason=f"{what}: slower than {ENOUGH} others")
            elif choice.feasible:
                choice = self._within_reach(task, choice)
                found += choice.feasible
            out.append(choice)
        return sorted(out, key=lambda c: (not c.feasible, c.time if c.time is not None else math.inf))

    def _within_reach(self, task: Task, choice: Choice) -> Choice:
        """Return a draft planned with the axle of its turns' force angle; infeasible out of the arm's reach."""
        (contact,) = choice.contacts
        figures = choice.stretches[-1].parameters
        if task.believed.rho is None and task.motion.vehicle != "pivot":
            backward, before = figures["backward"] > 0.0, figures
            choice = self._draft(task, contact, backward, PLANNED * figures["steepest"])
            if not choice.feasible:
                return choice
            figures = choice.stretches[-1].parameters
            moved = math.dist((figures["axle_x"], figures["axle_y"]), (before["axle_x"], before["axle_y"]))
            length = math.dist((before["axle_x"], before["axle_y"]), contact.point)
            if moved > AXLE_PLAY * length:
                what = choice.reason.split(" with ")[0]
                why = (
                    f"the virtual axle moves by {moved * 1e3:.0f} mm between straight and turning, allowed "
                    f"{AXLE_PLAY:g} of the {length * 1e3:.0f} mm to the contact"
                )
                return replace(choice, feasible=False, reason=f"{what}: {why}")
        problems = (path_problem(task, stretch, self.vehicle_frame(stretch)) for stretch in choice.stretches)
        why = next((problem for problem in problems if problem is not None), None)
        if why is None:
            return choice
        return replace(choice, feasible=False, reason=f"{choice.reason.split(' with ')[0]}: {why}")

    @staticmethod
    def _loads(task: Task) -> tuple[str | None, list[float]]:
        """Return what stands against any press, and the loads [N] to try, the safest first."""
        belief, most = task.believed, task.limits.normal_force
        mu_s, mu_a, weight = belief.support_friction, belief.contact_friction, belief.mass * GRAVITY
        wanted = task.motion.press_force
        if wanted is None:
            loads = [max(LEAST_PRESS, least_load(weight, mu_s, mu_a, use)) for use in USE]
            if loads[-1] <= most:
                return None, sorted({load for load in loads if load <= most}, reverse=True)
            if mu_a <= mu_s:
                return f"contact friction {mu_a:g} must exceed the support's, {mu_s:g}: no press drags", []
            return f"needs a press of {loads[-1]:.1f} N, limits.normal_force is {most:g} N", []
        if wanted > most:
            return f"motion.press_force of {wanted:g} N, limits.normal_force is {most:g} N", []
        use = friction_use(wanted, weight, mu_s, mu_a)
        if use > USE[-1]:
            needed = mu_s * (weight + wanted) / (USE[-1] * wanted)
            return (
                f"pressed with {wanted:g} N the tip slips before the object: straight sliding takes {use:.2f} "
                f"of its friction, allowed {USE[-1]:g}; contact friction {mu_a:g}, needed {needed:.3f}"
            ), []
        return None, [wanted]

    @staticmethod
    def _press(task: Task, contact: Contact) -> Press:
        belief = task.believed
        return Press(
            task.object, contact.point, contact.load, belief.mass * GRAVITY, belief.support_friction
        )

    def _vehicle(self, task: Task, press: Press, backward: bool, angle: float) -> Unicycle:
        """Return the object as a vehicle, as believed, that turns by a force at ``angle`` [rad].

        Raises ValueError where it tips.
        """
        rho = task.believed.rho
        if rho is not None:
            return Unicycle(press.contact, press.cop, rho, backward, press.shift)
        ahead, reach = press.axle(angle, backward)
        shift = -ahead - reach if backward else ahead + reach
        return Unicycle(press.contact, press.cop, math.sqrt(reach * press.lever), backward, shift)

    def _draft(
        self,
        task: Task,
        contact: Contact,
        backward: bool,
        angle: float = 0.0,
        back_ups: Sequence[float] = BACK_UPS,
    ) -> Choice:
        """Judge one contact and direction but for the arm's reach."""
        belief, motion, vehicle = task.believed, task.motion, task.motion.vehicle
        pivots = vehicle == "pivot"
        drive = "turned on the spot" if pivots else "pushed" if backward else "pulled"
        what = f"{drive} at ({contact.point[0]:.3f}, {contact.point[1]:.3f})"

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", (contact,))

        if not inside_top(task.object, contact.point, EDGE):
            return refused(f"the contact must be {EDGE * 1e3:.0f} mm inside the object's top")
        left = remainder(task.goal.yaw - task.start.yaw, TURN) > 0.0
        try:
            press = self._press(task, contact)
            bounds = (0.5 * math.pi,) if pivots else STEEPEST
            rooms = [(a, min(press.room(s * (math.pi - a if backward else a)) for s in (-1, 1))) for a in bounds]
            if rooms[0][1] < TIPPING_ROOM:
                return refused(
                    f"drag at {task.object.shape.height:.3f} m tips it: the centre of pressure comes within "
                    f"{rooms[0][1]:.2f} half widths of the base's edge, allowed {TIPPING_ROOM:g}"
                )
            steepest = max(a for a, room in rooms if room >= TIPPING_ROOM)
            if vehicle in ("car", "forklift"):
                steepest = min(steepest, CAR_ANGLE)
            if pivots:
                car, pivot = Unicycle(press.contact, press.cop, 1.0), press.pivot(left)
                back = (press.cop[0] - pivot[0]) * car.axis[0] + (press.cop[1] - pivot[1]) * car.axis[1]
                car = replace(car, rho=math.sqrt(back * press.lever))
                X_BV = Pose2(*pivot, car.X_BV.yaw)
            else:
                car = self._vehicle(task, press, backward, angle)
                X_BV = car.X_BV
        except ValueError as error:
            return refused(str(error))
        load, off = _tool_load(task, X_BV.yaw)
        if off > TOOL_SKEW:
            return refused(f"it drives {math.degrees(off):.1f} deg off the normal of tool.face, allowed "
                f"{math.degrees(TOOL_SKEW):g} deg")
        start, goal = (X.compose(task.object.X_GB).compose(X_BV) for X in (task.start, task.goal))
        look_ahead = motion.look_ahead or min(max(0.35 * car.length, 0.04), 0.10)
        gentle, steady = SWING / car.length, min(1.0, rooms[0][1] / SAFE_ROOM)
        speed = motion.speed * steady * (PUSHED_SPEED if backward else 1.0)
        back_up, path = 0.0, self._pivot_path(start, goal, math.dist(contact.point, X_BV.position))
        if pivots:
            moves = math.dist(start.position, goal.position)
            run_in, curvature = 0.0, 0.0
            if moves > task.tolerance.position:
                return refused(
                    f"the point about which it turns has to stay in its place, from start to goal it moves by "
                    f"{moves * 1e3:.1f} mm, allowed {task.tolerance.position * 1e3:g} mm"
                )
        else:
            curvatures = _curvatures(gentle, math.tan(PLANNED * steepest) / abs(car.reach))
            # where it cannot go back there is no second attempt: only with a long run-in
            returns = self._way_back(task, press, not backward) is not None
            straight = 0.0 if task.tool is None else task.tool.straight
            run_ins = [straight + k * look_ahead for k in (RUN_INS if returns else RUN_INS[:2])]
            ways = []
            for back_up in back_ups if returns else (0.0,):
                begin = advance(start, 0.0, -back_up)
                run_in, curvature, path = gentlest(begin, goal, curvatures, run_ins)
                ways.append((path.length - room(begin, goal, curvature), back_up, run_in, curvature, path))
                if ways[-1][0] <= 0.0:
                    break
            over, back_up, run_in, curvature, path = min(ways, key=lambda way: max(way[0], 0.0))
            if over > LOOP:
                return refused(f"only by a loop of {path.length:.2f} m, {over:.2f} m too long, allowed {LOOP:g} m")
            speed *= min(1.0, gentle / curvature)
        time = SpeedProfile(path.length, speed, motion.acceleration).duration + OVERHEAD
        mu = belief.contact_friction
        use = friction_use(contact.load, press.weight, belief.support_friction, mu) + load / (mu * contact.load)
        if use > USE[-1]:
            return refused(f"with the pushed body's {load:.1f} N straight sliding takes {use:.2f} of the tip's "
                f"friction, allowed {USE[-1]:g}")
        level = belief.support_friction * (press.weight + contact.load)
        parameters = {
            **_figures(car, X_BV, level), "steepest": steepest, "look_ahead": look_ahead,
            "curvature": curvature, "run_in": run_in, "speed": speed, "press_force": contact.load,
            "friction_use": use,
        }  # fmt: skip
        reason = (
            f"{what} with {contact.load:.1f} N: path {path.length:.3f} m, virtual axle "
            f"{1e3 * math.dist(X_BV.position, car.cop):.0f} mm from the centre of pressure, "
            f"{use:.2f} of the tip's friction used"
        )
        margin = atan(mu) - atan(use * mu)
        made = Choice(self.name, True, reason, (contact,), path.length, time, margin, parameters, path)
        return made if back_up == 0.0 else self._after_backing_up(task, press, made, back_up)

    def _after_backing_up(self, task: Task, press: Press, then: Choice, way: float) -> Choice:
        """Return the choice to drive ``way`` [m] straight the other way first, and then as ``then`` does."""
        backward = not then.parameters["backward"] > 0.0
        car = self._way_back(task, press, backward)
        assert car is not None
        start = task.start.compose(task.object.X_GB).compose(car.X_BV)
        path = ArcPath(start, ((0.0, way),))
        goal = path.end.compose(car.X_BV.inverse()).compose(task.object.X_GB.inverse())
        time = SpeedProfile(way, then.parameters["speed"], task.motion.acceleration).duration
        parameters = {**then.parameters, **_figures(car, car.X_BV, then.parameters["push_force"])}
        parameters |= {"curvature": 1.0 / car.length, "run_in": way, "steepest": STEEPEST[0]}
        return replace(
            then, reason=f"{then.reason}, {way:g} m back first", path_length=way + (then.path_length or 0.0),
            time=time + (then.time or 0.0), parameters=parameters, path=path, goal=goal, following=then,
        )  # fmt: skip

    def _way_back(self, task: Task, press: Press, backward: bool) -> Unicycle | None:
        """The vehicle for a short straight way; None where the object would tip, or cannot be steered since the
        drag moves the centre of pressure by more than the vehicle is long.
        """
        angle = math.pi - STEEPEST[0] if backward else STEEPEST[0]
        if min(press.room(angle), press.room(-angle)) < TIPPING_ROOM:
            return None
        car = self._vehicle(task, press, backward, 0.0)
        return car if car.length > car.shift else None

    @staticmethod
    def _pivot_path(start: Pose2, goal: Pose2, radius: float) -> MotionPath:
        return TwistPath.between((start, goal), radius)

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
        law = LookAheadAlignment(figures["look_ahead"], math.tan(figures["steepest"]) / abs(car.reach), fixed)
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

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return a plan that goes back straight and then to the goal; None for a turn on the spot, or where the
        object would tip.
        """
        figures, (contact,) = plan.choice.parameters, plan.choice.contacts
        if isinstance(plan.path, TwistPath):
            return None
        task = replace(plan.task, start=X_WB.compose(plan.task.object.X_GB.inverse()))
        angle = PLANNED * figures["steepest"]
        choice = self._draft(
            task, replace(contact, point=touched[0]), figures["backward"] > 0.0, angle, BACK_UPS[1:]
        )
        if not choice.feasible:
            return None
        made = None
        for stretch in reversed(choice.stretches):
            assert stretch.path is not None
            profile = SpeedProfile(stretch.path.length, plan.profile.speed, plan.profile.acceleration)
            frame = self.vehicle_frame(stretch)
            made = Plan(plan.task, stretch, stretch.path, profile, frame, made)
        return made

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
        task, figures, pivots = plan.task, plan.choice.parameters, isinstance(plan.path, TwistPath)
        contact, level = replace(plan.choice.contacts[0], point=touched[0]), figures["push_force"]
        if contact.point == (0.0, 0.0):
            return None
        car, X_BV = replace(_car(plan.choice), contact=contact.point, cop=self._press(task, contact).cop), plan.X_BV
        if not pivots:
            if identified is not None:
                car = replace(car, rho=math.sqrt(identified.reach * abs(car.lever)), shift=0.0)
                car, level = replace(car, shift=identified.axle - _ahead(car)), identified.drag
            X_BV = car.X_BV
        start, goal = X_WB.compose(X_BV), plan.goal.compose(task.object.X_GB).compose(X_BV)
        path: MotionPath
        if pivots:
            path = self._pivot_path(start, goal, math.dist(contact.point, X_BV.position))
        else:
            gentle = SWING / car.length
            curvatures = _curvatures(gentle, max(figures["curvature"], gentle))
            path = gentlest(start, goal, curvatures, [k * figures["look_ahead"] for k in (*RUN_INS, 0.5, 0.0)], longest)[2]
        if path.length > longest:
            return None
        parameters = {**figures, **_figures(car, X_BV, level)}
        choice = replace(
            plan.choice, contacts=(contact,), path=path, path_length=path.length, parameters=parameters
        )
        profile = SpeedProfile(path.length, plan.profile.speed, plan.profile.acceleration)
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _tool_load(task: Task, heading: float) -> tuple[float, float]:
    """What a body pushed by the object adds to the drag [N], and how far ``heading`` [rad] in B is off the
    pushing face's normal [rad].
    """
    shape, tool = task.object.shape, task.tool
    if tool is None or isinstance(shape, Cylinder):
        return 0.0, 0.0
    (ax, ay), (bx, by) = (shape.footprint[(tool.face + i) % len(shape.footprint)] for i in (0, 1))
    body = next(obstacle for obstacle in task.obstacles if obstacle.name == tool.body)
    outward = math.atan2(ax - bx, by - ay)
    return body.friction * body.mass * GRAVITY, abs(remainder(heading - outward, TURN))


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
        "axle_x": X_BV.x, "axle_y": X_BV.y, "axle_yaw": X_BV.yaw, "push_force": level,
    }  # fmt: skip


def _car(choice: Choice) -> Unicycle:
    """The vehicle of a choice."""
    p, (contact,) = choice.parameters, choice.contacts
    return Unicycle(
        contact.point, (p["cop_x"], p["cop_y"]), p["rho"], p["backward"] > 0.0, p["height_shift"]
    )


MODE = PressSlide()
allocator = MODE.allocator
