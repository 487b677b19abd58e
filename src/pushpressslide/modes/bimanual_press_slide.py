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
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
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
from pushpressslide.modes.base import (
    ENOUGH,
    Allocator,
    Course,
    Draft,
    Mode,
    search,
)
from pushpressslide.planning.held_twist import (
    DECAY,
    EDGE,
    path_onward,
    tipping_refusal,
    twist_at,
    utilisation,
)
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.segments import segment
from pushpressslide.planning.side_contacts import assignments
from pushpressslide.rom.drives import ORIGIN, HeldDrive
from pushpressslide.tracking.carried import CarriedTracker
from pushpressslide.tracking.eased import EasedTracker

COP: Cop = "balanced"
# shares of the tips' friction that a motion may take, the best first
UTILISATION = (0.7, 0.8, 0.9, 0.95)
HARDER = 1.3  # times as hard where the drag's lever takes more of the friction
LEAST_PRESS = 4.0  # [N] below which a tip bounces on the object
ROUNDING = 1e-6  # [m] by which a contact may be nearer to the edge
APART = 0.10  # [m] between the contacts, so that the arms have room

Pair = tuple[Point, Point]
Presses = Callable[..., TwoPresses]


@dataclass(frozen=True, slots=True)
class _Drag:
    """Two presses that drag the object with one twist."""

    surface: DraggedSurface  # near that twist
    friction_utilisation: float
    tipping_margin: float  # half widths


class BimanualPressSlide(Mode):
    """Two arms press on top and slide the object."""

    name = "bimanual_press_slide"
    arms = 2
    reduced_model = "quasi-holonomic"
    tracking_point = "CoM, or CoP when pivoting"
    cop_steering = True
    carries_weight = True
    pushed_faces = 0
    drives = (HeldDrive,)

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the choices of all placements."""
        return search(task, self._drafts(task), enough)

    def _drafts(self, task: Task) -> list[Draft | Choice]:
        """Return one draft per pair of contacts, those with the shortest arms first."""
        farthest = max((hypot(*p) for p in top_places(task.object, EDGE)), default=0.0)
        placed = [self._placed(task, points, farthest) for points in _pairs(task)]
        if not placed:
            text = "the top has no two places {allowed:mm.0f} apart"
            refusal = Refusal("too_close", text, None, APART, "m")
            return [Choice(self.name, refusal=refusal)]
        placed.sort(key=lambda one: _arm_length(task, one[0].contacts))
        return [
            Draft(choice.time or inf, partial(self._pressed, task, choice, path))
            for choice, path in placed
        ]

    def _placed(
        self, task: Task, points: Pair, farthest: float
    ) -> tuple[Choice, TwistPath]:
        """Return the choice of one pair of contacts, but for their loads, and the path
        of the body; ``farthest`` [m] that a place is from the CoM.
        """
        body = task.object
        start = task.start.compose(body.X_GB)
        goal = task.goal.compose(body.X_GB)
        radius = max(farthest, *(hypot(*p) for p in points))
        path = TwistPath.between((start, goal), radius)
        poses = [path.pose(0.25 * i * path.length) for i in range(5)]
        ways = assignments(task.scene.bases, points, poses)
        given = task.motion.contacts is not None and (0, 1) in ways
        arms = (0, 1) if given else next(iter(ways), None)
        if arms == (1, 0):
            points = (points[1], points[0])
        contacts = tuple(
            Contact(i, "top", point, ORIGIN, body.shape.height)
            for i, point in enumerate(points)
        )
        choice = Choice(
            self.name,
            "pressed at " + " and ".join(f"({x:.3f}, {y:.3f})" for x, y in points),
            contacts,
            time=_time(task, path),
            refusal=_placement_refusal(task, points, crossing=arms is None),
        )
        if choice.feasible and path.length == 0.0:
            choice = choice.refused(Refusal("at_goal", "the goal is the start"))
        return choice, path

    def _pressed(
        self, task: Task, placed: Choice, path: TwistPath, evaluated: bool
    ) -> list[Choice]:
        """Judge one pair of contacts but for the arms' reach."""
        if not (evaluated and placed.feasible):
            return [placed]
        points = (placed.contacts[0].point, placed.contacts[1].point)
        try:
            refusal, loads = _loads(task, points, path)
        except ValueError as error:
            return [placed.refused(refusal_of(error, "press"))]
        for normals in loads:
            contacts = tuple(
                replace(contact, load=load)
                for contact, load in zip(placed.contacts, normals, strict=True)
            )
            point = _tracking_point(task, contacts, twist_at(path, ORIGIN))
            X_BV = Pose2(*point)
            ends = path.start.compose(X_BV), path.end.compose(X_BV)
            tracked = TwistPath.between(ends, path.radius)
            try:
                drag = self._drag(task, contacts, tracked, point)
            except ValueError as error:
                tips = f"it would tip: {refusal_of(error, 'tipping')}"
                return [placed.refused(Refusal("tipping", tips))]
            if drag.friction_utilisation <= UTILISATION[-1]:
                break
        return [self._driven(task, placed, contacts, tracked, point, drag, refusal)]

    def _driven(
        self,
        task: Task,
        placed: Choice,
        contacts: tuple[Contact, ...],
        path: TwistPath,
        point: Point,
        drag: _Drag,
        refusal: Refusal | None,
    ) -> Choice:
        """Return the choice of contacts with loads, and the path that it tracks."""
        used = drag.friction_utilisation
        height = task.object.shape.height
        if refusal is None:
            cause = f"drag at {height:.3f} m tips the object"
            refusal = tipping_refusal(cause, drag.tipping_margin)
        if refusal is None and used > UTILISATION[-1]:
            refusal = _slipping(contacts, used)
        load = task.scene.weight_on + sum(contact.load for contact in contacts)
        drive = HeldDrive(
            drag.surface, path.radius, point, lever(task.scene, load), used
        )
        mu = task.believed.contact_friction
        margin = atan(mu) - atan(used * mu)
        piece = segment(task, self.name, contacts, drive, path, cone_margin=margin)
        left, right = (contact.load for contact in contacts)
        merits = (
            f"{left:.1f} and {right:.1f} N, path {path.length:.3f} m, centre of "
            f"pressure {_fraction(task, contacts):.2f} of the way from left to right, "
            f"{used:.2f} of the tips' friction used"
        )
        return replace(
            placed,
            contacts=contacts,
            segments=(piece,),
            time=_time(task, path),
            merits=merits,
            refusal=refusal,
        )

    def _drag(
        self, task: Task, contacts: Sequence[Contact], path: TwistPath, point: Point
    ) -> _Drag:
        """Return what dragging ``point`` along its path is like. Raises ValueError
        where the object tips.
        """
        belief = task.believed
        height = task.object.shape.height
        twist = twist_at(path, point)
        load = task.scene.weight_on + sum(c.load for c in contacts)
        surface, cop = dragged_ellipsoid(
            pressures(task.scene),
            belief.support_friction,
            load,
            _cop(task, contacts),
            twist,
            lambda wrench: (height * wrench.fx / load, height * wrench.fy / load),
        )
        mu = belief.contact_friction
        raised = lever(task.scene, load)
        x, y = surface.center
        most = 0.0
        margin = inf
        allocate = self.allocator(contacts, mu, surface.rho, surface.center)
        for wx, wy in weights(task.scene, path):
            lifted = replace(surface, center=(x - raised * wx, y - raised * wy))
            fx, fy, tau, _ = lifted.wrench(twist).moved_to((x, y))
            held = Wrench(wx, wy, 0.0).moved_to((x, y))
            given = allocate(fx - wx, fy - wy, tau - held.tau)
            used = max(
                hypot(*f) / (mu * c.load)
                for f, c in zip(given.forces, contacts, strict=True)
            )
            most = max(most, utilisation(used, given, surface))
            moved = (cop[0] - raised * wx, cop[1] - raised * wy)
            margin = min(margin, room_inside(task.object, moved))
        return _Drag(surface, most, margin)

    def tracker(self, task: Task, segment: Segment) -> EasedTracker:
        """Return the holonomic law for a segment, within what the contacts hold."""
        drive = segment.drive
        assert isinstance(drive, HeldDrive)
        law = CarriedTracker(
            drive.X_BV, drive.surface, task.scene.weight_along, drive.lever, DECAY
        )
        mu = task.believed.contact_friction
        allocate = self.allocator(segment.contacts, mu, drive.rho, drive.center)
        return EasedTracker(law, allocate)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m]; ``rho`` plays no part."""
        left, right = contacts
        allocate = two_press_allocator((left.point, right.point), friction)
        return partial(allocate, normals=(left.load, right.load), cop=cop)

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by one twist from the object's true pose and contacts."""
        planned = segment.drive
        assert isinstance(planned, HeldDrive)
        path = path_onward(
            task, X_WB, planned.X_BV, segment.goal, planned.radius, longest
        )
        if path is None:
            return None
        try:
            drag = self._drag(task, contacts, path, planned.point)
        except ValueError:
            return None
        used = drag.friction_utilisation
        drive = replace(planned, surface=drag.surface, friction_utilisation=used)
        return Course(contacts, drive, path)


def _pairs(task: Task) -> list[Pair]:
    """Pairs of places to press, in B [m]: opposite each other about the CoM, or given."""
    body = task.object
    given = task.motion.contacts
    if given is not None and len(given) == 2:
        first, second = (body.X_GB.inverse().apply(p) for p in given)
        return [(first, second)]
    dx, dy = lean(
        task.scene, task.goal, task.motion.press_force or lean_press(task.scene)
    )
    pairs: list[Pair] = []
    for p in top_places(body, EDGE):
        q = (-p[0], -p[1])
        new = all(
            min(math.dist(p, other) for other in pair) > ROUNDING for pair in pairs
        )
        if not new or math.dist(p, q) < APART:
            continue
        if inside_top(body, q, EDGE - ROUNDING):
            pairs.append((p, q))
    return [((px + dx, py + dy), (qx + dx, qy + dy)) for (px, py), (qx, qy) in pairs]


def _placement_refusal(task: Task, points: Pair, crossing: bool) -> Refusal | None:
    """Return what stands against two contacts, whatever their loads."""
    if not all(inside_top(task.object, p, EDGE - ROUNDING) for p in points):
        text = "the contacts must be {allowed:mm.0f} inside the object's top"
        return Refusal("off_top", text, None, EDGE, "m")
    apart = math.dist(*points)
    if apart < APART:
        text = "the contacts are {figure:mm.0f} apart, allowed from {allowed:mm.0f}"
        return Refusal("too_close", text, apart, APART, "m")
    if crossing:
        text = "the arms would cross, whichever takes which contact"
        return Refusal("arms_cross", text)
    return None


def _loads(
    task: Task, points: Pair, path: TwistPath
) -> tuple[Refusal | None, list[Point]]:
    """Return what stands against the loads, and loads [N] to try for ``path``: the
    largest where none do.

    Raises RefusedError where no two tips can press so.
    """
    belief = task.believed
    cap = task.limits.normal_force
    cop: Cop = COP if task.motion.cop is None else task.motion.cop
    twist = twist_at(path, ORIGIN)
    weight = task.scene.weight_on
    mu_s = belief.support_friction
    mu_a = belief.contact_friction
    rho = touching_ellipsoid(pressures(task.scene)(ORIGIN), mu_s, twist).rho

    def presses(share: float = 1.0) -> TwoPresses:
        """Return the presses with a share of the contact friction."""
        return TwoPresses(*points, weight, mu_s, share * mu_a, rho, cap)

    given = task.motion.press_force
    if given is not None:
        return None, [_given_loads(presses(), cop, given, cap)]
    if any(task.scene.weight_along):
        steps = [(twist, along) for along in weights(task.scene, path)]
        least = max(LEAST_PRESS, lean_press(task.scene))
        return None, [wall_loads(presses, steps, UTILISATION, least)]
    found = safe_loads(presses, cop, twist, UTILISATION, LEAST_PRESS)
    if found is not None:
        harder = loads_with(presses(), cop, min(cap, HARDER * max(found)))
        return None, [found, harder]
    if mu_a <= mu_s:
        text = (
            "contact friction {figure:g} must exceed the support's, {allowed:g}: no "
            "press drags"
        )
        raise RefusedError(Refusal("friction", text, mu_a, mu_s))
    if isinstance(cop, str):
        normals = loads_with(presses(), cop, cap)
        used = presses().at(normals, twist).needed / sum(normals)
        return _slipping_at_limit(normals, used, cap), [normals]
    raise RefusedError(_cop_refusal(presses, cop, twist, cap))


def _given_loads(presses: TwoPresses, cop: Cop, given: float, cap: float) -> Point:
    """Return the loads [N] of a given press. Raises RefusedError where it is too hard or
    too light.
    """
    normals = loads_with(presses, cop, given)
    if given > cap:
        text = "motion.press_force of {figure:Ng}, limits.normal_force is {allowed:Ng}"
        raise RefusedError(Refusal("normal_force", text, given, cap, "N"))
    if min(normals) < LEAST_PRESS:
        text = (
            "the lighter press is {figure:N.1f}, allowed from {allowed:Ng}: a contact "
            "that does not press holds nothing"
        )
        raise RefusedError(Refusal("press", text, min(normals), LEAST_PRESS, "N"))
    return normals


def _cop_refusal(presses: Presses, cop: float, twist: Twist, cap: float) -> Refusal:
    """Return what stands against a wanted centre of pressure."""
    can = possible_fractions(presses, twist, UTILISATION[-1:], LEAST_PRESS)
    span = "and so does any other"
    if can:
        span = f"allowed from {can[0]:.2f} to {can[1]:.2f}"
    text = (
        "a centre of pressure {figure:g} of the way from left to right needs a contact "
        f"that does not press, or more than limits.normal_force of {cap:g} N, {span}"
    )
    return Refusal("cop", text, cop)


def _slipping(contacts: Sequence[Contact], used: float) -> Refusal:
    left, right = (contact.load for contact in contacts)
    return Refusal("friction", _slipping_text(left, right), used, UTILISATION[-1])


def _slipping_at_limit(normals: Point, used: float, cap: float) -> Refusal:
    text = f"{_slipping_text(*normals)}; limits.normal_force is {cap:g} N"
    return Refusal("friction", text, used, UTILISATION[-1])


def _slipping_text(left: float, right: float) -> str:
    return (
        f"pressed with {left:.1f} and {right:.1f} N the tips slip before the object: "
        "the motion takes {figure:.2f} of their friction, allowed {allowed:g}"
    )


def _time(task: Task, path: TwistPath) -> float:
    """How long the whole run takes [s]."""
    motion = task.motion
    profile = SpeedProfile(path.length, motion.speed, motion.acceleration)
    return round(profile.duration + overhead(task, pressed=True), 3)


def _arm_length(task: Task, contacts: Sequence[Contact]) -> float:
    """How far the contacts are from their arms' bases, at start and goal together [m]."""
    ends = [pose.compose(task.object.X_GB) for pose in (task.start, task.goal)]
    return sum(
        math.dist(X.apply(c.point), task.scene.bases[c.arm][:2])
        for X in ends
        for c in contacts
    )


def _cop(task: Task, contacts: Sequence[Contact]) -> Point:
    """The centre of pressure without drag [m]."""
    loads = [contact.load for contact in contacts]
    points = [contact.point for contact in contacts]
    return center_of_pressure(task.scene.weight_on, ORIGIN, loads, points)


def _tracking_point(task: Task, contacts: Sequence[Contact], twist: Twist) -> Point:
    """The CoP where the object turns about a point inside its base, else the CoM [m]."""
    if not twist.w:
        return ORIGIN
    icr = (-twist.vy / twist.w, twist.vx / twist.w)
    return _cop(task, contacts) if inside_top(task.object, icr, 0.0) else ORIGIN


def _fraction(task: Task, contacts: Sequence[Contact]) -> float:
    """The centre of pressure without drag, as part of the way from the left to the
    right contact.
    """
    left, right = (contact.point for contact in contacts)
    x, y = _cop(task, contacts)
    line = ContactLine(left, right)
    return line.in_axes((x - left[0], y - left[1]))[0] / line.length


MODE = BimanualPressSlide()
allocator = MODE.allocator
