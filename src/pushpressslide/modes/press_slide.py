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
from math import atan

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import ArcPath, SpeedProfile
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import MOST_USE, friction_use, press_loads, pressed_cop
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.modes.base import overhead, path_problem, tool_load
from pushpressslide.planning.pressed_vehicle import (
    BACK_UPS,
    LOOP,
    PLANNED,
    RUN_INS,
    SHORT_RUN_INS,
    STEEPEST,
    SWING,
    PressedVehicle,
    axle_ahead,
    figures,
    pressed_vehicle,
    turns,
    way_back,
    way_to,
)
from pushpressslide.planning.run_in import gentlest
from pushpressslide.rom.unicycle import Unicycle
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, UnicycleTracker

GRAVITY = 9.81
EDGE = 0.012  # [m] that a contact stays away from the top's edges
SAFE_ROOM = 0.5  # half widths inside the base's edge from which on the object is driven at full speed
# share of the vehicle's length by which the virtual axle may move between straight and a plan's turns
AXLE_PLAY = 0.45
TOOL_SKEW = math.radians(2.0)  # of the motion from the normal of the face that pushes another body
ENOUGH = 8  # choices that the arm can follow: slower ones are not looked at
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

        Where a believed rho leads every path out of bounds, the rho of the object's shape is planned with,
        and what is true is found out on the way.
        """
        judged = self._judged(task)
        told = task.believed.rho
        if told is None or any(choice.feasible for choice in judged):
            return judged
        own = self._judged(replace(task, belief=replace(task.believed, rho=None)))
        note = f"; planned with the shape's rho, belief.rho {told:g} m leads out of bounds"
        return [replace(c, reason=c.reason + note) for c in own if c.feasible] or judged

    def _judged(self, task: Task) -> list[Choice]:
        belief, most = task.believed, task.limits.normal_force
        problem, loads = press_loads(
            belief.mass * GRAVITY, belief.support_friction, belief.contact_friction, most,
            task.motion.press_force,
        )  # fmt: skip
        if problem is not None:
            return [Choice(self.name, False, problem)]
        directions = DIRECTIONS[task.motion.vehicle or "unicycle"]
        com, given = task.object.center_of_mass, task.motion.contacts
        places = [(x - com[0], y - com[1]) for x, y in given[:1]] if given else top_places(task.object, EDGE)
        drafts = []
        for arm in range(len(task.robots)):
            for place in places:
                for backward in directions:
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
        """Return a draft planned with the axle of its turns' force angle; infeasible out of the arm's
        reach.
        """
        (contact,) = choice.contacts
        if task.believed.rho is None and task.motion.vehicle != "pivot":
            before = choice.stretches[-1].parameters
            choice = self._draft(task, contact, before["backward"] > 0.0, PLANNED * before["steepest"])
            if not choice.feasible:
                return choice
            after = choice.stretches[-1].parameters
            moved = math.dist((after["axle_x"], after["axle_y"]), (before["axle_x"], before["axle_y"]))
            length = math.dist((before["axle_x"], before["axle_y"]), contact.point)
            if moved > AXLE_PLAY * length:
                what = choice.reason.split(" with ")[0]
                why = (
                    f"the virtual axle moves by {moved * 1e3:.0f} mm between straight and turning, allowed "
                    f"{AXLE_PLAY:g} of the {length * 1e3:.0f} mm to the contact"
                )
                return replace(choice, feasible=False, reason=f"{what}: {why}")
        problems = (path_problem(task, stretch, self.vehicle_frame(stretch)) for stretch in choice.stretches)
        problem = next((problem for problem in problems if problem is not None), None)
        if problem is None:
            return choice
        return replace(choice, feasible=False, reason=f"{choice.reason.split(' with ')[0]}: {problem}")

    def _draft(
        self,
        task: Task,
        contact: Contact,
        backward: bool,
        angle: float = 0.0,
        back_ups: Sequence[float] = BACK_UPS,
    ) -> Choice:
        """Judge one contact and direction but for the arm's reach."""
        belief, motion, pivots = task.believed, task.motion, task.motion.vehicle == "pivot"
        drive = "turned on the spot" if pivots else "pushed" if backward else "pulled"
        what = f"{drive} at ({contact.point[0]:.3f}, {contact.point[1]:.3f})"

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", (contact,))

        if not inside_top(task.object, contact.point, EDGE):
            return refused(f"the contact must be {EDGE * 1e3:.0f} mm inside the object's top")
        try:
            vehicle = pressed_vehicle(task, contact, backward, angle)
            # where it cannot go back there is no second attempt: only with a long run-in
            returns = not pivots and way_back(task, vehicle.press, not backward) is not None
        except ValueError as error:
            return refused(str(error))
        car, X_BV, press, mu = vehicle.car, vehicle.X_BV, vehicle.press, belief.contact_friction
        load, off = tool_load(task, X_BV.yaw)
        if off > TOOL_SKEW:
            degrees, most = math.degrees(off), math.degrees(TOOL_SKEW)
            return refused(f"it drives {degrees:.1f} deg off the normal of tool.face, allowed {most:g} deg")
        use = friction_use(contact.load, press.weight, belief.support_friction, mu)
        use += load / (mu * contact.load)
        if use > MOST_USE:
            return refused(
                f"with the pushed body's {load:.1f} N straight sliding takes {use:.2f} of the tip's "
                f"friction, "
                f"allowed {MOST_USE:g}"
            )
        start, goal = (X.compose(task.object.X_GB).compose(X_BV) for X in (task.start, task.goal))
        look_ahead = motion.look_ahead or min(max(0.35 * car.length, 0.04), 0.10)
        speed = motion.speed * min(1.0, vehicle.room / SAFE_ROOM) * (PUSHED_SPEED if backward else 1.0)
        level = belief.support_friction * (press.weight + contact.load)
        parameters = vehicle.figures(level)
        parameters |= {"look_ahead": look_ahead, "press_force": contact.load, "friction_use": use}
        path: MotionPath
        if pivots:
            path, way = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position)), None
            moves, most = math.dist(start.position, goal.position) * 1e3, task.tolerance.position * 1e3
            if moves > most:
                return refused(
                    f"the point about which it turns has to stay in its place, from start to goal it "
                    f"moves by "
                    f"{moves:.1f} mm, allowed {most:g} mm"
                )
        else:
            straight = 0.0 if task.tool is None else task.tool.straight
            run_ins = [straight + k * look_ahead for k in (RUN_INS if returns else RUN_INS[:2])]
            way = way_to(start, goal, vehicle, run_ins, back_ups if returns else (0.0,))
            path = way.path
            if way.too_long > LOOP:
                return refused(
                    f"only by a loop of {path.length:.2f} m, {way.too_long:.2f} m too long, allowed "
                    f"{LOOP:g} m"
                )
            speed *= min(1.0, SWING / (car.length * way.curvature))
            parameters |= {"curvature": way.curvature, "run_in": way.run_in}
        parameters["speed"] = speed
        time = SpeedProfile(path.length, speed, motion.acceleration).duration + overhead(task, contact.load)
        reason = (
            f"{what} with {contact.load:.1f} N: path {path.length:.3f} m, virtual axle "
            f"{1e3 * math.dist(X_BV.position, car.cop):.0f} mm from the centre of pressure, "
            f"{use:.2f} of the tip's friction used"
        )
        margin = atan(mu) - atan(use * mu)
        made = Choice(self.name, True, reason, (contact,), path.length, time, margin, parameters, path)
        if way is None or way.back_up == 0.0:
            return made
        return self._after_backing_up(task, vehicle, made, way.back_up)

    @staticmethod
    def _after_backing_up(task: Task, vehicle: PressedVehicle, then: Choice, way: float) -> Choice:
        """Return the choice to drive ``way`` [m] straight the other way first, and then as ``then`` does."""
        car = way_back(task, vehicle.press, not vehicle.car.backward)
        assert car is not None
        path = ArcPath(task.start.compose(task.object.X_GB).compose(car.X_BV), ((0.0, way),))
        goal = path.end.compose(car.X_BV.inverse()).compose(task.object.X_GB.inverse())
        time = SpeedProfile(way, then.parameters["speed"], task.motion.acceleration).duration
        parameters = {**then.parameters, **figures(car, car.X_BV, then.parameters["push_force"])}
        parameters |= {"curvature": 1.0 / car.length, "run_in": way, "steepest": STEEPEST[0]}
        return replace(
            then, reason=f"{then.reason}, {way:g} m back first", path_length=way + (then.path_length or 0.0),
            time=time + (then.time or 0.0), parameters=parameters, path=path, goal=goal, following=then,
        )  # fmt: skip

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the virtual axle, x along the motion."""
        p = choice.parameters
        return Pose2(p["axle_x"], p["axle_y"], p["axle_yaw"])

    def tracker(self, plan: Plan) -> UnicycleTracker | PivotTracker:
        """Return the look-ahead law for a plan, or that of a turn on the spot."""
        planned, car = plan.choice.parameters, _car(plan.choice)
        if isinstance(plan.path, TwistPath):
            return PivotTracker(car, plan.X_BV, planned["push_force"])
        fixed = plan.path.end if plan.task.motion.fixed_target else None
        law = LookAheadAlignment(planned["look_ahead"], math.tan(planned["steepest"]) / abs(car.reach), fixed)
        return UnicycleTracker(law, car, planned["push_force"])

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
        predicted = Identified(axle_ahead(car), abs(car.reach), plan.choice.parameters["push_force"])
        return AxleIdentifier(car.X_BV.yaw, predicted, car.lever)

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return a plan that goes back straight and then to the goal; None for a turn on the spot, or where
        the object would tip.
        """
        planned, (contact,) = plan.choice.parameters, plan.choice.contacts
        if isinstance(plan.path, TwistPath):
            return None
        task = replace(plan.task, start=X_WB.compose(plan.task.object.X_GB.inverse()))
        contact, angle = replace(contact, point=touched[0]), PLANNED * planned["steepest"]
        choice = self._draft(task, contact, planned["backward"] > 0.0, angle, BACK_UPS[1:])
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
        task, planned, pivots = plan.task, plan.choice.parameters, isinstance(plan.path, TwistPath)
        contact, level = replace(plan.choice.contacts[0], point=touched[0]), planned["push_force"]
        if contact.point == (0.0, 0.0):
            return None
        cop = pressed_cop(contact.point, contact.load, task.believed.mass * GRAVITY)
        car, X_BV = replace(_car(plan.choice), contact=contact.point, cop=cop), plan.X_BV
        if not pivots:
            if identified is not None:
                car = replace(car, rho=math.sqrt(identified.reach * abs(car.lever)), shift=0.0)
                car, level = replace(car, shift=identified.axle - axle_ahead(car)), identified.drag
            X_BV = car.X_BV
        start, goal = X_WB.compose(X_BV), plan.goal.compose(task.object.X_GB).compose(X_BV)
        path: MotionPath
        if pivots:
            path = TwistPath.between((start, goal), math.dist(contact.point, X_BV.position))
        else:
            curvatures = turns(car, max(planned["curvature"], SWING / car.length))
            run_ins = [k * planned["look_ahead"] for k in SHORT_RUN_INS]
            path = gentlest(start, goal, curvatures, run_ins, longest)[2]
        if path.length > longest:
            return None
        parameters = {**planned, **figures(car, X_BV, level)}
        choice = replace(
            plan.choice, contacts=(contact,), path=path, path_length=path.length, parameters=parameters
        )
        profile = SpeedProfile(path.length, plan.profile.speed, plan.profile.acceleration)
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _car(choice: Choice) -> Unicycle:
    """The vehicle of a choice."""
    p, (contact,) = choice.parameters, choice.contacts
    return Unicycle(contact.point, (p["cop_x"], p["cop_y"]), p["rho"], p["backward"] > 0.0, p["height_shift"])


MODE = PressSlide()
allocator = MODE.allocator
