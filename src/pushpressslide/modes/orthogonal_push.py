"""Mode orthogonal_push: two arms push two faces that are not parallel
(docs/mechanics.md, section 6).

Together they drive every twist of a cone: ahead between the two normals, turned to
either side by friction and by contacts beside the centre of mass; never back. Where the
contacts are decides which cone it is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from itertools import combinations, product

from pushpressslide.allocation.projections import Projection
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.refusal import Refusal, refusal_of
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import TwistPath, screw
from pushpressslide.core.wrench import Twist
from pushpressslide.identification.online import Identified
from pushpressslide.mechanics.face_push import on_face
from pushpressslide.mechanics.faces import Face, faces
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import (
    CROSSING,
    ENOUGH,
    Allocator,
    Course,
    Draft,
    Mode,
    search,
    with_arms,
)
from pushpressslide.planning.in_cone import (
    describe_cone_margin,
    least_cone_margin,
    path_in_cone,
)
from pushpressslide.planning.segments import run_time, segment
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
    drag_refusal,
    farthest_corner,
    least_distance,
    span,
)
from pushpressslide.rom.drives import ORIGIN, TwistDrive
from pushpressslide.tracking.holonomic import HolonomicTracker

CORNER_CLEARANCE = 0.015  # [m] between a contact and a corner of its face
# places of a contact, in shares of the face on either side of the CoM's line
PLACES = (-1.0, -0.5, 0.0, 0.5, 1.0)
ANGLES = (math.radians(40.0), math.radians(140.0))  # between the two normals
CONE_MARGIN = math.radians(6.0)  # that a plan keeps from its cone's edges
REPLAN_MARGIN = math.radians(2.0)  # that a plan made under way keeps
# of placements with more margin the one that takes the least force is the best
AMPLE_MARGIN = math.radians(30.0)
CORRECTION_SHARE = 0.9  # of the friction, that corrections may use
PREFERRED = 0.8  # of the friction, that forces keep to where they can
# times the drag that one contact may push with: more is spent against the other
SQUEEZE = 1.6
LOOP_RATIO = 1.6  # times the direct path: a longer one is not taken
PIECEWISE = 5  # placements on two faces for which paths of several twists are sought
OFFERED = 6  # placements on two faces that are judged further


class OrthogonalPush(Mode):
    """Two arms push two faces that are not parallel."""

    name = "orthogonal_push"
    arms = 2
    reduced_model = "quasi-holonomic within a cone"
    tracking_point = "CoM"
    cop_steering = False
    carries_weight = False
    pushed_faces = 2
    drives = (TwistDrive,)

    def choices(self, task: Task, enough: int = ENOUGH) -> list[Choice]:
        """Return the choices of all placements."""
        return search(task, self._drafts(task), enough)

    def _drafts(self, task: Task) -> list[Draft | Choice]:
        """Return the best placements on every two faces: the quickest first; of equally
        quick ones that with the least force, if it is well inside its cone.
        """
        if not task.object.shape.corners:
            text = "a cylinder has no flat faces for two pushes"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed = []
        for pair in combinations(faces(task.object, CORNER_CLEARANCE), 2):
            if ANGLES[0] <= _angle_between(*pair) <= ANGLES[1]:
                placed += self._placed(task, pair)
        if not placed:
            text = "no two faces with 40 to 140 deg between their normals"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed.sort(key=_rank)
        return [
            Draft(float(i), partial(self._given_to_arms, task, choice), ordered=True)
            for i, choice in enumerate(placed)
        ]

    def _given_to_arms(
        self, task: Task, choice: Choice, evaluated: bool
    ) -> list[Choice]:
        """Return one choice for each way to give the contacts to the arms."""
        if not (choice.feasible and evaluated):
            return [choice]
        (piece,) = choice.segments
        path = piece.path
        poses = [path.pose(share * path.length) for share in (0.0, 0.5, 1.0)]
        points = [contact.point for contact in choice.contacts]
        ways = assignments(task.scene.bases, points, poses)
        if not ways:
            return [choice.refused(CROSSING)]
        return [with_arms(choice, arms) for arms in ways]

    def _placed(self, task: Task, pair: tuple[Face, Face]) -> list[Choice]:
        """Return the best placements on two faces, but for the arms' reach; or one, and
        why it cannot do the task.
        """
        names = f"faces {pair[0].index} and {pair[1].index}"
        height = contact_height(task)
        middles = tuple(
            Contact(i, "side", face.foot, face.normal, height)
            for i, face in enumerate(pair)
        )
        none = Choice(self.name, names, middles)
        refusal = drag_refusal(task, pair, height)
        placements = _placements(task, pair)
        if refusal is None and not placements:
            text = "no two contacts {allowed:mm.0f} apart, as two tools need"
            refusal = Refusal("too_close", text, None, least_distance(task), "m")
        if refusal is not None:
            return [none.refused(refusal)]
        start, goal = (X.compose(task.object.X_GB) for X in (task.start, task.goal))
        direct = screw(start, goal)
        radius = farthest_corner(task.object)
        try:
            surface = push_surface(task.scene, height, Twist(*direct))
        except ValueError as error:
            return [none.refused(refusal_of(error, "tipping"))]
        mu = task.believed.contact_friction
        cones = [TwistCone(contacts, mu, surface) for contacts in placements]
        margins = {cone: round(cone.spare(*direct), 6) for cone in cones}
        cones.sort(key=lambda cone: (-margins[cone], _spread(cone.contacts)))
        inside = sum(margin >= CONE_MARGIN for margin in margins.values())
        longest = LOOP_RATIO * TwistPath.between((start, goal), radius).length
        found = []
        for cone in cones[: max(PIECEWISE, inside)]:
            path = path_in_cone(start, goal, cone, CONE_MARGIN, radius, longest)
            if path is not None:
                found.append(self._driven(task, names, path, cone))
        if found:
            found.sort(key=lambda choice: (not choice.feasible, *_rank(choice)))
            return found[:OFFERED]
        fx, fy, tau, _ = cones[0].wrench(*direct)
        margin = cones[0].angle(*direct)
        text = (
            f"to the goal it takes ({fx:.1f}, {fy:.1f}) N and {tau:.2f} N m, "
            f"{describe_cone_margin(margin, CONE_MARGIN)}; no way of three twists "
            f"within {longest:.2f} m"
        )
        refusal = Refusal("outside_cone", text, margin, CONE_MARGIN, "rad")
        return [Choice(self.name, names, cones[0].contacts, refusal=refusal)]

    def _driven(
        self, task: Task, names: str, path: TwistPath, cone: TwistCone
    ) -> Choice:
        """Return the choice of a path in a cone, its contacts not yet given to arms."""
        contacts = cone.contacts
        margin = least_cone_margin(path, cone)
        places = " and ".join("({:.3f}, {:.3f})".format(*c.point) for c in contacts)
        push = self._push(task, path, cone)
        drive = TwistDrive(cone.surface, path.radius, push)
        piece = segment(task, self.name, contacts, drive, path, cone_margin=margin)
        merits = (
            f"path {path.length:.3f} m of {len(path.pieces)} twist(s), "
            f"{describe_cone_margin(margin, CONE_MARGIN)}, pushed with up to {push:.1f} N"
        )
        limit = task.limits.normal_force
        squeeze = SQUEEZE * cone.surface.max_force
        refusal = None
        if push > limit:
            text = (
                "pushed with up to {figure:N.1f}, limits.normal_force is {allowed:Ng}"
            )
            refusal = Refusal("normal_force", text, push, limit, "N")
        elif push > squeeze:
            text = (
                "pushed with up to {figure:N.1f}, a squeeze: allowed {allowed:N.1f}, "
                f"{SQUEEZE:g} times the drag"
            )
            refusal = Refusal("squeeze", text, push, squeeze, "N")
        return Choice(
            self.name,
            f"{names} at {places}",
            contacts,
            (piece,),
            run_time(task, (piece,)),
            merits,
            refusal,
        )

    def _push(self, task: Task, path: TwistPath, cone: TwistCone) -> float:
        """Return the largest normal force [N] that driving a path takes."""
        mu = task.believed.contact_friction
        allocate = self.allocator(cone.contacts, mu, cone.surface.rho)
        wrenches = [cone.wrench(*rate) for rate, _ in path.pieces]
        return max(max(allocate(w.fx, w.fy, w.tau).normals) for w in wrenches)

    def tracker(self, task: Task, segment: Segment) -> HolonomicTracker:
        """Return the holonomic law for a segment, corrected within the cone of
        CORRECTION_SHARE of the friction.
        """
        drive = segment.drive
        assert isinstance(drive, TwistDrive)
        friction = CORRECTION_SHARE * task.believed.contact_friction
        cone = TwistCone(segment.contacts, friction, drive.surface)
        return HolonomicTracker(drive.X_BV, cone.surface, cone.nearest)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
        projection: Projection = "nearest",
    ) -> Allocator:
        """Return ``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM.

        Forces keep to PREFERRED of the friction where that is enough. ``rho`` [m]
        weighs torque errors (default: half the distance of the contacts);
        ``projection`` says what remains of a wrench outside the cone.
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        normals = [c.normal for c in contacts]
        if rho is None:
            rho = 0.5 * math.dist(*points)
        preferred = two_contact_allocator(points, normals, PREFERRED * friction, rho)
        exact = two_contact_allocator(
            points, normals, friction, rho, projection=projection
        )

        def allocate(fx: float, fy: float, tau: float) -> Allocation:
            """Return the forces of a wrench in B."""
            allocation = preferred(fx, fy, tau)
            return allocation if allocation.status == "ok" else exact(fx, fy, tau)

        return allocate

    def course(
        self,
        task: Task,
        segment: Segment,
        X_WB: Pose2,
        contacts: tuple[Contact, ...],
        longest: float,
        identified: Identified | None,
    ) -> Course | None:
        """Return the course by twists within the cone of the true contacts."""
        drive = segment.drive
        assert isinstance(drive, TwistDrive)
        cone = TwistCone(contacts, task.believed.contact_friction, drive.surface)
        goal = segment.goal.compose(task.object.X_GB)
        path = path_in_cone(X_WB, goal, cone, REPLAN_MARGIN, drive.radius, longest)
        return None if path is None else Course(contacts, drive, path)


def _angle_between(first: Face, second: Face) -> float:
    """Angle [rad] between the normals of two faces."""
    ax, ay = first.normal
    bx, by = second.normal
    return abs(math.atan2(ax * by - ay * bx, ax * bx + ay * by))


def _placements(task: Task, pair: tuple[Face, Face]) -> list[tuple[Contact, ...]]:
    """Return contacts on two faces that leave room for the tools."""
    height = contact_height(task)
    sides = []
    for i, face in enumerate(pair):
        right, left = span(task.object, face)
        low = right + CORNER_CLEARANCE
        high = left - CORNER_CLEARANCE
        middle = min(max(0.0, low), high)
        offsets = (
            middle + k * (high - middle if k > 0.0 else middle - low) for k in PLACES
        )
        sides.append(
            [Contact(i, "side", on_face(face, y), face.normal, height) for y in offsets]
        )
    apart = least_distance(task)
    return [(a, b) for a, b in product(*sides) if math.dist(a.point, b.point) >= apart]


def _rank(choice: Choice) -> tuple[float, float, float, float]:
    """Order of choices: the quickest first, then by how far inside the cone, by force,
    and by distance.
    """
    margin = choice.friction_margin
    if choice.time is None or margin is None:
        return (math.inf, 0.0, 0.0, 0.0)
    (piece,) = choice.segments
    assert isinstance(piece.drive, TwistDrive)
    inside = round(min(margin, AMPLE_MARGIN), 6)
    force = round(piece.drive.normal_force, 6)
    return (round(choice.time, 3), -inside, force, _spread(choice.contacts))


def _spread(contacts: Sequence[Contact]) -> float:
    """Sum of the contacts' distances from the CoM [m]: settles ties, the same for a
    mirrored object.
    """
    return round(sum(math.hypot(*contact.point) for contact in contacts), 6)


MODE = OrthogonalPush()
allocator = MODE.allocator
