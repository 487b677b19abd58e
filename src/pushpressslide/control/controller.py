"""The controller: the paper's Algorithm 1, for any mode and any plant, top to bottom.

    touch    line the tips up with their contacts, advance until they feel the object,
             settle the normal force
    move     track -> wrench -> allocate -> contact forces, plus a velocity servo along
             the contact motion; segment after segment of a placement
    release  draw the tips back, unless nothing else carries the object; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) ->
(commands, log, state)``. It sees what a robot would see: object pose, tip state,
contact force. It never raises; what went wrong is in ``state.failure``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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
from pushpressslide.control.entry import HOLD_TIME, SEAT_TIME, entry
from pushpressslide.control.execution import USUAL, Execution
from pushpressslide.control.state import (
    Binding,
    ControllerState,
    Losses,
    Still,
    TipContext,
    TipMemory,
    begin,
    bind,
    by_arm,
    control_log,
    findings,
    joint_progress,
    joint_reference,
    pressed,
    ramp_time,
    remade,
    seen,
    smooth,
    smooth_change,
    smooth_rate,
)
from pushpressslide.control.timeline import Timeline
from pushpressslide.control.tip_motion import (
    TipHold,
    TipMover,
    TipTask,
    drag_ratio,
    missing,
)
from pushpressslide.control.touch import TipTouch, WayBack, drawn_back, held_at
from pushpressslide.core import margins
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import ControlLog, Measurement, Phase, TipCommand
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.path import ArcPath
from pushpressslide.core.plan import Contact, Plan, Segment, lasting_arms
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.record import Ending, ReasonCode
from pushpressslide.core.task import Sensing, Task
from pushpressslide.core.twist_path import moved
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.identification.center import CenterIdentifier, CenterState
from pushpressslide.identification.online import AxleState
from pushpressslide.kernels.leading import corrected, paced
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Measured
from pushpressslide.planning.side_contacts import room_before
from pushpressslide.planning.workspace import poses_along

CATCH_UP = 1.5  # [1/s] pull of the time reference on the progress
# [m], [rad] of noise that may remain in the object's pose: the mean of as many
# measurements as it takes, up to 1 / LEAST_GAIN
POSE_NOISE = 2e-4
YAW_NOISE = math.radians(0.08)
LEAST_GAIN = 0.1
RETOUCHES = 3
LOSSES = 6  # of contact at one place, above which the attempt ends
RETRIES = 4

Commands = tuple[TipCommand | None, ...]
Step = tuple[Commands, ControlLog, ControllerState]


class Controller:
    """Closed-form control of one placement of a plan; hold one per run of it."""

    def __init__(
        self,
        plan: Plan,
        number: int = 0,
        gap: float | None = None,
        back: float = math.inf,
        execution: Execution = USUAL,
    ) -> None:
        """Prepare everything that does not change from tick to tick.

        ``number`` is the placement's index in the plan; ``gap`` [m] is the free path
        that the approach leaves before the touch (default: as the task asks for);
        ``back`` [m] is how far the tips can be drawn back from the end; ``execution``
        may change the laws.
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
        motion = task.motion
        self.object = task.object
        self.X_GB = task.object.X_GB
        self.X_BG = self.X_GB.inverse()
        self.robots = task.robots
        self.floor_speed = margins.FLOOR_SPEED * motion.speed  # [m/s]
        self.replanner = Replanner(told)
        threshold = task.sensing.felt_force
        regulator = NormalForceRegulator(f_max=task.limits.normal_force)
        last = self.parts[self.segments[-1].leg]
        self.entry = entry(last, first.contacts)  # into an opening of the support
        # an object that goes down into an opening takes its tips along
        sunk = math.inf if self.entry is not None else margins.ARM.sunk
        self.touches = tuple(
            TipTouch(
                self.robots[contact.arm].tip_radius,
                motion.approach_distance if gap is None else gap,
                _touch_push(first),
                threshold,
                task.sensing.seen_motion,
                regulator,
                sunk,
            )
            for contact in first.contacts
        )
        # the servo and what adds to it; an experiment without them gives the force alone
        self.drives_on = execution.servo and execution.force_gain is None
        self.force_gain = execution.gain
        damping = motion.servo_damping if execution.servo else 0.0
        friction = task.contact_friction
        noise = task.sensing.force_noise
        self.pose_gain = pose_gain(task.sensing)
        radii = tuple(robot.tip_radius for robot in task.robots)
        self.mover = TipMover(
            damping, friction, threshold, noise, regulator, radii, sunk
        )
        self.patience = min(
            margins.ARM.loss_time(contact.kind)
            + motion.control_period * self.mover.samples(contact)
            for contact in first.contacts
        )
        final = number == len(placements) - 1
        # to the end of the run, since nothing else carries the object at its goal
        self.scene = told.scene
        self.holds = final and not self.scene.carried(last.goal)
        self.waits = self.entry is not None or self.holds
        # nothing but a retry can mend a miss
        self.reaches_far = self.waits or motion.recoveries == 0
        self.lasting: frozenset[int] = frozenset()
        if not final:
            self.lasting = lasting_arms(self.segments, placements[number + 1])

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
        return ControllerState(
            "touch",
            measurement.time,
            tips,
            self._bound(first),
            measurement.time,
            first,
            tuple(ahead),
            MODES[first.mode].identifier(self.parts[first.leg], first),
            self._center_identifier(first, (0.0, 0.0)),
        )

    def stop(
        self,
        state: ControllerState,
        measurement: Measurement,
        failure: tuple[ReasonCode, str],
    ) -> ControllerState:
        """Return the state that ends the run safely because of ``failure``: the tips
        slow down, then draw back or hold; tips that were drawing back stay.
        """
        drawn = 0.0 if state.phase == "release" else 1.0
        failed = state._replace(failure=failure, drawn=drawn)
        return begin(failed, "release", measurement)

    def halted(
        self, state: ControllerState, measurement: Measurement
    ) -> ControllerState:
        """Return the state in which tips that draw back stay where they are led now;
        those that still stand at their contacts will draw back.
        """
        share = _share_back(state, measurement)
        if share == 0.0:
            return state
        return state._replace(drawn=min(state.drawn, share))

    def step(self, state: ControllerState, measurement: Measurement) -> Step:
        """Return one command per arm (None: it has no contact), what was decided, and
        the next state.
        """
        pose = self._pose(state, measurement)
        if pose is not measurement.object_pose:
            measurement = replace(measurement, object_pose=pose)
        X_WB = pose.compose(self.X_GB)
        state = state._replace(X_WB=X_WB)
        if state.phase == "touch":
            return self._touch(state, measurement, X_WB)
        if state.phase == "move":
            return self._move(state, measurement, X_WB)
        return self._release(state, measurement, X_WB)

    def normal_forces(
        self, state: ControllerState, measurement: Measurement
    ) -> list[float]:
        """Return the normal force [N] measured at each tip; of a tip that has no
        contact, the size of its force.
        """
        X_WB = measurement.object_pose.compose(self.X_GB)
        forces = [math.hypot(*tip.force) for tip in measurement.tips]
        for contact in state.binding.segment.contacts:
            direction = contact.direction(X_WB)
            forces[contact.arm] = pressed(
                measurement.tips[contact.arm].force, direction
            )
        return forces

    def seen(self, state: ControllerState, measurement: Measurement) -> Pose2:
        """Return X_WG at the last tick, freed from noise as far as it can be."""
        if state.X_WB is None:
            return measurement.object_pose
        return state.X_WB.compose(self.X_BG)

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

    def _pose(self, state: ControllerState, measurement: Measurement) -> Pose2:
        """Return X_WG: where the object should have moved since the last tick, corrected
        by what was measured; where the camera missed it, not corrected.
        """
        before = state.X_WB
        exact = measurement.pose_seen and self.pose_gain == 1.0
        if before is None or exact:
            return measurement.object_pose
        at_com = state.twist.moved_to((0.0, 0.0))
        dt = measurement.time - state.last_time
        predicted = moved(before, (at_com.vx, at_com.vy, at_com.w), dt)
        if not measurement.pose_seen:
            return predicted.compose(self.X_BG)
        seen = measurement.object_pose.compose(self.X_GB)
        pose = corrected(
            (predicted.x, predicted.y, predicted.yaw),
            (seen.x, seen.y, seen.yaw),
            self.pose_gain,
        )
        return Pose2(*pose).compose(self.X_BG)

    def _touch(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        contacts = state.binding.segment.contacts
        elapsed = measurement.time - state.since
        aligned = 0.0
        if state.align:  # together, however far each has to go
            parts = zip(self.touches, state.tips, contacts, strict=True)
            aligned = max(t.align_time(memory, c, X_WB) for t, memory, c in parts)
        tool_yaw = self._touch_yaw(state, measurement, elapsed, aligned)
        progress = joint_progress(state)
        steps = [
            touch.step(
                memory,
                self._context(state, measurement, X_WB, contact, tool_yaw, progress),
                elapsed,
                aligned,
            )
            for touch, memory, contact in zip(
                self.touches, state.tips, contacts, strict=True
            )
        ]
        failure = state.failure
        for step in steps:
            if step.problem is not None:
                failure = ("contact_lost", step.problem)
        next_state = state._replace(
            tips=tuple(step.memory for step in steps),
            last_time=measurement.time,
            failure=failure,
        )
        if failure is not None:
            next_state = begin(next_state, "release", measurement)
        elif all(step.done for step in steps):
            next_state = self._begin_move(next_state, measurement, X_WB)
        commands = tuple(step.command for step in steps)
        log = control_log(state, measurement, self.X_BG, self.planned)
        return by_arm(commands, contacts, len(self.robots)), log, next_state

    def _touch_yaw(
        self,
        state: ControllerState,
        measurement: Measurement,
        elapsed: float,
        aligned: float,
    ) -> float:
        """Return the wanted yaw of the tools [rad]: from the planned one to the
        object's, over the time [s] in which the tips line up.
        """
        yaw = measurement.object_pose.yaw
        if not state.align:
            return yaw
        planned = state.binding.segment.body_pose(state.progress).compose(self.X_BG)
        share = smooth(elapsed / aligned) if aligned > 0.0 else 1.0
        return planned.yaw + share * wrap_angle(yaw - planned.yaw)

    def _context(
        self,
        state: ControllerState,
        measurement: Measurement,
        X_WB: Pose2,
        contact: Contact,
        tool_yaw: float,
        progress: float,
    ) -> TipContext:
        time = measurement.time
        return TipContext(
            contact,
            measurement.tips[contact.arm],
            X_WB,
            time,
            time - state.last_time,
            progress,
            tool_yaw,
        )

    def _begin_move(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> ControllerState:
        """Begin to move, replanned from where object and contacts turn out to be."""
        time = measurement.time
        rest = rest_of(state.binding.segment, state.progress)
        longest = margins.longest(
            margins.TOUCH_DETOUR, rest.path.length, self.object.radius
        )
        touched = state.binding.touched(X_WB, measurement.tips)
        found = findings(state)
        measured = Measured.touching(X_WB, rest.contacts, touched, longest, found)
        fresh = self.replanner.believing(state.rho).replan(
            (rest, *state.ahead), measured
        )
        moving = begin(state, "move", measurement)
        if fresh:
            moving = moving._replace(
                binding=self._bound(fresh[0]),
                ahead=fresh[1:],
                followed_center=found.center,
                center_identifier=self._center_identifier(fresh[0], found.center),
                center=_onward(state),
                progress=0.0,
                clock_start=time,
            )
        elif state.reference is None:
            moving = moving._replace(clock_start=time)
        else:
            pause = time - (state.lost or time)
            moving = moving._replace(clock_start=state.clock_start + pause)
        if state.reference is None:
            reference = moving.binding.segment
            moving = moving._replace(reference=reference, reference_start=time)
        if state.began is None:
            moving = moving._replace(began=time)
        return moving

    def _center_identifier(
        self, segment: Segment, center: Point
    ) -> CenterIdentifier | None:
        """Return what identifies the CoM in a segment planned with it at ``center``."""
        part = self.parts[segment.leg]
        return MODES[segment.mode].center_identifier(part, segment, center)

    def _bound(self, segment: Segment) -> Binding:
        part = self.parts[segment.leg]
        return bind(part, segment, self.execution.tracker(part, segment))

    def _move(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        binding = state.binding
        speed = self._speed(state, measurement.time)
        started = perf_counter()
        guidance = binding.tracker.step(
            binding.segment.path, X_WB, state.progress, speed, state.adaptation.grip
        )
        tracked = perf_counter()
        allocation = binding.allocate(guidance.fx, guidance.fy, guidance.tau)
        ticks = (tracked - started, perf_counter() - tracked)

        contacts = binding.segment.contacts
        twist = guidance.twist
        tasks = self._tip_tasks(state, measurement, twist, allocation)
        tracking = self.execution.joint_stiffness > 0.0
        progress = joint_reference(state, measurement.time, tracking)
        moved = []
        for memory, contact, task in zip(state.tips, contacts, tasks, strict=True):
            context = self._context(
                state, measurement, X_WB, contact, X_WB.yaw, progress
            )
            moved.append(self.mover.step(memory, context, task))
        commands, memories, felt = zip(*moved, strict=True)
        lost = None
        if missing(felt, contacts, allocation.normals):
            lost = measurement.time if state.lost is None else state.lost
        most = max(tip.friction_utilisation for tip in felt)
        dt = measurement.time - state.last_time
        touched = binding.touched(X_WB, measurement.tips)
        axle, center = seen(state, measurement, X_WB, touched[0])
        speeds = self._tip_speeds(measurement, commands, contacts)
        next_state = state._replace(
            progress=guidance.progress,
            lost=lost,
            adaptation=state.adaptation.step(most, speeds, dt),
            tips=memories,
            last_time=measurement.time,
            axle=axle,
            center=center,
            twist=twist,
            ticks=ticks,
        )
        next_state = self._after_move(next_state, measurement, X_WB, touched, guidance)
        log = control_log(
            state, measurement, self.X_BG, self.planned, guidance, allocation
        )
        return by_arm(commands, contacts, len(self.robots)), log, next_state

    def _speed(self, state: ControllerState, time: float) -> float:
        """Return the speed [m/s] along the path: the profile's, and what catches up."""
        segment = state.binding.segment
        profile = segment.profile
        planned = profile.at(time - state.clock_start)
        left = segment.path.length - state.progress
        floor = self.floor_speed
        # for the object to be seated or at rest
        waits = self.waits and not state.ahead and left <= margins.ARM.stop
        pace = (floor, 1.5 * profile.speed, profile.acceleration, CATCH_UP)
        return paced(planned, state.progress, left, 0.0 if waits else floor, pace)

    def _tip_tasks(
        self,
        state: ControllerState,
        measurement: Measurement,
        twist: Twist,
        allocation: Allocation,
    ) -> list[TipTask]:
        """Return what each tip is to do."""
        gain = self.force_gain * drag_ratio(state) * state.adaptation.effort
        starts = [memory.start for memory in state.tips]
        speeds: list[float | None] = [None] * len(starts)
        if self.entry is not None:
            speeds = self.entry.speeds(measurement, starts)
        holds = self._holds(state, allocation)
        return [
            TipTask(twist, center, (gain * fx, gain * fy), load, speed, hold)
            for center, (fx, fy), load, speed, hold in zip(
                state.binding.tip_points,
                allocation.forces,
                allocation.normals,
                speeds,
                holds,
                strict=True,
            )
        ]

    def _holds(
        self, state: ControllerState, allocation: Allocation
    ) -> list[TipHold | None]:
        """Return what keeps each of two pushing tips at its contact; None of others."""
        planned = state.segment.contacts
        sides = sum(contact.kind == "side" for contact in planned)
        if sides < 2 or not self.drives_on:
            return [None] * len(planned)
        least = margins.HELD_SHARE * math.fsum(allocation.normals)
        least = max(least, self.mover.threshold)
        return [
            TipHold(c.tip_place(self.robots[c.arm].tip_radius)[0], least)
            for c in planned
        ]

    def _tip_speeds(
        self,
        measurement: Measurement,
        commands: Sequence[TipCommand],
        contacts: Sequence[Contact],
    ) -> list[TipSpeed]:
        """Velocities of the tips, as commanded and measured; of those alone that a
        servo drives.
        """
        if not self.drives_on:
            return []
        return [
            TipSpeed(command.velocity, measurement.tips[contact.arm].velocity)
            for command, contact in zip(commands, contacts, strict=True)
        ]

    def _after_move(
        self,
        state: ControllerState,
        measurement: Measurement,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        guidance: Guidance,
    ) -> ControllerState:
        """What comes next: go on, end, touch again, touch the planned place anew, or
        follow a better plan.
        """
        segment = state.binding.segment
        time = measurement.time
        left = segment.path.length - state.progress
        astray = abs(guidance.error[1])
        allowed = margins.ARM.astray
        if astray > allowed:
            text = f"{astray * 1e3:.0f} mm off its path, allowed {allowed * 1e3:.0f} mm"
            return self.stop(state, measurement, ("goal_missed", text))
        still = self._still(state, X_WB, time)
        if still is not state.still:
            state = state._replace(still=still)
        rests = time - still.since if still else 0.0
        if rests > margins.ARM.stall_time:
            text = f"stood still for {rests:.0f} s, {left * 1e3:.0f} mm before its end"
            return self.stop(state, measurement, ("goal_missed", text))
        if self._arrived(state, measurement, left):
            ahead = state.ahead or self._retry(state, measurement, X_WB)
            if not ahead:
                return begin(state, "done" if self.holds else "release", measurement)
            return self._next_segment(state, ahead, measurement, X_WB)
        if state.lost is not None and time - state.lost > self.patience:
            return self._touch_again(state, measurement, X_WB)
        retouch = margins.ARM.retouch
        slid = side_slide(state.segment.contacts, touched) > retouch
        crept = press_creep(self.segments[0].contacts, touched) > margins.CREPT
        if (slid or crept) and left > retouch and state.retouches < RETOUCHES:
            return self._touch_planned_place(state, measurement, crept)
        if state.lost is not None:
            return state
        return self._replanned(state, time, X_WB, touched, guidance)

    def _still(self, state: ControllerState, X_WB: Pose2, time: float) -> Still | None:
        """Return where the object was when it last moved, in this phase; None where it
        may rest, as with a force alone, or at a goal where it is waited for.
        """
        if self.waits or not self.drives_on:
            return None
        still = state.still
        if still is None or still.since < state.since:
            return Still(X_WB, time)
        way = self._way(still.pose, X_WB)
        speed = state.binding.segment.profile.speed
        if way < margins.STALL * speed * margins.ARM.stall_time:
            return still
        return Still(X_WB, time)

    def _touch_again(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> ControllerState:
        """Touch where the tips are; stop where contact is lost again and again."""
        within = margins.ARM.retouch
        losses = Losses(X_WB, 1)
        before = state.losses
        if before is not None and self._way(before.pose, X_WB) <= within:
            losses = Losses(before.pose, before.count + 1)
        state = state._replace(losses=losses)
        if losses.count > LOSSES:
            text = f"contact lost {losses.count} times within {within * 1e3:.0f} mm"
            return self.stop(state, measurement, ("contact_lost", text))
        return begin(state, "touch", measurement)._replace(align=False)

    def _way(self, pose: Pose2, X_WB: Pose2) -> float:
        """Return how far the object has come from ``pose``, X_WB, turns included [m]."""
        turned = self.object.radius * abs(wrap_angle(X_WB.yaw - pose.yaw))
        return math.dist(X_WB.position, pose.position) + turned

    def _touch_planned_place(
        self, state: ControllerState, measurement: Measurement, crept: bool
    ) -> ControllerState:
        """Let go, and touch again where the segment was planned to be touched; harder a
        press that ``crept``.
        """
        followed = state.binding.segment
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
        segment = replace(followed, contacts=contacts, drive=state.segment.drive)
        again = state._replace(binding=self._bound(segment))
        return begin(again, "touch", measurement)._replace(
            lost=measurement.time,
            retouches=state.retouches + 1,
        )

    def _replanned(
        self,
        state: ControllerState,
        time: float,
        X_WB: Pose2,
        touched: tuple[Point, ...],
        guidance: Guidance,
    ) -> ControllerState:
        """Follow a better plan from here, if there is one."""
        found = findings(state)
        if found.rho != state.rho:
            state = state._replace(rho=found.rho)
        better = self.replanner.onward(
            (state.binding.segment, *state.ahead),
            X_WB,
            touched,
            guidance,
            time - state.replanned,
            found,
        )
        if better is None:
            return state
        # a turn on the spot that goes on as arcs leads away from its spot
        led = isinstance(state.segment.path, ArcPath)
        if led and not (self.reaches_far or self._beside(better.segments)):
            return state._replace(replanned=time)  # asked again after a pause
        first = better.segments[0]
        if found.center != state.followed_center:
            # the virtual axle is looked for about the centre that was found
            identifier = MODES[first.mode].identifier(self.parts[first.leg], first)
            axle = AxleState(drag=state.axle.drag)
            state = state._replace(identifier=identifier, axle=axle)
        return state._replace(
            binding=self._bound(first),
            ahead=better.segments[1:],
            followed_center=found.center,
            progress=better.progress,
            clock_start=time - better.clock,
            replanned=time,
        )

    def _arrived(
        self, state: ControllerState, measurement: Measurement, left: float
    ) -> bool:
        """Whether a segment is over, ``left`` [m] before its end; in an opening, or
        held, when it rests.
        """
        if state.ahead or not self.waits:
            return left <= margins.ARM.stop
        duration = state.binding.segment.profile.duration
        late = measurement.time - state.clock_start - duration
        if self.entry is None:
            rests = late > HOLD_TIME
        else:
            rests = self.entry.seated(measurement)
        return late > SEAT_TIME or (left <= margins.ARM.stop and rests)

    def _retry(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> tuple[Segment, ...]:
        """Return segments that take the object to its goal in another attempt, if it is
        not there.
        """
        task = self.parts[state.segment.leg]
        off = _share_of_tolerance(task, measurement.object_pose)
        above = margins.RETRY_ABOVE
        if self.entry is not None:
            above = margins.RETRY_ABOVE_SEATED
        if off < above or state.retries == RETRIES:
            return ()
        segment = state.binding.segment
        touched = state.binding.touched(X_WB, measurement.tips)
        replanner = self.replanner.believing(state.rho)
        measured = Measured.touching(
            X_WB, segment.contacts, touched, findings=findings(state)
        )
        fresh = replanner.again(segment, measured)
        return fresh if self._can_follow(fresh, measurement.time) else ()

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
        self,
        state: ControllerState,
        ahead: tuple[Segment, ...],
        measurement: Measurement,
        X_WB: Pose2,
    ) -> ControllerState:
        """Go on with the first of ``ahead``, from where the object is, without letting
        go.
        """
        planned = ahead[0]
        part = self.parts[planned.leg]
        time = measurement.time
        sides = sides_of(self.object, planned.contacts)
        touched = touched_points(planned.contacts, sides, X_WB, measurement.tips)
        longest = margins.longest(
            margins.TOUCH_DETOUR, planned.path.length, self.object.radius
        )
        replanner = self.replanner.believing(state.rho)
        mode = MODES[planned.mode]
        # the axle is that of the segment before
        found = findings(state._replace(identifier=None))
        measured = Measured.touching(X_WB, planned.contacts, touched, longest, found)
        fresh = replanner.replan(ahead, measured)
        center = found.center if fresh else state.followed_center
        fresh = fresh or ahead
        retries = state.retries
        if not state.ahead:
            retries += 1
        elif retries < RETRIES and mode.misses(part, fresh, X_WB):
            beyond = Measured.touching(
                X_WB, fresh[-1].contacts, touched, findings=found
            )
            anew = replanner.again(fresh[-1], beyond)
            if anew and self._can_follow(anew, time):
                fresh = anew
                center = found.center
                retries += 1
        joint_start = joint_progress(state)
        if remade(state, planned):
            # the joints go on along what was planned of the whole leg
            joint_start = state.joint_start
            planned = state.segment
        return state._replace(
            segment=planned,
            ahead=fresh[1:],
            identifier=mode.identifier(part, fresh[0]),
            center_identifier=self._center_identifier(fresh[0], center),
            center=_onward(state),
            followed_center=center,
            joint_start=joint_start,
            retries=retries,
            axle=AxleState(drag=state.axle.drag),
            binding=self._bound(fresh[0]),
            progress=0.0,
            clock_start=time,
            replanned=time,
            reference=fresh[0],
            reference_start=time,
        )

    def _release(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        """Draw the tips back; after a failure slow down first, and go on holding an
        object that nothing else carries.
        """
        failed = state.failure is not None
        holds = failed and not self.scene.carried(measurement.object_pose)
        rest = _rest(state)
        duration = ramp_time(margins.ARM.retreat)
        elapsed = measurement.time - state.since
        share = _way_back(state, measurement)
        contacts = state.binding.segment.contacts
        part = self.parts[state.binding.segment.leg]
        yaw = measurement.object_pose.yaw
        progress = joint_progress(state)
        commands = []
        for touch, memory, contact in zip(
            self.touches, state.tips, contacts, strict=True
        ):
            context = self._context(state, measurement, X_WB, contact, yaw, progress)
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
        over = elapsed > rest + duration + 0.3
        if failed and elapsed < margins.ARM.longest_stop:
            over = over and _at_rest(measurement, contacts)
        phase: Phase = "done" if over else "release"
        next_state = state._replace(phase=phase, last_time=measurement.time)
        log = control_log(state, measurement, self.X_BG, self.planned)
        return by_arm(tuple(commands), contacts, len(self.robots)), log, next_state


def _rest(state: ControllerState) -> float:
    """Return how long [s] the tips stand still before they draw back."""
    return 0.0 if state.failure is None else margins.ARM.rest_time


def _ramp_back(state: ControllerState, measurement: Measurement) -> float:
    """Return the share of the time of a way back that has passed, if nothing halts it."""
    elapsed = measurement.time - state.since - _rest(state)
    return elapsed / ramp_time(margins.ARM.retreat)


def _share_back(state: ControllerState, measurement: Measurement) -> float:
    """Return the share of the way back that tips are led, if nothing halts them."""
    return smooth(_ramp_back(state, measurement))


def _way_back(state: ControllerState, measurement: Measurement) -> WayBack:
    """Return how the tips are led along a way back of 1 m: they are halted where
    ``state.drawn`` says so.
    """
    share = _share_back(state, measurement)
    if share >= state.drawn:
        return WayBack(state.drawn, 0.0, 0.0)
    u = _ramp_back(state, measurement)
    duration = ramp_time(margins.ARM.retreat)
    return WayBack(share, smooth_rate(u) / duration, smooth_change(u) / duration**2)


def _share_of_tolerance(task: Task, pose: Pose2) -> float:
    """Return how far an object at ``pose``, X_WG, is from its goal, over the tolerance."""
    off = math.dist(pose.position, task.goal.position) / task.tolerance.position
    turned = abs(wrap_angle(pose.yaw - task.goal.yaw)) / task.tolerance.yaw
    return max(off, turned)


def _onward(state: ControllerState) -> CenterState:
    """Return what stays known of the CoM when a segment ends."""
    if state.center_identifier is None:
        return state.center
    return state.center_identifier.onward(state.center)


def _at_rest(measurement: Measurement, contacts: Sequence[Contact]) -> bool:
    """Whether the tips of all contacts are at rest."""
    speeds = [math.hypot(*measurement.tips[c.arm].velocity) for c in contacts]
    return max(speeds) < margins.ARM.at_rest


def pose_gain(sensing: Sensing) -> float:
    """Return the share of a measured pose's error that corrects the predicted one: 1
    without noise, less where it is larger than POSE_NOISE or YAW_NOISE.
    """
    noise = max(sensing.position_noise / POSE_NOISE, sensing.yaw_noise / YAW_NOISE)
    return min(1.0, max(LEAST_GAIN, 1.0 / max(noise * noise, 1e-12)))


def _touch_push(segment: Segment) -> float:
    """Return what each pushing tip presses with before the motion begins [N]."""
    sides = sum(contact.kind == "side" for contact in segment.contacts)
    push = margins.TOUCH_SHARE * segment.drive.max_friction / max(sides, 1)
    return max(0.6, push)
