"""The controller: the paper's Algorithm 1, for any mode and any engine, top to bottom.

    touch    line the tips up with their contacts, advance until they feel the object, settle the normal force
    move     track -> wrench -> allocate -> contact forces, plus a velocity servo along the wanted contact motion
    release  draw the tips back; then done

State in, state out: ``init(measurement) -> state``, ``step(state, measurement) -> (commands, log, state)``. It sees what a
robot would see: object pose, tip state, contact force. It never raises; what went wrong is in ``state.failure``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

from pushpressslide.core.allocation import Allocation
from pushpressslide.core.control import ControlLog, Measurement, Phase, TipCommand, Vector3
from pushpressslide.core.path import ArcPath, SpeedProfile, advance
from pushpressslide.core.plan import Contact, Plan
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.record import ReasonCode
from pushpressslide.core.wrench import Twist
from pushpressslide.execution.normal_force import NormalForceRegulator, NormalForceState
from pushpressslide.modes import MODES
from pushpressslide.modes.base import Tracker

ALIGN_SPEED = 0.10  # [m/s] of the free tip
TOUCH_SPEED = 0.03  # [m/s] on the last centimetres
TOUCH_SHARE = 0.4  # of the force that would move the object: pressed before the motion begins
SETTLE_TIME = 0.2  # [s] that the touch force must hold
TOUCH_DEPTH = 0.05  # [m] beyond the expected contact at which the object counts as not there
FELT_TIME = 0.03  # [s] of normal force before a touch is believed
LOSS_TIME = 0.12  # [s] without contact force before the tip goes back to touch
SLID = 2.5e-3  # [m] along the face, after which the path is planned anew for the contact where it is
SLID_ROOM = 0.03  # [m] of path that must be left for that
SLID_PAUSE = 0.5  # [s] between two such re-plans
RETREAT = 0.06  # [m] drawn back on release
CATCH_UP = 1.5  # [1/s] pull of the time reference on the progress
FLOOR_SPEED = 0.006  # [m/s] least speed while the goal is not reached
STOP = 2e-4  # [m] of path left at which the motion ends
FREE_STIFFNESS = (1500.0, 1500.0, 3000.0)  # [N/m] of a tip that touches nothing
FREE_DAMPING = (150.0, 150.0, 250.0)  # [N s/m]
HEIGHT_STIFFNESS, HEIGHT_DAMPING = 3000.0, 250.0  # [N/m], [N s/m] of a pushing tip
SERVO_CAP = 25.0  # [N] by which the servo may exceed the allocated force


@dataclass(frozen=True, slots=True)
class Binding:
    """A plan with its closed-form laws; made anew when the contacts turn out to be elsewhere."""

    plan: Plan
    tracker: Tracker
    allocate: Callable[[float, float, float], Allocation]
    tip_points: tuple[Point, ...]  # [m] in B, of the tips' centres


def bind(plan: Plan) -> Binding:
    """Return the laws of ``plan``'s mode for its contacts."""
    mode, choice = MODES[plan.choice.mode], plan.choice
    tip_points = tuple(
        (c.point[0] - r.tip_radius * c.normal[0], c.point[1] - r.tip_radius * c.normal[1])
        for c, r in zip(choice.contacts, plan.task.robots, strict=True)
    )
    friction, rho = plan.task.believed.contact_friction, choice.parameters.get("rho")
    return Binding(plan, mode.tracker(plan), mode.allocator(choice.contacts, friction, rho), tip_points)


@dataclass(frozen=True, slots=True)
class ControllerState:
    """Everything that the controller remembers between ticks."""

    phase: Phase
    since: float  # [s] start of the phase
    tip_start: tuple[Vector3, ...]  # [m] where the tips were when the phase began
    binding: Binding
    progress: float = 0.0  # [m]
    move_start: float = 0.0  # [s]
    felt: float | None = None  # [s] when contact was first felt in this touch
    lost: float | None = None  # [s] since when contact is missing
    paused: float = 0.0  # [s] of the time reference, while contact was being regained
    touch_base: float = 0.0  # [m] advance of the touch when contact was felt
    regulator: NormalForceState = NormalForceState()
    last_time: float = 0.0
    rebound_at: float = 0.0  # [s] of the last re-plan because of a slid contact
    failure: tuple[ReasonCode, str] | None = None


class Controller:
    """Closed-form control of one plan; hold one per run."""

    def __init__(self, plan: Plan) -> None:
        """Prepare everything that does not change from tick to tick."""
        task = plan.task
        self.plan, self.mode = plan, MODES[plan.choice.mode]
        self.binding = bind(plan)
        self.contacts: tuple[Contact, ...] = plan.choice.contacts
        self.X_GB = task.object.X_GB
        self.X_BG = self.X_GB.inverse()
        self.touch_force = max(0.6, TOUCH_SHARE * plan.choice.parameters["push_force"])
        self.threshold = max(0.25, 4.0 * task.sensing.force_noise)
        motion = task.motion
        self.damping = motion.servo_damping if motion.velocity_servo else 0.0
        self.force_gain = motion.force_gain or (1.0 if motion.velocity_servo else 1.05)
        self.regulator = NormalForceRegulator(f_max=task.limits.normal_force)
        self.ticks = (0.0, 0.0)  # wall time of the last track and allocate, for the record only

    def init(self, measurement: Measurement) -> ControllerState:
        """Return the state at the start of the touch."""
        tips = tuple(tip.position for tip in measurement.tips)
        return ControllerState(
            "touch", measurement.time, tips, self.binding, last_time=measurement.time
        )

    def step(
        self, state: ControllerState, measurement: Measurement
    ) -> tuple[tuple[TipCommand, ...], ControlLog, ControllerState]:
        """Return one command per tip, what was thought, and the next state."""
        X_WB = measurement.object_pose.compose(self.X_GB)
        if state.phase == "touch":
            return self._touch(state, measurement, X_WB)
        if state.phase == "move":
            return self._move(state, measurement, X_WB)
        return self._release(state, measurement, X_WB)

    # -- touch ---------------------------------------------------------------------------------------------------------

    def _touch(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> tuple[tuple[TipCommand, ...], ControlLog, ControllerState]:
        dt = measurement.time - state.last_time
        elapsed = measurement.time - state.since
        gap = self.plan.task.motion.approach_distance
        commands: list[TipCommand] = []
        felt, regulator, base, failure = state.felt, state.regulator, state.touch_base, state.failure
        tip, contact, inside = measurement.tips[0], self.contacts[0], self.binding.tip_points[0]
        n = X_WB.rotate(contact.normal)
        before = (inside[0] - gap * contact.normal[0], inside[1] - gap * contact.normal[1])
        target = X_WB.apply(before)
        start = state.tip_start[0]
        way = math.dist((*target, contact.height), start)
        align_time = 0.0 if state.move_start > 0.0 else 1.875 * way / ALIGN_SPEED + 0.1
        force: Vector3 = (0.0, 0.0, 0.0)
        velocity: Vector3 = (0.0, 0.0, 0.0)
        stiffness, damping = FREE_STIFFNESS, FREE_DAMPING
        normal_force = tip.force[0] * n[0] + tip.force[1] * n[1]
        if elapsed < align_time:
            u = _smooth(elapsed / align_time)
            position = (
                start[0] + u * (target[0] - start[0]),
                start[1] + u * (target[1] - start[1]),
                start[2] + u * (contact.height - start[2]),
            )
        else:
            # advance along the face's normal; from a regained touch, from wherever the tip is
            depth = TOUCH_SPEED * (elapsed - align_time)
            if state.move_start > 0.0:
                along = (start[0] - target[0]) * n[0] + (start[1] - target[1]) * n[1]
                depth += min(max(along, 0.0), gap)
            if normal_force > self.threshold:
                felt, base = (measurement.time, depth) if felt is None else (felt, base)
            elif felt is not None and measurement.time - felt < FELT_TIME:
                felt = None  # a knock, not the object
            sure = felt is not None and measurement.time - felt >= FELT_TIME
            if sure:
                depth = base
            elif depth > gap + TOUCH_DEPTH:
                failure = ("contact_lost", f"no contact felt {TOUCH_DEPTH * 1e3:.0f} mm beyond the expected face")
            else:
                velocity = (TOUCH_SPEED * n[0], TOUCH_SPEED * n[1], 0.0)
            position = (target[0] + depth * n[0], target[1] + depth * n[1], contact.height)
            if sure:
                push, regulator = self.regulator.step(regulator, self.touch_force, normal_force, dt)
                force = (push * n[0], push * n[1], 0.0)
                stiffness = (0.0, FREE_STIFFNESS[1], FREE_STIFFNESS[2])
        # the tool turns to the object's yaw while it lines up
        planned = state.binding.plan.object_pose(state.progress).yaw
        turned = _smooth(elapsed / align_time) if align_time > 0.0 else 1.0
        tool_yaw = planned + turned * wrap_angle(measurement.object_pose.yaw - planned)
        commands.append(
            TipCommand(
                force, position, velocity, stiffness, damping, math.atan2(n[1], n[0]), tool_yaw, 0.0, SERVO_CAP,
                state.progress,
            )
        )  # fmt: skip
        phase, since, move_start, binding = state.phase, state.since, state.move_start, state.binding
        paused, progress = state.paused, state.progress
        if failure is not None:
            phase, since = "release", measurement.time
        elif felt is not None and measurement.time - felt > SETTLE_TIME + self.touch_force / self.regulator.ramp:
            phase, since = "move", measurement.time
            replanned = self.mode.replan(binding.plan, X_WB, self._touched(measurement, X_WB))
            if replanned is not None:
                binding, progress, move_start, paused = bind(replanned), 0.0, measurement.time, 0.0
            elif move_start == 0.0:
                move_start = measurement.time
            else:
                paused += measurement.time - (state.lost or measurement.time)
        starts = state.tip_start if phase == state.phase else tuple(t.position for t in measurement.tips)
        log = self._log(state, measurement, X_WB)
        return tuple(commands), log, ControllerState(
            phase, since, starts, binding, progress, move_start, felt if phase == "touch" else None,
            state.lost if phase == "touch" else None, paused, base, regulator, measurement.time, state.rebound_at, failure,
        )  # fmt: skip

    def _touched(self, measurement: Measurement, X_WB: Pose2) -> tuple[Point, ...]:
        """Where the tips touch, in B [m], by their own kinematics."""
        out = []
        for tip, contact, robot in zip(measurement.tips, self.contacts, self.plan.task.robots, strict=True):
            p = X_WB.unapply((tip.position[0], tip.position[1]))
            out.append((p[0] + robot.tip_radius * contact.normal[0], p[1] + robot.tip_radius * contact.normal[1]))
        return tuple(out)

    # -- move ----------------------------------------------------------------------------------------------------------

    def _move(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> tuple[tuple[TipCommand, ...], ControlLog, ControllerState]:
        binding = state.binding
        path, profile = binding.plan.path, binding.plan.profile
        clock = measurement.time - state.move_start - state.paused
        wanted_progress, wanted_speed = profile.at(clock)
        left = path.length - state.progress
        speed = wanted_speed + CATCH_UP * (wanted_progress - state.progress)
        speed = min(max(speed, FLOOR_SPEED), 1.5 * profile.speed, FLOOR_SPEED + math.sqrt(profile.acceleration * max(left, 0.0)))
        started = perf_counter()
        guidance = binding.tracker.step(path, X_WB, state.progress, speed)
        tracked = perf_counter()
        wrench = guidance.wrench
        allocation = binding.allocate(wrench.fx, wrench.fy, wrench.tau)
        self.ticks = (tracked - started, perf_counter() - tracked)

        commands = []
        touching = True
        for tip, contact, inside, f_B in zip(
            measurement.tips, self.contacts, binding.tip_points, allocation.forces, strict=True
        ):
            n = X_WB.rotate(contact.normal)
            touching = touching and tip.force[0] * n[0] + tip.force[1] * n[1] > 0.5 * self.threshold
            f = X_WB.rotate((self.force_gain * f_B[0], self.force_gain * f_B[1]))
            at_tip: Twist = guidance.twist.moved_to(inside)
            v = X_WB.rotate((at_tip.vx, at_tip.vy))
            commands.append(
                TipCommand(
                    (f[0], f[1], 0.0), (tip.position[0], tip.position[1], contact.height), (v[0], v[1], 0.0),
                    (0.0, 0.0, HEIGHT_STIFFNESS), (self.damping, self.damping, HEIGHT_DAMPING),
                    math.atan2(n[1], n[0]), measurement.object_pose.yaw, guidance.twist.w, SERVO_CAP, guidance.progress,
                )
            )  # fmt: skip
        rebound = self._rebound(state, measurement, X_WB, left)
        if rebound is not None:
            log = self._log(state, measurement, X_WB, guidance.error, guidance.steering, wrench, allocation)
            return tuple(commands), log, rebound
        lost = None if touching else (state.lost if state.lost is not None else measurement.time)
        phase, since = state.phase, state.since
        if guidance.progress >= path.length - STOP:
            phase, since = "release", measurement.time
        elif lost is not None and measurement.time - lost > LOSS_TIME:
            phase, since = "touch", measurement.time
        starts = state.tip_start if phase == "move" else tuple(t.position for t in measurement.tips)
        log = self._log(state, measurement, X_WB, guidance.error, guidance.steering, wrench, allocation)
        return tuple(commands), log, ControllerState(
            phase, since, starts, binding, guidance.progress, state.move_start, None, lost, state.paused,
            0.0, NormalForceState(), measurement.time, state.rebound_at, state.failure,
        )  # fmt: skip

    def _rebound(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2, left: float
    ) -> ControllerState | None:
        """The state with a new plan from here, where a contact has slid along its face; None where all is well."""
        plan = state.binding.plan
        touched = self._touched(measurement, X_WB)
        slid = max(math.dist(p, c.point) for p, c in zip(touched, plan.choice.contacts, strict=True))
        if slid < SLID or left < SLID_ROOM or measurement.time - state.rebound_at < SLID_PAUSE:
            return None
        # the new contact keeps to the face's line: the tip's own measured depth is not a slide
        points = []
        for p, c in zip(touched, plan.choice.contacts, strict=True):
            across = (p[0] - c.point[0]) * -c.normal[1] + (p[1] - c.point[1]) * c.normal[0]
            points.append((c.point[0] - across * c.normal[1], c.point[1] + across * c.normal[0]))
        replanned = self.mode.replan(plan, X_WB, tuple(points))
        if replanned is None:
            return None
        # go on at speed: the new path begins with the way on which the profile would have reached it
        profile, start = plan.profile, replanned.path.start
        v = profile.speed
        ramp = 0.5 * v * v / profile.acceleration
        path = ArcPath(advance(start, 0.0, -ramp), ((0.0, ramp), *replanned.path.pieces))
        profile = SpeedProfile(path.length, v, profile.acceleration)
        moving = replace(replanned, path=path, profile=profile)
        return ControllerState(
            "move", state.since, state.tip_start, bind(moving), ramp, measurement.time - v / profile.acceleration,
            last_time=measurement.time, rebound_at=measurement.time, failure=state.failure,
        )  # fmt: skip

    # -- release -------------------------------------------------------------------------------------------------------

    def _release(
        self, state: ControllerState, measurement: Measurement, X_WB: Pose2
    ) -> tuple[tuple[TipCommand, ...], ControlLog, ControllerState]:
        duration = 1.875 * RETREAT / ALIGN_SPEED + 0.3
        elapsed = measurement.time - state.since
        back = RETREAT * _smooth(elapsed / (duration - 0.3))
        commands = []
        for start, contact in zip(state.tip_start, self.contacts, strict=True):
            n = X_WB.rotate(contact.normal)
            commands.append(
                TipCommand(
                    (0.0, 0.0, 0.0), (start[0] - back * n[0], start[1] - back * n[1], contact.height), (0.0, 0.0, 0.0),
                    FREE_STIFFNESS, FREE_DAMPING, math.atan2(n[1], n[0]), measurement.object_pose.yaw, 0.0,
                    SERVO_CAP, state.progress,
                )
            )  # fmt: skip
        phase: Phase = "done" if elapsed > duration else state.phase
        log = self._log(state, measurement, X_WB)
        return tuple(commands), log, ControllerState(
            phase, state.since, state.tip_start, state.binding, state.progress, state.move_start, None, None, state.paused,
            0.0, NormalForceState(), measurement.time, state.rebound_at, state.failure,
        )  # fmt: skip

    def _log(self, state: ControllerState, measurement: Measurement, X_WB: Pose2, error=None, steering=0.0, wrench=None, allocation=None):  # noqa: E501
        clock = measurement.time - state.move_start - state.paused if state.move_start > 0.0 else 0.0
        plan = state.binding.plan
        reference = plan.object_pose(plan.profile.at(clock)[0])
        wanted = (wrench.fx, wrench.fy, wrench.tau) if wrench is not None else (0.0, 0.0, 0.0)
        given, status = wanted, "ok"
        if allocation is not None:
            given = tuple(a - b for a, b in zip(wanted, allocation.residual, strict=True))
            status = allocation.status
        return ControlLog(
            state.phase, state.progress, Pose2(reference.x, reference.y, wrap_angle(reference.yaw)),
            error or (0.0, 0.0, 0.0), wanted, given, steering, status,
        )  # fmt: skip


def _smooth(u: float) -> float:
    """Minimum-jerk ramp from 0 to 1."""
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))
