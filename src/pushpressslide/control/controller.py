"""The controller: the paper's Algorithm 1, for any mode and any engine, top to bottom.

    touch    line the tips up with their contacts, advance until they feel the object,
    settle the normal force move     track -> wrench -> allocate -> contact forces, plus
    a velocity servo along the contact motion;
             stretch after stretch of the plan
    release  draw the tips back, unless nothing else carries the object; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) ->
(commands, log, state)``. It sees what a robot would see: object pose, tip state,
contact force. It never raises; what went wrong is in ``state.failure``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter

from pushpressslide.control.correction import (
    corrected,
    left_of,
    side_slide,
    touched_points,
)
from pushpressslide.control.entry import HOLD_TIME, SEAT_TIME, entry, holds
from pushpressslide.control.state import (
    ControllerState,
    TipMemory,
    begin,
    bind,
    by_arm,
    control_log,
    identified,
    joint_progress,
    joint_reference,
    ramp_time,
    seen,
    smooth,
)
from pushpressslide.control.tip_motion import TipMover, drag_ratio, drawn_back, missing
from pushpressslide.control.touch import align_time, held_at, touch
from pushpressslide.core.control import ControlLog, Measurement, Phase, TipCommand
from pushpressslide.core.guidance import Guidance
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Pose2, wrap_angle
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.identification.online import AxleState
from pushpressslide.modes import MODES

# of the force that would move the object: pressed before the motion begins
TOUCH_SHARE = 0.4
# [s] without contact force before a tip goes back to touch: a side push rides over a
# gap, a press must not
LOSS_TIME = {"side": 0.12, "top": 0.012}
CATCH_UP = 1.5  # [1/s] pull of the time reference on the progress
FLOOR_SPEED = 0.006  # [m/s] least speed while the goal is not reached
STOP = 2e-4  # [m] of path left at which the motion ends
RETREAT = 0.06  # [m] drawn back on release
# [m] of slid contact, more way left, at which the tip lets go and takes the planned
# place
REGRASP = 0.012
REGRASPS = 3
# share of the friction cone, by the measured force, beyond which the steering is eased
GRIP_USE = 0.93
GRIP_FALL = 4.0
GRIP_RISE = 0.5
GRIP_LEAST = 0.3  # [1/s], [1/s], -
ASTRAY = 0.1  # [m] of the tracking point from its path at which the run is given up
GOOD_ENOUGH = 0.9
RETRIES = 2  # share of the tolerance at the end up to which it is not tried once more
# that share in an opening, where the fall in has pushed the object off its path
SEATED_ENOUGH = 0.3
TOUCH_DETOUR = 1.2  # times the way that is left, for the plan made at a touch
TOUCH_SLACK = 0.03  # [m]

Commands = tuple[TipCommand | None, ...]
Step = tuple[Commands, ControlLog, ControllerState]


class Controller:
    """Closed-form control of one plan; hold one per run."""

    def __init__(self, plan: Plan) -> None:
        """Prepare everything that does not change from tick to tick."""
        task = plan.task
        self.plan, self.mode, self.binding = plan, MODES[plan.choice.mode], bind(plan)
        self.X_GB = task.object.X_GB
        self.robots = task.robots
        contacts = plan.choice.contacts
        sides = sum(c.kind == "side" for c in contacts)
        push = TOUCH_SHARE * plan.choice.parameters["push_force"] / max(sides, 1)
        self.touch_forces = [
            c.load if c.kind == "top" else max(0.6, push) for c in contacts
        ]
        self.threshold = max(0.25, 4.0 * task.sensing.force_noise)
        motion = task.motion
        self.force_gain = motion.force_gain or (1.0 if motion.velocity_servo else 1.05)
        self.regulator = NormalForceRegulator(f_max=task.limits.normal_force)
        damping = motion.servo_damping if motion.velocity_servo else 0.0
        self.mover = TipMover(
            damping, task.believed.contact_friction, self.threshold, self.regulator
        )
        self.entry = entry(plan)  # into an opening of the support
        self.holds = holds(plan)  # to the end of the run
        self.waits = self.entry is not None or self.holds
        self.kept = (
            plan.kept(plan.next_grasp) if plan.next_grasp is not None else frozenset()
        )
        # wall time of the last track and allocate, for the record only
        self.ticks = (0.0, 0.0)

    def init(self, measurement: Measurement, held: Commands = ()) -> ControllerState:
        """Return the state at the start of the touch; ``held``: the commands of arms
        that have not let go.
        """
        tips = tuple(
            TipMemory(
                measurement.tips[c.arm].position,
                regulator=NormalForceState(ramped=c.load),
                held=held[c.arm] if held else None,
            )
            for c in self.plan.choice.contacts
        )
        first, *ahead = self.plan.stretches
        return ControllerState(
            "touch",
            measurement.time,
            tips,
            self.binding,
            measurement.time,
            first,
            tuple(ahead),
            self.mode.identifier(first),
        )

    def step(self, state: ControllerState, measurement: Measurement) -> Step:
        """Return one command per arm (None: it has no contact), what was thought, and
        the next state.
        """
        X_WB = measurement.object_pose.compose(self.X_GB)
        if state.phase == "touch":
            return self._touch(state, measurement, X_WB)
        if state.phase == "move":
            return self._move(state, measurement, X_WB)
        return self._release(state, measurement, X_WB)

    def _touch(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        plan = state.binding.plan
        time = measurement.time
        contacts = plan.choice.contacts
        gap = plan.task.motion.approach_distance
        elapsed = time - state.since
        dt = time - state.last_time
        radii = [self.robots[c.arm].tip_radius for c in contacts]
        aligned = 0.0
        if state.align:  # together, however far each has to go
            parts = zip(state.tips, contacts, radii, strict=True)
            aligned = max(align_time(m, c, X_WB, radius, gap) for m, c, radius in parts)
        planned = (
            plan.object_pose(state.progress).yaw
            if state.align
            else measurement.object_pose.yaw
        )
        turned = smooth(elapsed / aligned) if aligned > 0.0 else 1.0
        tool_yaw = planned + turned * wrap_angle(measurement.object_pose.yaw - planned)
        commands = []
        memories = []
        done = True
        failure = state.failure
        for memory, contact, radius, force in zip(
            state.tips, contacts, radii, self.touch_forces, strict=True
        ):
            command, kept, ready, problem = touch(
                memory,
                measurement.tips[contact.arm],
                contact,
                X_WB,
                radius,
                time,
                elapsed,
                aligned,
                dt,
                self.regulator,
                force,
                self.threshold,
                gap,
                tool_yaw,
                joint_progress(state),
            )
            commands.append(command)
            memories.append(kept)
            done = done and ready
            failure = ("contact_lost", problem) if problem is not None else failure
        log = control_log(state, measurement)
        next_state = replace(
            state, tips=tuple(memories), last_time=time, failure=failure
        )
        if failure is not None:
            next_state = begin(next_state, "release", measurement)
        elif done:
            next_state = self._planned_anew(next_state, measurement, X_WB)
        return by_arm(tuple(commands), contacts, len(self.robots)), log, next_state

    def _planned_anew(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> ControllerState:
        """Begin to move, by a plan made anew from where object and contacts turn out to
        be.
        """
        plan = left_of(state.binding.plan, state.progress)
        longest = TOUCH_DETOUR * plan.path.length + TOUCH_SLACK
        touched = touched_points(plan, X_WB, measurement.tips)
        fresh = self.mode.replan(plan, X_WB, touched, longest, identified(state))
        moving = begin(state, "move", measurement)
        if fresh is not None:
            moving = replace(
                moving,
                binding=bind(fresh),
                ahead=fresh.stretches[1:],
                progress=0.0,
                clock_start=measurement.time,
            )
        elif state.reference is None:
            moving = replace(moving, clock_start=measurement.time)
        else:
            pause = measurement.time - (state.lost or measurement.time)
            moving = replace(moving, clock_start=state.clock_start + pause)
        if state.reference is None:
            moving = replace(
                moving, reference=moving.binding.plan, reference_start=measurement.time
            )
        return moving

    def _move(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        binding = state.binding
        path = binding.plan.path
        profile = binding.plan.profile
        wanted_progress, wanted_speed = profile.at(measurement.time - state.clock_start)
        left = path.length - state.progress
        speed = wanted_speed + CATCH_UP * (wanted_progress - state.progress)
        braking = FLOOR_SPEED + math.sqrt(profile.acceleration * max(left, 0.0))
        # for the object to be seated or at rest
        waits = self.waits and not state.ahead and left <= STOP
        speed = min(
            max(speed, 0.0 if waits else FLOOR_SPEED), 1.5 * profile.speed, braking
        )

        started = perf_counter()
        guidance = binding.tracker.step(path, X_WB, state.progress, speed, state.grip)
        tracked = perf_counter()
        wrench = guidance.wrench
        allocation = binding.allocate(wrench.fx, wrench.fy, wrench.tau)
        self.ticks = (tracked - started, perf_counter() - tracked)

        contacts = binding.plan.choice.contacts
        dt = measurement.time - state.last_time
        reference = joint_reference(state, measurement.time)
        gain = self.force_gain * drag_ratio(state)
        entry = self.entry
        begun = [memory.start for memory in state.tips]
        speeds = (
            entry.speeds(measurement, begun)
            if entry is not None
            else [None] * len(contacts)
        )
        moved = [
            self.mover.step(
                memory,
                measurement.tips[contact.arm],
                contact,
                X_WB,
                guidance.twist,
                inside,
                (gain * f[0], gain * f[1]),
                load,
                dt,
                reference,
                entry_speed,
            )
            for memory, contact, inside, f, load, entry_speed in zip(
                state.tips,
                contacts,
                binding.tip_points,
                allocation.forces,
                allocation.normals,
                speeds,
                strict=True,
            )
        ]
        commands, memories, felt = zip(*moved, strict=True)
        lost = missing(felt, contacts, allocation.normals)
        use = max(f.use for f in felt)
        log = control_log(state, measurement, guidance, wrench, allocation)
        since = (
            (state.lost if state.lost is not None else measurement.time)
            if lost
            else None
        )
        rate = -GRIP_FALL if use > GRIP_USE else GRIP_RISE
        grip = min(1.0, max(GRIP_LEAST, state.grip + rate * dt))
        next_state = replace(
            state,
            progress=guidance.progress,
            lost=since,
            grip=grip,
            tips=memories,
            last_time=measurement.time,
            axle=seen(state, measurement, X_WB),
        )
        next_state = self._after_move(next_state, measurement, X_WB, guidance)
        return by_arm(commands, contacts, len(self.robots)), log, next_state

    def _after_move(
        self,
        state: ControllerState,
        measurement: Measurement,
        X_WB: Pose2,
        guidance: Guidance,
    ) -> ControllerState:
        """What comes next: go on, end, touch again, take the contact anew, or follow a
        better plan.
        """
        plan = state.binding.plan
        time = measurement.time
        left = plan.path.length - state.progress
        if abs(guidance.error[1]) > ASTRAY:
            text = f"{abs(guidance.error[1]) * 1e3:.0f} mm off its path, allowed {ASTRAY * 1e3:.0f} mm"
            return begin(
                replace(state, failure=("goal_missed", text)), "release", measurement
            )
        if self._arrived(state, measurement, left):
            ahead = state.ahead or self._once_more(state, measurement, X_WB)
            if not ahead:
                return begin(state, "done" if self.holds else "release", measurement)
            return self._next_stretch(state, ahead, measurement, X_WB)
        patience = min(LOSS_TIME[c.kind] for c in plan.choice.contacts)
        if state.lost is not None and time - state.lost > patience:
            return replace(begin(state, "touch", measurement), align=False)
        touched = touched_points(plan, X_WB, measurement.tips)
        planned = state.stretch
        if left > REGRASP < side_slide(planned, touched) and state.regrasps < REGRASPS:
            again = replace(
                state,
                binding=bind(replace(plan, choice=planned.choice, X_BV=planned.X_BV)),
            )
            return replace(
                begin(again, "touch", measurement),
                lost=time,
                regrasps=state.regrasps + 1,
            )
        if state.lost is None:
            better = corrected(
                self.mode,
                plan,
                X_WB,
                touched,
                guidance,
                left,
                time - state.corrected,
                identified(state),
            )
            if better is not None:
                fresh, progress, clock = better
                return replace(
                    state,
                    binding=bind(fresh),
                    ahead=fresh.stretches[1:],
                    progress=progress,
                    clock_start=time - clock,
                    corrected=time,
                )
        return state

    def _arrived(
        self, state: ControllerState, measurement: Measurement, left: float
    ) -> bool:
        """Whether a stretch is over, ``left`` [m] before its end; in an opening, or
        held, when it rests.
        """
        if state.ahead or not self.waits:
            return left <= STOP
        late = (
            measurement.time - state.clock_start - state.binding.plan.profile.duration
        )
        rests = (
            late > HOLD_TIME if self.entry is None else self.entry.seated(measurement)
        )
        return late > SEAT_TIME or (left <= STOP and rests)

    def _once_more(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> tuple[Plan, ...]:
        """Return stretches that take the object to its goal in another attempt, if it
        is not there.
        """
        task = state.stretch.task
        at = measurement.object_pose
        off = math.dist(at.position, task.goal.position) / task.tolerance.position
        turned = abs(wrap_angle(at.yaw - task.goal.yaw)) / task.tolerance.yaw
        enough = GOOD_ENOUGH if self.entry is None else SEATED_ENOUGH
        if max(off, turned) < enough or state.retries == RETRIES:
            return ()
        plan = state.binding.plan
        again = self.mode.again(
            plan, X_WB, touched_points(plan, X_WB, measurement.tips)
        )
        return () if again is None else again.stretches

    def _next_stretch(
        self,
        state: ControllerState,
        ahead: tuple[Plan, ...],
        measurement: Measurement,
        X_WB: Pose2,
    ) -> ControllerState:
        """Go on with the next stretch of ``ahead``, from where the object is, without
        letting go.
        """
        plan = ahead[0]
        touched = touched_points(plan, X_WB, measurement.tips)
        fresh = (
            self.mode.replan(
                plan, X_WB, touched, TOUCH_DETOUR * plan.path.length + TOUCH_SLACK
            )
            or plan
        )
        return replace(
            state,
            stretch=plan,
            ahead=fresh.stretches[1:],
            identifier=self.mode.identifier(plan),
            joint_start=joint_progress(state),
            retries=state.retries + (not state.ahead),
            axle=AxleState(),
            binding=bind(fresh),
            progress=0.0,
            clock_start=measurement.time,
            corrected=measurement.time,
            reference=fresh,
            reference_start=measurement.time,
        )

    def _release(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> Step:
        duration = ramp_time(RETREAT)
        elapsed = measurement.time - state.since
        back = RETREAT * smooth(elapsed / duration)
        progress = joint_progress(state)
        contacts = state.binding.plan.choice.contacts
        yaw = measurement.object_pose.yaw
        still = (0.0, 0.0, 0.0)
        commands = tuple(
            held_at(contact, X_WB, memory.start, still, force, yaw, progress)
            if contact.arm in self.kept and state.failure is None
            else drawn_back(memory.start, contact, X_WB, back, yaw, progress)
            for memory, contact, force in zip(
                state.tips, contacts, self.touch_forces, strict=True
            )
        )
        log = control_log(state, measurement)
        phase: Phase = "done" if elapsed > duration + 0.3 else "release"
        next_state = replace(state, phase=phase, last_time=measurement.time)
        return by_arm(commands, contacts, len(self.robots)), log, next_state
