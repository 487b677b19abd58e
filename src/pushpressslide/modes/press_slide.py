"""Mode press_slide: one arm presses on top and slides the object, driven as a unicycle about its virtual axle
(docs/mechanics.md, sections 2 and 4).

The line of centre of pressure and contact is the heading axis. Pulled, the contact leads; pushed, it follows;
turned, the force is across. The friction disc under the tip has no direction of its own, so that any of these
goes with any contact that the press holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import atan, cos, remainder, sin, sqrt

from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Choice, Contact, MotionPath, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.pressing import Press, friction_use, least_load, straight_axle
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure
from pushpressslide.mechanics.top import inside_top, room_inside, top_places
from pushpressslide.modes.base import Guidance, path_problem
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

GRAVITY = 9.81
TURN = 2.0 * math.pi
USE = (0.7, 0.8, 0.9, 0.96)  # shares of the press's friction that a motion may take, the best first
LEAST_PRESS = 2.0  # [N] below which contact is not felt for sure
EDGE = 0.012  # [m] that a contact stays away from the top's edges
TIPPING_ROOM = 0.1  # of the base's half width that the centre of pressure stays inside
RESOLUTION = 4  # of the pressure samples: enough for their variance
STEEPEST = math.radians(75.0)  # force angle from the axis that steering may ask for
CAR_ANGLE = math.radians(45.0)  # the same for a plan as car or forklift
SWING = 1.2  # times the speed of the virtual axle that the contact may move in a planned turn
LOOP_RATIO = 1.6  # times the straight way: a longer path has turned a loop
OVERHEAD = 4.0  # [s] approach and release
RUN_INS = (5.0, 3.0, 1.5, 0.5, 0.0)  # straight ends that are tried, in look-aheads
PUSHED_SPEED = 0.8  # share of the speed when pushed: what is behind the axle swings more


@dataclass(frozen=True, slots=True)
class Drive:
    """The object as a vehicle: one contact, one press, one direction."""

    press: Press
    backward: bool  # pushed: the contact follows
    axle: Point  # [m] in B
    reach: float  # [m] rho^2/d > 0: tan(force angle) per curvature

    @property
    def X_BV(self) -> Pose2:
        """The vehicle frame: at the axle, x along the motion."""
        ex, ey = self.press.axis
        sign = -1.0 if self.backward else 1.0
        return Pose2(self.axle[0], self.axle[1], math.atan2(sign * ey, sign * ex))

    @property
    def swing(self) -> float:
        """Distance from the axle to the contact [m]."""
        return math.dist(self.axle, self.press.contact)

    @property
    def tightest(self) -> float:
        """Largest curvature [1/m] of a plan: by the force's angle, and by how fast the contact may swing."""
        return min(math.tan(STEEPEST) / self.reach, SWING / self.swing)


class PressSlideTracker:
    """Look-ahead alignment, and the wrench on the limit surface that turns so."""

    def __init__(self, law: LookAheadAlignment, drive: Drive, level: float) -> None:
        """Bind the law to a drive; ``level`` mu_s N [N]."""
        self._curvature = law.curvature
        X_BV, d = drive.X_BV, drive.press.lever
        self._axle = (X_BV.x, X_BV.y, X_BV.yaw, cos(X_BV.yaw), sin(X_BV.yaw))
        # pushed, the lever is negative: a force to the left turns to the right
        self._reach = -drive.reach if drive.backward else drive.reach
        self._figures = (level, d / drive.reach, drive.press.cop)
        c, p = drive.press.cop, drive.press.contact
        self._lever = (p[0] - c[0], p[1] - c[1])

    def step(self, path: MotionPath, X_WB: Pose2, progress: float, speed: float, grip: float) -> Guidance:
        """Return wrench (about the centre of pressure) and twist that follow ``path`` at ``speed`` [m/s]."""
        assert isinstance(path, ArcPath)
        qx, qy, axis, ex, ey = self._axle
        level, ratio, cop = self._figures
        yaw = X_WB.yaw
        c, s = cos(yaw), sin(yaw)
        x, y = X_WB.x + c * qx - s * qy, X_WB.y + s * qx + c * qy
        progress, left, heading, curvature = path.nearest(x, y, progress)
        heading_error = remainder(heading - yaw - axis, TURN)
        turn, saturated = self._curvature((x, y, yaw + axis), left, heading_error, curvature, grip)
        steering = atan(turn * self._reach)
        along, across = cos(steering), sin(steering)
        # |f| = mu_s N / sqrt(1 + (d sin(phi) / rho)^2), d^2 / rho^2 = d / reach
        size = level / sqrt(1.0 + ratio * across * across)
        fx, fy = size * (along * ex - across * ey), size * (across * ex + along * ey)
        rx, ry = self._lever
        w = speed * turn
        return Guidance(
            progress,
            Wrench(fx, fy, rx * fy - ry * fx, cop),
            Twist(speed * ex + w * qy, speed * ey - w * qx, w),
            steering,
            (0.0, left, heading_error),
            saturated,
        )


class PressSlide:
    """One arm presses on top and slides the object."""

    name = "press_slide"
    arms = 1
    reduced_model = "unicycle / car / forklift"
    tracking_point = "virtual axle"
    cop_steering = True

    def choices(self, task: Task) -> list[Choice]:
        """Return one choice per contact and direction, feasible ones first, the quickest first."""
        vehicle = task.motion.vehicle or "unicycle"
        problem, load = self._press_problem(task)
        places = task.motion.contacts
        com = task.object.center_of_mass
        if places is not None:
            points = [(x - com[0], y - com[1]) for x, y in places[:1]]
        else:
            points = top_places(task.object, EDGE)
        directions = {"car": (False,), "forklift": (True,), "pivot": (False,)}.get(vehicle, (False, True))
        drafts = []
        for arm in range(len(task.robots)):
            for point in points:
                contact = Contact(arm, "top", point, (0.0, 0.0), task.object.shape.height, load)
                if problem is not None:
                    drafts.append(Choice(self.name, False, problem, (contact,)))
                    continue
                drafts += [self._draft(task, contact, backward, vehicle) for backward in directions]
        drafts.sort(key=lambda c: (not c.feasible, c.time if c.time is not None else math.inf))
        return self._within_reach(task, drafts)

    @staticmethod
    def _press_problem(task: Task) -> tuple[str | None, float]:
        """Return what stands against any press, and the load [N] to press with."""
        belief, most = task.believed, task.limits.normal_force
        mu_s, mu_a, weight = belief.support_friction, belief.contact_friction, belief.mass * GRAVITY
        wanted = task.motion.press_force
        if wanted is not None:
            if wanted > most:
                return f"motion.press_force of {wanted:g} N, limits.normal_force is {most:g} N", wanted
            use = friction_use(wanted, weight, mu_s, mu_a)
            if use > USE[-1]:
                needed = mu_s * (weight + wanted) / (USE[-1] * wanted)
                return (
                    f"pressed with {wanted:g} N the contact slips before the object: straight sliding takes "
                    f"{use:.2f} of the tip's friction, allowed {USE[-1]:g}; "
                    f"contact friction {mu_a:g}, needed {needed:.3f}"
                ), wanted
            return None, wanted
        for use in USE:
            load = max(LEAST_PRESS, least_load(weight, mu_s, mu_a, use))
            if load <= most:
                return None, load
        if mu_a <= mu_s:
            return f"contact friction {mu_a:g} must exceed the support's, {mu_s:g}: no press drags", LEAST_PRESS
        return (
            f"needs a press of {least_load(weight, mu_s, mu_a, USE[-1]):.1f} N, "
            f"limits.normal_force is {most:g} N"
        ), most

    def _drive(self, task: Task, press: Press, backward: bool, rho: float | None = None) -> Drive:
        """Return the object as a vehicle, as believed; ``rho`` [m] overrides what the pressure gives.

        Raises ValueError where the object tips or the contact is at the CoM.
        """
        belief, body = task.believed, task.object
        rho = rho if rho is not None else belief.rho
        height = body.shape.height
        if rho is not None:
            e, reach = press.axis, rho * rho / press.lever
            shift = (-1.0 if backward else 1.0) * height * belief.support_friction
            back = shift - reach
            return Drive(press, backward, (press.cop[0] + back * e[0], press.cop[1] + back * e[1]), reach)

        def pressure_at(cop: Point) -> PressureSamples:
            return support_pressure(body.shape, 1.0, body.center_of_mass, cop, RESOLUTION)

        axle, reach = straight_axle(pressure_at, belief.support_friction, press, height, backward)
        return Drive(press, backward, axle, reach)

    def _draft(self, task: Task, contact: Contact, backward: bool, vehicle: str) -> Choice:
        """Judge one contact and direction but for the arm's reach."""
        belief, body = task.believed, task.object
        press = Press(contact.point, contact.load, belief.mass * GRAVITY)
        what = f"{'pushed' if backward else 'pulled'} at ({contact.point[0]:.3f}, {contact.point[1]:.3f})"

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", (contact,))

        if not inside_top(body, contact.point, EDGE):
            return refused(f"the contact must be {EDGE * 1e3:.0f} mm inside the object's top")
        try:
            e = press.axis
            shift = (-1.0 if backward else 1.0) * body.shape.height * belief.support_friction
            cop = (press.cop[0] + shift * e[0], press.cop[1] + shift * e[1])
            room = room_inside(body, cop)
            if room < TIPPING_ROOM:
                return refused(
                    f"drag at {body.shape.height:.3f} m tips the object: the centre of pressure comes within "
                    f"{room:.2f} half widths of the base's edge, allowed {TIPPING_ROOM:g}"
                )
            drive = self._drive(task, press, backward)
        except ValueError as error:
            return refused(str(error))
        X_BV, X_GB = drive.X_BV, body.X_GB
        start, goal = (X.compose(X_GB).compose(X_BV) for X in (task.start, task.goal))
        look_ahead = task.motion.look_ahead or min(max(0.35 * drive.swing, 0.04), 0.10)
        angle = CAR_ANGLE if vehicle in ("car", "forklift") else STEEPEST
        tightest = min(math.tan(angle) / drive.reach, drive.tightest)
        run_in, curvature, path = _path(start, goal, look_ahead, tightest)
        speed = task.motion.speed * (PUSHED_SPEED if backward else 1.0)
        time = SpeedProfile(path.length, speed, task.motion.acceleration).duration + OVERHEAD
        use = friction_use(press.load, press.weight, belief.support_friction, belief.contact_friction)
        margin = atan(belief.contact_friction) - atan(belief.contact_friction * use)
        parameters = {
            "backward": float(backward),
            "axle_x": drive.axle[0],
            "axle_y": drive.axle[1],
            "axle_yaw": X_BV.yaw,
            "axle_from_com": math.hypot(*drive.axle),
            "reach": drive.reach,
            "lever": press.lever,
            "rho": math.sqrt(drive.reach * press.lever),
            "cop_x": press.cop[0],
            "cop_y": press.cop[1],
            "look_ahead": look_ahead,
            "curvature": curvature,
            "run_in": run_in,
            "speed": speed,
            "push_force": belief.support_friction * press.total,
            "press_force": press.load,
            "friction_use": use,
        }
        reason = (
            f"{what} with {press.load:.1f} N: path {path.length:.3f} m, "
            f"virtual axle {1e3 * math.dist(drive.axle, press.cop):.0f} mm from the centre of pressure, "
            f"{use:.2f} of the tip's friction used"
        )
        choice = Choice(self.name, True, reason, (contact,), path.length, time, margin, parameters, path)
        straight = math.hypot(goal.x - start.x, goal.y - start.y)
        if path.length > LOOP_RATIO * straight + 4.0 / tightest:
            return replace(
                choice, feasible=False, reason=f"{what}: only by a loop of {path.length:.2f} m, "
                f"allowed {LOOP_RATIO * straight + 4.0 / tightest:.2f} m",
            )  # fmt: skip
        return choice

    def _within_reach(self, task: Task, drafts: list[Choice]) -> list[Choice]:
        """Return the choices, those infeasible that the arm cannot follow."""
        out = []
        for choice in drafts:
            if choice.feasible:
                problem = path_problem(task, choice, self.vehicle_frame(choice))
                if problem is not None:
                    what = choice.reason.split(":")[0]
                    choice = replace(choice, feasible=False, reason=f"{what}: {problem}")
            out.append(choice)
        return sorted(out, key=lambda c: not c.feasible)

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the virtual axle, x along the motion."""
        p = choice.parameters
        return Pose2(p["axle_x"], p["axle_y"], p["axle_yaw"])

    def tracker(self, plan: Plan) -> PressSlideTracker:
        """Return the look-ahead law for a plan."""
        p, (contact,) = plan.choice.parameters, plan.choice.contacts
        press = Press(contact.point, contact.load, plan.task.believed.mass * GRAVITY)
        drive = Drive(press, p["backward"] > 0.0, (p["axle_x"], p["axle_y"]), p["reach"])
        fixed = plan.path.end if plan.task.motion.fixed_target else None
        law = LookAheadAlignment(p["look_ahead"], math.tan(STEEPEST) / drive.reach, fixed)
        return PressSlideTracker(law, drive, p["push_force"])

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

    def replan(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...], longest: float) -> Plan | None:
        """Return the plan from the object's true pose and the true contact; None if its path is longer than
        ``longest`` [m].
        """
        task, figures, (old,) = plan.task, plan.choice.parameters, plan.choice.contacts
        press = Press(touched[0], old.load, task.believed.mass * GRAVITY)
        try:
            drive = self._drive(task, press, figures["backward"] > 0.0)
        except ValueError:
            return None
        X_BV = drive.X_BV
        start = X_WB.compose(X_BV)
        goal = plan.goal.compose(task.object.X_GB).compose(X_BV)
        run_in, curvature, path = _path(start, goal, figures["look_ahead"], drive.tightest, longest)
        if path.length > longest:
            return None
        parameters = {
            **figures,
            "axle_x": drive.axle[0],
            "axle_y": drive.axle[1],
            "axle_yaw": X_BV.yaw,
            "axle_from_com": math.hypot(*drive.axle),
            "reach": drive.reach,
            "lever": press.lever,
            "rho": math.sqrt(drive.reach * press.lever),
            "cop_x": press.cop[0],
            "cop_y": press.cop[1],
            "curvature": curvature,
            "run_in": run_in,
        }
        choice = replace(
            plan.choice, contacts=(replace(old, point=touched[0]),), path=path, path_length=path.length,
            parameters=parameters,
        )  # fmt: skip
        profile = SpeedProfile(path.length, plan.profile.speed, plan.profile.acceleration)
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _path(
    start: Pose2, goal: Pose2, look_ahead: float, tightest: float, longest: float | None = None
) -> tuple[float, float, ArcPath]:
    """Return run-in [m], curvature [1/m] and path of the virtual axle: gentle turns and a long straight end
    if there is room.

    ``longest`` [m]: what counts as room; default: by how far the goal is.
    """
    straight = math.hypot(goal.x - start.x, goal.y - start.y)
    best: tuple[float, float, ArcPath] | None = None
    for share in (0.5, 0.75, 1.0):
        for looks in RUN_INS:
            run_in, curvature = looks * look_ahead, share * tightest
            room = longest if longest is not None else 1.15 * straight + 1.0 / curvature
            turned = shortest_path(start, advance(goal, 0.0, -run_in), curvature, curvature)
            pieces = tuple(p for p in (*turned.pieces, (0.0, run_in)) if p[1] > 0.0)
            path = ArcPath(start, pieces)
            if path.length <= room:
                return run_in, curvature, path
            if best is None or path.length < best[2].length:
                best = (run_in, curvature, path)
    assert best is not None
    return best


MODE = PressSlide()
allocator = MODE.allocator
