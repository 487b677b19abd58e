"""Mode press_and_push: one arm presses a point of the top and pins it, the other pushes
a side face, and the object turns about the pinned point (docs/mechanics.md, sections
1.2 and 7).

An arm that does not press transmits no friction, and under two presses the object turns
best between them. To turn it about a point near its edge the second arm pushes from the
side, where it has the longest lever; the press holds what drag and push leave over.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import atan, hypot, inf

from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.osculating import dragged_ellipsoid, pressures
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.mechanics.top import inside_top, room_inside
from pushpressslide.modes.base import ENOUGH, followed, instead
from pushpressslide.planning.levers import LEAST_LEVER, Lever, depth_inside, levers
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.side_contacts import assignments, contact_height
from pushpressslide.tracking.eased import EasedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker

GRAVITY = 9.81  # [m/s^2]
# shares of the press's friction that holding the pivot may take, best first
USE = (0.5, 0.6, 0.7, 0.8, 0.9)
LEAST_PRESS = 3.0  # [N] below which contact is not felt for sure
HALVINGS = 8  # of the interval of presses
EDGE = 0.012  # [m] that the press stays away from the top's edges
LEAST_TURN = math.radians(3.0)  # of a goal
# half widths that the centre of pressure stays inside the base's edge
TIPPING_ROOM = 0.15
DECAY = 0.015  # [m] of way over which the tracker takes an error down to 1/e


@dataclass(frozen=True, slots=True)
class _Drag:
    """A press and a push that drag the object with one twist."""

    surface: DraggedSurface  # the limit surface near that twist
    forces: Allocation
    use: float  # share of the press's friction
    cop: Point  # [m] in B, centre of pressure
    room: float  # half widths of it from the base's edge


class PressAndPush:
    """One arm pins a point, the other turns the object about it."""

    name = "press_and_push"
    arms = 2
    reduced_model = "pivot about a pressed point"
    tracking_point = "the pressed point"
    cop_steering = True
    walls = False
    pushed_faces: int | None = None

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return one choice per place to push and way to give the contacts to the arms,
        feasible ones first, those with the longest lever first.
        """
        try:
            pin = _pin(task)
        except ValueError as error:
            return [Choice(self.name, False, str(error))]
        turn = math.remainder(task.goal.yaw - task.start.yaw, 2.0 * math.pi)
        places = levers(task.object, pin, math.copysign(1.0, turn), task.motion.face)
        if not places:
            least = LEAST_LEVER * 1e3
            return [
                Choice(
                    self.name,
                    False,
                    f"no face has a lever of {least:.0f} mm about the pressed point",
                )
            ]
        body = task.object
        radius = max(math.dist(pin, place.point) for place in places)
        start, goal = (
            X.compose(body.X_GB).compose(Pose2(*pin)) for X in (task.start, task.goal)
        )
        path = TwistPath.between((start, goal), radius)
        time = SpeedProfile(
            path.length, task.motion.speed, task.motion.acceleration
        ).duration
        time += overhead(task, pressed=True)
        drafts = [
            (time, partial(self._drafts, task, pin, place, path, time))
            for place in places
        ]
        return followed(task, drafts, self.vehicle_frame, enough, instead)

    def _drafts(
        self,
        task: Task,
        pin: Point,
        lever: Lever,
        path: TwistPath,
        time: float,
        judged: bool,
    ) -> list[Choice]:
        """Judge one place to push but for the arms' reach: one choice for each way to
        give the two to the arms.
        """
        body = task.object
        belief = task.believed
        cap = task.limits.normal_force
        what = (
            f"pressed at ({pin[0]:.3f}, {pin[1]:.3f}), pushed on face "
            f"{lever.face.index} at "
            f"({lever.point[0]:.3f}, {lever.point[1]:.3f})"
        )
        height = contact_height(task)

        def contacts(load: float) -> tuple[Contact, Contact]:
            return (
                Contact(0, "top", pin, (0.0, 0.0), body.shape.height, load),
                Contact(1, "side", lever.point, lever.face.normal, height),
            )

        def refused(why: str) -> list[Choice]:
            return [Choice(self.name, False, f"{what}: {why}", contacts(0.0))]

        top = body.shape.height
        if height >= top:
            return refused(
                f"the push is at {height * 1e3:.0f} mm, the object is {top * 1e3:.0f} "
                "mm high"
            )
        if not judged:
            return [Choice(self.name, True, what, contacts(0.0), path.length, time)]
        poses = [
            path.pose(0.25 * i * path.length).compose(Pose2(*pin).inverse())
            for i in range(5)
        ]
        ways = assignments(task.bases, (pin, lever.point), poses)
        if not ways:
            return refused("the arms would cross, whichever takes which contact")
        try:
            load, drag = self._press(task, contacts, _twist(path, pin))
        except ValueError as error:
            return refused(f"the object would tip: {error}")
        side = drag.forces.normals[1]
        problem = None
        if load > cap:
            problem = (
                f"motion.press_force of {load:g} N, limits.normal_force is {cap:g} N"
            )
        elif drag.forces.status != "ok" or drag.use > USE[-1]:
            problem = (
                f"pressed with {load:.1f} N the tip slips: holding the pivot takes "
                f"{drag.use:.2f} of its "
                f"friction, allowed {USE[-1]:g}; limits.normal_force is {cap:g} N"
            )
        elif side > cap:
            problem = f"needs a push of {side:.1f} N, limits.normal_force is {cap:g} N"
        elif drag.room < TIPPING_ROOM:
            problem = (
                "drag tips the object: the centre of pressure comes within "
                f"{drag.room:.2f} half widths of "
                f"the base's edge, allowed {TIPPING_ROOM:g}"
            )
        mu = belief.contact_friction
        speed = task.motion.speed
        reason = (
            f" with {load:.1f} and {side:.1f} N: lever {lever.length * 1e3:.0f} mm, "
            f"path {path.length:.3f} m, {drag.use:.2f} of the press's friction used"
        )
        parameters = {
            **_figures(drag, lever.point, lever.face.normal),
            "radius": path.radius,
            "lever": lever.length,
            "face": float(lever.face.index),
            "contact_height": height,
            "press_force": load,
            "speed": speed,
        }
        choice = Choice(
            self.name,
            problem is None,
            what + (reason if problem is None else f": {problem}"),
            contacts(load),
            path.length,
            time,
            atan(mu) - atan(drag.use * mu),
            parameters,
            path,
        )
        pairs = [zip(choice.contacts, arms, strict=True) for arms in ways]
        return [
            replace(choice, contacts=tuple(replace(c, arm=arm) for c, arm in pair))
            for pair in pairs
        ]

    def _press(
        self,
        task: Task,
        contacts: Callable[[float], tuple[Contact, Contact]],
        twist: Twist,
    ) -> tuple[float, _Drag]:
        """Return the load to press with [N], the least that is safe, and what dragging
        is like then.

        Raises ValueError where the object tips.
        """
        given = task.motion.press_force
        cap = task.limits.normal_force
        if given is not None:
            return given, self._drag(task, contacts(given), twist)
        hardest = self._drag(task, contacts(cap), twist)
        use = next((share for share in USE if hardest.use <= share), None)
        if use is None:
            return cap, hardest
        low = LEAST_PRESS
        high = cap
        drag = hardest
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            lighter = self._drag(task, contacts(middle), twist)
            if lighter.use <= use:
                high = middle
                drag = lighter
            else:
                low = middle
        return high, drag

    def _drag(self, task: Task, contacts: Sequence[Contact], twist: Twist) -> _Drag:
        """Return what dragging with ``twist`` is like. Raises ValueError where the
        object tips.
        """
        belief = task.believed
        press, push = contacts
        weight = belief.mass * GRAVITY
        mu = belief.contact_friction
        load = weight + press.load

        def forces(wrench: Wrench) -> Allocation:
            return self.allocator(contacts, mu, None, wrench.about)(
                wrench.fx, wrench.fy, wrench.tau
            )

        def shift(wrench: Wrench) -> Point:
            (ax, ay), (bx, by) = forces(wrench).forces
            h1 = press.height / load
            h2 = push.height / load
            return (h1 * ax + h2 * bx, h1 * ay + h2 * by)

        resting = center_of_pressure(weight, (0.0, 0.0), [press.load], [press.point])
        surface, cop = dragged_ellipsoid(
            pressures(task), belief.support_friction, load, resting, twist, shift
        )
        wanted = surface.wrench(twist)
        given = forces(wanted)
        lost = (
            hypot(*given.residual[:2], given.residual[2] / surface.rho)
            / surface.max_force
        )
        use = hypot(*given.forces[0]) / (mu * press.load) / max(1.0 - lost, 1e-3)
        return _Drag(surface, given, use, cop, room_inside(task.object, cop))

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the pressed point, axes along B's."""
        return Pose2(*choice.contacts[0].point)

    def tracker(self, plan: Plan) -> EasedTracker:
        """Return the holonomic law for a plan, within what the contacts hold."""
        p = plan.choice.parameters
        friction = plan.task.believed.contact_friction
        surface = DraggedSurface(
            p["push_force"], p["rho"], 0.0, (p["cop_x"], p["cop_y"])
        )
        allocate = self.allocator(
            plan.choice.contacts, friction, p["rho"], surface.center
        )

        def holds(wrench: Wrench) -> bool:
            allocation = allocate(wrench.fx, wrench.fy, wrench.tau)
            return allocation.status == "ok" and allocation.margin > 0.0

        return EasedTracker(HolonomicTracker(plan.X_BV, surface, decay=DECAY), holds)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], press first; ``rho`` is
        of no use.
        """
        press, push = contacts
        return press_and_push_allocator(
            press.point, press.load, push.point, push.normal, friction, cop
        )

    def identifier(self, plan: Plan) -> None:
        """Return nothing: the pivot is where the tip presses."""

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return the plan by one more twist to the goal; None where the push would have
        to pull.
        """
        return self.replan(plan, X_WB, touched, inf)

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan by one twist from the object's true pose and contacts; None
        if its path is longer than ``longest`` [m], or the contacts cannot drive it.
        """
        task = plan.task
        figures = plan.choice.parameters
        contacts = tuple(
            replace(c, point=p)
            for c, p in zip(plan.choice.contacts, touched, strict=True)
        )
        X_BV = Pose2(*touched[0])
        goal = plan.goal.compose(task.object.X_GB)
        path = TwistPath.between(
            (X_WB.compose(X_BV), goal.compose(X_BV)), figures["radius"]
        )
        if not 0.0 < path.length <= longest:
            return None
        try:
            drag = self._drag(task, contacts, _twist(path, touched[0]))
        except ValueError:
            return None
        if drag.forces.status != "ok":
            return None
        choice = replace(
            plan.choice,
            contacts=contacts,
            path=path,
            path_length=path.length,
            parameters={**figures, **_figures(drag, touched[1], contacts[1].normal)},
        )
        profile = SpeedProfile(
            path.length, plan.profile.speed, plan.profile.acceleration
        )
        return replace(plan, choice=choice, path=path, profile=profile, X_BV=X_BV)


def _twist(path: TwistPath, point: Point) -> Twist:
    """The twist per metre with which a path of ``point`` begins."""
    return Twist(*path.rate(0.0), point)


def _pin(task: Task) -> Point:
    """The point to press [m] in B; raises ValueError where the goal is not turned about
    one that can be.
    """
    body = task.object
    given = task.motion.contacts
    allowed = task.tolerance.position
    start = task.start.compose(body.X_GB)
    goal = task.goal.compose(body.X_GB)
    vx, vy, w = screw(start, goal)
    if abs(w) < LEAST_TURN:
        turn = math.degrees(w)
        least = math.degrees(LEAST_TURN)
        raise ValueError(
            f"the goal is turned by {turn:.1f} deg, allowed from {least:g} deg"
        )
    pin = (-vy / w, vx / w)
    if given is not None:
        pin = (
            given[0][0] - body.center_of_mass[0],
            given[0][1] - body.center_of_mass[1],
        )
        apart = math.dist(start.apply(pin), goal.apply(pin))
        if apart > allowed:
            raise ValueError(
                "the pressed point has to stay in its place, start and goal have it "
                f"{apart * 1e3:.1f} mm "
                f"apart, allowed {allowed * 1e3:g} mm"
            )
    if not inside_top(body, pin, EDGE):
        raise ValueError(
            f"the goal is turned about ({pin[0]:.3f}, {pin[1]:.3f}), which would have "
            "to be pressed: it is "
            f"{depth_inside(body, pin) * 1e3:.0f} mm inside the top, allowed from "
            f"{EDGE * 1e3:.0f} mm"
        )
    return pin


def _figures(drag: _Drag, push: Point, normal: Point) -> dict[str, float]:
    """What a choice remembers of the drag; the wrench is about the ellipsoid's centre.
    The virtual axle is where the push alone would turn the object, under a press that
    weighs on it but does not hold it.
    """
    surface = drag.surface
    x, y = drag.surface.center
    nx, ny = normal
    reach = surface.rho**2 / ((push[0] - x) * ny - (push[1] - y) * nx)
    return {
        "cop_x": x,
        "cop_y": y,
        "rho": surface.rho,
        "push_force": surface.max_force,
        "side_force": drag.forces.normals[1],
        "friction_use": drag.use,
        "pressure_x": drag.cop[0],
        "pressure_y": drag.cop[1],
        "axle_x": x - ny * reach,
        "axle_y": y + nx * reach,
    }


MODE = PressAndPush()
allocator = MODE.allocator
