"""Mode press_and_push: one arm presses a point of the top and pins it, the other pushes
a side face, and the object turns about the pinned point (docs/mechanics.md, sections
1.2 and 7).

Under two presses an object turns best about a point between them. To turn it about a
point near its edge, the second arm pushes from the side, where it has the longest
lever. The press provides the difference between drag and push.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.core import margins
from pushpressslide.core.plan import Choice, Contact, Segment
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.refusal import Refusal, RefusedError, refusal_of
from pushpressslide.core.scene import Scene
from pushpressslide.core.twist_path import TwistPath
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.friction import utilisation_margin
from pushpressslide.modes.base import (
    BOTH_CROSSING,
    Allocator,
    Candidate,
    Continuation,
    Measured,
    Mode,
    in_arms,
)
from pushpressslide.planning.held_twist import resume_path
from pushpressslide.planning.levers import Lever, levers
from pushpressslide.planning.overhead import path_time
from pushpressslide.planning.pressed.drag import PinnedDrag, pinned_drag
from pushpressslide.planning.pressed.pin import least_pin_load, pin_of, pin_refusal
from pushpressslide.planning.segments import describe_points, remaining_ends, segment
from pushpressslide.planning.side_contacts import (
    assignments,
    contact_height,
)
from pushpressslide.rom.drives import ORIGIN, PinnedDrive
from pushpressslide.tracking.eased import EasedTracker
from pushpressslide.tracking.holonomic import HolonomicTracker


@dataclass(frozen=True, slots=True)
class _Turn:
    """The turn about the pinned point that the task requires."""

    pin: Point  # [m] in B
    path: TwistPath  # of the pin
    time: float  # [s] of the whole run


class PressAndPush(Mode[PinnedDrive]):
    """One arm pins a point, the other turns the object about it."""

    name = "press_and_push"
    arms = 2
    reduced_model = "pivot about a pressed point"
    tracking_point = "the pressed point"
    cop_steering = True
    carries_weight = False
    pushed_faces = None
    drives = (PinnedDrive,)

    def candidates(self, query: MotionQuery) -> list[Candidate | Choice]:
        """One candidate per place to push, those with the longest lever first."""
        try:
            pin = pin_of(query)
        except RefusedError as error:
            return [Choice(self.name, refusal=error.refusal)]
        turn = math.remainder(query.goal.yaw - query.start.yaw, 2.0 * math.pi)
        height = contact_height(query.scene, query.motion)
        side = math.copysign(1.0, turn)
        places = levers(query.scene, pin, side, height, query.motion.face)
        if not places:
            text = "no face has a lever of {allowed:mm.0f} about the pressed point"
            least = margins.LEAST_LEVER * query.body.radius
            refusal = Refusal("lever", text, None, least, "m")
            return [Choice(self.name, refusal=refusal)]
        radius = max(math.dist(pin, place.point) for place in places)
        start, goal = (X_WB.compose(Pose2(*pin)) for X_WB in query.body_ends)
        path = TwistPath.between((start, goal), radius)
        time = path_time(query.motion, path.length, pressed=True)
        turning = _Turn(pin, path, time)
        return [
            Candidate(time, partial(self._pushed, query, turning, place))
            for place in places
        ]

    def _pushed(
        self, query: MotionQuery, turn: _Turn, lever: Lever, evaluated: bool
    ) -> list[Choice]:
        """One choice for each assignment of the two contacts to the arms, for one place
        to push.

        The arms' reach is not checked.
        """
        scene = query.scene
        top = query.body.shape.top_height
        height = contact_height(scene, query.motion)
        press = Contact(0, "top", turn.pin, ORIGIN, top)
        push = Contact(1, "side", lever.point, lever.face.normal, height)
        label = (
            f"pressed at {describe_points([turn.pin])}, pushed on face "
            f"{lever.face.index} at {describe_points([lever.point])}"
        )
        choice = Choice(self.name, label, (press, push), time=turn.time)
        if height >= top:
            text = "the push is at {figure:mm.0f}, the object is {allowed:mm.0f} high"
            return [choice.refused(Refusal("above_object", text, height, top, "m"))]
        if not evaluated:
            return [choice]
        path = turn.path
        X_VB = Pose2(*turn.pin).inverse()
        poses = [path.pose(0.25 * i * path.length).compose(X_VB) for i in range(5)]
        assigned = assignments(scene.bases, (turn.pin, lever.point), poses)
        if not assigned:
            return [choice.refused(BOTH_CROSSING)]
        try:
            driven = self._driven(query, choice, turn, lever)
        except ValueError as error:
            tips = f"the object would tip: {refusal_of(error, 'tipping')}"
            return [choice.refused(Refusal("tipping", tips))]
        return in_arms(driven, assigned)

    def _driven(
        self, query: MotionQuery, choice: Choice, turn: _Turn, lever: Lever
    ) -> Choice:
        """``choice`` with its press load: that of the task, or by default the smallest
        safe load.

        Raises ValueError if the object tips.
        """
        scene = query.scene
        press, push = choice.contacts
        path = turn.path
        twist = path.initial_twist(turn.pin)
        cap = query.planned_force

        @cache
        def dragged(load: float) -> PinnedDrag:
            """Drag of the object with a press of ``load`` [N]."""
            return self._drag(scene, (replace(press, load=load), push), twist)

        load = query.motion.press_force
        if load is None:
            load = least_pin_load(
                dragged, cap, scene.pin_uses, query.sensing.least_press
            )
        drag = dragged(load)
        contacts = (replace(press, load=load), push)
        utilisation = drag.friction_utilisation
        margin = utilisation_margin(scene.contact_friction, utilisation)
        drive = _drive(drag, path.radius, contacts)
        one_segment = segment(
            query, self.name, contacts, drive, path, cone_margin=margin
        )
        summary = (
            f"{load:.1f} and {drag.forces.normals[1]:.1f} N, lever "
            f"{lever.length * 1e3:.0f} mm, path {path.distance:.3f} m, "
            f"{utilisation:.2f} of the press's friction used"
        )
        return replace(
            choice,
            contacts=contacts,
            segments=(one_segment,),
            summary=summary,
            refusal=pin_refusal(cap, load, drag, scene.pin_uses[-1]),
        )

    def _drag(
        self, scene: Scene, contacts: Sequence[Contact], twist: Twist
    ) -> PinnedDrag:
        """Drag of the object at ``twist``. Raises ValueError if the object tips."""
        mu = scene.contact_friction
        allocator = partial(self.allocator, contacts, mu, None)
        return pinned_drag(scene, contacts, twist, allocator)

    def tracker(self, query: MotionQuery, segment: Segment) -> EasedTracker:
        """Holonomic law for a segment, limited by the friction of the contacts."""
        drive = self.drive_of(segment)
        decay = margins.ARM.quick * segment.profile.speed
        law = HolonomicTracker(drive.X_BV, drive.surface, decay)
        friction = query.scene.contact_friction
        return EasedTracker(law, self.allocator_of(segment, friction))

    def allocator(
        self,
        contacts: Sequence[Contact],
        friction: float,
        rho: float | None = None,
        cop: Point = ORIGIN,
    ) -> Allocator:
        """``allocate(fx, fy, tau)`` about ``cop`` [m], with the press as the first
        contact. ``rho`` is not used.
        """
        press, push = contacts
        return press_and_push_allocator(
            press.point, press.load, push.point, push.normal, friction, cop
        )

    def continue_from(
        self, query: MotionQuery, segment: Segment, measured: Measured
    ) -> Continuation | None:
        """Continuation by one twist about the measured pin. None if the pushing arm
        would have to pull.
        """
        planned = self.drive_of(segment)
        radius = planned.radius
        contacts = measured.contacts
        pin = contacts[0].point
        ends = remaining_ends(query.body, segment, measured.X_WB, Pose2(*pin))
        path = resume_path(ends, radius, measured.longest)
        if path is None:
            return None
        try:
            drag = self._drag(query.scene, contacts, path.initial_twist(pin))
        except ValueError:
            return None
        if drag.forces.status != "ok":
            return None
        return Continuation(contacts, _drive(drag, radius, contacts), path)


def _drive(drag: PinnedDrag, radius: float, contacts: Sequence[Contact]) -> PinnedDrive:
    press, push = contacts
    return PinnedDrive(
        drag.surface,
        radius,
        press.point,
        drag.cop,
        drag.friction_utilisation,
        push.point,
        push.normal,
    )


MODE = PressAndPush()
allocator = MODE.allocator
