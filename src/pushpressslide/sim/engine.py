"""Runs a plan in Drake: reads the station's ports, steps the controller, writes joint
torques, records everything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from time import perf_counter
from typing import Any

import numpy as np

from pushpressslide.control.controller import Commands, Controller
from pushpressslide.control.recording import Recorder
from pushpressslide.control.sensing import Sensor
from pushpressslide.control.state import ControllerState
from pushpressslide.core.arrays import Array
from pushpressslide.core.control import ControlLog, Measurement, TipState
from pushpressslide.core.plan import JointPath, Plan
from pushpressslide.core.record import ReasonCode, Record
from pushpressslide.execution.arm import ArmExecutor, ArmState
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.sim.arm_model import ArmModel
from pushpressslide.sim.convert import planar_pose_from_positions, planar_twist
from pushpressslide.sim.joints.approach import led_in
from pushpressslide.sim.joints.joint_path import ArmPath
from pushpressslide.sim.joints.placements import all_joint_paths
from pushpressslide.sim.station import Station

FORCE_OVERRUN = 1.5  # times limits.normal_force, for FORCE_TIME, ends the run
FORCE_TIME = 0.05  # [s]
SETTLE = 0.2  # [s] that an arm rests at the end of its way to the object
FAR = 2.0  # [m] from start or goal: the simulation has diverged
NO_LOG_ERROR = (0.0, 0.0, 0.0)


class _Arm:
    """One arm at run time: its model, executor, joint path, and where its numbers are
    in the plant's state.
    """

    def __init__(self, plan: Plan, index: int, station: Station, models: str) -> None:
        self.model = ArmModel(plan.task.robots[index], models=models)
        self.facts = facts = self.model.instance.facts
        self.instance = station.scene.robots[index].model_instance
        plant = station.plant
        joints = [plant.get_joint(j) for j in plant.GetJointIndices(self.instance)]
        moving = [joint for joint in joints if joint.num_positions() == 1]
        self.q_at = np.array([joint.position_start() for joint in moving])
        self.v_at = plant.num_positions() + np.array(
            [joint.velocity_start() for joint in moving]
        )
        self.limits = (facts.effort_limit, facts.torque_rate_limit)
        self.radius = plan.task.robots[index].tip_radius
        self.torque: Array | None = None
        self.share = 0.0
        self.state: ArmState | None = None

    def take(self, plan: Plan, path: JointPath, attitude: ToolAttitude) -> None:
        """Follow ``path`` with the tool held as in ``attitude`` from now on."""
        motion = plan.task.motion
        self.executor = ArmExecutor(
            *self.limits,
            attitude.rotation_at,
            path.tool_yaw_offset,
            motion.joint_stiffness if motion.joint_tracking else 0.0,
            motion.control_period,
            plan.task.support.frame,
        )
        self.path = path

    def approach(self, t: float) -> tuple[Array, Array]:
        """Joint reference and its velocity at time ``t`` of the approach."""
        times = self.path.approach_time
        q = self.path.approach
        i = int(np.clip(np.searchsorted(times, t) - 1, 0, len(times) - 2))
        span = times[i + 1] - times[i]
        u = min(max((t - times[i]) / span, 0.0), 1.0)
        rate = (q[i + 1] - q[i]) / span if t < times[-1] else np.zeros(q.shape[1])
        return q[i] + u * (q[i + 1] - q[i]), rate

    def along(self, s: float) -> Array:
        """Joint reference at arc length ``s`` of the path."""
        grid = self.path.arc_length
        q = self.path.move
        if grid[-1] <= 0.0:  # the goal is the start
            return q[0]
        i = int(np.clip(np.searchsorted(grid, s) - 1, 0, len(grid) - 2))
        u = min(max((s - grid[i]) / (grid[i + 1] - grid[i]), 0.0), 1.0)
        return q[i] + u * (q[i + 1] - q[i])


def run(
    plan: Plan,
    *,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
    models: str = "generated",
    time_step: float | None = None,
    paths: Sequence[tuple[ArmPath, ...]] | None = None,
    stop: Callable[[], bool] = bool,
    live: Callable[[str], None] | None = None,
    disturb: Callable[[float, Commands], Commands] | None = None,
) -> Record:
    """Run ``plan`` in the hydroelastic simulation and return its record; deterministic
    for a seed on one kind of machine.

    Raises InfeasibleTaskError before anything moves where an arm has no joint path.
    ``paths`` gives those of each grasp, made before; ``stop`` is asked at every tick
    whether to end the run (reason "interrupted"). ``live`` is told the address of a
    page that shows the run, in real time, while it goes on. ``disturb`` changes the
    controller's commands at a time [s] on their way to the arms, to try what happens
    when they fail.
    """
    task = plan.part(plan.segments[0])
    dt = task.motion.control_period
    frame = task.support.frame
    physics_step = time_step or task.motion.time_step
    if paths is None:
        paths = all_joint_paths(plan)
    view = None
    if live is not None:
        from pushpressslide.sim.view.live import LiveView

        view = LiveView(plan, live)
    station = Station(plan, models=models, time_step=physics_step, view=view)
    arms = [_Arm(plan, i, station, models) for i in range(len(task.robots))]
    for i, arm in enumerate(arms):
        arm.take(plan, *paths[0][i])
        station.plant.SetPositions(
            station.plant_context, arm.instance, arm.path.approach[0]
        )
    start_tips = [
        arm.model.state(arm.path.approach[-1], np.zeros(arm.model.size)).position
        for arm in arms
    ]
    controller = _controller(plan, 0, paths[0])
    sensor = Sensor(task.sensing, seed, dt)
    recorder = Recorder(plan)
    (grasp, _), *ahead = zip(plan.by_placement, paths, strict=True)
    number = 0
    kept: Commands = (None,) * len(arms)
    began = 0.0
    reached = _arrival(arms)
    approach_time = reached
    expected = sum(stretch.profile.duration for stretch in plan.segments) + 4.0 * len(
        plan.by_placement
    )
    expected += sum(
        max(float(path.approach_time[-1]) for path, _ in of) for of in paths
    )
    plant = station.plant
    object_q = station.scene.object.floating_positions_start()
    object_v = (
        station.scene.object.floating_velocities_start_in_v() + plant.num_positions()
    )
    bodies = {
        name: body.floating_positions_start()
        for name, body in station.scene.bodies.items()
    }
    state: ControllerState | None = None
    reason: tuple[ReasonCode, str] = (
        "time_limit",
        f"limits.time of {task.limits.time:g} s is over",
    )
    overrun = 0.0
    station.simulator.Initialize()
    started = perf_counter()
    ticks = 0
    while True:
        time = ticks * dt
        if time >= task.limits.time:
            break
        tick = perf_counter()
        x = station.state_vector()
        pose = planar_pose_from_positions(x[object_q : object_q + 7], frame)
        forces = [frame.components(station.contact_force(i)) for i in range(len(arms))]
        executing = perf_counter()
        tips = []
        for arm, force in zip(arms, forces, strict=True):
            arm.state = arm.model.state(x[arm.q_at], x[arm.v_at])
            place = frame.coordinates(arm.state.position)
            velocity = frame.components(arm.state.velocity)
            tips.append(TipState(place, velocity, force))
        executed = perf_counter() - executing
        commands: Commands
        followed = state.reference if state is not None else None
        references = []
        if time < reached:
            commands = kept
            log = _waiting(grasp)
            executing = perf_counter()
            for arm, command in zip(arms, kept, strict=True):
                assert arm.state is not None
                q_ref, v_ref = arm.approach(time - began)
                if command is None:
                    arm.torque, arm.share = arm.executor.free(
                        arm.state, q_ref, v_ref, arm.torque
                    )
                else:
                    arm.torque, arm.share = arm.executor.contact(
                        arm.state, command, q_ref, arm.torque
                    )
                references.append(q_ref)
        else:
            measurement = sensor.measure(Measurement(time, pose, tuple(tips)))
            if state is None:
                state = controller.init(measurement, kept)
            given, log, state = controller.step(state, measurement)
            commands = given
            executing = perf_counter()
            if disturb is not None:
                given = disturb(time, given)
            for arm, command in zip(arms, given, strict=True):
                assert arm.state is not None
                if command is None:
                    q_ref = arm.along(0.0)
                    arm.torque, arm.share = arm.executor.free(
                        arm.state, q_ref, np.zeros_like(q_ref), arm.torque
                    )
                else:
                    q_ref = arm.along(command.progress)
                    arm.torque, arm.share = arm.executor.contact(
                        arm.state, command, q_ref, arm.torque
                    )
                references.append(q_ref)
        for i, arm in enumerate(arms):
            assert arm.torque is not None
            station.set_torque(i, arm.torque)
        executed += perf_counter() - executing
        total = perf_counter() - tick
        recorder.add(
            time=time,
            log=log,
            true_pose=pose,
            twist=planar_twist(x[object_v : object_v + 6], frame),
            commands=commands,
            tips=[t.position for t in tips],
            forces=forces,
            ticks=(
                *(state.ticks if state is not None else (0.0, 0.0)),
                executed,
                total,
            ),
            more=_rows(x, object_q, arms, references, tips, bodies),
            followed=followed,
        )
        if (
            state is not None
            and state.phase == "done"
            and ahead
            and state.failure is None
        ):
            kept = tuple(
                c if i in controller.lasting else None for i, c in enumerate(commands)
            )
            (grasp, taken), *ahead = ahead
            following, attitudes = zip(*taken, strict=True)
            led = led_in(
                following, [arm.facts for arm in arms], [x[arm.q_at] for arm in arms]
            )
            for arm, path, attitude in zip(arms, led, attitudes, strict=True):
                arm.take(grasp, path, attitude)
            number += 1
            controller = _controller(plan, number, taken)
            state = None
            began = time
            reached = time + _arrival(arms)
            recorder.begin(number)
        if state is not None and state.phase == "done":
            reason = state.failure or ("goal_reached", "")
            break
        largest = max(math.hypot(*f) for f in forces)
        over = largest > FORCE_OVERRUN * task.limits.normal_force and state is not None
        overrun = overrun + dt if over else 0.0
        if overrun > FORCE_TIME:
            reason = (
                "force_limit",
                f"{largest:.1f} N measured, limits.normal_force is "
                f"{task.limits.normal_force:g} N",
            )
            break
        if (
            not np.isfinite(x).all()
            or math.hypot(pose.x - task.start.x, pose.y - task.start.y) > FAR
        ):
            reason = ("diverged", f"the object is at ({pose.x:.2f}, {pose.y:.2f})")
            break
        if stop():
            reason = ("interrupted", f"stopped by the user at {time:.1f} s")
            break
        ticks += 1
        try:
            station.simulator.AdvanceTo(ticks * dt)
        except RuntimeError as error:
            reason = ("diverged", str(error).splitlines()[0])
            break
        if progress is not None and ticks % 25 == 0:
            progress(time, expected)
    every = [path for of in paths for path, _ in of]
    meta: dict[str, Any] = {
        "time_step": physics_step,
        "control_period": dt,
        "joint_margin_planned": min(path.joint_margin for path in every),
        "condition_planned": max(path.condition for path in every),
        "clearance_planned": min(path.clearance for path in every),
        "approach_time": approach_time,
        "models": models,
        "start_tips": start_tips,
    }
    return recorder.record(reason, "drake", seed, perf_counter() - started, meta)


def _controller(plan: Plan, number: int, paths: Sequence[ArmPath]) -> Controller:
    """The controller of a placement, with the gap that the arms' ways really leave."""
    motion = plan.part(plan.placements[number][0]).motion
    gap = min(motion.approach_distance, *(path.gap for path, _ in paths))
    return Controller(plan, number, gap)


def _arrival(arms: list[_Arm]) -> float:
    """How long it takes [s] until all arms are where the touch begins."""
    return max(float(arm.path.approach_time[-1]) for arm in arms) + SETTLE


def _waiting(plan: Plan) -> ControlLog:
    """The log of a tick on the way to the object."""
    return ControlLog(
        "approach",
        0.0,
        plan.task.start,
        NO_LOG_ERROR,
        NO_LOG_ERROR,
        NO_LOG_ERROR,
        0.0,
        "ok",
    )


def _rows(
    x: Array,
    object_q: int,
    arms: list[_Arm],
    references: list[Array],
    tips: list[TipState],
    bodies: dict[str, int],
) -> dict[str, Any]:
    """What only this engine records of a tick."""
    rows: dict[str, Any] = {"object_pose_3d": x[object_q : object_q + 7].copy()}
    points = []
    for i, (arm, q_ref, tip) in enumerate(zip(arms, references, tips, strict=True)):
        state = arm.state
        assert state is not None
        rows[f"joint_position_{i}"], rows[f"joint_velocity_{i}"] = state.q, state.v
        rows[f"joint_torque_{i}"], rows[f"joint_reference_{i}"] = arm.torque, q_ref
        rows[f"torque_share_{i}"] = arm.share
        size = math.hypot(*tip.force)
        if size > 0.3:
            points.append(
                [
                    p + arm.radius * f / size
                    for p, f in zip(tip.position, tip.force, strict=True)
                ]
            )
        else:
            points.append([math.nan] * 3)
    rows["contact_point"] = points
    for name, at in bodies.items():
        rows[f"body_{name}"] = x[at : at + 7].copy()
    return rows
