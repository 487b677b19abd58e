"""The rear push's control tick compared with model-predictive control of the same push.

All controllers share one plant: a quasi-static object on an ellipsoidal limit surface,
pushed by a point with a given velocity, which sticks, slips or leaves the object. Each
controller receives the object's pose and returns the pusher's velocity. The predictive
controllers solve for the contact forces over a horizon: by IPOPT until convergence,
warm-started from the previous solution, or by a single Gauss-Newton step with HPIPM
(Diehl, Bock and Schloeder, "A real-time iteration scheme for nonlinear optimization in
optimal feedback control", SIAM J. Control Optim. 43, 2005). The model of the contact
forces is that of Hogan and Rodriguez, "Feedback control of the pusher-slider system",
WAFR 2016.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, Literal, NamedTuple

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import MotionPath, Segment
from pushpressslide.core.pose import Point, Pose2, wrap_angle
from pushpressslide.core.task import Task
from pushpressslide.core.twist_path import integrate
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface
from pushpressslide.rom.drives import RearSteerDrive
from pushpressslide_studies.bench.compared import Row, measured, missing, not_installed

TASKS = ("rear-push-rear", "rear-push-left")
PERIOD = 0.02  # [s] of control
SPEED = 0.05  # [m/s] along the path
STEPS = 15  # of the horizon
STEP = 0.08  # [s] of one of them
PUSHED_BY = (0.002, 0.03)  # [m], [rad] that the object is off its path at first
# what weighs as much as what in the horizon's cost
POSITION = 0.003  # [m]
YAW = 0.05  # [rad]
FORCE = 0.02  # [m/s] of the force's size, which is a velocity here
FINE = 0.0005  # [m] between the poses of a path that are looked at
LONGEST = 1.5  # times the path that a push may take
OFF = 0.25  # of rho and friction, that the plant differs from what is believed
ABSENT = not_installed("pushpressslide-studies[bench]")

Controller = Callable[[Pose2, float], Point | None]
"""Function from X_WB and the reference's path length so far [m] to the pusher's
velocity [m/s] in B. It returns None at the end.
"""
Kind = Literal["ipopt", "real_time"]


class World(NamedTuple):
    """True parameters of a push."""

    rho: float  # [m]
    friction: float


@dataclass(frozen=True)
class Push:
    """One push: its path and its contact."""

    task: Task
    segment: Segment

    @property
    def believed_world(self) -> World:
        """Parameters that the controllers assume."""
        rho = self.segment.drive.rho
        assert rho is not None  # of a push
        return World(rho, self.task.scene.contact_friction)

    @property
    def contact(self) -> Point:
        """The contact's point in B [m]."""
        return self.segment.contacts[0].point

    @property
    def normal(self) -> Point:
        """The contact's inward normal in B."""
        return self.segment.contacts[0].normal

    def body_pose(self, s: float) -> Pose2:
        """X_WB at the path length ``s`` [m]. The path is extended straight beyond its
        end.
        """
        path: MotionPath = self.segment.path
        end = min(s, path.length)
        pose = path.pose(end).compose(Pose2(s - end, 0.0, 0.0))
        return pose.compose(self.segment.X_BV.inverse())


class Closed(NamedTuple):
    """Result of a push under one controller."""

    times: list[float]  # [s] of each tick
    worst: float  # [m] farthest off the path, after the first tenth of it
    position: float  # [m] off in the end
    yaw: float  # [rad] off in the end


def mpc() -> list[Row]:
    """A row for each task, truth and controller: the time of a tick, its ratio to the
    closed forms, and the object's deviation from its path.
    """
    rows: list[Row] = []
    for name in TASKS:
        push = _push(name)
        true = push.believed_world
        worlds = {
            "as believed": true,
            "rho 25 % larger": World(true.rho * (1.0 + OFF), true.friction),
            "friction 25 % less": World(true.rho, true.friction * (1.0 - OFF)),
        }
        for truth, world in worlds.items():
            rows += _compared(f"{name}, {truth}", push, world)
    return rows


def _compared(what: str, push: Push, world: World) -> list[Row]:
    """Rows of one push under each controller."""
    makers: dict[str, Callable[[], Controller]] = {
        "closed form": lambda: closed_form(push),
        "MPC, IPOPT warm": lambda: predictive(push, "ipopt"),
        "MPC, one step, HPIPM": lambda: predictive(push, "real_time"),
    }
    rows: list[Row] = []
    first: float | None = None
    for name, make in makers.items():
        try:
            found = controlled(push, world, make())
        except ModuleNotFoundError:
            rows.append(missing(f"{what}: {name}", ABSENT))
            continue
        median = float(np.median(found.times))
        first = first or median
        figures = {
            "p99_us": 1e6 * float(np.percentile(found.times, 99)),
            "off_path_mm": 1e3 * found.worst,
            "end_mm": 1e3 * found.position,
            "end_deg": math.degrees(found.yaw),
        }
        rows.append(measured(f"{what}: {name}", median, first, **figures))
    return rows


def _push(name: str) -> Push:
    """Push of a shipped task along the support.

    The plant is planar. Unlike in the task's own plan, the height of the contact
    therefore does not displace the virtual axle.
    """
    from pushpressslide.selection.solve import plan
    from pushpressslide.taskfile.load import load_task

    task = load_task(name)
    (segment,) = plan(task).segments
    drive = segment.drive
    assert isinstance(drive, RearSteerDrive)
    return Push(task, replace(segment, drive=replace(drive, shift=0.0)))


def controlled(push: Push, world: World, control: Controller) -> Closed:
    """Result of a push in ``world`` under a controller."""
    path: MotionPath = push.segment.path
    surface = EllipsoidLimitSurface(1.0, world.rho)
    nx, ny = push.normal
    contact = push.contact
    off, turned = PUSHED_BY
    X = push.body_pose(0.0).compose(Pose2(0.0, off, turned))
    along = [push.body_pose(s) for s in np.arange(0.0, path.length, FINE)]
    route = np.array([pose.position for pose in along])
    done = 0.0
    times = []
    worst = 0.0
    while done < LONGEST * path.length:
        began = perf_counter()
        velocity = control(X, done)
        if velocity is None:
            break
        times.append(perf_counter() - began)
        outcome = push_outcome(surface, contact, push.normal, world.friction, velocity)
        twist = outcome.twist
        X = integrate(X, (twist.vx, twist.vy, twist.w), PERIOD)
        slip = outcome.slip_velocity * PERIOD
        contact = (contact[0] - ny * slip, contact[1] + nx * slip)
        done += SPEED * PERIOD
        if done > 0.1 * path.length:
            off_way = np.hypot(*(route - X.position).T).min()
            worst = max(worst, float(off_way))
    wanted = push.body_pose(path.length)
    away = math.dist(X.position, wanted.position)
    return Closed(times, worst, away, abs(wrap_angle(X.yaw - wanted.yaw)))


def closed_form(push: Push) -> Controller:
    """Controller with the closed-form tracking law and allocator of a run."""
    from pushpressslide.modes import MODES

    segment = push.segment
    mode = MODES[segment.mode]
    tracker = mode.tracker(push.task.query, segment)
    allocate = mode.allocator_of(segment, push.believed_world.friction)
    progress = 0.0

    def control(X: Pose2, done: float) -> Point | None:
        nonlocal progress
        if progress >= segment.path.length - FINE:
            return None
        guidance = tracker.step(segment.path, X, progress, SPEED, 1.0)
        progress = guidance.progress
        allocate(guidance.fx, guidance.fy, guidance.tau)
        at_contact = guidance.twist.moved_to(push.contact)
        return at_contact.vx, at_contact.vy

    return control


def predictive(push: Push, kind: Kind) -> Controller:
    """A model-predictive controller. Raises ModuleNotFoundError without CasADi."""
    problem = _Horizon(push, kind)

    def control(X: Pose2, done: float) -> Point | None:
        if done >= push.segment.path.length:
            return None
        return problem.velocity(X, done)

    return control


class _Horizon:
    """The optimal-control problem over one horizon, with alternating states (x, y, yaw)
    and forces (normal, tangential).
    """

    def __init__(self, push: Push, kind: Kind) -> None:
        self.push = push
        ca = importlib.import_module("casadi")
        states = [ca.MX.sym(f"x{k}", 3) for k in range(STEPS + 1)]
        forces = [ca.MX.sym(f"u{k}", 2) for k in range(STEPS)]
        wanted = ca.MX.sym("wanted", 3, STEPS + 1)
        cost = 0.0
        rows = []
        lower: list[float] = []
        upper: list[float] = []
        friction = push.believed_world.friction
        for k, force in enumerate(forces):
            rows.append(self._after(ca, states[k], force) - states[k + 1])
            rows.append(friction * force[0] - force[1])
            rows.append(friction * force[0] + force[1])
            lower += [0.0] * 5
            upper += [0.0, 0.0, 0.0, math.inf, math.inf]
            cost += ca.sumsqr((force - ca.DM([SPEED, 0.0])) / FORCE)
        scale = ca.DM([POSITION, POSITION, YAW])
        for k, state in enumerate(states):
            cost += ca.sumsqr((state - wanted[:, k]) / scale)
        order = [v for pair in zip(states, forces, strict=False) for v in pair]
        variables = ca.vertcat(*order, states[-1])
        program = {
            "x": variables,
            "p": ca.vec(wanted),
            "f": cost,
            "g": ca.vertcat(*rows),
        }
        self._solver = _solver(ca, program, kind)
        self._bounds = {"lbg": lower, "ubg": upper}
        self._free = np.full(variables.shape[0], math.inf)
        self._guess: Array | None = None
        self._multipliers: Any = 0.0

    def _after(self, ca: Any, state: Any, force: Any) -> Any:
        """State after a step, by the midpoint rule."""
        half = state + 0.5 * STEP * self._rate(ca, state, force)
        return state + STEP * self._rate(ca, half, force)

    def _rate(self, ca: Any, state: Any, force: Any) -> Any:
        """Rate of a state under a contact force.

        Forces are scaled so that their size is the velocity that they cause.
        """
        nx, ny = self.push.normal
        cx, cy = self.push.contact
        fx = force[0] * nx - force[1] * ny
        fy = force[0] * ny + force[1] * nx
        c = ca.cos(state[2])
        s = ca.sin(state[2])
        w = (cx * fy - cy * fx) / self.push.believed_world.rho**2
        return ca.vertcat(c * fx - s * fy, s * fx + c * fy, w)

    def velocity(self, X: Pose2, done: float) -> Point:
        """The pusher's velocity [m/s] in B from the first force of the horizon."""
        ahead = [self.push.body_pose(done + SPEED * STEP * k) for k in range(STEPS + 1)]
        wanted = [(p.x, p.y, X.yaw + wrap_angle(p.yaw - X.yaw)) for p in ahead]
        if self._guess is None:
            pairs = [value for pose in wanted for value in (*pose, SPEED, 0.0)]
            self._guess = np.array(pairs[:-2])
        lower = -self._free
        upper = self._free.copy()
        lower[:3] = upper[:3] = (X.x, X.y, X.yaw)
        found = self._solver(
            x0=self._guess,
            p=np.array(wanted).ravel(),
            lam_g0=self._multipliers,
            lbx=lower,
            ubx=upper,
            **self._bounds,
        )
        self._guess = np.asarray(found["x"]).ravel()
        self._multipliers = found["lam_g"]
        normal, across = self._guess[3:5]
        return self._of_force(float(normal), float(across))

    def _of_force(self, normal: float, across: float) -> Point:
        """The contact's velocity [m/s] in B under a force."""
        nx, ny = self.push.normal
        cx, cy = self.push.contact
        fx = normal * nx - across * ny
        fy = normal * ny + across * nx
        w = (cx * fy - cy * fx) / self.push.believed_world.rho**2
        return fx - w * cy, fy + w * cx


def _solver(ca: Any, program: dict[str, Any], kind: Kind) -> Any:
    """CasADi's solver for a program."""
    quiet = {"print_time": False}
    if kind == "ipopt":
        options = {
            **quiet,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.warm_start_init_point": "yes",
            "ipopt.mu_init": 1e-4,
            "ipopt.tol": 1e-5,
        }
        return ca.nlpsol("horizon", "ipopt", program, options)
    x, p, f = program["x"], program["p"], program["f"]
    factor = ca.MX.sym("factor")
    multipliers = ca.MX.sym("multipliers", program["g"].shape[0])
    hessian = ca.triu(factor * ca.hessian(f, x)[0])  # the cost's alone: Gauss-Newton
    options = {
        **quiet,
        "print_header": False,
        "print_iteration": False,
        "print_status": False,
        "max_iter": 1,
        "max_iter_ls": 0,
        "hess_lag": ca.Function("hessian", [x, p, factor, multipliers], [hessian]),
        "qpsol": "hpipm",
        "qpsol_options": {
            "N": STEPS,
            "nx": [3] * (STEPS + 1),
            "nu": [2] * STEPS + [0],
            "ng": [2] * STEPS + [0],
            "hpipm.iter_max": 50,
            "error_on_fail": False,
        },
    }
    return ca.nlpsol("horizon", "sqpmethod", program, options)
