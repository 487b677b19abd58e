"""Mode orthogonal_push: two arms push two faces that are not parallel
(docs/mechanics.md, section 6).

Together they drive every twist of a cone. The object moves forward between the two
normals, never backward; friction and contacts off the centre of mass turn it to either
side. The places of the contacts determine the cone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations

from pushpressslide.allocation.projections import Projection
from pushpressslide.allocation.reserve import reserving_allocator
from pushpressslide.allocation.twist_cone import TwistCone
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Contact
from pushpressslide.core.pose import Point
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, refusal_of
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.faces import Face
from pushpressslide.mechanics.push_surface import push_surface
from pushpressslide.modes.base import Allocator, Candidate
from pushpressslide.modes.shared.twist_pushes import (
    TwistPushes,
    driven_by_twists,
    exact_margin,
    in_free_arms,
    largest_push,
    within_reach,
)
from pushpressslide.planning.face_placements import (
    angle_between,
    on_two_faces,
    spread,
)
from pushpressslide.planning.in_cone import (
    ConeGoal,
    describe_cone_margin,
)
from pushpressslide.planning.segments import describe_points
from pushpressslide.planning.side_contacts import (
    contact_height,
    drag_refusal,
    least_distance,
    push_refusal,
    pushable,
    untouchable,
)
from pushpressslide.robots.contact_reach import UNKNOWN
from pushpressslide.rom.drives import ORIGIN, TwistDrive

ANGLES = (math.radians(40.0), math.radians(140.0))  # angles between the two normals
PIECEWISE = 5  # placements on two faces for which paths of several twists are sought
# the same for each of the many motions in a search for a sequence
PIECEWISE_SEARCHED = 2
OFFERED = 6  # placements on two faces that are fully evaluated


class OrthogonalPush(TwistPushes):
    """Two arms push two faces that are not parallel."""

    name = "orthogonal_push"
    arms = 2
    reduced_model = "quasi-holonomic within a cone"
    tracking_point = "CoM"
    evaluation_cost = 2
    cop_steering = False
    carries_weight = False
    pushed_faces = 2
    drives = (TwistDrive,)

    def candidates(self, query: MotionQuery) -> list[Candidate | Choice]:
        """Best placements on each pair of faces, the quickest first.

        Among equally quick placements, one that needs less force comes first if its
        forces are well inside their cones.
        """
        height = contact_height(query.scene, query.motion)
        pushed = pushable(query.scene, height)
        if not pushed:
            return [Choice(self.name, refusal=untouchable(query.scene, height))]
        flat = [face for face in pushed if face.flat]
        if not flat:
            text = "there are no flat faces for two pushes"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed = []
        for pair in combinations(flat, 2):
            if ANGLES[0] <= angle_between(*pair) <= ANGLES[1]:
                placed += self._placed(query, pair)
        if not placed:
            text = "no two faces with 40 to 140 deg between their normals"
            return [Choice(self.name, refusal=Refusal("no_faces", text))]
        placed.sort(key=_rank)
        return [
            Candidate(
                float(i), partial(_in_arms, query.scene, choice), True, choice.contacts
            )
            for i, choice in enumerate(placed)
        ]

    def _placed(self, query: MotionQuery, pair: tuple[Face, Face]) -> list[Choice]:
        """Best placements on two faces, before the check of the arms' reach. If no
        placement is feasible, a single choice with its refusal.
        """
        scene = query.scene
        height = contact_height(scene, query.motion)
        middles = tuple(
            Contact(i, "side", face.foot, face.normal, height)
            for i, face in enumerate(pair)
        )
        names = f"faces {pair[0].index} and {pair[1].index}"
        none = Choice(self.name, names, middles)
        refusal = drag_refusal(query, pair, 2, height)
        placements = on_two_faces(scene, pair, height)
        if refusal is None and not placements:
            text = "no two contacts {allowed:mm.0f} apart, as two tools need"
            refusal = Refusal("too_close", text, None, least_distance(scene), "m")
        if refusal is not None:
            return [none.refused(refusal)]
        placements = within_reach(query, placements)
        if not placements:
            return [none.refused(UNKNOWN)]
        cone_goal = ConeGoal.between(query.body_ends, query.body.radius)
        try:
            surface = push_surface(scene, height, Twist(*cone_goal.direct))
        except ValueError as error:
            return [none.refused(refusal_of(error, "tipping"))]
        mu = scene.least_contact_friction
        cones = [TwistCone(contacts, mu, surface) for contacts in placements]
        return self._by_twists(query, names, cone_goal, cones)

    def _by_twists(
        self,
        query: MotionQuery,
        names: str,
        cone_goal: ConeGoal,
        cones: list[TwistCone],
    ) -> list[Choice]:
        """Best choices of contacts with the given ``cones``. If none has a path, the
        refused choice that comes nearest to having one.
        """
        direct = cone_goal.direct
        inside = {cone: round(cone.cone_margin(*direct), 6) for cone in cones}
        cones = sorted(cones, key=lambda cone: (-inside[cone], spread(cone.contacts)))
        usable = sum(margin >= margins.CONE_MARGIN for margin in inside.values())
        driven = []
        piecewise = PIECEWISE_SEARCHED if query.from_search else PIECEWISE
        tried = max(piecewise, usable)
        for cone in cones[:tried]:
            path = cone_goal.path(cone, exact_margin(query.scene, cone.contacts))
            if path is not None:
                driven.append(self._driven(query, names, path, cone))
        if driven:
            driven.sort(key=lambda choice: (not choice.feasible, *_rank(choice)))
            return driven[:OFFERED]
        fx, fy, tau, _ = cones[0].wrench(*direct)
        margin = cones[0].angle(*direct)
        text = (
            f"the goal requires ({fx:.1f}, {fy:.1f}) N and {tau:.2f} N m, "
            f"{describe_cone_margin(margin)}; no path of three twists "
            f"within {cone_goal.longest:.2f} m"
        )
        refusal = Refusal("outside_cone", text, margin, margins.CONE_MARGIN, "rad")
        return [Choice(self.name, names, cones[0].contacts, refusal=refusal)]

    def _driven(
        self, query: MotionQuery, names: str, path: TwistPath, cone: TwistCone
    ) -> Choice:
        """Choice that drives the object along a ``path`` of twists in a ``cone``.

        Its contacts are not yet assigned to arms.
        """
        places = describe_points(contact.point for contact in cone.contacts)
        placed = Choice(self.name, f"{names} at {places}", cone.contacts)
        friction = query.scene.contact_friction
        allocate = self.allocator(cone.contacts, friction, cone.surface.rho)
        push = largest_push(path, cone, allocate)
        driven = driven_by_twists(query, placed, path, cone, push)
        summary = f"{driven.summary}, pushed with up to {push:.1f} N"
        refusal = push_refusal(push, query.limits, cone.surface.max_force)
        return replace(driven, summary=summary, refusal=refusal)

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
        projection: Projection = "nearest",
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m], by default the CoM.

        Forces keep a reserve of friction if possible. ``rho`` [m] weights moment errors
        (default: half the distance between the contacts). ``projection`` selects how a
        wrench outside the cone is projected.
        """
        points = [(c.point[0] - cop[0], c.point[1] - cop[1]) for c in contacts]
        normals = [c.normal for c in contacts]
        if rho is None:
            rho = 0.5 * math.dist(*points)
        return reserving_allocator(points, normals, friction, rho, projection)


def _in_arms(scene: Scene, choice: Choice, evaluated: bool) -> list[Choice]:
    """One choice for each assignment of the choice's contacts to arms."""
    if not (choice.feasible and evaluated):
        return [choice]
    return in_free_arms(scene, choice)


def _rank(choice: Choice) -> tuple[float, float, float, float]:
    """Ranking key of choices: time, then cone margin, force and distance."""
    margin = choice.friction_margin
    if choice.time is None or margin is None:
        return (math.inf, 0.0, 0.0, 0.0)
    (segment,) = choice.segments
    assert isinstance(segment.drive, TwistDrive)
    inside = round(min(margin, margins.AMPLE_MARGIN), 6)
    force = round(segment.drive.normal_force, 6)
    return (round(choice.time, 3), -inside, force, spread(choice.contacts))


MODE = OrthogonalPush()
allocator = MODE.allocator
