"""Mode bimanual_press_slide: two arms press and slide the object any way
(docs/mechanics.md, 7 and 9).

The friction discs under two tips give every planar wrench, so that the object is
holonomic: it is led along one constant twist from start to goal. How the load is shared
says where the centre of pressure goes. On a wall the presses alone press the object on,
and carry its weight.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import atan, hypot, inf

from pushpressslide.allocation.contact_line import ContactLine
from pushpressslide.allocation.cop_strategy import (
    loads_with,
    possible_fractions,
    safe_loads,
)
from pushpressslide.allocation.press_loads import TwoPresses
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.wall_presses import wall_loads
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cop, Task
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.height_term import DraggedSurface
from pushpressslide.mechanics.osculating import (
    dragged_ellipsoid,
    pressures,
    touching_ellipsoid,
)
from pushpressslide.mechanics.pressure import center_of_pressure
from pushpressslide.mechanics.top import inside_top, room_inside, top_places
from pushpressslide.mechanics.wall import lean, lean_press, lever, weights
from pushpressslide.modes.base import ENOUGH, followed, instead
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.side_contacts import assignments
from pushpressslide.tracking.carried import CarriedTracker
from pushpressslide.tracking.eased import EasedTracker

COP: Cop = "balanced"
# shares of the tips' friction that a motion may take, the best first
USE = (0.7, 0.8, 0.9, 0.95)
HARDER = 1.3  # times as hard where the drag's lever takes more of the friction
LEAST_PRESS = 4.0  # [N] below which a tip bounces on the object
EDGE = 0.012  # [m] that a contact stays away from the top's edges
ROUNDING = 1e-6  # [m] by which it may be nearer
APART = 0.10  # [m] between the contacts, so that the arms have room
# half widths that the centre of pressure stays inside the base's edge
TIPPING_ROOM = 0.15
DECAY = 0.015  # [m] of way over which the tracker takes an error down to 1/e

Pair = tuple[Point, Point]


@dataclass(frozen=True, slots=True)
class _Drag:
    """Two presses that drag the object with one twist."""

    surface: DraggedSurface  # near that twist
    use: float  # share of the tips' friction that it takes
    room: float  # half widths of the centre of pressure from the base's edge


class BimanualPressSlide:
    """Two arms press on top and slide the object."""

    name = "bimanual_press_slide"
    arms = 2
    reduced_model = "quasi-holonomic"
    tracking_point = "CoM, or CoP when pivoting"
    cop_steering = True
    walls = True
    pushed_faces = 0

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return one choice per pair of contacts, feasible ones first, those with the
        shortest arms first.
        """
        farthest = max((hypot(*p) for p in top_places(task.object, EDGE)), default=0.0)
        placed = [self._placed(task, points, farthest) for points in self._pairs(task)]
        if not placed:
            return [
                Choice(
                    self.name,
                    False,
                    f"the top has no two places {APART * 1e3:.0f} mm apart",
                )
            ]
        placed.sort(key=lambda c: _arm_length(task, c.contacts))
        drafts = [(c.time or inf, partial(self._draft, task, c)) for c in placed]
        return followed(task, drafts, self.vehicle_frame, enough, instead)

    @staticmethod
    def _pairs(task: Task) -> list[Pair]:
        """Pairs of places to press, in B [m]: opposite each other about the CoM, or
        given.
        """
        body = task.object
        given = task.motion.contacts
        if given is not None and len(given) == 2:
            first, second = (body.X_GB.inverse().apply(p) for p in given)
            return [(first, second)]
        dx, dy = lean(task, task.motion.press_force or lean_press(task))
        pairs: list[Pair] = []
        for p, q in ((p, (-p[0], -p[1])) for p in top_places(body, EDGE)):
            new = all(
                min(math.dist(p, other) for other in pair) > ROUNDING for pair in pairs
            )
            if (
                new
                and inside_top(body, q, EDGE - ROUNDING)
                and math.dist(p, q) >= APART
            ):
                pairs.append((p, q))
        return [
            ((px + dx, py + dy), (qx + dx, qy + dy)) for (px, py), (qx, qy) in pairs
        ]

    def _placed(self, task: Task, points: Pair, farthest: float) -> Choice:
        """Return the choice of one pair of contacts, and how long it takes, but for
        their loads; ``farthest`` [m] that a place is from the CoM.
        """
        body = task.object
        motion = task.motion
        start = task.start.compose(body.X_GB)
        goal = task.goal.compose(body.X_GB)
        radius = max(farthest, *(hypot(*p) for p in points))
        path = TwistPath.between((start, goal), radius)
        poses = [path.pose(0.25 * i * path.length) for i in range(5)]
        ways = assignments(task.bases, points, poses)
        arms = (0, 1) if motion.contacts and (0, 1) in ways else next(iter(ways), None)
        if arms == (1, 0):
            points = (points[1], points[0])
        what = "pressed at " + " and ".join(f"({x:.3f}, {y:.3f})" for x, y in points)
        contacts = tuple(
            Contact(i, "top", p, (0.0, 0.0), body.shape.height)
            for i, p in enumerate(points)
        )

        def refused(why: str) -> Choice:
            return Choice(self.name, False, f"{what}: {why}", contacts)

        if not all(inside_top(body, p, EDGE - ROUNDING) for p in points):
            return refused(
                f"the contacts must be {EDGE * 1e3:.0f} mm inside the object's top"
            )
        if math.dist(*points) < APART:
            apart = math.dist(*points) * 1e3
            return refused(
                f"the contacts are {apart:.0f} mm apart, allowed from "
                f"{APART * 1e3:.0f} mm"
            )
        if arms is None:
            return refused("the arms would cross, whichever takes which contact")
        if path.length == 0.0:
            return refused("the goal is the start")
        return Choice(
            self.name, True, what, contacts, path.length, _time(task, path), path=path
        )

    def _draft(self, task: Task, placed: Choice, judged: bool) -> list[Choice]:
        """Judge one pair of contacts but for the arms' reach."""
        body = placed.path
        mu = task.believed.contact_friction
        what = placed.reason
        if not (judged and placed.feasible and isinstance(body, TwistPath)):
            return [placed]
        try:
            problem, loads = self._loads(
                task, (placed.contacts[0].point, placed.contacts[1].point), body
            )
        except ValueError as error:
            return [
                replace(placed, feasible=False, path=None, reason=f"{what}: {error}")
            ]
        for normals in loads:
            pressed = tuple(
                replace(c, load=n)
                for c, n in zip(placed.contacts, normals, strict=True)
            )
            point = _tracking_point(task, pressed, _twist(body, (0.0, 0.0)))
            ends = body.start.compose(Pose2(*point)), body.end.compose(Pose2(*point))
            path = TwistPath.between(ends, body.radius)
            try:
                drag = self._drag(task, pressed, path, point)
            except ValueError as error:
                return [
                    replace(
                        placed,
                        feasible=False,
                        path=None,
                        reason=f"{what}: it would tip: {error}",
                    )
                ]
            if drag.use <= USE[-1]:
                break
        if problem is None and drag.room < TIPPING_ROOM:
            problem = (
                f"drag at {task.object.shape.height:.3f} m tips the object: the centre "
                "of pressure comes "
                f"within {drag.room:.2f} half widths of the base's edge, allowed "
                f"{TIPPING_ROOM:g}"
            )
        if problem is None and drag.use > USE[-1]:
            problem = _slipping(normals, drag.use)
        fraction = _fraction(task, pressed)
        left, right = normals
        reason = (
            f" with {left:.1f} and {right:.1f} N: path {path.length:.3f} m, centre of "
            "pressure "
            f"{fraction:.2f} of the way from left to right, {drag.use:.2f} of the "
            "tips' friction used"
        )
        parameters = {
            **_figures(drag),
            "lever": lever(task, sum(normals)),
            "radius": path.radius,
            "speed": task.motion.speed,
            "track_x": point[0],
            "track_y": point[1],
            "press_left": left,
            "press_right": right,
            "cop_fraction": fraction,
        }
        told = what + (reason if problem is None else f": {problem}")
        time = _time(task, path)
        margin = atan(mu) - atan(drag.use * mu)
        ok = problem is None
        return [
            Choice(
                self.name,
                ok,
                told,
                pressed,
                path.length,
                time,
                margin,
                parameters,
                path,
            )
        ]

    def _loads(
        self, task: Task, points: Pair, path: TwistPath
    ) -> tuple[str | None, list[Point]]:
        """Return what stands against the loads, and loads [N] to try for ``path``: the
        largest where none do.

        Raises ValueError where no two tips can press so.
        """
        belief = task.believed
        cap = task.limits.normal_force
        given = task.motion.press_force
        cop: Cop = COP if task.motion.cop is None else task.motion.cop
        twist = _twist(path, (0.0, 0.0))
        weight = task.weight_on_support
        mu_s = belief.support_friction
        mu_a = belief.contact_friction
        rho = touching_ellipsoid(pressures(task)((0.0, 0.0)), mu_s, twist).rho

        def presses(use: float = 1.0) -> TwoPresses:
            return TwoPresses(*points, weight, mu_s, use * mu_a, rho, cap)

        if given is not None:
            normals = loads_with(presses(), cop, given)
            if given > cap:
                raise ValueError(
                    f"motion.press_force of {given:g} N, limits.normal_force is "
                    f"{cap:g} N"
                )
            if min(normals) < LEAST_PRESS:
                raise ValueError(
                    f"the lighter press is {min(normals):.1f} N, allowed from "
                    f"{LEAST_PRESS:g} N: a contact "
                    "that does not press holds nothing"
                )
            return None, [normals]
        if weight == 0.0:
            steps = [(twist, along) for along in weights(task, path)]
            return None, [
                wall_loads(presses, steps, USE, max(LEAST_PRESS, lean_press(task)))
            ]
        found = safe_loads(presses, cop, twist, USE, LEAST_PRESS)
        if found is not None:
            return None, [
                found,
                loads_with(presses(), cop, min(cap, HARDER * max(found))),
            ]
        if mu_a <= mu_s:
            raise ValueError(
                f"contact friction {mu_a:g} must exceed the support's, {mu_s:g}: no "
                "press drags"
            )
        if isinstance(cop, str):
            normals = loads_with(presses(), cop, cap)
            use = presses().at(normals, twist).needed / sum(normals)
            return f"{_slipping(normals, use)}; limits.normal_force is {cap:g} N", [
                normals
            ]
        can = possible_fractions(presses, twist, USE[-1:], LEAST_PRESS)
        span = (
            f"allowed from {can[0]:.2f} to {can[1]:.2f}"
            if can
            else "and so does any other"
        )
        raise ValueError(
            f"a centre of pressure {cop:g} of the way from left to right needs a "
            "contact that does not "
            f"press, or more than limits.normal_force of {cap:g} N, {span}"
        )

    def _drag(
        self, task: Task, contacts: Sequence[Contact], path: TwistPath, point: Point
    ) -> _Drag:
        """Return what dragging ``point`` along its path is like. Raises ValueError
        where the object tips.
        """
        belief = task.believed
        height = task.object.shape.height
        twist = _twist(path, point)
        load = task.weight_on_support + sum(c.load for c in contacts)
        surface, cop = dragged_ellipsoid(
            pressures(task),
            belief.support_friction,
            load,
            _cop(task, contacts),
            twist,
            lambda wrench: (height * wrench.fx / load, height * wrench.fy / load),
        )
        mu = belief.contact_friction
        raised = lever(task, load)
        x, y = surface.center
        use = 0.0
        room = inf
        allocate = self.allocator(contacts, mu, surface.rho, surface.center)
        for wx, wy in weights(task, path):
            lifted = replace(surface, center=(x - raised * wx, y - raised * wy))
            fx, fy, tau, _ = lifted.wrench(twist).moved_to((x, y))
            given = allocate(
                fx - wx, fy - wy, tau - Wrench(wx, wy, 0.0).moved_to((x, y)).tau
            )
            used = max(
                hypot(*f) / (mu * c.load)
                for f, c in zip(given.forces, contacts, strict=True)
            )
            lost = (
                hypot(*given.residual[:2], given.residual[2] / surface.rho)
                / surface.max_force
            )
            use = max(use, used / max(1.0 - lost, 1e-3))
            room = min(
                room,
                room_inside(task.object, (cop[0] - raised * wx, cop[1] - raised * wy)),
            )
        return _Drag(surface, use, room)

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: origin at the tracking point, axes along B's."""
        return Pose2(choice.parameters["track_x"], choice.parameters["track_y"])

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

        law = CarriedTracker(
            plan.X_BV, surface, plan.task.weight_in_plane, p["lever"], DECAY
        )
        return EasedTracker(law, holds)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = (0.0, 0.0),
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m]; ``rho`` plays no part."""
        left, right = contacts
        allocate = two_press_allocator((left.point, right.point), friction)
        return partial(allocate, normals=(left.load, right.load), cop=cop)

    def identifier(self, plan: Plan) -> None:
        """Return nothing: two tips that hold lead the object, whatever its rho."""

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return the plan by one more twist to the goal."""
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
        if its path is longer than ``longest`` [m].
        """
        task = plan.task
        figures = plan.choice.parameters
        contacts = tuple(
            replace(c, point=p)
            for c, p in zip(plan.choice.contacts, touched, strict=True)
        )
        goal = plan.goal.compose(task.object.X_GB)
        path = TwistPath.between(
            (X_WB.compose(plan.X_BV), goal.compose(plan.X_BV)), figures["radius"]
        )
        if not 0.0 < path.length <= longest:
            return None
        try:
            drag = self._drag(task, contacts, path, plan.X_BV.position)
        except ValueError:
            return None
        choice = replace(
            plan.choice,
            contacts=contacts,
            path=path,
            path_length=path.length,
            parameters={**figures, **_figures(drag)},
        )
        profile = SpeedProfile(
            path.length, plan.profile.speed, plan.profile.acceleration
        )
        return replace(plan, choice=choice, path=path, profile=profile)


def _time(task: Task, path: TwistPath) -> float:
    """How long the whole run takes [s]."""
    motion = SpeedProfile(
        path.length, task.motion.speed, task.motion.acceleration
    ).duration
    return round(motion + overhead(task, pressed=True), 3)


def _arm_length(task: Task, contacts: Sequence[Contact]) -> float:
    """How far the contacts are from their arms' bases, at start and goal together [m]."""
    ends = [pose.compose(task.object.X_GB) for pose in (task.start, task.goal)]
    return sum(
        math.dist(X.apply(c.point), task.bases[c.arm][:2])
        for X in ends
        for c in contacts
    )


def _twist(path: TwistPath, point: Point) -> Twist:
    """The twist per metre with which a path of ``point`` begins."""
    return Twist(*path.rate(0.0), point)


def _cop(task: Task, contacts: Sequence[Contact]) -> Point:
    """The centre of pressure without drag [m]."""
    weight = task.weight_on_support
    return center_of_pressure(
        weight, (0.0, 0.0), [c.load for c in contacts], [c.point for c in contacts]
    )


def _tracking_point(task: Task, contacts: Sequence[Contact], twist: Twist) -> Point:
    """The CoP where the object turns about a point inside its base, else the CoM [m]."""
    if twist.w and inside_top(
        task.object, (-twist.vy / twist.w, twist.vx / twist.w), 0.0
    ):
        return _cop(task, contacts)
    return (0.0, 0.0)


def _fraction(task: Task, contacts: Sequence[Contact]) -> float:
    """The centre of pressure without drag, as part of the way from the left to the
    right contact.
    """
    lx, ly = contacts[0].point
    x, y = _cop(task, contacts)
    line = ContactLine(contacts[0].point, contacts[1].point)
    return line.in_axes((x - lx, y - ly))[0] / line.length


def _slipping(normals: Point, use: float) -> str:
    return (
        f"pressed with {normals[0]:.1f} and {normals[1]:.1f} N the tips slip before "
        "the object: the motion "
        f"takes {use:.2f} of their friction, allowed {USE[-1]:g}"
    )


def _figures(drag: _Drag) -> dict[str, float]:
    """What a choice remembers of the drag; the wrench is about the ellipsoid's centre."""
    surface = drag.surface
    return {
        "cop_x": surface.center[0],
        "cop_y": surface.center[1],
        "rho": surface.rho,
        "push_force": surface.max_force,
        "friction_use": drag.use,
    }


MODE = BimanualPressSlide()
allocator = MODE.allocator
