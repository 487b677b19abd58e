"""The controller: the paper's Algorithm 1, for any mode and any engine, top to bottom.

    touch    line the tips up with their contacts, advance until they feel the object, settle the normal force
    move     track -> wrench -> allocate -> contact forces, plus a velocity servo along the contact motion
    release  draw the tips back; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) -> (commands, log, state)``.
It sees what a robot would see: object pose, tip state, contact force. It never raises; what went wrong is in
``state.failure``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import ControlLog, Measurement, Phase, TipCommand
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.wrench import Wrench
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Guidance
from pushpressslide.pipeline.control_state import (
    FREE_DAMPING,
    FREE_STIFFNESS,
    SERVO_CAP,
    ControllerState,
    approached,
    bind,
    ramp_time,
    smooth,
)
from pushpressslide.pipeline.correction import contacts_on_faces, corrected, slide
from pushpressslide.pipeline.touch import touch

TOUCH_SHARE = 0.4  # of the force that would move the object: pressed before the motion begins
LOSS_TIME = 0.12  # [s] without contact force before the tip goes back to touch
CATCH_UP = 1.5  # [1/s] pull of the time reference on the progress
FLOOR_SPEED = 0.006  # [m/s] least speed while the goal is not reached
STOP = 2e-4  # [m] of path left at which the motion ends
RETREAT = 0.06  # [m] drawn back on release
# [N/m], [N s/m] of a pushing tip: soft, so that it does not lean on the face
HEIGHT_STIFFNESS, HEIGHT_DAMPING = 2000.0, 300.0
REGRASP = 0.012  # [m] of slid contact at which the tip lets go and takes the planned place again
REGRASPS = 3
GRIP_USE = 0.93  # share of the friction cone, by the measured force, beyond which the steering is eased
GRIP_FALL, GRIP_RISE, GRIP_LEAST = 4.0, 0.5, 0.3  # [1/s], [1/s], -
TIP_ACCELERATION = 5.0  # [m/s^2] of the tips' reference: a jump of the steering must not jerk the contact
# [m] that the joint reference may be ahead of the object or behind it: a spring stretched round a bend would
# pull the tip sideways off its face
JOINT_LEAD = 0.03
TOUCH_DETOUR = 1.2  # times the way that is left, for the plan made at a touch
TOUCH_SLACK = 0.03  # [m]

Step = tuple[tuple[TipCommand, ...], ControlLog, ControllerState]


class Controller:
    """Closed-form control of one plan; hold one per run."""

    def __init__(self, plan: Plan) -> None:
        """Prepare everything that does not change from tick to tick."""
        task = plan.task
        self.plan, self.mode, self.binding = plan, MODES[plan.choice.mode], bind(plan)
        self.contacts: tuple[Contact, ...] = plan.choice.contacts
        self.X_GB = task.object.X_GB
        self.X_BG = self.X_GB.inverse()
        self.touch_force = max(0.6, TOUCH_SHARE * plan.choice.parameters["push_force"])
        self.threshold = max(0.25, 4.0 * task.sensing.force_noise)
        self.friction = task.believed.contact_friction
        motion = task.motion
        self.damping = motion.servo_damping if motion.velocity_servo else 0.0
        self.force_gain = motion.force_gain or (1.0 if motion.velocity_servo else 1.05)
        self.regulator = NormalForceRegulator(f_max=task.limits.normal_force)
        self.ticks = (0.0, 0.0)  # wall time of the last track and allocate, for the record only

    def init(self, measurement: Measurement) -> ControllerState:
        """Return the state at the start of the touch."""
        tips = tuple(tip.position for tip in measurement.tips)
        return ControllerState("touch", measurement.time, tips, self.binding, measurement.time)

    def step(self, state: ControllerState, measurement: Measurement) -> Step:
        """Return one command per tip, what was thought, and the next state."""
        X_WB = measurement.object_pose.compose(self.X_GB)
        if state.phase == "touch":
            return self._touch(state, measurement, X_WB)
        if state.phase == "move":
            return self._move(state, measurement, X_WB)
        return self._release(state, measurement, X_WB)

    def _touch(self, state: ControllerState, measurement: Measurement, X_WB: Pose2) -> Step:
        commands, next_state, done = touch(
            state, measurement, X_WB, self.contacts, self.regulator, self.touch_force, self.threshold,
            self.plan.task.motion.approach_distance, self._joint_progress(state),
        )  # fmt: skip
        log = self._log(state, measurement)
        if next_state.failure is not None:
            return commands, log, self._begin(next_state, "release", measurement)
        if done:
            # plan anew from where object and contacts turn out to be
            plan = state.binding.plan
            longest = TOUCH_DETOUR * (plan.path.length - state.progress) + TOUCH_SLACK
            touched = contacts_on_faces(plan, self._touched(measurement, X_WB))
            fresh = self.mode.replan(plan, X_WB, touched, longest)
            next_state = self._begin(next_state, "move", measurement)
            if fresh is not None:
                next_state = replace(
                    next_state, binding=bind(fresh), progress=0.0, clock_start=measurement.time
                )
            elif state.reference is None:
                next_state = replace(next_state, clock_start=measurement.time)
            else:
                pause = measurement.time - (state.lost or measurement.time)
                next_state = replace(next_state, clock_start=state.clock_start + pause)
            if state.reference is None:
                next_state = replace(
                    next_state, reference=next_state.binding.plan, reference_start=measurement.time
                )
        return commands, log, next_state

    def _move(self, state: ControllerState, measurement: Measurement, X_WB: Pose2) -> Step:
        binding = state.binding
        path, profile = binding.plan.path, binding.plan.profile
        wanted_progress, wanted_speed = profile.at(measurement.time - state.clock_start)
        left = path.length - state.progress
        speed = wanted_speed + CATCH_UP * (wanted_progress - state.progress)
        braking = FLOOR_SPEED + math.sqrt(profile.acceleration * max(left, 0.0))
        speed = min(max(speed, FLOOR_SPEED), 1.5 * profile.speed, braking)

        started = perf_counter()
        guidance = binding.tracker.step(path, X_WB, state.progress, speed, state.grip)
        tracked = perf_counter()
        wrench = guidance.wrench
        allocation = binding.allocate(wrench.fx, wrench.fy, wrench.tau)
        self.ticks = (tracked - started, perf_counter() - tracked)

        commands, velocities = [], []
        touching, use = True, 0.0
        step = TIP_ACCELERATION * (measurement.time - state.last_time)
        before = state.tip_velocities or ((0.0, 0.0),) * len(self.contacts)
        for tip, contact, inside, f_B, was in zip(
            measurement.tips, self.contacts, binding.tip_points, allocation.forces, before, strict=True
        ):
            n = X_WB.rotate(contact.normal)
            normal_force = tip.force[0] * n[0] + tip.force[1] * n[1]
            touching = touching and normal_force > 0.5 * self.threshold
            shear = abs(tip.force[1] * n[0] - tip.force[0] * n[1])
            use = max(use, shear / (self.friction * max(normal_force, self.threshold)))
            f = X_WB.rotate((self.force_gain * f_B[0], self.force_gain * f_B[1]))
            at_tip = guidance.twist.moved_to(inside)
            v = approached(was, X_WB.rotate((at_tip.vx, at_tip.vy)), step)
            velocities.append(v)
            commands.append(
                TipCommand(
                    force=(f[0], f[1], 0.0),
                    position=(tip.position[0], tip.position[1], contact.height),
                    velocity=(v[0], v[1], 0.0),
                    stiffness=(0.0, 0.0, HEIGHT_STIFFNESS),
                    damping=(self.damping, self.damping, HEIGHT_DAMPING),
                    normal_yaw=math.atan2(n[1], n[0]),
                    tool_yaw=measurement.object_pose.yaw,
                    tool_yaw_rate=guidance.twist.w,
                    servo_cap=SERVO_CAP,
                    progress=self._joint_reference(state, measurement.time),
                )
            )
        log = self._log(state, measurement, guidance, wrench, allocation)
        lost = None if touching else (state.lost if state.lost is not None else measurement.time)
        rate = -GRIP_FALL if use > GRIP_USE else GRIP_RISE
        grip = min(1.0, max(GRIP_LEAST, state.grip + rate * (measurement.time - state.last_time)))
        next_state = replace(
            state, progress=guidance.progress, lost=lost, grip=grip, tip_velocities=tuple(velocities),
            last_time=measurement.time,
        )  # fmt: skip
        return tuple(commands), log, self._after_move(next_state, measurement, X_WB, guidance)

    def _after_move(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2, guidance: Guidance
    ) -> ControllerState:
        """What comes next: go on, end, touch again, take the contact anew, or follow a better plan."""
        plan = state.binding.plan
        left = plan.path.length - state.progress
        if left <= STOP:
            return self._begin(state, "release", measurement)
        if state.lost is not None and measurement.time - state.lost > LOSS_TIME:
            return replace(self._begin(state, "touch", measurement), align=False)
        touched = self._touched(measurement, X_WB)
        if slide(self.plan, touched) > REGRASP and state.regrasps < REGRASPS:
            again = replace(state, binding=bind(replace(plan, choice=self.plan.choice, X_BV=self.plan.X_BV)))
            return replace(
                self._begin(again, "touch", measurement), lost=measurement.time, regrasps=state.regrasps + 1
            )
        if state.lost is None:
            better = corrected(
                self.mode, plan, X_WB, touched, guidance, left, measurement.time - state.corrected
            )
            if better is not None:
                fresh, progress, clock = better
                return replace(
                    state, binding=bind(fresh), progress=progress, clock_start=measurement.time - clock,
                    corrected=measurement.time,
                )  # fmt: skip
        return state

    def _release(self, state: ControllerState, measurement: Measurement, X_WB: Pose2) -> Step:
        duration = ramp_time(RETREAT)
        elapsed = measurement.time - state.since
        back = RETREAT * smooth(elapsed / duration)
        commands = []
        for start, contact in zip(state.tip_start, self.contacts, strict=True):
            n = X_WB.rotate(contact.normal)
            commands.append(
                TipCommand(
                    force=(0.0, 0.0, 0.0),
                    position=(start[0] - back * n[0], start[1] - back * n[1], contact.height),
                    velocity=(0.0, 0.0, 0.0),
                    stiffness=FREE_STIFFNESS,
                    damping=FREE_DAMPING,
                    normal_yaw=math.atan2(n[1], n[0]),
                    tool_yaw=measurement.object_pose.yaw,
                    tool_yaw_rate=0.0,
                    servo_cap=SERVO_CAP,
                    progress=self._joint_progress(state),
                )
            )
        log = self._log(state, measurement)
        if elapsed > duration + 0.3:
            return tuple(commands), log, replace(state, phase="done", last_time=measurement.time)
        return tuple(commands), log, replace(state, last_time=measurement.time)

    def _begin(self, state: ControllerState, phase: Phase, measurement: Measurement) -> ControllerState:
        """Return the state at the start of a phase."""
        return replace(
            state, phase=phase, since=measurement.time, tip_start=tuple(t.position for t in measurement.tips),
            last_time=measurement.time, felt=None, align=True, tip_velocities=(),
            regulator=NormalForceState(),
            lost=state.lost if phase == "touch" else None,
        )  # fmt: skip

    def _joint_progress(self, state: ControllerState) -> float:
        """Where on the PLANNED path the joint reference is taken: as far from the end as the object is on its
        own path.
        """
        left = state.binding.plan.path.length - state.progress
        return max(0.0, self.plan.path.length - left)

    def _joint_reference(self, state: ControllerState, time: float) -> float:
        """Where on the planned path the joint reference is taken in the move: with the joint-tracking term
        where the reference is at the same ``time`` [s], the paper's q(t), at most JOINT_LEAD from the object.
        """
        here, reference = self._joint_progress(state), state.reference
        if not self.plan.task.motion.joint_tracking or reference is None:
            return here
        timed = reference.profile.at(time - state.reference_start)[0]
        timed += self.plan.path.length - reference.path.length
        return max(0.0, min(max(timed, here - JOINT_LEAD), here + JOINT_LEAD))

    def _touched(self, measurement: Measurement, X_WB: Pose2) -> tuple[Point, ...]:
        """Where the tips touch, in B [m], by their own kinematics."""
        out = []
        for tip, contact, robot in zip(measurement.tips, self.contacts, self.plan.task.robots, strict=True):
            p = X_WB.unapply((tip.position[0], tip.position[1]))
            out.append(
                (p[0] + robot.tip_radius * contact.normal[0], p[1] + robot.tip_radius * contact.normal[1])
            )
        return tuple(out)

    def _log(
        self,
        state: ControllerState,
        measurement: Measurement,
        guidance: Guidance | None = None,
        wrench: Wrench | None = None,
        allocation: Allocation | None = None,
    ) -> ControlLog:
        plan = state.reference if state.reference is not None else self.plan
        clock = measurement.time - state.reference_start if state.reference is not None else 0.0
        reference = plan.object_pose(plan.profile.at(clock)[0])
        pose = Pose2(reference.x, reference.y, wrap_angle(reference.yaw))
        if guidance is None or wrench is None or allocation is None:
            nothing = (0.0, 0.0, 0.0)
            return ControlLog(state.phase, state.progress, pose, nothing, nothing, nothing, 0.0, "ok")
        rx, ry, rt = allocation.residual
        return ControlLog(
            state.phase, state.progress, pose, guidance.error, (wrench.fx, wrench.fy, wrench.tau),
            (wrench.fx - rx, wrench.fy - ry, wrench.tau - rt), guidance.steering, allocation.status,
        )  # fmt: skip
