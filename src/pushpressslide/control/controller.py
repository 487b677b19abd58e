"""The controller of one placement, for any mode and any plant, phase by phase.

    touch    line the tips up with their contacts, advance until they feel the object,
             settle the normal force
    move     the paper's Algorithm 1 (law.py) at each tick, segment after segment
    release  draw the tips back, unless nothing else carries the object; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) ->
(commands, log, state)``. It sees what a robot would see: object pose, tip state,
contact force. It never raises; what went wrong is in ``state.phase.failure``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter

from pushpressslide.control.adaptation import TipSpeed
from pushpressslide.control.correction import (
    Replanner,
    press_creep,
    rest_of,
    side_slide,
    sides_of,
    touched_points,
)
from pushpressslide.control.entry import HOLD_TIME, SEAT_TIME, Entry, entry
from pushpressslide.control.estimator import (
    Estimate,
    Estimator,
    ObjectEstimator,
    Observation,
    stamped,
)
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.following import Binding, Following, Prediction, bind
from pushpressslide.control.law import Decision, Law
from pushpressslide.control.state import (
    ControllerState,
    Failure,
    Instant,
    Losses,
    PhaseState,
    Still,
    TipMemory,
    begin,
    by_arm,
    findings,
    pressed,
    ramp_time,
    smooth,
    smooth_change,
    smooth_rate,
)
from pushpressslide.control.timeline import Timeline
from pushpressslide.control.tip_motion import TipMover, missing
from pushpressslide.control.touch import TipTouch, WayBack, drawn_back, held_at
from pushpressslide.core import margins
from pushpressslide.core.control import (
    ControlLog,
    Measurement,
    Phase,
    TipCommand,
    TipState,
)
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, Plan, Segment, lasting_arms
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.record import Ending
from pushpressslide.core.task import Task
from pushpressslide.core.wrench import Wrench
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.identification.center import CenterIdentifier
from pushpressslide.identification.findings import Findings
from pushpressslide.identification.online import AxleIdentifier
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.planning.side_contacts import room_before
from pushpressslide.planning.workspace import poses_along

RETOUCHES = 3
LOSSES = 6  # of contact at one place, above which the attempt ends
RETRIES = 4

Commands = tuple[TipCommand | None, ...]
Step = tuple[Commands, ControlLog, ControllerState]
# of a phase: a command per contact, the next state, what the law of the motion came to
PhaseStep = tuple[tuple[TipCommand, ...], ControllerState, Decision | None]


class Controller:
    """Closed-form control of one placement of a plan; hold one per run of it."""

    def __init__(
        self,
        plan: Plan,
        number: int = 0,
        gap: float | None = None,
        back: float = math.inf,
        execution: Execution = USUAL,
        estimator: Callable[[Task], Estimator] = ObjectEstimator,
    ) -> None:
        """Prepare everything that does not change from tick to tick.

        ``number`` is the placement's index in the plan; ``gap`` [m] is the free path
        that the approach leaves before the touch (default: as the task asks for);
        ``back`` [m] is how far the tips can be drawn back from the end; ``execution``
        may change the laws; ``estimator`` makes one of the task as it is believed.
        """
        self.execution = execution
        self.back = min(margins.ARM.retreat, back)
        placements = plan.placements
        self.segments = placements[number]
        self.planned = Timeline(self.segments)
        self.planned_poses = [X for piece in self.segments for X in poses_along(piece)]
        first = self.segments[0]
        told = plan.task.told
        self.parts = told.parts
        task = self.parts[first.leg]
        self.object = task.object
        self.X_GB = task.object.X_GB
        self.X_BG = self.X_GB.inverse()
        self.robots = task.robots
        self.replanner = Replanner(told)
        self.estimator = estimator(task)
        last = self.parts[self.segments[-1].leg]
        self.entry = entry(last, first.contacts)  # into an opening of the support
        final = number == len(placements) - 1
        # to the end of the run, since nothing else carries the object at its goal
        self.scene = told.scene
        self.holds = final and not self.scene.carried(last.goal)
        self.waits = self.entry is not None or self.holds
        # nothing but a retry can mend a miss
        self.reaches_far = self.waits or task.motion.recoveries == 0
        self.lasting: frozenset[int] = frozenset()
        if not final:
            self.lasting = lasting_arms(self.segments, placements[number + 1])
        self.touches = _touches(task, first, gap, self.entry)
        self.law = _law(task, execution, self.entry, self.waits)
        self.patience = min(
            margins.ARM.loss_time(contact.kind)
            + task.motion.control_period * self.law.mover.samples(contact)
            for contact in first.contacts
        )

    def init(self, measurement: Measurement, held: Commands = ()) -> ControllerState:
        """Return the state at the start of the touch.

        ``held`` are the commands of arms that have not let go.
        """
        first, *ahead = self.segments
        tips = tuple(
            TipMemory(
                measurement.tips[contact.arm].position,
                regulator=NormalForceState(ramped=contact.load),
                held=held[contact.arm] if held else None,
            )
            for contact in first.contacts
        )
        prediction = Prediction(
            self._axle_identifier(first), self._center_identifier(first, (0.0, 0.0))
        )
        pose = stamped(measurement)
        return ControllerState(
            PhaseState("touch", measurement.time, tips),
            Following(self._bound(first), first, tuple(ahead), prediction),
            Estimate(pose.time, pose.X_WG),
            self.estimator.start(pose),
        )

    def stop(
        self,
        state: ControllerState,
        measurement: Measurement,
        failure: Failure,
    ) -> ControllerState:
        """Return the state that ends the run safely because of ``failure``: the tips
        slow down, then draw back or hold; tips that were drawing back stay.
        """
        drawn = 0.0 if state.phase.name == "release" else 1.0
        stopped = begin(state, "release", measurement, failure)
        return stopped._replace(phase=stopped.phase._replace(drawn=drawn))

    def halted(
        self, state: ControllerState, measurement: Measurement
    ) -> ControllerState:
        """Return the state in which tips that draw back stay where they are led now;
        those that still stand at their contacts will draw back.
        """
        phase = state.phase
        share = _share_back(phase, measurement.time)
        if share == 0.0:
            return state
        return state._replace(phase=phase._replace(drawn=min(phase.drawn, share)))

    def step(self, state: ControllerState, measurement: Measurement) -> Step:
        """Return one command per arm (None: it has no contact), what was decided, and
        the next state.
        """
        state, instant = self._estimated(state, measurement)
        name = state.phase.name
        if name == "touch":
            commands, next_state, decision = self._touch(state, instant)
        elif name == "move":
            commands, next_state, decision = self._move(state, instant)
        else:
            commands, next_state, decision = self._release(state, instant)
        contacts = state.following.binding.segment.contacts
        log = self._log(state, instant.time, decision)
        return by_arm(commands, contacts, len(self.robots)), log, next_state

    def _estimated(
        self, state: ControllerState, measurement: Measurement
    ) -> tuple[ControllerState, Instant]:
        """The state with the estimate of this tick, and what is known at it."""
        time = measurement.time
        tips = measurement.tips
        phase = state.phase
        following = state.following
        observation = Observation(
            time,
            stamped(measurement) if measurement.pose_seen else None,
            phase.led,
            phase.name == "move",
            tips,
            following.binding,
            following.prediction,
        )
        estimate, estimator = self.estimator.step(state.estimator, observation)
        X_WG = estimate.X_WG
        dt = time - state.estimate.time
        instant = Instant(time, dt, X_WG, X_WG.compose(self.X_GB), tips)
        estimated = ControllerState(
            phase, following, estimate, estimator, state.adaptation, state.watches
        )
        return estimated, instant

    def _log(
        self, state: ControllerState, time: float, decision: Decision | None
    ) -> ControlLog:
        """What was decided at a ``time`` [s], for the record."""
        following = state.following
        began = following.began
        clock = 0.0 if began is None else time - began
        reference = self.planned.body_pose(clock).compose(self.X_BG)
        yaw = wrap_angle(reference.yaw)
        if yaw != reference.yaw:
            reference = replace(reference, yaw=yaw)
        name = state.phase.name
        if decision is None:
            return ControlLog(name, following.progress, reference)
        guidance = decision.guidance
        wrench = guidance.wrench
        rx, ry, rt = decision.allocation.residual
        given = Wrench(wrench.fx - rx, wrench.fy - ry, wrench.tau - rt, wrench.about)
        return ControlLog(
            name,
            following.progress,
            reference,
            guidance.error,
            wrench.moved_to((0.0, 0.0))[:3],
            given.moved_to((0.0, 0.0))[:3],
            guidance.steering,
            decision.wall_times,
        )

    def normal_forces(
        self, state: ControllerState, measurement: Measurement
    ) -> list[float]:
        """Return the normal force [N] measured at each tip; of a tip that has no
        contact, the size of its force.
        """
        X_WB = measurement.object_pose.compose(self.X_GB)
        forces = [math.hypot(*tip.force) for tip in measurement.tips]
        for contact in state.following.binding.segment.contacts:
            direction = contact.direction(X_WB)
            forces[contact.arm] = pressed(
                measurement.tips[contact.arm].force, direction
            )
        return forces

    def seen(self, state: ControllerState) -> Pose2:
        """Return X_WG at the last tick, freed from noise as far as it can be."""
        return state.estimate.X_WG.compose(self.X_GB).compose(self.X_BG)

    def missed(self, pose: Pose2) -> Ending | None:
        """Return by how much an object left at ``pose``, X_WG, misses the goal of this
        placement; None if it does not.
        """
        task = self.parts[self.segments[-1].leg]
        if _share_of_tolerance(task, pose) < margins.RETRY_ABOVE:
            return None
        off = math.dist(pose.position, task.goal.position)
        turned = math.degrees(abs(wrap_angle(pose.yaw - task.goal.yaw)))
        return Ending("goal_missed", f"{off * 1e3:.1f} mm and {turned:.1f} deg off")

    def _touch(self, state: ControllerState, instant: Instant) -> PhaseStep:
        phase = state.phase
        contacts = state.following.binding.segment.contacts
        elapsed = instant.time - phase.since
        aligned = 0.0
        if phase.align:  # together, however far each has to go
            parts = zip(self.touches, phase.tips, contacts, strict=True)
            X_WB = instant.X_WB
            aligned = max(t.align_time(memory, c, X_WB) for t, memory, c in parts)
        tool_yaw = self._touch_yaw(state, instant.X_WG.yaw, elapsed, aligned)
        progress = state.following.joint_progress(instant.X_WB)
        steps = [
            touch.step(
                memory, instant.context(contact, tool_yaw, progress), elapsed, aligned
            )
            for touch, memory, contact in zip(
                self.touches, phase.tips, contacts, strict=True
            )
        ]
        problems = [step.problem for step in steps if step.problem is not None]
        memories = tuple(step.memory for step in steps)
        next_state = state._replace(phase=phase._replace(tips=memories))
        if problems:
            failure: Failure = ("contact_lost", problems[-1])
            next_state = begin(next_state, "release", instant, failure)
        elif all(step.done for step in steps):
            next_state = self._begin_move(next_state, instant)
        return tuple(step.command for step in steps), next_state, None

    def _touch_yaw(
        self, state: ControllerState, yaw: float, elapsed: float, aligned: float
    ) -> float:
        """Return the wanted yaw of the tools [rad]: from the planned one to the
        object's ``yaw``, over the time [s] in which the tips line up.
        """
        if not state.phase.align:
            return yaw
        following = state.following
        X_WB = following.binding.segment.body_pose(following.progress)
        planned = X_WB.compose(self.X_BG)
        share = smooth(elapsed / aligned) if aligned > 0.0 else 1.0
        return planned.yaw + share * wrap_angle(yaw - planned.yaw)

    def _begin_move(self, state: ControllerState, instant: Instant) -> ControllerState:
        """Begin to move, replanned from where object and contacts turn out to be."""
        time = instant.time
        following = state.following
        rest = rest_of(following.binding.segment, following.progress)
        longest = margins.longest(
            margins.TOUCH_DETOUR, rest.path.length, self.object.radius
        )
        X_WB = instant.X_WB
        touched = following.binding.touched(X_WB, instant.tips)
        found = findings(state)
        measured = Measured.touching(X_WB, rest.contacts, touched, longest, found)
        fresh = self.replanner.believing(following.rho).replan(
            (rest, *following.ahead), measured
        )
        if fresh:
            prediction = following.prediction._replace(
                center=self._center_identifier(fresh[0], found.center),
                followed_center=found.center,
            )
            following = following._replace(
                binding=self._bound(fresh[0]),
                ahead=fresh[1:],
                prediction=prediction,
                progress=0.0,
                clock_start=time,
            )
        elif following.reference is None:
            following = following._replace(clock_start=time)
        else:
            pause = time - (state.watches.lost or time)
            following = following._replace(clock_start=following.clock_start + pause)
        following = following.begun(time)
        return begin(state._replace(following=following), "move", instant)

    def _axle_identifier(self, segment: Segment) -> AxleIdentifier | None:
        """Return what identifies the virtual axle in a segment."""
        part = self.parts[segment.leg]
        return MODES[segment.mode].identifier(part, segment)

    def _center_identifier(
        self, segment: Segment, center: Point
    ) -> CenterIdentifier | None:
        """Return what identifies the CoM in a segment planned with it at ``center``."""
        part = self.parts[segment.leg]
        return MODES[segment.mode].center_identifier(part, segment, center)

    def _bound(self, segment: Segment) -> Binding:
        part = self.parts[segment.leg]
        return bind(part, segment, self.execution.tracker(part, segment))

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
        if lost != (watches.lost is not None):
            watches = watches._replace(lost=instant.time if lost else None)
        adaptation = state.adaptation.step(
            max(tip.friction_utilisation for tip in felt),
            self._tip_speeds(instant, commands, contacts),
            state.estimate.parameters.drag,
            instant.dt,
        )
        next_state = ControllerState(
            PhaseState("move", state.phase.since, decision.tips, led=guidance.twist),
            following._replace(progress=guidance.progress),
            state.estimate,
            state.estimator,
            adaptation,
            watches,
        )
        touched = binding.touched(instant.X_WB, instant.tips)
        next_state = self._after_move(next_state, instant, touched, guidance)
        return commands, next_state, decision

    def _tip_speeds(
        self,
        instant: Instant,
        commands: Sequence[TipCommand],
        contacts: Sequence[Contact],
    ) -> list[TipSpeed]:
        """Velocities of the tips, as commanded and measured; of those alone that a
        servo drives.
        """
        if not self.law.servo:
            return []
        return [
            (command.velocity, instant.tips[contact.arm].velocity)
            for command, contact in zip(commands, contacts, strict=True)
        ]

    def _after_move(
        self,
        state: ControllerState,
        instant: Instant,
        touched: tuple[Point, ...],
        guidance: Guidance,
    ) -> ControllerState:
        """What comes next: go on, end, touch again, or follow a better plan."""
        time = instant.time
        following = state.following
        left = following.left
        astray = abs(guidance.error[1])
        allowed = margins.ARM.astray
        if astray > allowed:
            text = f"{astray * 1e3:.0f} mm off its path, allowed {allowed * 1e3:.0f} mm"
            return begin(state, "release", instant, ("goal_missed", text))
        still = self._still(state, instant)
        if still is not state.watches.still:
            state = state._replace(watches=state.watches._replace(still=still))
        rests = time - still.since if still else 0.0
        if rests > margins.ARM.stall_time:
            text = f"stood still for {rests:.0f} s, {left * 1e3:.0f} mm before its end"
            return begin(state, "release", instant, ("goal_missed", text))
        if self._arrived(following, instant, left):
            ahead = following.ahead or self._retry(state, instant)
            if not ahead:
                return begin(state, "done" if self.holds else "release", instant)
            return self._next_segment(state, ahead, instant)
        watches = state.watches
        if watches.lost is not None and time - watches.lost > self.patience:
            return self._touch_again(state, instant)
        retouch = margins.ARM.retouch
        slid = side_slide(following.segment.contacts, touched) > retouch
        crept = press_creep(self.segments[0].contacts, touched) > margins.CREPT
        if (slid or crept) and left > retouch and watches.retouches < RETOUCHES:
            return self._touch_planned_place(state, instant, crept)
        if watches.lost is not None:
            return state
        return self._replanned(state, instant, touched, guidance)

    def _still(self, state: ControllerState, instant: Instant) -> Still | None:
        """Return where the object was when it last moved, in this phase; None where it
        may rest, as with a force alone, or at a goal where it is waited for.
        """
        if self.waits or not self.law.servo:
            return None
        still = state.watches.still
        if still is not None and still.since >= state.phase.since:
            way = self._way(still.pose, instant.X_WB)
            speed = state.following.binding.segment.profile.speed
            if way < margins.STALL * speed * margins.ARM.stall_time:
                return still
        return Still(instant.X_WB, instant.time)

    def _touch_again(self, state: ControllerState, instant: Instant) -> ControllerState:
        """Touch where the tips are; stop where contact is lost again and again."""
        within = margins.ARM.retouch
        losses = Losses(instant.X_WB, 1)
        before = state.watches.losses
        if before is not None and self._way(before.pose, instant.X_WB) <= within:
            losses = Losses(before.pose, before.count + 1)
        state = state._replace(watches=state.watches._replace(losses=losses))
        if losses.count > LOSSES:
            text = f"contact lost {losses.count} times within {within * 1e3:.0f} mm"
            return begin(state, "release", instant, ("contact_lost", text))
        again = begin(state, "touch", instant)
        return again._replace(phase=again.phase._replace(align=False))

    def _way(self, pose: Pose2, X_WB: Pose2) -> float:
        """Return how far the object has come from ``pose``, X_WB, turns included [m]."""
        turned = self.object.radius * abs(wrap_angle(X_WB.yaw - pose.yaw))
        return math.dist(X_WB.position, pose.position) + turned

    def _touch_planned_place(
        self, state: ControllerState, instant: Instant, crept: bool
    ) -> ControllerState:
        """Let go, and touch again where the segment was planned to be touched; harder a
        press that ``crept``.
        """
        following = state.following
        followed = following.binding.segment
        planned = self.segments[0].contacts  # those of the whole placement
        contacts = tuple(
            replace(contact, point=at.point)
            for contact, at in zip(followed.contacts, planned, strict=True)
        )
        if crept:
            most = self.parts[followed.leg].limits.planned_force
            contacts = tuple(
                replace(
                    contact,
                    load=max(contact.load, min(margins.HARDER * contact.load, most)),
                )
                for contact in contacts
            )
        drive = following.segment.drive
        segment = replace(followed, contacts=contacts, drive=drive)
        watches = state.watches
        again = state._replace(
            following=following._replace(binding=self._bound(segment)),
            watches=watches._replace(
                lost=instant.time, retouches=watches.retouches + 1
            ),
        )
        return begin(again, "touch", instant)

    def _replanned(
        self,
        state: ControllerState,
        instant: Instant,
        touched: tuple[Point, ...],
        guidance: Guidance,
    ) -> ControllerState:
        """Follow a better plan from here, if there is one."""
        time = instant.time
        found = findings(state)
        if found.rho != state.following.rho:
            following = state.following._replace(rho=found.rho)
            state = state._replace(following=following)
        following = state.following
        segments = (following.binding.segment, *following.ahead)
        since = time - state.watches.replanned
        better = self.replanner.onward(
            segments, instant.X_WB, touched, guidance, since, found
        )
        if better is None:
            return state
        state = state._replace(watches=state.watches._replace(replanned=time))
        # a turn on the spot that goes on as arcs leads away from its spot
        led = isinstance(following.segment.path, ArcPath)
        if led and not (self.reaches_far or self._beside(better.segments)):
            return state  # asked again after a pause
        first = better.segments[0]
        prediction = following.prediction
        if found.center != prediction.followed_center:
            # the virtual axle is looked for about the centre that was found
            axle = self._axle_identifier(first)
            prediction = prediction._replace(axle=axle, followed_center=found.center)
        following = following._replace(
            binding=self._bound(first),
            ahead=better.segments[1:],
            prediction=prediction,
            progress=better.progress,
            clock_start=time - better.clock,
        )
        return state._replace(following=following)

    def _arrived(self, following: Following, instant: Instant, left: float) -> bool:
        """Whether a segment is over, ``left`` [m] before its end; in an opening, or
        held, when it rests.
        """
        if following.ahead or not self.waits:
            return left <= margins.ARM.stop
        duration = following.binding.segment.profile.duration
        late = instant.time - following.clock_start - duration
        if self.entry is None:
            rests = late > HOLD_TIME
        else:
            rests = self.entry.seated(instant.tips)
        return late > SEAT_TIME or (left <= margins.ARM.stop and rests)

    def _retry(self, state: ControllerState, instant: Instant) -> tuple[Segment, ...]:
        """Return segments that take the object to its goal in another attempt, if it is
        not there.
        """
        following = state.following
        task = self.parts[following.segment.leg]
        off = _share_of_tolerance(task, instant.X_WG)
        above = margins.RETRY_ABOVE
        if self.entry is not None:
            above = margins.RETRY_ABOVE_SEATED
        if off < above or state.watches.retries == RETRIES:
            return ()
        segment = following.binding.segment
        touched = following.binding.touched(instant.X_WB, instant.tips)
        replanner = self.replanner.believing(following.rho)
        measured = Measured.touching(
            instant.X_WB, segment.contacts, touched, findings=findings(state)
        )
        fresh = replanner.again(segment, measured)
        return fresh if self._can_follow(fresh, instant.time) else ()

    def _can_follow(self, segments: Sequence[Segment], time: float) -> bool:
        """Whether ``segments`` begun at ``time`` [s] end in time, and beside the planned
        way: elsewhere nobody has looked whether the arms can follow.
        """
        return self._in_time(segments, time) and (
            self.reaches_far or self._beside(segments)
        )

    def _beside(self, segments: Sequence[Segment]) -> bool:
        """Whether each pose of ``segments`` is near a planned one."""
        near = margins.ARM.beside
        turn = margins.ARM.turned_beside
        return all(
            any(
                math.dist(pose.position, other.position) < near
                and abs(wrap_angle(pose.yaw - other.yaw)) < turn
                for other in self.planned_poses
            )
            for segment in segments
            for pose in poses_along(segment)
        )

    def _in_time(self, segments: Sequence[Segment], time: float) -> bool:
        """Whether ``segments`` begun at ``time`` [s] end before the run has to."""
        ends = time + math.fsum(segment.profile.duration for segment in segments)
        part = self.parts[self.segments[0].leg]
        return ends < part.limits.time - ramp_time(margins.ARM.retreat)

    def _next_segment(
        self, state: ControllerState, ahead: tuple[Segment, ...], instant: Instant
    ) -> ControllerState:
        """Go on with the first of ``ahead``, from where the object is, without letting
        go.
        """
        before = state.following
        planned = ahead[0]
        found = findings(state)._replace(axle=None, rho=before.rho)
        fresh, center, retries = self._led_on(state, ahead, instant, found)
        joint_start = before.joint_progress(instant.X_WB)
        if before.remade(planned):
            # the joints go on along what was planned of the whole leg
            joint_start = before.joint_start
            planned = before.segment
        first = fresh[0]
        axle = MODES[ahead[0].mode].identifier(self.parts[ahead[0].leg], first)
        following = Following(
            self._bound(first),
            planned,
            fresh[1:],
            Prediction(axle, self._center_identifier(first, center), center),
            clock_start=instant.time,
            began=before.began,
            reference=first,
            reference_start=instant.time,
            joint_start=joint_start,
            rho=before.rho,
        )
        watches = state.watches._replace(replanned=instant.time, retries=retries)
        return state._replace(following=following, watches=watches)

    def _led_on(
        self,
        state: ControllerState,
        ahead: tuple[Segment, ...],
        instant: Instant,
        found: Findings,
    ) -> tuple[tuple[Segment, ...], Point, int]:
        """The segments ``ahead`` from where the object is, or the retry that takes their
        place; p_BCom [m] that they are planned with, and how many retries there were.
        """
        X_WB = instant.X_WB
        following = state.following
        planned = ahead[0]
        part = self.parts[planned.leg]
        mode = MODES[planned.mode]
        sides = sides_of(self.object, planned.contacts)
        touched = touched_points(planned.contacts, sides, X_WB, instant.tips)
        longest = margins.longest(
            margins.TOUCH_DETOUR, planned.path.length, self.object.radius
        )
        replanner = self.replanner.believing(following.rho)
        measured = Measured.touching(X_WB, planned.contacts, touched, longest, found)
        fresh = replanner.replan(ahead, measured)
        center = found.center if fresh else following.prediction.followed_center
        fresh = fresh or ahead
        retries = state.watches.retries
        if not following.ahead:
            return fresh, center, retries + 1
        if retries < RETRIES and mode.misses(part, fresh, X_WB):
            beyond = Measured.touching(
                X_WB, fresh[-1].contacts, touched, findings=found
            )
            anew = replanner.again(fresh[-1], beyond)
            if anew and self._can_follow(anew, instant.time):
                return anew, found.center, retries + 1
        return fresh, center, retries

    def _release(self, state: ControllerState, instant: Instant) -> PhaseStep:
        """Draw the tips back; after a failure slow down first, and go on holding an
        object that nothing else carries.
        """
        phase = state.phase
        failed = phase.failure is not None
        contacts = state.following.binding.segment.contacts
        commands = self._drawn_back(state, instant)
        elapsed = instant.time - phase.since
        over = elapsed > _rest(phase) + ramp_time(margins.ARM.retreat) + 0.3
        if failed and elapsed < margins.ARM.longest_stop:
            over = over and _at_rest(instant.tips, contacts)
        name: Phase = "done" if over else "release"
        next_state = state._replace(phase=phase._replace(name=name))
        return commands, next_state, None

    def _drawn_back(
        self, state: ControllerState, instant: Instant
    ) -> tuple[TipCommand, ...]:
        """Commands of tips on their way back, or that hold."""
        phase = state.phase
        failed = phase.failure is not None
        holds = failed and not self.scene.carried(instant.X_WG)
        share = _way_back(phase, instant.time)
        segment = state.following.binding.segment
        part = self.parts[segment.leg]
        yaw = instant.X_WG.yaw
        progress = state.following.joint_progress(instant.X_WB)
        commands = []
        for touch, memory, contact in zip(
            self.touches, phase.tips, segment.contacts, strict=True
        ):
            context = instant.context(contact, yaw, progress)
            if holds or (contact.arm in self.lasting and not failed):
                command = held_at(context, memory.start, push=touch.force_of(contact))
            else:
                wanted = margins.ARM.retreat if failed else self.back
                room = room_before(part, contact, wanted)
                way = WayBack(*(room * one for one in share))
                if not failed:
                    ahead = progress + way.distance
                    context = context._replace(joint_progress=ahead)
                command = drawn_back(context, memory.start, way)
            commands.append(command)
        return tuple(commands)


def _touches(
    task: Task, first: Segment, gap: float | None, into: Entry | None
) -> tuple[TipTouch, ...]:
    """Touch of each contact of the ``first`` segment."""
    return tuple(
        TipTouch(
            task.robots[contact.arm].tip_radius,
            task.motion.approach_distance if gap is None else gap,
            _touch_push(first),
            task.sensing.felt_force,
            task.sensing.seen_motion,
            NormalForceRegulator(f_max=task.limits.normal_force),
            _sunk(into),
        )
        for contact in first.contacts
    )


def _law(task: Task, execution: Execution, into: Entry | None, waits: bool) -> Law:
    """Algorithm 1 with the figures of a task."""
    mover = TipMover(
        task.motion.servo_damping if execution.servo else 0.0,
        task.contact_friction,
        task.sensing.felt_force,
        task.sensing.force_noise,
        NormalForceRegulator(f_max=task.limits.normal_force),
        tuple(robot.tip_radius for robot in task.robots),
        _sunk(into),
    )
    # the servo and what adds to it; an experiment without them gives the force alone
    servo = execution.servo and execution.force_gain is None
    floor_speed = margins.FLOOR_SPEED * task.motion.speed
    tracks_joints = execution.joint_stiffness > 0.0
    return Law(mover, floor_speed, execution.gain, servo, tracks_joints, into, waits)


def _sunk(into: Entry | None) -> float:
    """How much lower than it rests on top a pressing tip has slid off [m]; an object
    that goes down into an opening takes its tips along.
    """
    return margins.ARM.sunk if into is None else math.inf


def _rest(phase: PhaseState) -> float:
    """Return how long [s] the tips stand still before they draw back."""
    return 0.0 if phase.failure is None else margins.ARM.rest_time


def _ramp_back(phase: PhaseState, time: float) -> float:
    """Return the share of the time of a way back that has passed, if nothing halts it."""
    elapsed = time - phase.since - _rest(phase)
    return elapsed / ramp_time(margins.ARM.retreat)


def _share_back(phase: PhaseState, time: float) -> float:
    """Return the share of the way back that tips are led, if nothing halts them."""
    return smooth(_ramp_back(phase, time))


def _way_back(phase: PhaseState, time: float) -> WayBack:
    """Return how the tips are led along a way back of 1 m: they are halted where
    ``phase.drawn`` says so.
    """
    share = _share_back(phase, time)
    if share >= phase.drawn:
        return WayBack(phase.drawn, 0.0, 0.0)
    u = _ramp_back(phase, time)
    duration = ramp_time(margins.ARM.retreat)
    return WayBack(share, smooth_rate(u) / duration, smooth_change(u) / duration**2)


def _share_of_tolerance(task: Task, pose: Pose2) -> float:
    """Return how far an object at ``pose``, X_WG, is from its goal, over the tolerance."""
    off = math.dist(pose.position, task.goal.position) / task.tolerance.position
    turned = abs(wrap_angle(pose.yaw - task.goal.yaw)) / task.tolerance.yaw
    return max(off, turned)


def _at_rest(tips: Sequence[TipState], contacts: Sequence[Contact]) -> bool:
    """Whether the tips of all contacts are at rest."""
    speeds = [math.hypot(*tips[c.arm].velocity) for c in contacts]
    return max(speeds) < margins.ARM.at_rest


def _touch_push(segment: Segment) -> float:
    """Return what each pushing tip presses with before the motion begins [N]."""
    sides = sum(contact.kind == "side" for contact in segment.contacts)
    push = margins.TOUCH_SHARE * segment.drive.max_friction / max(sides, 1)
    return max(0.6, push)
