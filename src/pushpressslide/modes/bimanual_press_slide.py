"""Mode bimanual_press_slide: two arms press and slide the object in any direction
(docs/mechanics.md, 7 and 9).

The friction discs under two tips can provide every planar wrench. The object is
therefore holonomic, and is led along one constant twist from start to goal. The
distribution of the load sets the centre of pressure. On a wall the presses alone hold
the object against it, and carry its weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import inf

from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.slide_loads import (
    cop_fraction,
    slide_loads,
    slip_refusal,
)
from pushpressslide.core import margins
from pushpressslide.core.motion import Motion
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, refusal_of
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.friction import utilisation_margin
from pushpressslide.mechanics.pressing import resting_cop
from pushpressslide.mechanics.top import room_inside
from pushpressslide.mechanics.wall import lever
from pushpressslide.modes.base import (
    BOTH_CROSSING,
    Allocator,
    Candidate,
    Continuation,
    Measured,
    Mode,
)
from pushpressslide.planning.held_twist import resume_path, tipping_refusal
from pushpressslide.planning.overhead import path_time
from pushpressslide.planning.press_pairs import PlacedPair, placed_pairs
from pushpressslide.planning.pressed.drag import HeldDrag, held_drag
from pushpressslide.planning.segments import describe_points, remaining_ends, segment
from pushpressslide.rom.drives import ORIGIN, HeldDrive
from pushpressslide.tracking.carried import CarriedTracker
from pushpressslide.tracking.eased import EasedTracker


class BimanualPressSlide(Mode[HeldDrive]):
    """Two arms press on top and slide the object."""

    name = "bimanual_press_slide"
    arms = 2
    reduced_model = "quasi-holonomic"
    tracking_point = "CoM, or CoP when pivoting"
    evaluation_cost = 4
    cop_steering = True
    carries_weight = True
    pushed_faces = 0
    drives = (HeldDrive,)

    def candidates(self, query: MotionQuery) -> list[Candidate | Choice]:
        """One candidate per pair of contacts, those nearest to their arms first."""
        placed = placed_pairs(query)
        if not placed:
            text = "the top has no two places {allowed:mm.0f} apart"
            refusal = Refusal("too_close", text, None, margins.ARM.hand_room, "m")
            return [Choice(self.name, refusal=refusal)]
        return [self._candidate(query, pair) for pair in placed]

    def _candidate(self, query: MotionQuery, pair: PlacedPair) -> Candidate:
        """Candidate for one pair of contacts."""
        refusal = pair.refusal
        if refusal is None and pair.crossing:
            refusal = BOTH_CROSSING
        if refusal is None and pair.path.length == 0.0:
            refusal = Refusal("at_goal", "the goal is the start")
        points = (contact.point for contact in pair.contacts)
        label = f"pressed at {describe_points(points)}"
        time = _time(query.motion, pair.path)
        choice = Choice(self.name, label, pair.contacts, time=time, refusal=refusal)
        make = partial(self._pressed, query, choice, pair.path)
        return Candidate(time or inf, make, contacts=pair.contacts)

    def _pressed(
        self, query: MotionQuery, placed: Choice, path: TwistPath, evaluated: bool
    ) -> list[Choice]:
        """Evaluate one pair of contacts, without a check of the arms' reach."""
        if not (evaluated and placed.feasible):
            return [placed]
        scene = query.scene
        points = (placed.contacts[0].point, placed.contacts[1].point)
        cap = query.planned_force
        try:
            refusal, loads = slide_loads(
                scene, query.motion, cap, points, path, query.sensing.least_press
            )
        except ValueError as error:
            return [placed.refused(refusal_of(error, "press"))]
        for normals in loads:
            contacts = tuple(
                replace(contact, load=load)
                for contact, load in zip(placed.contacts, normals, strict=True)
            )
            point = _tracking_point(scene, contacts, path.initial_twist(ORIGIN))
            X_BV = Pose2(*point)
            ends = path.start.compose(X_BV), path.end.compose(X_BV)
            tracked = TwistPath.between(ends, path.radius)
            try:
                drag = self._drag(scene, contacts, tracked, point)
            except ValueError as error:
                tips = f"it would tip: {refusal_of(error, 'tipping')}"
                return [placed.refused(Refusal("tipping", tips))]
            if drag.friction_utilisation <= scene.friction_uses[-1]:
                break
        placed = replace(placed, contacts=contacts, refusal=refusal)
        return [self._driven(query, placed, tracked, point, drag)]

    def _driven(
        self,
        query: MotionQuery,
        placed: Choice,
        path: TwistPath,
        point: Point,
        drag: HeldDrag,
    ) -> Choice:
        """``placed`` with its segment along ``path``, loads and margins."""
        scene = query.scene
        contacts = placed.contacts
        utilisation = drag.friction_utilisation
        left, right = (contact.load for contact in contacts)
        refusal = placed.refusal
        if refusal is None:
            cause = f"drag at {query.body.shape.top_height:.3f} m tips the object"
            refusal = tipping_refusal(cause, drag.tipping_margin)
        allowed = scene.friction_uses[-1]
        if refusal is None and utilisation > allowed:
            refusal = slip_refusal((left, right), utilisation, allowed)
        load = scene.weight_on + sum(contact.load for contact in contacts)
        drive = HeldDrive(
            drag.surface, path.radius, point, lever(scene, load), utilisation
        )
        margin = utilisation_margin(scene.contact_friction, utilisation)
        one_segment = segment(
            query, self.name, contacts, drive, path, cone_margin=margin
        )
        summary = (
            f"{left:.1f} and {right:.1f} N, path {path.distance:.3f} m, centre of "
            f"pressure {cop_fraction(scene, contacts):.2f} of the way from left to "
            f"right, {utilisation:.2f} of the tips' friction used"
        )
        return replace(
            placed,
            segments=(one_segment,),
            time=_time(query.motion, path),
            summary=summary,
            refusal=refusal,
        )

    def _drag(
        self, scene: Scene, contacts: Sequence[Contact], path: TwistPath, point: Point
    ) -> HeldDrag:
        """Drag of the object led at ``point`` along its path. Raises ValueError if the
        object tips.
        """
        mu = scene.contact_friction
        allocator = partial(self.allocator, contacts, mu, None)
        return held_drag(scene, contacts, path, point, allocator)

    def tracker(self, query: MotionQuery, segment: Segment) -> EasedTracker:
        """Holonomic law for a segment, limited by the friction of the contacts."""
        drive = self.drive_of(segment)
        decay = margins.ARM.quick * segment.profile.speed
        law = CarriedTracker(
            drive.X_BV, drive.surface, query.scene.weight_along, drive.lever, decay
        )
        friction = query.scene.contact_friction
        return EasedTracker(law, self.allocator_of(segment, friction))

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m]. ``rho`` is not used."""
        left, right = contacts
        allocate = two_press_allocator((left.point, right.point), friction)
        return partial(allocate, normals=(left.load, right.load), cop=cop)

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation by one twist from the measured object pose and contacts."""
        planned = self.drive_of(segment)
        ends = remaining_ends(query.body, segment, measured.X_WB, planned.X_BV)
        path = resume_path(ends, planned.radius, measured.longest)
        if path is None:
            return None
        contacts = measured.contacts
        try:
            drag = self._drag(query.scene, contacts, path, planned.point)
        except ValueError:
            return None
        utilisation = drag.friction_utilisation
        drive = replace(planned, surface=drag.surface, friction_utilisation=utilisation)
        return Continuation(contacts, drive, path)


def _time(motion: Motion, path: TwistPath) -> float:
    """Time [s] of the whole run."""
    return round(path_time(motion, path.length, pressed=True), 3)


def _tracking_point(scene: Scene, contacts: Sequence[Contact], twist: Twist) -> Point:
    """Tracking point [m]: the CoP if the object turns about a point inside its base,
    otherwise the CoM.
    """
    if not twist.w:
        return ORIGIN
    icr = (-twist.vy / twist.w, twist.vx / twist.w)
    if room_inside(scene.body, icr) < 0.0:
        return ORIGIN
    return resting_cop(scene, contacts)


MODE = BimanualPressSlide()
allocator = MODE.allocator
