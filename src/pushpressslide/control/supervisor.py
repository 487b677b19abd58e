"""The supervisor of the motion: a table of transitions, evaluated in order at every
tick.

``TRANSITIONS`` is the policy. The first row whose event holds decides the action. A row
does not depend on those below it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

from pushpressslide.control.correction import (
    Replanner,
    axle_error,
    press_creep,
    rest_of,
    side_slide,
    sides_of,
    slide,
    touched_points,
)
from pushpressslide.control.following import Following, Prediction
from pushpressslide.control.insertion import HOLD_TIME, SEAT_TIME
from pushpressslide.control.placement import Placement, share_of_tolerance
from pushpressslide.control.pressed_body import PressedBody
from pushpressslide.control.state import (
    ContactLosses,
    ControllerState,
    Failure,
    Instant,
    StallWatch,
    Touched,
    enter_phase,
    estimates,
    ramp_time,
)
from pushpressslide.control.touch import held_at
from pushpressslide.core import margins
from pushpressslide.core.control import Phase
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Segment
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.identification.online import AxleEstimate
from pushpressslide.identification.parameter_estimates import ParameterEstimates
from pushpressslide.identification.tip_friction import TipFriction
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.planning.pressed.harder import harder_presses
from pushpressslide.planning.workspace import poses_along

RETOUCHES = 3
LOSSES = 6  # losses of contact at one point above which the attempt ends
RETRIES = 4
SLOWED = 1.5  # duration of a motion that slows down to be seen, over the planned one


class Moment(NamedTuple):
    """A tick of the motion, after its commands."""

    state: ControllerState
    instant: Instant
    contact_points: tuple[Point, ...]  # [m] in B, where the tips touch the object
    guidance: Guidance

    @property
    def left(self) -> float:
        """Remaining length [m] of the path."""
        return self.state.following.left


class Settled(NamedTuple):
    """The tick at which all tips have settled at their contacts."""

    state: ControllerState
    instant: Instant


class SeenGap(NamedTuple):
    """Gap of a pushing tip from its side."""

    gap: float  # [m]
    tip_radius: float  # [m]


class Supervisor:
    """Decides on the events of one placement.

    Some actions replan and may take longer than a tick.
    """

    def __init__(self, placement: Placement, servo: bool, patience: float) -> None:
        """Watch ``placement``.

        With ``servo``, a velocity servo leads the tips in addition to the planned
        forces. ``patience`` [s] is the time for which a contact may be missing.
        """
        self.placement = placement
        self.servo = servo
        self.patience = patience
        self.gives_up = True  # a motion whose goal will be missed: a recovery is left
        # what the turns under presses have told up to now; None: nothing
        self.pressed_body: Callable[[], PressedBody | None] = _nothing
        # of the body that was last followed: it is asked for at every tick
        self._believing: tuple[PressedBody | None, Replanner]
        self._believing = (None, placement.replanner)

    def step(self, event: Moment | Settled) -> ControllerState:
        """State after an event. During the motion, the first row that holds decides."""
        if isinstance(event, Settled):
            if self._held_back(event):
                return event.state
            return self._begin_motion(event.state, event.instant)
        moment = self._watched(event)
        return self._row(moment).act(self, moment)

    def plans(self, event: Moment | Settled) -> bool:
        """Whether the action of ``event`` may take longer than a tick."""
        if isinstance(event, Settled):
            return not self._held_back(event)
        return self._row(self._watched(event)).plans

    def _row(self, moment: Moment) -> Transition:
        """The first row whose event holds."""
        for row in TRANSITIONS:
            if row.holds(self, moment):
                return row
        raise AssertionError("the last row always holds")

    def _watched(self, moment: Moment) -> Moment:
        """The given moment with its watches updated."""
        watches = moment.state.watches
        still = self._still(moment.state, moment.instant)
        looked = self._looked(moment)
        resisted = None
        if self._pushes_back(moment.state, moment.instant):
            resisted = watches.resisted
            if resisted is None:
                resisted = moment.instant.time
        seen = (looked, resisted)
        if still is not watches.still or seen != (watches.looked, watches.resisted):
            watches = watches._replace(still=still, looked=looked, resisted=resisted)
            moment = moment._replace(state=moment.state._replace(watches=watches))
        return moment

    def _looked(self, moment: Moment) -> float | None:
        """Time [s] since when an object that has arrived is looked at. None elsewhere."""
        following = moment.state.following
        if not self.placement.looks or following.ahead:
            return None
        since = moment.state.watches.looked
        if since is None and following.left <= margins.ARM.stop:
            since = moment.instant.time
        return since

    def astray(self, moment: Moment) -> bool:
        """The tracking point is too far off its path."""
        return abs(moment.guidance.error[1]) > margins.ARM.astray

    def stop_astray(self, moment: Moment) -> ControllerState:
        """Stop: goal missed."""
        astray = abs(moment.guidance.error[1])
        allowed = margins.ARM.astray
        text = f"{astray * 1e3:.0f} mm off its path, allowed {allowed * 1e3:.0f} mm"
        return _stopped(moment, ("goal_missed", text))

    def turned_away(self, moment: Moment) -> bool:
        """A pushed object is turned too far from its path."""
        turned = abs(moment.guidance.error[2])
        contacts = moment.state.following.binding.segment.contacts
        pushed = all(contact.kind == "side" for contact in contacts)
        return pushed and turned > margins.ARM.turned_away

    def stop_turned_away(self, moment: Moment) -> ControllerState:
        """Stop: goal missed."""
        turned = math.degrees(abs(moment.guidance.error[2]))
        allowed = math.degrees(margins.ARM.turned_away)
        text = f"turned {turned:.0f} deg from its path, allowed {allowed:.0f} deg"
        return _stopped(moment, ("goal_missed", text))

    def stalled(self, moment: Moment) -> bool:
        """The object stands still although it should move."""
        return self._rested(moment) > margins.ARM.stall_time

    def stop_stalled(self, moment: Moment) -> ControllerState:
        """Let go if the goal is reached all the same. Otherwise stop: goal missed."""
        spread = moment.state.estimate.spread
        if self.placement.at_goal(moment.instant.X_WG, spread):
            return self._let_go(moment)
        rests = self._rested(moment)
        left = moment.left
        text = f"stood still for {rests:.0f} s, {left * 1e3:.0f} mm before its end"
        return _stopped(moment, ("goal_missed", text))

    def arrived_midway(self, moment: Moment) -> bool:
        """A segment is over, and the next one has the same contacts."""
        following = moment.state.following
        return bool(following.ahead) and self._arrived(following, moment.instant)

    def go_on(self, moment: Moment) -> ControllerState:
        """Follow the next segment from the object's pose, or the mode's retry in its
        place.
        """
        ahead = moment.state.following.ahead
        return self._next_segment(moment.state, ahead, moment.instant)

    def arrived(self, moment: Moment) -> bool:
        """The last segment is over, and the object has been looked at."""
        if not self.placement.looks or self.placement.waits:
            return self._arrived(moment.state.following, moment.instant)
        return moment.state.watches.looked is not None and self._sure(moment)

    def _sure(self, moment: Moment) -> bool:
        """Whether the pose of an object that has arrived is known well enough."""
        since = moment.state.watches.looked
        if since is None or moment.instant.time - since > margins.ARM.longest_look:
            return True
        return self.placement.unsure(moment.state.estimate.spread) < margins.SURE

    def end(self, moment: Moment) -> ControllerState:
        """Retry if the goal is missed. Otherwise let go, unless the arms carry the
        object: then hold it.
        """
        retried = self._retried(moment)
        return self._let_go(moment) if retried is None else retried

    def _retried(self, moment: Moment) -> ControllerState | None:
        """State in which the object is led to its goal once more, by the same contacts.
        None if it is there, or if nothing leads there.
        """
        state = self._learning(moment.state)
        retry = self._retry(state, moment.instant)
        if not retry:
            return None
        last = state._replace(following=state.following._replace(ahead=()))
        return self._next_segment(last, retry, moment.instant)

    def _let_go(self, moment: Moment) -> ControllerState:
        """State in which the tips draw back, or hold an object that nothing carries."""
        name: Phase = "done" if self.placement.holds else "release"
        return enter_phase(moment.state, name, moment.instant)

    def lost_for_good(self, moment: Moment) -> bool:
        """Contact is lost once more at a place where it was lost repeatedly."""
        return self.lost(moment) and self._losses(moment).count > LOSSES

    def stop_lost(self, moment: Moment) -> ControllerState:
        """Stop: contact lost."""
        losses = self._losses(moment)
        within = margins.ARM.retouch
        text = f"contact lost {losses.count} times within {within * 1e3:.0f} mm"
        return _stopped(_with_losses(moment, losses), ("contact_lost", text))

    def lost(self, moment: Moment) -> bool:
        """Contact has been missing for longer than the patience."""
        since = moment.state.watches.lost
        return since is not None and moment.instant.time - since > self.patience

    def touch_again(self, moment: Moment) -> ControllerState:
        """Touch where the tips are."""
        state = _with_losses(moment, self._losses(moment)).state
        state = self._forgetting(state, state.following.binding.segment)
        again = enter_phase(state, "touch", moment.instant)
        return again._replace(phase=again.phase._replace(align=False))

    def resisted(self, moment: Moment) -> bool:
        """Two pushes have met far more force than friction for a touch's time."""
        since = moment.state.watches.resisted
        return since is not None and (
            moment.instant.time - since > margins.ARM.settle_time
            and moment.state.watches.resistances < RETOUCHES
        )

    def hold(self, moment: Moment) -> ControllerState:
        """Hold the tips until the force is gone, and replan."""
        instant = moment.instant
        following = moment.state.following
        watches = moment.state.watches
        watches = watches._replace(
            lost=instant.time,
            resisted=None,
            resistances=watches.resistances + 1,
        )
        state = moment.state._replace(watches=watches)
        held = enter_phase(state, "touch", instant, at_once=True)
        progress = following.joint_progress(instant.X_WB)
        tips = []
        contacts = following.binding.segment.contacts
        for contact, memory in zip(contacts, held.phase.tips, strict=True):
            context = instant.context(contact, instant.X_WG.yaw, progress)
            command = held_at(context, context.tip.position)
            tips.append(memory._replace(held_command=command))
        return held._replace(phase=held.phase._replace(tips=tuple(tips), align=False))

    def slid_off(self, moment: Moment) -> bool:
        """A push has left its side, or a press keeps sliding, and no correction is left."""
        if self._may_retouch(moment):
            return False
        return self._left_side(moment) or self._slides_on(moment)

    def stop_slid_off(self, moment: Moment) -> ControllerState:
        """Stop: contact lost."""
        gaps = [one.gap for one in self._gaps(moment)]
        if gaps:
            text = f"a tip is {max(gaps) * 1e3:.0f} mm off the side that it pushed"
        else:
            text = (
                f"{self._slid_text(moment)}, although touched {RETOUCHES} times again"
            )
        return _stopped(self._with_friction(moment), ("contact_lost", text))

    def _slides_on(self, moment: Moment) -> bool:
        """Whether a press that may be smoother or carry more than believed has slid again
        after its last correction, and a recovery is left.
        """
        again = moment.state.watches.retouches >= RETOUCHES
        left = moment.left > margins.ARM.retouch and not self.missing(moment)
        if not (self._unsure_of_friction and self.gives_up and again and left):
            return False
        return self._creeps(moment)

    @cached_property
    def _unsure_of_friction(self) -> bool:
        """Whether the object may have more friction or mass than believed, or its tips
        less friction.
        """
        scene = self.placement.scene
        return scene.friction_error > 0.0 or scene.mass_error > 0.0

    def _slid_text(self, moment: Moment) -> str:
        """How far a press has slid."""
        slid = slide(self.placement.segments[0].contacts, moment.contact_points)
        return f"a press slid by {slid * 1e3:.0f} mm"

    def _left_side(self, moment: Moment) -> bool:
        """Whether a push is surely off its side, though its force does not tell."""
        if self.missing(moment):
            return False
        allowed = self._allowed_slide(moment)
        return any(one.gap > one.tip_radius + allowed for one in self._gaps(moment))

    def _allowed_slide(self, moment: Moment) -> float:
        """Distance [m] by which a contact may slide from its planned place."""
        place, _ = moment.state.estimate.spread
        return margins.ARM.retouch + margins.DOUBT * place

    def _gaps(self, moment: Moment) -> list[SeenGap]:
        """Gap of each push, where it is seen, from the side that it pushes."""
        instant = moment.instant
        X_WB = moment.state.estimate.from_tip(instant.X_WB)
        robots = self.placement.scene.robots
        binding = moment.state.following.binding
        gaps = []
        for contact, side in zip(binding.segment.contacts, binding.sides, strict=True):
            if side is not None:
                x, y, _ = instant.tips[contact.arm].position
                radius = robots[contact.arm].tip_radius
                gap = side.distance(X_WB.unapply((x, y))) - radius
                gaps.append(SeenGap(gap, radius))
        return gaps

    def crept(self, moment: Moment) -> bool:
        """A press has crept, and enough path is left to correct it."""
        return self._creeps(moment) and self._may_retouch(moment)

    def _creeps(self, moment: Moment) -> bool:
        """Whether a press has slid from its planned place."""
        return self._creep(moment) > margins.CREPT or self._dragged_off(moment)

    def _creep(self, moment: Moment) -> float:
        """``press_creep`` of a press. Where its friction is unsure, it has to leave the
        place at which it was seen to touch: a tip that is seen beside its planned place
        from the beginning has not slid.
        """
        planned = self.placement.segments[0].contacts
        creep = press_creep(planned, moment.contact_points)
        touched = moment.state.watches.touched
        if creep == 0.0 or touched is None:
            return creep
        estimate = moment.state.estimate
        (now,) = self._seen_contacts(moment.state, moment.instant)
        # both with what is known now of the tip: it has not slid by being seen
        binding = moment.state.following.binding
        before = estimate.from_tip(touched.X_WB)
        (then,) = binding.contact_points(before, touched.tips)
        unsure = margins.DOUBT * math.hypot(estimate.spread[0], touched.place)
        slid = max(0.0, math.dist(now, then) - unsure)
        return min(creep, slid / math.hypot(*planned[0].point))

    def _seen_contacts(
        self, state: ControllerState, instant: Instant
    ) -> tuple[Point, ...]:
        """Points [m] in B at which the tips are seen to touch the object."""
        seen = state.estimate.from_tip(instant.X_WB)
        return state.following.binding.contact_points(seen, instant.tips)

    def _dragged_off(self, moment: Moment) -> bool:
        """Whether two presses have slid over the top, under an object that may have
        more friction or mass than believed.
        """
        if not self._unsure_of_friction:
            return False
        contacts = self.placement.segments[0].contacts
        if len(contacts) == 1 or any(contact.kind != "top" for contact in contacts):
            return False
        return slide(contacts, moment.contact_points) > self._allowed_slide(moment)

    def touch_harder(self, moment: Moment) -> ControllerState:
        """Touch the planned place again, and press harder. Stop if a tip that may have
        less friction than believed cannot.
        """
        moment = self._with_friction(moment)
        if self.placement.scene.friction_error > 0.0 and not self._harder(moment):
            text = f"{self._slid_text(moment)}, and cannot be harder"
            stopped = _stopped(moment, ("contact_lost", text))
            watches = stopped.watches
            counted = watches._replace(retouches=watches.retouches + 1)
            return stopped._replace(watches=counted)
        return self._touch_planned_place(moment.state, moment.instant, crept=True)

    def _with_friction(self, moment: Moment) -> Moment:
        """The moment with the friction of the tips, if presses surely slide. A single
        one may have rolled, until it creeps again.
        """
        state = moment.state
        contacts = state.following.binding.segment.contacts
        watches = state.watches
        forces = [memory.mean_force for memory in state.phase.tips]
        felt = [force for force in forces if force is not None]
        pressed = all(contact.kind == "top" for contact in contacts)
        rolled = len(contacts) == 1 and watches.retouches == 0
        if not pressed or rolled or self.missing(moment) or len(felt) < len(contacts):
            return moment
        planned = min(contact.load for contact in contacts)
        unsure = self.placement.query.sensing.felt_noise
        found = TipFriction.of_slide(felt, planned, unsure)
        if found is None:
            return moment
        watches = watches._replace(tip_friction=found)
        return moment._replace(state=state._replace(watches=watches))

    def _harder(self, moment: Moment) -> bool:
        """Whether a press can be made harder."""
        followed = moment.state.following.binding.segment
        most = self.placement.queries[followed.leg].planned_force
        contacts = followed.contacts
        return harder_presses(self.placement.scene, contacts, most) != contacts

    def slid(self, moment: Moment) -> bool:
        """A push has slid along its side, or left it, and enough path is left to correct
        it.
        """
        if not self._may_retouch(moment):
            return False
        contacts = moment.state.following.segment.contacts
        slid = side_slide(contacts, moment.contact_points)
        return slid > self._allowed_slide(moment) or self._left_side(moment)

    def touch_planned(self, moment: Moment) -> ControllerState:
        """Touch the planned place again."""
        return self._touch_planned_place(moment.state, moment.instant, crept=False)

    def mistaken(self, moment: Moment) -> bool:
        """The object turns otherwise than planned, and no path leads on."""
        since = moment.state.watches.mistaken
        return since is not None and (
            moment.instant.time - since > margins.ARM.mistaken_time
        )

    def lead_again(self, moment: Moment) -> ControllerState:
        """Retry. Otherwise stop: goal missed."""
        retried = self._retried(moment)
        if retried is not None:
            return retried
        found = estimates(moment.state)
        followed = moment.state.following.prediction.followed_center
        aside = math.dist(found.center, followed)
        text = f"centre of mass {aside * 1e3:.0f} mm beside the planned one"
        if found.reach is not None:
            text += f", axle {found.reach * 1e3:.0f} mm from the contact"
        return _stopped(moment, ("goal_missed", text))

    def missing(self, moment: Moment) -> bool:
        """Contact is missing, but for less than the patience."""
        return moment.state.watches.lost is not None

    def wait(self, moment: Moment) -> ControllerState:
        """Go on."""
        return moment.state

    def otherwise(self, moment: Moment) -> bool:
        """No other event holds."""
        return True

    def _rested(self, moment: Moment) -> float:
        """Time [s] since the object last moved."""
        still = moment.state.watches.still
        return moment.instant.time - still.since if still else 0.0

    def _may_retouch(self, moment: Moment) -> bool:
        enough = moment.left > margins.ARM.retouch
        return enough and moment.state.watches.retouches < RETOUCHES

    def _held_back(self, event: Settled) -> bool:
        """Whether tips that hold are still pushed back, and may wait."""
        phase = event.state.phase
        holds = any(tip.held_command is not None for tip in phase.tips)
        waits = event.instant.time - phase.since < margins.ARM.stall_time
        return holds and waits and self._pushes_back(event.state, event.instant)

    def _pushes_back(self, state: ControllerState, instant: Instant) -> bool:
        """Whether two pushing tips push with much more than the object's friction may be
        as believed.
        """
        segment = state.following.binding.segment
        contacts = segment.contacts
        if len(contacts) == 1 or any(contact.kind != "side" for contact in contacts):
            return False
        felt = self._felt_on_leg[segment.leg]
        tips = [instant.tips[contact.arm] for contact in contacts]
        total = math.hypot(
            math.fsum(tip.force[0] for tip in tips),
            math.fsum(tip.force[1] for tip in tips),
        )
        most = segment.drive.max_friction * self._most_drag
        return total > margins.RESISTED * most + felt

    @cached_property
    def _most_drag(self) -> float:
        """Largest drag of the object, as a multiple of the believed one."""
        scene = self.placement.scene
        return (1.0 + scene.friction_error) * (1.0 + scene.mass_error)

    @cached_property
    def _felt_on_leg(self) -> list[float]:
        """Force [N] beyond friction that is felt on each leg, infinite where more than
        friction may resist.
        """
        return [
            query.sensing.felt_force
            if query.resisted_by_friction_alone and not self.placement.waits
            else math.inf
            for query in self.placement.queries
        ]

    def _losses(self, moment: Moment) -> ContactLosses:
        """Number of contact losses here, this one included."""
        X_WB = moment.instant.X_WB
        before = moment.state.watches.losses
        within = margins.ARM.retouch
        if before is not None and self._distance_from(before.pose, X_WB) <= within:
            return ContactLosses(before.pose, before.count + 1)
        return ContactLosses(X_WB, 1)

    def _still(self, state: ControllerState, instant: Instant) -> StallWatch | None:
        """Pose and time of the object's last motion in this phase.

        None while the object may rest (under pure force control, or waiting at the
        goal).
        """
        if self.placement.waits or not self.servo or instant.rests:
            return None
        still = state.watches.still
        if still is not None and still.since >= state.phase.since:
            path = self._distance_from(still.pose, instant.X_WB)
            speed = state.following.binding.segment.profile.speed
            slowly = instant.pace * speed
            if path < margins.STALL * slowly * margins.ARM.stall_time:
                return still
        return StallWatch(instant.X_WB, instant.time)

    def _distance_from(self, pose: Pose2, X_WB: Pose2) -> float:
        """Displacement [m] of the object from ``pose``, X_WB, including its rotation."""
        turned = self.placement.object.radius * abs(wrap_angle(X_WB.yaw - pose.yaw))
        return math.dist(X_WB.position, pose.position) + turned

    def _touch_planned_place(
        self, state: ControllerState, instant: Instant, crept: bool
    ) -> ControllerState:
        """Let go, and touch the planned place of the segment again. A press that
        ``crept`` presses harder.
        """
        following = state.following
        followed = following.binding.segment
        planned = self.placement.segments[0].contacts  # those of the whole placement
        contacts = tuple(
            replace(contact, point=at.point)
            for contact, at in zip(followed.contacts, planned, strict=True)
        )
        if crept:
            most = self.placement.queries[followed.leg].planned_force
            contacts = harder_presses(self.placement.scene, contacts, most)
        drive = following.segment.drive
        segment = replace(followed, contacts=contacts, drive=drive)
        watches = state.watches
        prediction = following.prediction
        if prediction.center is not None and not crept:  # it may be that of a slide
            prediction = prediction._replace(followed_center=drive.center)
        again = state._replace(
            following=following._replace(
                binding=self.placement.bound_laws(segment), prediction=prediction
            ),
            watches=watches._replace(
                lost=instant.time, retouches=watches.retouches + 1, touched=None
            ),
        )
        return enter_phase(self._forgetting(again, segment), "touch", instant)

    def _forgetting(self, state: ControllerState, segment: Segment) -> ControllerState:
        """State without what the last motion told of the virtual axle: where a contact
        of the ``segment`` is lost, something else may have moved the object.
        """
        following = state.following
        axle = self.placement.axle_identifier(segment)
        prediction = following.prediction._replace(axle=axle)
        return state._replace(following=following._replace(prediction=prediction))

    def replan(self, moment: Moment) -> ControllerState:
        """Follow a better plan from here, if there is one."""
        state, instant, touched, guidance = moment
        time = instant.time
        found = estimates(state)
        if found.rho != state.following.rho:
            following = state.following._replace(rho=found.rho)
            state = state._replace(following=following)
        following = state.following
        planned_axle = _planned_axle(following) if found.axle is None else None
        if planned_axle is not None:
            found = found._replace(axle=planned_axle)
        segments = (following.binding.segment, *following.ahead)
        since = time - state.watches.replanned
        better = self._replanner(following).improve(
            segments,
            instant.X_WB,
            touched,
            guidance,
            since,
            found,
            state.estimate.spread,
        )
        if better is None:
            return self._stuck(state, time)
        watches = state.watches._replace(replanned=time, mistaken=None)
        state = state._replace(watches=watches)
        # a turn on the spot that continues along arcs leads away from its spot
        led = isinstance(following.segment.path, ArcPath)
        if led and not (
            self.placement.reaches_far or self._is_near_plan(better.segments)
        ):
            return state  # tried again after a pause
        first = better.segments[0]
        prediction = following.prediction
        if found.center != prediction.followed_center:
            # the virtual axle is identified about the identified centre
            axle = self.placement.axle_identifier(first)
            prediction = prediction._replace(axle=axle, followed_center=found.center)
        laws = self.placement.bound_laws(first)
        ahead, progress = better.segments[1:], better.progress
        following = following.replanned(laws, ahead, progress, instant.X_WB)
        following = following._replace(
            prediction=prediction, clock_start=time - better.clock
        )
        return state._replace(following=following)

    def _stuck(self, state: ControllerState, now: float) -> ControllerState:
        """State after a tick at time ``now`` [s] in which no better path was found."""
        watches = state.watches
        if now - watches.replanned < margins.ARM.replan_pause:
            return state
        since = None
        if self._turns_otherwise(state):
            since = now if watches.mistaken is None else watches.mistaken
        if since == watches.mistaken:
            return state
        return state._replace(watches=watches._replace(mistaken=since))

    def _turns_otherwise(self, state: ControllerState) -> bool:
        """Whether the centre of mass is surely so far from that of the followed plan that
        the goal is missed.
        """
        unsure = self.placement.looks and self.placement.scene.center_error > 0.0
        if not (unsure and self.gives_up) or self.placement.waits:
            return False
        found = estimates(state)
        following = state.following
        if not found.elsewhere or following.left < margins.ARM.least_left:
            return False
        lever = math.hypot(*following.binding.segment.contacts[0].point)
        aside = math.dist(found.center, following.prediction.followed_center)
        least = max(self.placement.last.tolerance.yaw, found.doubt)
        return aside > margins.DOUBT * least * lever

    def _begin_motion(
        self, state: ControllerState, instant: Instant
    ) -> ControllerState:
        """Start the motion, replanned from the measured object pose and contacts."""
        time = instant.time
        following = state.following
        rest = rest_of(following.binding.segment, following.progress)
        longest = margins.longest(
            margins.TOUCH_DETOUR, rest.path.length, self.placement.object.radius
        )
        X_WB = instant.X_WB
        seen = state.estimate.from_tip(X_WB)
        place, _ = state.estimate.spread
        touched = following.binding.sure_contact_points(seen, instant.tips, place)
        found = estimates(state)
        measured = Measured.touching(X_WB, rest.contacts, touched, longest, found)
        fresh = self._replanner(following).replan((rest, *following.ahead), measured)
        if fresh:
            prediction = following.prediction._replace(
                center=self.placement.center_identifier(fresh[0], found.center),
                followed_center=found.center,
            )
            laws = self.placement.bound_laws(fresh[0])
            following = following.replanned(laws, fresh[1:], 0.0, X_WB)
            following = following._replace(prediction=prediction, clock_start=time)
        elif following.reference is None:
            following = following._replace(clock_start=time)
        else:
            pause = time - (state.watches.lost or time)
            following = following._replace(clock_start=following.clock_start + pause)
        following = following.begun(time)
        watches = state.watches
        alone = len(following.binding.segment.contacts) == 1
        if alone and watches.touched is None and self._unsure_of_friction:
            touched_now = Touched(X_WB, instant.tips, place)
            watches = watches._replace(touched=touched_now)
        begun = state._replace(following=following, watches=watches)
        return enter_phase(begun, "move", instant)

    def _arrived(self, following: Following, instant: Instant) -> bool:
        """Whether a segment is over.

        If a placement ends in an opening, or with the object held, its last segment is
        over only when the object rests, or at the latest ``SEAT_TIME`` after its
        planned end.
        """
        left = following.left
        if following.ahead or not self.placement.waits:
            return left <= margins.ARM.stop
        duration = following.binding.segment.profile.duration
        late = instant.time - following.clock_start - duration
        if self.placement.entry is None:
            rests = late > HOLD_TIME
        else:
            rests = self.placement.entry.seated(instant.tips)
        return late > SEAT_TIME or (left <= margins.ARM.stop and rests)

    def _retry(self, state: ControllerState, instant: Instant) -> tuple[Segment, ...]:
        """Segments of a retry that takes the object to its goal.

        Empty if the object is already there, no retry is left, or the segments cannot
        be followed in time.
        """
        following = state.following
        query = self.placement.queries[following.segment.leg]
        off = share_of_tolerance(instant.X_WG, query.goal, query.tolerance)
        above = margins.RETRY_ABOVE
        if self.placement.entry is not None:
            above = margins.RETRY_ABOVE_SEATED
        above = margins.retry_above(above, self.placement.unsure(state.estimate.spread))
        if off < above or state.watches.retries == RETRIES:
            return ()
        segment = following.binding.segment
        touched = self._seen_contacts(state, instant)
        found = self._with_center(estimates(state), following)
        measured = Measured.touching(
            instant.X_WB, segment.contacts, touched, estimates=found
        )
        fresh = self._replanner(following).retry(segment, measured)
        return fresh if self._can_follow(fresh, instant.time) else ()

    def _replanner(self, following: Following) -> Replanner:
        """Replanner with what is identified of the object."""
        body, replanner = self._believing
        if following.body is not body:
            body = following.body
            replanner = self.placement.replanner.believing(None, body)
            self._believing = (body, replanner)
        return replanner.believing(following.rho)

    def _learning(self, state: ControllerState) -> ControllerState:
        """``state`` with what the turns under presses have told up to now."""
        body = self.pressed_body()
        if body is None:
            return state
        return state._replace(following=state.following._replace(body=body))

    def _with_center(
        self, estimates: ParameterEstimates, following: Following
    ) -> ParameterEstimates:
        """The ``estimates`` with the centre of mass of the body that is followed."""
        if following.body is None:
            return estimates
        center = self.placement.query.X_GB.inverse().apply(following.body.center.place)
        return estimates._replace(center=center)

    def _can_follow(self, segments: Sequence[Segment], time: float) -> bool:
        """Whether ``segments`` started at ``time`` [s] end in time and stay near the
        planned path.

        The arms' ability to follow has been checked only for the planned path.
        """
        return self._in_time(segments, time) and (
            self.placement.reaches_far or self._is_near_plan(segments)
        )

    def _is_near_plan(self, segments: Sequence[Segment]) -> bool:
        """Whether each pose of ``segments`` is near a planned one."""
        near = margins.ARM.near_plan
        turn = margins.ARM.turned_beside
        return all(
            any(
                math.dist(pose.position, other.position) < near
                and abs(wrap_angle(pose.yaw - other.yaw)) < turn
                for other in self.placement.planned_poses
            )
            for segment in segments
            for pose in poses_along(segment)
        )

    def _in_time(self, segments: Sequence[Segment], time: float) -> bool:
        """Whether ``segments`` started at ``time`` [s] end before the time limit of the
        run.
        """
        lasts = math.fsum(segment.profile.duration for segment in segments)
        ends = time + (SLOWED * lasts if self.placement.looks else lasts)
        part = self.placement.queries[self.placement.segments[0].leg]
        return ends < part.limits.time - ramp_time(margins.ARM.retreat)

    def _next_segment(
        self, state: ControllerState, ahead: tuple[Segment, ...], instant: Instant
    ) -> ControllerState:
        """Continue with the first segment of ``ahead``, from the object's pose, without
        letting go.
        """
        state = self._learning(state)
        before = state.following
        planned = ahead[0]
        found = estimates(state)._replace(axle=None, rho=before.rho)
        found = self._with_center(found, before)
        fresh, center, retries = self._led_on(state, ahead, instant, found)
        joint_start = before.joint_progress(instant.X_WB)
        if before.replanned_as_arcs(planned):
            # the joints go on along what was planned of the whole leg
            joint_start = before.joint_start
            planned = before.segment
        first = fresh[0]
        axle = MODES[ahead[0].mode].identifier(
            self.placement.queries[ahead[0].leg], first
        )
        following = Following(
            self.placement.bound_laws(first),
            planned,
            fresh[1:],
            Prediction(
                axle,
                self.placement.center_identifier(first, center),
                center,
                self.placement.drag_identifier(first),
            ),
            clock_start=instant.time,
            began=before.began,
            reference=first,
            reference_start=instant.time,
            joint_start=joint_start,
            rho=before.rho,
            body=before.body,
        )
        watches = state.watches._replace(
            replanned=instant.time, retries=retries, looked=None, mistaken=None
        )
        return state._replace(following=following, watches=watches)

    def _led_on(
        self,
        state: ControllerState,
        ahead: tuple[Segment, ...],
        instant: Instant,
        estimates: ParameterEstimates,
    ) -> tuple[tuple[Segment, ...], Point, int]:
        """Segments ``ahead`` adapted to the object's pose, or a retry in their place.

        They come with the planned centre of mass p_BCom [m] and the number of retries.
        """
        X_WB = instant.X_WB
        seen = state.estimate.from_tip(X_WB)
        following = state.following
        planned = ahead[0]
        part = self.placement.queries[planned.leg]
        mode = MODES[planned.mode]
        sides = sides_of(self.placement.object, planned.contacts)
        touched = touched_points(planned.contacts, sides, seen, instant.tips)
        longest = margins.longest(
            margins.TOUCH_DETOUR, planned.path.length, self.placement.object.radius
        )
        replanner = self._replanner(following)
        measured = Measured.touching(
            X_WB, planned.contacts, touched, longest, estimates
        )
        fresh = replanner.replan(ahead, measured)
        center = estimates.center if fresh else following.prediction.followed_center
        fresh = fresh or ahead
        retries = state.watches.retries
        if not following.ahead:
            return fresh, center, retries + 1
        if retries < RETRIES and mode.misses(part, fresh, X_WB):
            beyond = Measured.touching(
                X_WB, fresh[-1].contacts, touched, estimates=estimates
            )
            anew = replanner.retry(fresh[-1], beyond)
            if anew and self._can_follow(anew, instant.time):
                return anew, estimates.center, retries + 1
        return fresh, center, retries


def _nothing() -> None:
    """Told of the object by presses that have not moved it."""


def _planned_axle(following: Following) -> AxleEstimate | None:
    """The axle as first planned, where it no longer contradicts what is measured, but
    another one is followed.
    """
    identifier = following.prediction.axle
    if identifier is None:
        return None
    planned = identifier.predicted
    off = axle_error(following.binding.segment, planned)
    return planned if off > margins.ARM.off_axle else None


def _stopped(moment: Moment, failure: Failure) -> ControllerState:
    return enter_phase(moment.state, "release", moment.instant, failure)


def _with_losses(moment: Moment, losses: ContactLosses) -> Moment:
    watches = moment.state.watches._replace(losses=losses)
    return moment._replace(state=moment.state._replace(watches=watches))


class Transition(NamedTuple):
    """A row of the table: an event and its action."""

    holds: Callable[[Supervisor, Moment], bool]
    act: Callable[[Supervisor, Moment], ControllerState]
    plans: bool = False  # for longer than a tick: the tips hold, where the clock runs

    @property
    def event(self) -> str:
        """Name of the event."""
        return self.holds.__name__.replace("_", " ")

    @property
    def words(self) -> tuple[str, str]:
        """Condition and action in words, taken from the docstrings of their functions."""
        when, then = (
            " ".join((function.__doc__ or "").split())
            for function in (self.holds, self.act)
        )
        return when, then


TRANSITIONS: tuple[Transition, ...] = (
    Transition(Supervisor.astray, Supervisor.stop_astray),
    Transition(Supervisor.turned_away, Supervisor.stop_turned_away),
    Transition(Supervisor.stalled, Supervisor.stop_stalled),
    Transition(Supervisor.arrived_midway, Supervisor.go_on, plans=True),
    Transition(Supervisor.arrived, Supervisor.end, plans=True),
    Transition(Supervisor.lost_for_good, Supervisor.stop_lost),
    Transition(Supervisor.lost, Supervisor.touch_again),
    Transition(Supervisor.resisted, Supervisor.hold),
    Transition(Supervisor.mistaken, Supervisor.lead_again, plans=True),
    Transition(Supervisor.slid_off, Supervisor.stop_slid_off),
    Transition(Supervisor.crept, Supervisor.touch_harder),
    Transition(Supervisor.slid, Supervisor.touch_planned),
    Transition(Supervisor.missing, Supervisor.wait),
    Transition(Supervisor.otherwise, Supervisor.replan),
)
"""Policy of the motion: the first transition that holds is taken, at every tick."""
