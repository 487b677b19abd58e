"""Mode press_slide: one arm presses on top and slides the object, driven as a unicycle
about its virtual axle (docs/mechanics.md, sections 2 and 4).

The line of centre of pressure and contact is the heading axis. Pulled, the contact
leads; pushed, it follows; turned on the spot, the force is across. The friction disc
under the tip has no direction of its own, so that any of these goes with any contact
that the press holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from math import atan

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.identification.online import AxleIdentifier, Identified
from pushpressslide.mechanics.pressing import friction_use, press_loads, pressed_cop
from pushpressslide.mechanics.top import inside_top, top_places
from pushpressslide.modes.base import ENOUGH, GRAVITY, UNJUDGED, path_problem, tool_load
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.pressed.manoeuvre import (
    CORRECTED,
    CORRECTING,
    pressed_manoeuvres,
)
from pushpressslide.planning.pressed.onward import onward, pressed_at
from pushpressslide.planning.pressed.ranking import by_time, soonest
from pushpressslide.planning.pressed.turns import steering_of
from pushpressslide.planning.pressed.vehicle import (
    BACK_UPS,
    LOOP,
    PLANNED,
    RUN_INS,
    SHORT_RUN_INS,
    SWING,
    after_backing_up,
    axle_ahead,
    car_of,
    figures,
    frame_of,
    plan_of,
    press_of,
    pressed_vehicle,
    turns,
    way_back,
    way_to,
)
from pushpressslide.planning.run_in import gentlest
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment
from pushpressslide.tracking.unicycle import PivotTracker, Steering, UnicycleTracker

EDGE = 0.012  # [m] that a contact stays away from the top's edges
# half widths inside the base's edge from which on the object is driven at full speed
SAFE_ROOM = 0.5
# of the motion from the normal of the face that pushes another body
TOOL_SKEW = math.radians(2.0)
SAME = 1e-3  # [m] between places that are one
# [rad] that another attempt may turn the object: the arm holds on, and has only so much
# room
AGAIN = 1.0
# share of the speed when pushed: what is ahead of the contact swings more
PUSHED_SPEED = 0.8
DIRECTIONS = {
    "unicycle": (False, True),
    "car": (False,),
    "forklift": (True,),
    "pivot": (False,),
}


class PressSlide:
    """One arm presses on top and slides the object."""

    name = "press_slide"
    arms = 1
    reduced_model = "unicycle / car / forklift"
    tracking_point = "virtual axle"
    cop_steering = True
    walls = False
    pushed_faces = 0

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return choices, feasible and quick ones first: manoeuvres where the contact
        is free, else one per direction.

        Where a believed rho leads every path out of bounds, that of the object's shape
        is planned with.
        """
        judged = self._judged(task, enough)
        told = task.believed.rho
        if told is None or any(choice.feasible for choice in judged):
            return judged
        own = self._judged(
            replace(task, belief=replace(task.believed, rho=None)), enough
        )
        note = (
            f"; planned with the shape's rho, belief.rho {told:g} m leads out of bounds"
        )
        return [replace(c, reason=c.reason + note) for c in own if c.feasible] or judged

    def _judged(self, task: Task, enough: int) -> list[Choice]:
        belief = task.believed
        most = task.limits.normal_force
        problem, loads = press_loads(
            belief.mass * GRAVITY,
            belief.support_friction,
            belief.contact_friction,
            most,
            task.motion.press_force,
            tool_load(task, 0.0)[0],
        )
        if problem is not None:
            return [Choice(self.name, False, problem)]
        com = task.object.center_of_mass
        given = task.motion.contacts
        places = (
            [(x - com[0], y - com[1]) for x, y in given[:1]]
            if given
            else top_places(task.object, EDGE)
        )
        kind = task.motion.vehicle or "unicycle"
        free = not (task.motion.vehicle or task.tool)
        manoeuvres = (
            self._manoeuvres(task, places, loads, enough) if free and not given else []
        )
        if manoeuvres and manoeuvres[0].feasible:
            return manoeuvres
        drafts = []
        for arm, place, backward in product(
            range(len(task.robots)), places, DIRECTIONS[kind]
        ):
            for load in loads:  # a lighter press tips less
                contact = Contact(
                    arm, "top", place, (0.0, 0.0), task.object.shape.height, load
                )
                draft = self._draft(task, contact, backward)
                if draft.feasible:
                    break
            drafts.append(draft)
        drafts.sort(key=_quickest)
        out = self._within_reach(task, drafts, CORRECTING, enough)
        if free and given and not any(choice.feasible for choice in out):
            manoeuvres = self._manoeuvres(task, places, loads, enough)
        # the last resort
        if not any(choice.feasible for choice in (*out, *manoeuvres)):
            out = self._within_reach(task, drafts, 0.0, enough)
        return sorted((*out, *manoeuvres), key=_quickest)

    def _within_reach(
        self, task: Task, drafts: Sequence[Choice], least: float, enough: int
    ) -> list[Choice]:
        """Return drafts planned with their turns' axle; feasible the quickest that the
        arm can follow.
        """
        out = []
        found = 0
        for choice in drafts:
            if choice.feasible and found == enough:
                choice = _refused(choice, UNJUDGED)
            elif choice.feasible:
                choice = self._steered(task, choice, least)
                choice = (
                    self._judged_for_reach(task, choice) if choice.feasible else choice
                )
                found += choice.feasible
            out.append(choice)
        return out

    def _steered(self, task: Task, draft: Choice, least: float) -> Choice:
        """Return a draft planned with its turns' axle; infeasible if steered by less
        than ``least`` [rad].
        """
        if task.believed.rho is not None or task.motion.vehicle == "pivot":
            return draft
        (contact,) = draft.contacts
        before = draft.stretches[-1].parameters
        backward = before["backward"] > 0.0
        free = math.inf
        if least > 0.0 and task.tool is None:
            free = steering_of(press_of(task, contact), backward)
        if free < least:
            degrees = math.degrees(free)
            needed = math.degrees(least)
            why = f"it is steered like a unicycle only up to {degrees:.1f} deg, needed {needed:g} deg"
            return _refused(draft, why)
        return self._draft(
            task, contact, backward, PLANNED * min(before["steepest"], free), most=free
        )

    def _judged_for_reach(self, task: Task, choice: Choice) -> Choice:
        problems = (
            path_problem(task, stretch, self.vehicle_frame(stretch))
            for stretch in choice.stretches
        )
        return next(
            (_refused(choice, problem) for problem in problems if problem is not None),
            choice,
        )

    def _manoeuvres(
        self, task: Task, places: list[Point], loads: list[float], enough: int
    ) -> list[Choice]:
        """Return manoeuvres until ``enough`` are feasible, those of the safest press
        first: one per contact, then others; with how long about contacts take that were
        not judged in full.
        """
        X_WB = task.start.compose(task.object.X_GB)
        height = task.object.shape.height
        out = list[Choice]()
        others = list[Choice]()
        left = enough
        inside = [
            p for p in places if inside_top(task.object, p, EDGE) and p != (0.0, 0.0)
        ]
        for arm, load in product(range(len(task.robots)), loads):
            contacts = [
                Contact(arm, "top", place, (0.0, 0.0), height, load) for place in inside
            ]
            ranked = by_time(task, X_WB, contacts)
            most = min(left, ENOUGH)
            for manoeuvre in soonest(task, X_WB, list(ranked)):
                out.append(
                    self._judged_for_reach(task, manoeuvre.choice(task, self.name))
                )
                most -= out[-1].feasible
                if most == 0:
                    break
            left = enough - sum(choice.feasible for choice in out)
            if left < enough and not others:
                told = "manoeuvre at ({:.3f}, {:.3f}): " + UNJUDGED
                after = overhead(task, pressed=True)
                seen = {choice.contacts[0] for choice in out}
                rest = [
                    (told.format(*c.point), (c,), t + after)
                    for c, t in ranked.items()
                    if c not in seen
                ]
                others = [
                    Choice(self.name, False, why, at, time=t, judged=False)
                    for why, at, t in rest
                ]
            # lighter presses only where more are asked for
            if left == 0 or left < enough <= ENOUGH:
                break
        return sorted(out, key=lambda choice: not choice.feasible) + others

    def _draft(
        self,
        task: Task,
        contact: Contact,
        backward: bool,
        angle: float = 0.0,
        back_ups: Sequence[float] = BACK_UPS,
        most: float = math.inf,
    ) -> Choice:
        """Judge one contact and direction, steered by at most ``most`` [rad], but for
        the arm's reach.
        """
        belief = task.believed
        motion = task.motion
        pivots = task.motion.vehicle == "pivot"
        drive = "turned on the spot" if pivots else "pushed" if backward else "pulled"
        what = f"{drive} at ({contact.point[0]:.3f}, {contact.point[1]:.3f})"

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", (contact,))

        if not inside_top(task.object, contact.point, EDGE):
            return refused(
                f"the contact must be {EDGE * 1e3:.0f} mm inside the object's top"
            )
        try:
            vehicle = pressed_vehicle(task, contact, backward, angle, most)
            # where it cannot go back there is no second attempt: only with a long
            # run-in
            returns = (
                not pivots and way_back(task, vehicle.press, not backward) is not None
            )
        except ValueError as error:
            return refused(str(error))
        car = vehicle.car
        X_BV = vehicle.X_BV
        press = vehicle.press
        mu = belief.contact_friction
        load, off = tool_load(task, X_BV.yaw)
        if off > TOOL_SKEW:
            degrees = math.degrees(off)
            skew = math.degrees(TOOL_SKEW)
            return refused(
                f"it drives {degrees:.1f} deg off the normal of tool.face, allowed "
                f"{skew:g} deg"
            )
        use = friction_use(
            contact.load, press.weight, belief.support_friction, mu, load
        )
        start, goal = (
            X.compose(task.object.X_GB).compose(X_BV) for X in (task.start, task.goal)
        )
        look_ahead = motion.look_ahead or min(max(0.35 * car.length, 0.04), 0.10)
        speed = (
            motion.speed
            * min(1.0, vehicle.room / SAFE_ROOM)
            * (PUSHED_SPEED if backward else 1.0)
        )
        level = belief.support_friction * (press.weight + contact.load)
        parameters = vehicle.figures(level)
        parameters |= {
            "look_ahead": look_ahead,
            "press_force": contact.load,
            "friction_use": use,
        }
        path: MotionPath
        if pivots:
            path = TwistPath.between(
                (start, goal), math.dist(contact.point, X_BV.position)
            )
            way = None
            moves = math.dist(start.position, goal.position) * 1e3
            near = task.tolerance.position * 1e3
            if moves > near:
                return refused(
                    "the point about which it turns has to stay in its place, from "
                    "start to goal it moves "
                    f"by {moves:.1f} mm, allowed {near:g} mm"
                )
        else:
            straight = 0.0 if task.tool is None else task.tool.straight
            run_ins = [
                straight + k * look_ahead for k in (RUN_INS if returns else RUN_INS[:2])
            ]
            way = way_to(start, goal, vehicle, run_ins, back_ups if returns else (0.0,))
            path = way.path
            # else a manoeuvre is the better way
            loop = LOOP if motion.vehicle or task.tool else 0.0
            if way.too_long > loop:
                return refused(
                    f"only by a loop of {path.length:.2f} m, {way.too_long:.2f} m too "
                    "long, allowed "
                    f"{loop:g} m"
                )
            speed *= min(1.0, SWING / (car.length * way.curvature))
            parameters |= {"curvature": way.curvature, "run_in": way.run_in}
        parameters["speed"] = speed
        time = SpeedProfile(
            path.length, speed, motion.acceleration
        ).duration + overhead(task, pressed=True)
        reason = (
            f"{what} with {contact.load:.1f} N: path {path.length:.3f} m, virtual axle "
            f"{1e3 * math.dist(X_BV.position, car.cop):.0f} mm from the centre of "
            "pressure, "
            f"{use:.2f} of the tip's friction used"
        )
        margin = atan(mu) - atan(use * mu)
        made = Choice(
            self.name,
            True,
            reason,
            (contact,),
            path.length,
            time,
            margin,
            parameters,
            path,
        )
        return (
            after_backing_up(task, vehicle, made, way.back_up)
            if way and way.back_up
            else made
        )

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the virtual axle, x along the motion."""
        return frame_of(choice)

    def tracker(self, plan: Plan) -> UnicycleTracker | PivotTracker:
        """Return the look-ahead law for a plan, or that of a turn on the spot."""
        planned = plan.choice.parameters
        car = car_of(plan.choice)
        if isinstance(plan.path, TwistPath):
            return PivotTracker(car, plan.X_BV, planned["push_force"])
        fixed = plan.path.end if plan.task.motion.fixed_target else None
        law = LookAheadAlignment(planned["look_ahead"], math.inf, fixed)
        return UnicycleTracker(law, Steering.of(planned, car))

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m]; ``rho`` [m] weighs torque
        errors (default: half the lever).
        """
        (contact,) = contacts
        rho = rho if rho is not None else 0.5 * max(math.hypot(*contact.point), EDGE)
        return one_press_allocator(contact.point, contact.load, friction, rho, cop)

    def identifier(self, plan: Plan) -> AxleIdentifier:
        """Return what identifies the virtual axle on the way."""
        car = car_of(plan.choice)
        predicted = Identified(
            axle_ahead(car), abs(car.reach), plan.choice.parameters["push_force"]
        )
        return AxleIdentifier(
            car.X_BV.yaw, predicted, car.lever, plan.choice.parameters.get("stiffness")
        )

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return a plan that goes back and then to the goal; None for a turn on the
        spot, or where the object would tip.
        """
        planned = plan.choice.parameters
        (contact,) = plan.choice.contacts
        if isinstance(plan.path, TwistPath):
            return None
        task = replace(plan.task, start=X_WB.compose(plan.task.object.X_GB.inverse()))
        contact = replace(contact, point=touched[0])
        most = planned["steepest"]
        backward = planned["backward"]
        choice = self._draft(
            task, contact, backward > 0.0, PLANNED * most, BACK_UPS[1:], most
        )
        if not choice.feasible or "manoeuvre" in planned:
            found = [
                m for m in pressed_manoeuvres(task, X_WB, [contact]) if m.swing < AGAIN
            ]
            if not found:
                return None
            choice = found[0].choice(task, self.name)
        return plan_of(plan.task, choice, plan.profile.acceleration)

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from the object's true pose and the true contact; None if its
        path is longer than ``longest`` [m]. ``identified``: the axle as it was seen to
        be.
        """
        task = plan.task
        planned = plan.choice.parameters
        pivots = isinstance(plan.path, TwistPath)
        contact = replace(plan.choice.contacts[0], point=touched[0])
        level = planned["push_force"]
        if contact.point == (0.0, 0.0):
            return None
        if planned.get("manoeuvre"):
            fresh = onward(plan, X_WB, contact)
            return fresh if fresh.path.length <= longest else None
        if "manoeuvre" in planned:
            planned = (plan := pressed_at(plan, contact)).choice.parameters
        cop = pressed_cop(contact.point, contact.load, task.believed.mass * GRAVITY)
        car = replace(car_of(plan.choice), contact=contact.point, cop=cop)
        X_BV = plan.X_BV
        if not pivots:
            if identified is not None:
                car = replace(
                    car, rho=math.sqrt(identified.reach * abs(car.lever)), shift=0.0
                )
                car = replace(car, shift=identified.axle - axle_ahead(car))
                level = identified.drag
            X_BV = car.X_BV
        start = X_WB.compose(X_BV)
        goal = plan.goal.compose(task.object.X_GB).compose(X_BV)
        path: MotionPath
        ahead, left = goal.unapply(start.position)
        straight = "manoeuvre" in planned and ahead < 0.0 and abs(left) < CORRECTED
        if pivots:
            path = TwistPath.between(
                (start, goal), math.dist(contact.point, X_BV.position)
            )
        elif straight:  # steering along the run-in is enough
            path = ArcPath(advance(goal, 0.0, ahead), ((0.0, -ahead),))
        else:
            curvatures = turns(
                car, math.tan(PLANNED * planned["steepest"]) / abs(car.reach)
            )
            run_ins = [k * planned["look_ahead"] for k in SHORT_RUN_INS]
            path = gentlest(start, goal, curvatures, run_ins, longest)[2]
        if path.length > longest:
            return None
        parameters = {**planned, **figures(car, X_BV, level)}
        choice = replace(
            plan.choice,
            contacts=(contact,),
            path=path,
            path_length=path.length,
            parameters=parameters,
        )
        profile = SpeedProfile(
            path.length, plan.profile.speed, plan.profile.acceleration
        )
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _quickest(choice: Choice) -> tuple[bool, float]:
    return not choice.feasible, choice.time if choice.time is not None else math.inf


def _refused(choice: Choice, why: str) -> Choice:
    reason = f"{choice.reason.split(' with ')[0]}: {why}"
    return replace(choice, feasible=False, judged=why is not UNJUDGED, reason=reason)


MODE = PressSlide()
allocator = MODE.allocator
