"""Runs a plan on the quasi-static engine: the same controller, a massless tip, and the limit surface with the
true load.

The truth here is the task's own friction, mass and shape; the controller sees only what a robot would see.
rho follows the direction of the contact force, from the exact surface, and the CoP moves with the force by
the height term.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from time import perf_counter

import numpy as np

from pushpressslide.core.control import Measurement, TipCommand, TipState
from pushpressslide.core.plan import Plan
from pushpressslide.core.pose import Point, Pose2
from pushpressslide.core.record import ReasonCode, Record
from pushpressslide.core.task import Task
from pushpressslide.core.wrench import Twist
from pushpressslide.mechanics.pressure import support_pressure
from pushpressslide.mechanics.virtual_axle import exact_axle_distance
from pushpressslide.pipeline.controller import Controller
from pushpressslide.pipeline.recording import Recorder
from pushpressslide.pipeline.sensing import Sensor
from pushpressslide.planar.pushing import PushOutcome, push_with_compliance

GRAVITY = 9.81
CONTACT_PLAY = 1e-6  # [m] of gap that still counts as touching: what integration leaves
TABLE_POINTS = 25  # force angles at which rho is tabulated


def rho_table(task: Task, contact: Point, height: float) -> Callable[[Point], float]:
    """Return rho [m] as a function of the contact force's direction (in B), from the exact limit surface."""
    lever = math.hypot(*contact)
    e = (-contact[0] / lever, -contact[1] / lever)
    angles = np.linspace(0.0, 0.45 * math.pi, TABLE_POINTS)
    shift = height * task.support.friction
    samples = support_pressure(
        task.object.shape, 1.0, task.object.center_of_mass, (shift * e[0], shift * e[1])
    )
    values = np.array([math.sqrt(lever * exact_axle_distance(samples, contact, float(a))) for a in angles])

    def rho(force: Point) -> float:
        along, across = force[0] * e[0] + force[1] * e[1], e[0] * force[1] - e[1] * force[0]
        return float(np.interp(abs(math.atan2(across, max(along, 1e-9))), angles, values))

    return rho


def run(
    plan: Plan,
    *,
    seed: int = 0,
    progress: Callable[[float, float], None] | None = None,
    stop: Callable[[], bool] = bool,
) -> Record:
    """Run ``plan`` from the task's true start and return its record; deterministic for a seed.

    ``stop`` is asked at every tick whether to end the run (reason "interrupted").
    """
    task = plan.task
    dt = task.motion.control_period
    contact = plan.choice.contacts[0]
    robot = task.robots[0]
    X_GB, X_BG = task.object.X_GB, task.object.X_GB.inverse()
    limit = task.support.friction * task.object.mass * GRAVITY
    rho_of = rho_table(task, contact.point, contact.height)
    X_WB = task.true_start.compose(X_GB)
    start_B = plan.task.start.compose(X_GB)
    gap = robot.tip_radius + task.motion.approach_distance
    tip = start_B.apply(
        (contact.point[0] - gap * contact.normal[0], contact.point[1] - gap * contact.normal[1])
    )
    tip_velocity: Point = (0.0, 0.0)
    force_W: Point = (0.0, 0.0)
    controller, sensor, recorder = Controller(plan), Sensor(task.sensing, seed, dt), Recorder(plan)
    time, started = 0.0, perf_counter()

    def measured() -> Measurement:
        state = TipState((*tip, contact.height), (*tip_velocity, 0.0), (*force_W, 0.0))
        return sensor.measure(Measurement(time, X_WB.compose(X_BG), (state,)))

    measurement = measured()
    state = controller.init(measurement)
    reason: tuple[ReasonCode, str] = ("time_limit", f"limits.time of {task.limits.time:g} s is over")
    last_force_B: Point = (0.0, 0.0)
    while time < task.limits.time:
        tick = perf_counter()
        commands, log, state = controller.step(state, measurement)
        total = perf_counter() - tick
        outcome, touching = _step(
            commands[0], X_WB, tip, contact.point, contact.normal, robot.tip_radius, task.contact_friction,
            rho_of, limit, contact.height, task.object.mass * GRAVITY, last_force_B, dt,
        )  # fmt: skip
        last_force_B = outcome.force
        v_W = X_WB.rotate(outcome.tip_velocity)
        cop = _cop(last_force_B, contact.height, task.object.mass * GRAVITY)
        twist = Twist(outcome.twist.vx, outcome.twist.vy, outcome.twist.w, cop).moved_to((0.0, 0.0))
        twist_W = (*X_WB.rotate((twist.vx, twist.vy)), twist.w)
        force_W = X_WB.rotate(outcome.force) if touching else (0.0, 0.0)
        recorder.add(
            time=time, log=log, true_pose=X_WB.compose(X_BG), twist=twist_W, commands=commands,
            tips=((*tip, contact.height),), forces=((*force_W, 0.0),), ticks=(*controller.ticks, 0.0, total),
        )  # fmt: skip
        X_WB = Pose2(X_WB.x + dt * twist_W[0], X_WB.y + dt * twist_W[1], X_WB.yaw + dt * twist.w)
        tip = (tip[0] + dt * v_W[0], tip[1] + dt * v_W[1])
        tip_velocity = v_W
        time += dt
        measurement = measured()
        if progress is not None:
            progress(time, plan.profile.duration + 6.0)
        if state.phase == "done":
            reason = state.failure or ("goal_reached", "")
            break
        if stop():
            reason = ("interrupted", f"stopped by the user at {time:.1f} s")
            break
    return recorder.record(
        reason, "planar", seed, perf_counter() - started, (plan.choice.mode,), {"time_step": dt}
    )


def _cop(force: Point, height: float, load: float) -> Point:
    return (height * force[0] / load, height * force[1] / load)


def _step(
    command: TipCommand,
    X_WB: Pose2,
    tip: Point,
    contact: Point,
    normal: Point,
    radius: float,
    friction: float,
    rho_of: Callable[[Point], float],
    limit: float,
    height: float,
    load: float,
    last_force: Point,
    dt: float,
) -> tuple[PushOutcome, bool]:
    """Return the outcome of one tick, in B, and whether the tip touches the face."""
    c, s = math.cos(command.normal_yaw), math.sin(command.normal_yaw)
    kn, kt, _ = command.stiffness
    bn, bt, _ = command.damping
    # implicit in the stiffness; a free tip that is neither held nor damped keeps a little drag
    bn, bt = max(bn + kn * dt, 50.0), max(bt + kt * dt, 50.0)
    dx, dy = command.position[0] - tip[0], command.position[1] - tip[1]
    vn = c * command.velocity[0] + s * command.velocity[1]
    vt = -s * command.velocity[0] + c * command.velocity[1]
    fn = kn * (c * dx + s * dy) + command.damping[0] * vn
    ft = kt * (-s * dx + c * dy) + command.damping[1] * vt
    f_W = (command.force[0] + c * fn - s * ft, command.force[1] + s * fn + c * ft)
    f_B, tip_B = X_WB.unrotate(f_W), X_WB.unapply(tip)
    depth = (tip_B[0] - contact[0]) * normal[0] + (tip_B[1] - contact[1]) * normal[1] + radius
    pressing = f_B[0] * normal[0] + f_B[1] * normal[1]
    tangent = (-normal[1], normal[0])
    if depth < -CONTACT_PLAY and depth + dt * pressing / bn < 0.0:
        across = f_B[0] * tangent[0] + f_B[1] * tangent[1]
        v = (
            pressing / bn * normal[0] + across / bt * tangent[0],
            pressing / bn * normal[1] + across / bt * tangent[1],
        )
        return PushOutcome("free", (0.0, 0.0), Twist(0.0, 0.0, 0.0), v), False
    point = (tip_B[0] + radius * normal[0], tip_B[1] + radius * normal[1])
    cop = _cop(last_force, height, load)
    rho = rho_of(last_force if last_force != (0.0, 0.0) else normal)
    outcome = push_with_compliance(
        f_B, (bn, bt), (point[0] - cop[0], point[1] - cop[1]), normal, friction, rho, limit, radius
    )
    return outcome, outcome.status != "free"
