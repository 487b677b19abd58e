"""Mode orthogonal_push: two arms push two faces that are not parallel
(docs/mechanics.md, section 6).

Together they drive every twist of a cone: ahead between the two normals, turned to
either side by friction and by contacts beside the centre of mass; never back. Where the
contacts are decides which cone it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import combinations, product

from pushpressslide.allocation.projections import Projection
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.path import SpeedProfile
from pushpressslide.core.plan import Choice, Contact, Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.task import Cylinder, Task
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import ENOUGH, UNJUDGED, path_problem
from pushpressslide.planning.in_cone import least_spare, path_in_cone, told
from pushpressslide.planning.overhead import overhead
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
    drag_problem,
    farthest_corner,
    given_to,
    least_distance,
    span,
)
from pushpressslide.tracking.holonomic import HolonomicTracker

ORIGIN = (0.0, 0.0)
CORNER_CLEARANCE = 0.015  # [m] between a contact and a corner of its face
# of a contact, in units of the face's room beside the CoM's line
PLACES = (-1.0, -0.5, 0.0, 0.5, 1.0)
ANGLES = (math.radians(40.0), math.radians(140.0))  # between the two normals
SPARE = math.radians(6.0)
REPLAN_SPARE = math.radians(2.0)  # inside the cone: of a plan, and of one made anew
# of placements with more the one that takes the least force is the best
ENOUGH_SPARE = math.radians(30.0)
KEPT = 0.9
# of the friction: what corrections may use, and what forces keep to if they can
PREFERRED = 0.8
# times the drag that one contact may push with: more is spent against the other
SQUEEZE = 1.6
LOOP_RATIO = 1.6  # times the direct way: a longer one is not taken
PIECEWISE = 5  # placements on two faces for which ways of several twists are looked for
OFFERED = 6  # placements on two faces that are looked at further


class OrthogonalPush:
    """Two arms push two faces that are not parallel."""

    name = "orthogonal_push"
    arms = 2
    reduced_model = "quasi-holonomic within a cone"
    tracking_point = "CoM"
    cop_steering = False
    walls = False
    pushed_faces = 2

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the best placements on every two faces, feasible ones first, the
        quickest first; of equally quick ones that with the least force, if it is well
        inside its cone.
        """
        if isinstance(task.object.shape, Cylinder):
            return [
                Choice(self.name, False, "a cylinder has no flat faces for two pushes")
            ]
        drafts = []
        for pair in combinations(faces(task.object, CORNER_CLEARANCE), 2):
            ax, ay = pair[0].normal
            bx, by = pair[1].normal
            if (
                ANGLES[0]
                <= abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by))
                <= ANGLES[1]
            ):
                drafts += self._drafts(task, pair)

        @cache
        def problem(path: TwistPath, contact: Contact, time: float) -> str | None:
            one = Choice(self.name, True, "", (contact,), path.length, time, path=path)
            return path_problem(task, one, Pose2())

        out = []
        found = 0
        for draft in sorted(drafts, key=_rank):
            path = draft.path
            time = draft.time
            if not draft.feasible or path is None or time is None:
                out.append(draft)
                continue
            if found >= enough:
                out.append(_refused(draft, UNJUDGED))
                continue
            poses = [path.pose(share * path.length) for share in (0.0, 0.5, 1.0)]
            ways = assignments(task.bases, [c.point for c in draft.contacts], poses)
            if not ways:
                out.append(_refused(draft, "the arms would cross"))
            for arms in ways:
                choice = replace(draft, contacts=given_to(draft.contacts, arms))
                problems = (problem(path, contact, time) for contact in choice.contacts)
                why = next((p for p in problems if p is not None), None)
                found += why is None
                out.append(choice if why is None else _refused(choice, why))
        return sorted(out, key=lambda c: not c.feasible) or [
            Choice(
                self.name,
                False,
                "no two faces with 40 to 140 deg between their normals",
            )
        ]

    def _drafts(self, task: Task, pair: tuple[Face, Face]) -> list[Choice]:
        """Return the best placements on two faces, but for the arms' reach; or one, and
        why it cannot do the task.
        """
        names = f"faces {pair[0].index} and {pair[1].index}"
        height = contact_height(task)
        placed = _places(task, pair)
        middles = tuple(
            Contact(i, "side", f.foot, f.normal, height) for i, f in enumerate(pair)
        )

        def refused(why: str, contacts: tuple[Contact, ...] = middles) -> list[Choice]:
            return [Choice(self.name, False, f"{names}: {why}", contacts)]

        problem = drag_problem(task, pair, height)
        if problem is not None:
            return refused(problem)
        if not placed:
            return refused(
                f"no two contacts {least_distance(task) * 1e3:.0f} mm apart, as two "
                "tools need"
            )
        start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
        direct = screw(start, goal)
        radius = farthest_corner(task.object)
        try:
            surface = push_surface(task, height, Twist(*direct))
        except ValueError as error:
            return refused(str(error))
        cones = [
            TwistCone(contacts, task.believed.contact_friction, surface)
            for contacts in placed
        ]
        spares = {cone: round(cone.spare(*direct), 6) for cone in cones}
        cones.sort(key=lambda cone: (-spares[cone], _spread(cone.contacts)))
        count = max(PIECEWISE, sum(spare >= SPARE for spare in spares.values()))
        longest = LOOP_RATIO * TwistPath.between((start, goal), radius).length
        out = []
        for cone in cones[:count]:
            path = path_in_cone(start, goal, cone, SPARE, radius, longest)
            if path is not None:
                out.append(self._draft(task, names, path, cone))
        if out:
            return sorted(out, key=lambda draft: (not draft.feasible, *_rank(draft)))[
                :OFFERED
            ]
        fx, fy, tau, _ = cones[0].wrench(*direct)
        return refused(
            f"to the goal it takes ({fx:.1f}, {fy:.1f}) N and {tau:.2f} N m, "
            f"{told(cones[0].angle(*direct), SPARE)}; no way of three twists within "
            f"{longest:.2f} m",
            cones[0].contacts,
        )

    def _draft(
        self, task: Task, names: str, path: TwistPath, cone: TwistCone
    ) -> Choice:
        """Return the choice of a path in a cone, its contacts not yet given to arms."""
        spare = least_spare(path, cone)
        motion = task.motion
        places = " and ".join(
            f"({c.point[0]:.3f}, {c.point[1]:.3f})" for c in cone.contacts
        )
        time = SpeedProfile(
            path.length, motion.speed, motion.acceleration
        ).duration + overhead(task)
        allocate = self.allocator(
            cone.contacts, task.believed.contact_friction, cone.surface.rho
        )
        wrenches = [cone.wrench(*rate) for rate, _ in path.pieces]
        push = max(max(allocate(w.fx, w.fy, w.tau).normals) for w in wrenches)
        reason = (
            f"{names} at {places}: path {path.length:.3f} m of {len(path.pieces)} "
            "twist(s), "
            f"{told(spare, SPARE)}, pushed with up to {push:.1f} N"
        )
        parameters = {
            **cone.figures,
            "radius": path.radius,
            "speed": motion.speed,
            "normal_force": push,
            "contact_height": cone.contacts[0].height,
        }
        limit = task.limits.normal_force
        squeeze = SQUEEZE * cone.surface.max_force
        if push > limit:
            reason += f", limits.normal_force is {limit:g} N"
        elif push > squeeze:
            reason += (
                f", a squeeze: allowed {squeeze:.1f} N, {SQUEEZE:g} times the drag"
            )
        feasible = push <= min(limit, squeeze)
        return Choice(
            self.name,
            feasible,
            reason,
            cone.contacts,
            path.length,
            time,
            spare,
            parameters,
            path,
        )

    def vehicle_frame(self, choice: Choice) -> Pose2:
        """Return X_BV: a constant twist is the same motion whatever point it is told
        of, so V is B.
        """
        return Pose2()

    def tracker(self, plan: Plan) -> HolonomicTracker:
        """Return the holonomic law for a plan, corrected within the cone of KEPT of the
        friction.
        """
        choice = plan.choice
        friction = KEPT * plan.task.believed.contact_friction
        cone = TwistCone.remembered(choice.parameters, choice.contacts, friction)
        return HolonomicTracker(plan.X_BV, cone.surface, cone.nearest)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
        projection: Projection = "nearest",
    ) -> Callable[[float, float, float], Allocation]:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM.

        Forces keep to PREFERRED of the friction where that is enough. ``rho`` [m]
        weighs torque errors (default: half the distance of the contacts);
        ``projection`` says what is kept of a wrench outside the cone.
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        normals = [c.normal for c in contacts]
        rho = rho if rho is not None else 0.5 * math.dist(*points)
        preferred = two_contact_allocator(points, normals, PREFERRED * friction, rho)
        exact = two_contact_allocator(
            points, normals, friction, rho, projection=projection
        )

        def allocate(fx: float, fy: float, tau: float) -> Allocation:
            allocation = preferred(fx, fy, tau)
            return allocation if allocation.status == "ok" else exact(fx, fy, tau)

        return allocate

    def identifier(self, plan: Plan) -> None:
        """Return nothing: the contacts hold the object, there is no axle."""

    def again(self, plan: Plan, X_WB: Pose2, touched: tuple[Point, ...]) -> Plan | None:
        """Return the plan for what is left of the way; None where that is not within
        the cone.
        """
        return self.replan(plan, X_WB, touched, math.inf)

    def replan(
        self,
        plan: Plan,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        longest: float,
        identified: Identified | None = None,
    ) -> Plan | None:
        """Return the plan from the object's true pose and the true contacts; None if
        there is none of up to ``longest`` [m] within the cone.
        """
        figures = plan.choice.parameters
        pairs = zip(plan.choice.contacts, touched, strict=True)
        contacts = tuple(replace(contact, point=point) for contact, point in pairs)
        cone = TwistCone.remembered(
            figures, contacts, plan.task.believed.contact_friction
        )
        goal = plan.goal.compose(plan.task.object.X_GB)
        path = path_in_cone(X_WB, goal, cone, REPLAN_SPARE, figures["radius"], longest)
        if path is None:
            return None
        choice = replace(
            plan.choice, contacts=contacts, path=path, path_length=path.length
        )
        profile = SpeedProfile(
            path.length, plan.profile.speed, plan.profile.acceleration
        )
        return replace(plan, choice=choice, path=path, profile=profile)


def _places(task: Task, pair: tuple[Face, Face]) -> list[tuple[Contact, ...]]:
    """Return contacts on two faces that leave room for the tools."""
    height = contact_height(task)
    sides = []
    for i, face in enumerate(pair):
        low, high = span(task.object, face)
        low = low + CORNER_CLEARANCE
        high = high - CORNER_CLEARANCE
        middle = min(max(0.0, low), high)
        offsets = (
            middle + k * (high - middle if k > 0.0 else middle - low) for k in PLACES
        )
        sides.append(
            [Contact(i, "side", on_face(face, y), face.normal, height) for y in offsets]
        )
    apart = least_distance(task)
    return [(a, b) for a, b in product(*sides) if math.dist(a.point, b.point) >= apart]


def _refused(choice: Choice, why: str) -> Choice:
    reason = f"{choice.reason}; {why}"
    return replace(choice, feasible=False, judged=why is not UNJUDGED, reason=reason)


def _rank(choice: Choice) -> tuple[float, float, float, float]:
    """Order of choices: the quickest first, then by how far inside the cone, by force,
    and by distance.
    """
    if choice.time is None or choice.friction_margin is None:
        return (math.inf, 0.0, 0.0, 0.0)
    spare = round(min(choice.friction_margin, ENOUGH_SPARE), 6)
    return (
        round(choice.time, 3),
        -spare,
        round(choice.parameters["normal_force"], 6),
        _spread(choice.contacts),
    )


def _spread(contacts: Sequence[Contact]) -> float:
    """Sum of the contacts' distances from the CoM [m]: settles ties, the same for a
    mirrored object.
    """
    return round(sum(math.hypot(*contact.point) for contact in contacts), 6)


MODE = OrthogonalPush()
allocator = MODE.allocator
