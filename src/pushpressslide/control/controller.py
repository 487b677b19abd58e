"""The controller of one placement, for any mode and any plant, phase by phase.

    touch    line the tips up with their contacts, advance until they feel the object,
             settle the normal force
    move     the paper's Algorithm 1 (law.py) at each tick, segment after segment
    release  draw the tips back, unless nothing else carries the object; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) ->
(commands, log, state, event)``. It uses only what a robot measures: object pose, tip
state, contact force. It never raises; a failure is in ``state.phase.failure``. The
supervisor decides on events, and may plan.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import NamedTuple

from pushpressslide.control.adaptation import TipSpeed, most_force_scale
from pushpressslide.control.center_belief import CenterBelief
from pushpressslide.control.estimator import (
    Estimate,
    Estimator,
    EstimatorState,
    ObjectEstimator,
    Observation,
    filtered_noise,
    stamped,
)
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.following import Following, Prediction
from pushpressslide.control.hand_eye import HandEye
from pushpressslide.control.identified import Identified, identified
from pushpressslide.control.insertion import Insertion
from pushpressslide.control.joint_pace import JointPace
from pushpressslide.control.last_look import LastLook
from pushpressslide.control.law import Decision, Law
from pushpressslide.control.placement import Placement
from pushpressslide.control.state import (
    SLOWING_TIME,
    ControllerState,
    Failure,
    Instant,
    PhaseState,
    TipMemory,
    by_arm,
    enter_phase,
    lowered,
    pressed,
    ramp_time,
    smooth,
    smooth_change,
    smooth_rate,
)
from pushpressslide.control.supervisor import Moment, Settled, Supervisor
from pushpressslide.control.timeline import Timeline
from pushpressslide.control.tip_motion import TipMover, missing
from pushpressslide.control.touch import (
    TipTouch,
    WayBack,
    drawn_back,
    held_at,
    slowed_down,
)
from pushpressslide.core import margins
from pushpressslide.core.control import (
    ControlLog,
    Measurement,
    Phase,
    Thought,
    TipCommand,
    TipState,
)
from pushpressslide.core.plan import Contact, Plan, Segment
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.core.query import MotionQuery
from pushpressslide.core.record import Ending
from pushpressslide.core.scene import Scene
from pushpressslide.core.wrench import Wrench
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.identification.parameter_estimates import withstood_friction
from pushpressslide.identification.pressed_travel import PressedTravel
from pushpressslide.modes.base import Tracker
from pushpressslide.planning.side_contacts import room_before

Commands = tuple[TipCommand | None, ...]
NO_TIMES = (0.0, 0.0)
LETTING_GO = 0.5  # [s] for which tips that draw back may still move the object


class Step(NamedTuple):
    """Result of a controller tick."""

    commands: Commands  # one per arm; None: it has no contact
    log: ControlLog
    state: ControllerState
    event: Settled | Moment | None  # for the supervisor to decide on


class PhaseStep(NamedTuple):
    """Result of a phase's tick."""

    commands: tuple[TipCommand, ...]  # one per contact
    state: ControllerState
    decision: Decision | None = None  # of the motion's tracking law
    event: Settled | Moment | None = None


class Controller:
    """Closed-form control of one placement of a plan. Use one instance per run.

    ``RunOptions.controller`` accepts a subclass.
    """

    def __init__(
        self,
        plan: Plan,
        number: int = 0,
        gap: float | None = None,
        back: float = math.inf,
        execution: Execution = USUAL,
        estimator: Callable[[MotionQuery], Estimator] = ObjectEstimator,
    ) -> None:
        """Precompute everything that is constant during the placement.

        ``number`` is the placement's index in the plan. ``gap`` [m] is the free path
        that the approach leaves before the touch (default: the task's). ``back`` [m] is
        the largest retreat of the tips at the end. ``execution`` may change the laws.
        ``estimator`` makes the object's estimator from the placement's query.
        """
        self.back = min(margins.ARM.retreat, back)
        self.execution = execution
        self.placement = Placement(plan, number, self.tracking_law)
        self.segments = self.placement.segments
        self.planned = Timeline(self.segments)
        first = self.segments[0]
        query = self.placement.query
        self.X_GB = query.X_GB
        self.X_BG = self.X_GB.inverse()
        self.robots = query.scene.robots
        self.estimator = estimator(query)
        self.longest_blind = query.sensing.longest_blind
        self.kept_arms = self.placement.kept_arms
        self.touches = _made_touches(query, first, gap, self.placement.entry)
        self.touches_again = tuple(
            touch.once_more(contact)
            for touch, contact in zip(self.touches, first.contacts, strict=True)
        )
        self.law = _law(query, execution, self.placement)
        patience = min(
            margins.ARM.loss_time(contact.kind)
            + query.motion.control_period * self.law.mover.samples(contact)
            for contact in first.contacts
        )
        self.supervisor = Supervisor(self.placement, self.law.servo, patience)

    def tracking_law(self, query: MotionQuery, segment: Segment) -> Tracker:
        """Tracking law of a ``segment``: that of its mode.

        A subclass may return another law, which must return ``core.guidance`` objects.
        """
        return self.execution.tracker(query, segment)

    def init(
        self, measurement: Measurement, held_commands: Commands = ()
    ) -> ControllerState:
        """State at the start of the touch.

        ``held_commands`` are the commands of arms that still hold their contacts.
        """
        first, *ahead = self.segments
        tips = tuple(
            TipMemory(
                measurement.tips[contact.arm].position,
                regulator=NormalForceState(ramped=contact.load),
                held_command=held_commands[contact.arm] if held_commands else None,
                lowered=self._lowered(measurement, contact) if held_commands else 0.0,
            )
            for contact in first.contacts
        )
        prediction = Prediction(
            self.placement.axle_identifier(first),
            self.placement.center_identifier(first, (0.0, 0.0)),
            drag=self.placement.drag_identifier(first),
        )
        pose = stamped(measurement)
        return ControllerState(
            PhaseState("touch", measurement.time, tips),
            Following(
                self.placement.bound_laws(first), first, tuple(ahead), prediction
            ),
            Estimate(measurement.time, pose.X_WG),
            self.estimator.start(pose),
        )

    def _lowered(self, measurement: Measurement, contact: Contact) -> float:
        """Depth [m] of a tip below its planned height that presses already."""
        radius = self.robots[contact.arm].tip_radius
        return lowered(contact, measurement.tips[contact.arm], radius, margins.ARM.sunk)

    def stop(
        self,
        state: ControllerState,
        measurement: Measurement,
        failure: Failure,
    ) -> ControllerState:
        """State that ends the run safely because of ``failure``.

        The tips stop at once, then draw back or hold. Tips that were already drawing
        back stop.
        """
        drawn = 0.0 if state.phase.name == "release" else 1.0
        stopped = enter_phase(state, "release", measurement, failure, at_once=True)
        return stopped._replace(phase=stopped.phase._replace(retreat_fraction=drawn))

    def halted(
        self, state: ControllerState, measurement: Measurement
    ) -> ControllerState:
        """State in which retreating tips stop at their present reference.

        Tips that are still at their contacts draw back later.
        """
        phase = state.phase
        share = _share_back(phase, measurement.time)
        if share == 0.0:
            return state
        return state._replace(
            phase=phase._replace(retreat_fraction=min(phase.retreat_fraction, share))
        )

    def step(self, state: ControllerState, measurement: Measurement) -> Step:
        """Commands, log, next state and event of a tick."""
        state, instant = self._estimated(state, measurement)
        name = state.phase.name
        if name == "touch":
            step = self._touch(state, instant)
        elif name == "move":
            step = self._move(state, instant)
        else:
            step = self._release(state, instant)
        contacts = state.following.binding.segment.contacts
        commands = by_arm(step.commands, contacts, len(self.robots))
        log = self._log(state, instant.time, step.decision)
        return Step(commands, log, step.state, step.event)

    def _estimated(
        self, state: ControllerState, measurement: Measurement
    ) -> tuple[ControllerState, Instant]:
        """State with this tick's estimate, and the quantities known at this instant."""
        time = measurement.time
        tips = measurement.tips
        phase = state.phase
        following = state.following
        observation = Observation(
            time,
            stamped(measurement) if measurement.pose_seen else None,
            phase.commanded_twist,
            phase.name == "move",
            tips,
            following.binding,
            following.prediction,
            _disturbs(phase, time),
            phase.name == "release",
            state.watches.unfelt,
        )
        estimate, estimator = self.estimator.step(state.estimator, observation)
        X_WG = estimate.X_WG
        dt = time - state.estimate.time
        blind = self.placement.looks and estimate.age > self.longest_blind
        rests = blind or state.watches.looked is not None
        pace = 0.0 if rests else self._pace(following, estimate)
        instant = Instant(time, dt, X_WG, X_WG.compose(self.X_GB), tips, pace)
        if blind and phase.name == "move":
            following = following.delayed(dt)
        elif blind and phase.name == "touch" and any(t.light for t in self.touches):
            phase = phase.delayed(dt)
        estimated = ControllerState(
            phase, following, estimate, estimator, state.adaptation, state.watches
        )
        return estimated, instant

    def _pace(self, following: Following, estimate: Estimate) -> float:
        """Share of the planned speed that the estimated pose allows."""
        if estimate.spread == (0.0, 0.0):
            return 1.0
        ahead = (segment.path.length for segment in following.ahead)
        left = following.left + math.fsum(ahead)
        return self.placement.pace(estimate.spread, left)

    def _log(
        self, state: ControllerState, time: float, decision: Decision | None
    ) -> ControlLog:
        """Log of the decision at a ``time`` [s]."""
        following = state.following
        thought = partial(self._thought, following.began, time, decision)
        wall_times = NO_TIMES if decision is None else decision.wall_times
        return ControlLog(state.phase.name, following.progress, thought, wall_times)

    def _thought(
        self, began: float | None, time: float, decision: Decision | None
    ) -> Thought:
        """Log of the controller's reference and estimates.

        ``time`` and ``began`` [s] are the present time and the start of the motion.
        """
        clock = 0.0 if began is None else time - began
        reference = self.planned.body_pose(clock).compose(self.X_BG)
        yaw = wrap_angle(reference.yaw)
        if yaw != reference.yaw:
            reference = replace(reference, yaw=yaw)
        if decision is None:
            return Thought(reference)
        guidance = decision.guidance
        wrench = guidance.wrench
        rx, ry, rt = decision.allocation.residual
        given = Wrench(wrench.fx - rx, wrench.fy - ry, wrench.tau - rt, wrench.about)
        return Thought(
            reference,
            guidance.error,
            wrench.moved_to((0.0, 0.0))[:3],
            given.moved_to((0.0, 0.0))[:3],
            guidance.steering,
        )

    def withstood_friction(self, state: ControllerState) -> float:
        """Friction of the support, at least, as it has withstood tips that push or drag
        the object. Zero if they do not, or if something else may have held it.
        """
        segment = state.following.binding.segment
        query = self.placement.queries[segment.leg]
        forces = [memory.mean_force for memory in state.phase.tips]
        felt = [force for force in forces if force is not None]
        alone = query.resisted_by_friction_alone and self.placement.entry is None
        if state.phase.name != "move" or len(felt) < len(forces) or not alone:
            return 0.0
        unsure = query.sensing.felt_noise
        motion = query.motion
        return withstood_friction(query.scene, felt, unsure, motion.acceleration)

    def normal_forces(
        self, state: ControllerState, measurement: Measurement
    ) -> list[float]:
        """Normal force [N] measured at each tip.

        A tip without contact has no normal; the size of its force is returned.
        """
        X_WB = state.estimate.X_WG.compose(self.X_GB)
        forces = [math.hypot(*tip.force) for tip in measurement.tips]
        for contact in state.following.binding.segment.contacts:
            direction = contact.direction(X_WB)
            forces[contact.arm] = pressed(
                measurement.tips[contact.arm].force, direction
            )
        return forces

    def untouched(self, state: ControllerState) -> tuple[int, ...]:
        """Arms whose tips have not yet advanced to the object in this placement."""
        phase = state.phase
        if (
            phase.name != "touch"
            or not phase.align
            or state.following.began is not None
        ):
            return ()
        contacts = state.following.binding.segment.contacts
        return tuple(
            contact.arm
            for contact, memory in zip(contacts, phase.tips, strict=True)
            if memory.advance_start is None and memory.held_command is None
        )

    def keep_pace(self, pace: JointPace | None) -> None:
        """Follow paths no faster than ``pace``."""
        self.law = replace(self.law, pace=pace)

    def know_tips(self, known: Mapping[int, HandEye]) -> None:
        """Start with what other placements have told of the arms' tips."""
        if isinstance(self.estimator, ObjectEstimator):
            first = self.segments[0].contacts[0]
            self.estimator.know_tip(known.get(first.arm))

    def know_center(self, center: CenterBelief) -> None:
        """Start with what other placements have told of the ``center`` of mass."""
        if isinstance(self.estimator, ObjectEstimator):
            self.estimator.know_center(center)

    def seen_tip(self, state: ControllerState) -> tuple[int, HandEye] | None:
        """Arm of the only contact, and where this placement has seen its tip. None if
        it has not moved the object in pictures.
        """
        estimator = state.estimator
        contacts = self.segments[0].contacts
        if not isinstance(estimator, EstimatorState) or len(contacts) > 1:
            return None
        filtered = estimator.filtered
        seen = None if filtered is None else filtered.seen_tip
        return None if seen is None else (contacts[0].arm, seen)

    def pressed_travels(self, state: ControllerState) -> tuple[PressedTravel, ...]:
        """What this placement has told of how an object turns under its only contact, a
        press. Empty where more than the support's friction turns it.
        """
        estimator = state.estimator
        query = self.placement.query
        alone = query.resisted_by_friction_alone and self.placement.entry is None
        if not isinstance(estimator, EstimatorState) or not alone:
            return ()
        return estimator.sightings.pressed.telling

    def filtered_pose(self, state: ControllerState) -> Pose2:
        """Filtered X_WG at the last tick."""
        return state.estimate.X_WG.compose(self.X_GB).compose(self.X_BG)

    def last_look(self, state: ControllerState) -> LastLook:
        """The object's estimated pose at the last tick, and how well it is known."""
        estimate = state.estimate
        sensing = self.placement.query.sensing
        place, yaw = estimate.spread
        noise, yaw_noise = filtered_noise(sensing)
        spread = (max(place, noise), max(yaw, yaw_noise))
        lasting = sensing.lasting_error(estimate.time)
        shown = self._shown_since_release(state, estimate.time)
        return LastLook(self.filtered_pose(state), spread, lasting, shown)

    def identified(self, state: ControllerState, belief: Scene) -> Identified:
        """What the estimator has identified in this placement, beside the scene
        of the ``belief`` before the run.
        """
        if not isinstance(state.estimator, EstimatorState):
            return Identified()
        query = self.placement.query
        found = identified(state.estimator, query, self.segments[0], belief)
        friction = state.watches.tip_friction
        if friction is None:
            return found
        return found.knowing(
            "tip_friction", friction.parameter(belief.contact_friction)
        )

    def missed(self, state: ControllerState, pose: Pose2) -> Ending | None:
        """Ending of a placement whose goal is missed by an object at ``pose``, X_WG.
        None if the goal is reached, as far as the estimate in ``state`` is sure.
        """
        if self.placement.at_goal(pose, state.estimate.spread):
            return None
        goal = self.placement.last.goal
        off = math.dist(pose.position, goal.position)
        turned = math.degrees(abs(wrap_angle(pose.yaw - goal.yaw)))
        return Ending("goal_missed", f"{off * 1e3:.1f} mm and {turned:.1f} deg off")

    def _touch(self, state: ControllerState, instant: Instant) -> PhaseStep:
        X_WB = state.estimate.from_tip(instant.X_WB)
        seen = instant._replace(X_WB=X_WB)
        phase = state.phase
        contacts = state.following.binding.segment.contacts
        elapsed = instant.time - phase.since
        first = state.following.began is None
        touches = self.touches if first else self.touches_again
        aligned = phase.aligned
        if phase.align and aligned == 0.0:  # together, whatever the distance of each
            parts = zip(touches, phase.tips, contacts, strict=True)
            aligned = max(t.align_time(memory, c, X_WB) for t, memory, c in parts)
            if elapsed >= aligned:
                phase = phase._replace(aligned=aligned)
        tool_yaw = self._touch_yaw(state, instant.X_WG.yaw, elapsed, aligned)
        progress = state.following.joint_progress(instant.X_WB)
        steps = [
            touch.step(
                memory, seen.context(contact, tool_yaw, progress), elapsed, aligned
            )
            for touch, memory, contact in zip(
                touches, phase.tips, contacts, strict=True
            )
        ]
        problems = [step.problem for step in steps if step.problem is not None]
        memories = tuple(step.memory for step in steps)
        next_state = state._replace(phase=phase._replace(tips=memories))
        if problems:
            failure: Failure = ("contact_lost", problems[-1])
            next_state = enter_phase(next_state, "release", instant, failure)
        commands = tuple(step.command for step in steps)
        settled = not problems and all(step.done for step in steps)
        event = Settled(next_state, instant) if settled else None
        return PhaseStep(commands, next_state, event=event)

    def _touch_yaw(
        self, state: ControllerState, yaw: float, elapsed: float, aligned: float
    ) -> float:
        """Wanted yaw [rad] of the tools.

        It changes from the planned yaw to the object's ``yaw`` while the tips are
        aligned for the first time.
        """
        following = state.following
        if not state.phase.align or following.began is not None:
            return yaw
        X_WB = following.binding.segment.body_pose(following.progress)
        planned = X_WB.compose(self.X_BG)
        share = smooth(elapsed / aligned) if aligned > 0.0 else 1.0
        return planned.yaw + share * wrap_angle(yaw - planned.yaw)

    def _move(self, state: ControllerState, instant: Instant) -> PhaseStep:
        following = state.following
        binding = following.binding
        contacts = binding.segment.contacts
        decision = self.law.step(
            following, instant, state.adaptation, state.phase.tips, perf_counter
        )
        guidance = decision.guidance
        felt = decision.felt
        commands = decision.commands
        watches = state.watches
        lost = missing(felt, contacts, decision.allocation.normals)
        lost = lost and not instant.rests
        if lost != (watches.lost is not None):
            watches = watches._replace(lost=instant.time if lost else None)
        unfelt: tuple[int, ...] = ()
        if len(felt) > 1 and not instant.rests:
            unfelt = tuple(i for i, one in enumerate(felt) if one.absent)
        if unfelt != watches.unfelt:
            watches = watches._replace(unfelt=unfelt)
        adaptation = state.adaptation.step(
            max(tip.friction_utilisation for tip in felt),
            self._tip_speeds(instant, commands, contacts),
            state.estimate.parameters.drag,
            instant.dt,
            most_force_scale(
                self.placement.scene, self.placement.query.limits, binding.segment
            ),
        )
        next_state = ControllerState(
            PhaseState(
                "move", state.phase.since, decision.tips, commanded_twist=guidance.twist
            ),
            following._replace(progress=guidance.progress),
            state.estimate,
            state.estimator,
            adaptation,
            watches,
        )
        place, _ = state.estimate.spread
        seen = state.estimate.from_tip(instant.X_WB)
        touched = binding.sure_contact_points(seen, instant.tips, place)
        moment = Moment(next_state, instant, touched, guidance)
        return PhaseStep(commands, next_state, decision, moment)

    def _tip_speeds(
        self,
        instant: Instant,
        commands: Sequence[TipCommand],
        contacts: Sequence[Contact],
    ) -> list[TipSpeed]:
        """Commanded and measured velocities of the servoed tips."""
        if not self.law.servo:
            return []
        return [
            (command.velocity, instant.tips[contact.arm].velocity)
            for command, contact in zip(commands, contacts, strict=True)
        ]

    def _release(self, state: ControllerState, instant: Instant) -> PhaseStep:
        """Draw the tips back. After a failure slow down first, and keep holding an
        object that would otherwise fall.
        """
        phase = state.phase
        failed = phase.failure is not None
        contacts = state.following.binding.segment.contacts
        commands = self._drawn_back(state, instant)
        elapsed = instant.time - phase.since
        over = elapsed > _rest(phase) + ramp_time(margins.ARM.retreat) + 0.3
        if failed and elapsed < margins.ARM.longest_stop:
            over = over and _at_rest(instant.tips, contacts)
        if elapsed < margins.ARM.longest_look:
            over = over and self.placement.unsure(state.estimate.spread) < margins.SURE
            over = over and self._shown_since_release(state, instant.time)
        held = self.placement.holds and phase.name == "done"
        name: Phase = "done" if over or held else "release"
        return PhaseStep(commands, state._replace(phase=phase._replace(name=name)))

    def _shown_since_release(self, state: ControllerState, time: float) -> bool:
        """Whether the last picture that is used at a ``time`` [s] was taken after the
        tips let go of the object, or, if they hold it, after it arrived.
        """
        phase = state.phase
        since = phase.since
        if not self.placement.holds:
            since += _rest(phase) + LETTING_GO
        return time - state.estimate.age >= since

    def _drawn_back(
        self, state: ControllerState, instant: Instant
    ) -> tuple[TipCommand, ...]:
        """Commands of tips that draw back or hold."""
        phase = state.phase
        failed = phase.failure is not None
        holds = self.placement.holds
        if failed:
            holds = not self.placement.scene.carried(instant.X_WG)
        share = _way_back(phase, instant.time)
        segment = state.following.binding.segment
        clearance = self.placement.queries[segment.leg].motion.clearance
        yaw = instant.X_WG.yaw
        progress = state.following.joint_progress(instant.X_WB)
        commands = []
        for touch, memory, contact in zip(
            self.touches, phase.tips, segment.contacts, strict=True
        ):
            context = instant.context(contact, yaw, progress)
            if holds or (contact.arm in self.kept_arms and not failed):
                command = held_at(context, memory.start, push=touch.force_of(contact))
            else:
                wanted = margins.ARM.retreat if failed else self.back
                margin = room_before(self.placement.scene, contact, wanted, clearance)
                path = WayBack(*(margin * one for one in share))
                if not failed:
                    ahead = progress + path.distance
                    context = context._replace(joint_progress=ahead)
                slowing = memory.slowed(instant.time - phase.since)
                command = drawn_back(context, slowing.position, path)
                command = slowed_down(command, slowing)
            commands.append(command)
        return tuple(commands)


def _made_touches(
    query: MotionQuery, first: Segment, gap: float | None, into: Insertion | None
) -> tuple[TipTouch, ...]:
    """Touch of each contact of the ``first`` segment."""
    return tuple(
        TipTouch(
            query.scene.robots[contact.arm].tip_radius,
            query.motion.approach_distance if gap is None else gap,
            _touch_push(first),
            query.sensing.felt_force,
            query.sensing.seen_motion,
            _regulator(query),
            _sunk(into),
            query.scene.robots[contact.arm].reaction,
            query.sensing.felt_samples,
            0.0 if query.sensing.sure else margins.ARM.first_look,
            query.sensing.force_noise > 0.0,
            contact.kind == "side" and query.slides_unfelt,
            query.sensing.seen_turn(query.scene.body.radius),
        )
        for contact in first.contacts
    )


def _regulator(query: MotionQuery) -> NormalForceRegulator:
    """Regulator of normal forces. Its integral falls no faster than it rises if an arm
    reacts late: the loop would swing.
    """
    late = any(robot.reaction > 0.0 for robot in query.scene.robots)
    regulator = NormalForceRegulator(f_max=query.limits.normal_force)
    return replace(regulator, unwinding=1.0) if late else regulator


def _law(query: MotionQuery, execution: Execution, placement: Placement) -> Law:
    """Algorithm 1 with the parameters of a query."""
    into = placement.entry
    drag = placement.segments[0].drive.max_friction
    mover = TipMover(
        query.motion.servo_damping if execution.servo else 0.0,
        query.scene.contact_friction,
        min(query.sensing.felt_force, max(drag, margins.ARM.felt_force)),
        query.sensing.force_noise,
        _regulator(query),
        tuple(robot.tip_radius for robot in query.scene.robots),
        _sunk(into),
        query.sensing.felt_samples,
        query.slides_unfelt,
    )
    # the servo and its additions; an experiment without them commands the force alone
    servo = execution.servo and execution.force_gain is None
    floor_speed = margins.FLOOR_SPEED * query.motion.speed
    tracks_joints = execution.joint_stiffness > 0.0
    return Law(
        mover,
        floor_speed,
        execution.gain,
        servo,
        tracks_joints,
        into,
        placement.waits,
    )


def _sunk(into: Insertion | None) -> float:
    """Depth [m] below its planned height at which a pressing tip counts as slid off the
    top.

    Infinite during an insertion: the tips follow the object down into the opening.
    """
    return margins.ARM.sunk if into is None else math.inf


def _rest(phase: PhaseState) -> float:
    """Time [s] for which the tips stand still before they draw back."""
    return 0.0 if phase.failure is None else margins.ARM.rest_time


def _ramp_back(phase: PhaseState, time: float) -> float:
    """Elapsed fraction of the retreat's duration, ignoring a halt."""
    elapsed = time - phase.since - _rest(phase)
    return elapsed / ramp_time(margins.ARM.retreat)


def _share_back(phase: PhaseState, time: float) -> float:
    """Fraction of the retreat's length covered so far, ignoring a halt."""
    return smooth(_ramp_back(phase, time))


def _way_back(phase: PhaseState, time: float) -> WayBack:
    """Motion of a retreat of unit length [1 m], halted at ``phase.retreat_fraction``."""
    share = _share_back(phase, time)
    if share >= phase.retreat_fraction:
        return WayBack(phase.retreat_fraction, 0.0, 0.0)
    u = _ramp_back(phase, time)
    duration = ramp_time(margins.ARM.retreat)
    return WayBack(share, smooth_rate(u) / duration, smooth_change(u) / duration**2)


def _disturbs(phase: PhaseState, time: float) -> bool:
    """Whether tips touch or let go of the object at a ``time`` [s]."""
    if phase.name == "release":
        return time - phase.since < _rest(phase) + LETTING_GO
    if phase.name != "touch":
        return False
    if phase.slows and time - phase.since < SLOWING_TIME:
        return True
    return any(memory.advance_start is not None for memory in phase.tips)


def _at_rest(tips: Sequence[TipState], contacts: Sequence[Contact]) -> bool:
    """Whether the tips of all contacts are at rest."""
    speeds = [math.hypot(*tips[c.arm].velocity) for c in contacts]
    return max(speeds) < margins.ARM.at_rest


def _touch_push(segment: Segment) -> float:
    """Force [N] of each pushing tip before the motion starts."""
    sides = sum(contact.kind == "side" for contact in segment.contacts)
    push = margins.TOUCH_SHARE * segment.drive.max_friction / max(sides, 1)
    return max(0.6, push)
