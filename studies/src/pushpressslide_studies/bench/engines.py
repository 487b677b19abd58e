"""One push of a box by a ball in several engines: the wall time per simulated second.

The ball moves straight at a given velocity, off the centre of the face. Batches run
many of these pushes at once, and their time is given per push.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from time import perf_counter
from typing import Any, NamedTuple, TypeVar

import numpy as np

from pushpressslide.batch.fast import installed
from pushpressslide.batch.planar_world import Faces, PlanarWorld, Tips
from pushpressslide.batch.pushed_bodies import PushedBodies
from pushpressslide.batch.support import polygon_support
from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import MissingPackageError
from pushpressslide.geometry.shapes import Box
from pushpressslide.mechanics.face_pressure import face_pressure
from pushpressslide.mechanics.pressure import rectangle_pressure
from pushpressslide.mechanics.rho import rho_fit
from pushpressslide_studies.bench.compared import Row, not_installed, rows_of_runs

SIZE = (0.2, 0.12, 0.06)  # [m]
MASS = 1.0  # [kg]
FRICTION = 0.3  # of the box with its support
TIP_FRICTION = 0.5
RADIUS = 0.015  # [m] of the ball
OFF = 0.02  # [m] beside the face's middle
SPEED = 0.05  # [m/s]
TIME = 1.0  # [s]
STEPS = 250  # of the quasi-static engines
BODIES = 10_000  # in the batch
EXACT_BODIES = 300  # on the exact surface
ROUNDS = 5
PHYSICS_STEP = 0.002  # [s] of MuJoCo and Drake
STIFF = 2_000.0  # [N s/m] of the ball's velocity servo, and of the compliant tip
NO_DRAKE = not_installed("pushpressslide[drake]")
NO_MUJOCO = not_installed("pushpressslide-studies[bench]")
NO_NUMBA = not_installed("pushpressslide[fast]")


State = TypeVar("State")  # of many bodies


class Pushed(NamedTuple):
    """Result of one push."""

    wall_time: float  # [s]
    x: float  # [m]
    y: float  # [m]
    yaw: float  # [rad]


def engines() -> list[Row]:
    """A row for each engine: wall time per simulated second of the push, its ratio to
    the compiled batch, and the final pose of the box.
    """
    makers: dict[str, Callable[[], Pushed | str]] = {
        "batch, compiled": lambda: _batch() if installed() else NO_NUMBA,
        "one by one, closed form": _alone,
        "batch, exact surface, compiled": lambda: _exact() if installed() else NO_NUMBA,
        "planar engine, one by one": _planar,
        "MuJoCo": _mujoco,
        "Drake, hydroelastic": _drake,
    }
    return rows_of_runs(
        makers,
        ROUNDS,
        seconds=lambda push: push.wall_time,
        figures=lambda push, _: {
            "x_mm": 1e3 * push.x,
            "y_mm": 1e3 * push.y,
            "yaw_deg": math.degrees(push.yaw),
        },
    )


def _rho() -> float:
    """Rho [m] of the ellipsoid of the box on its base."""
    length, width, _ = SIZE
    return rho_fit(rectangle_pressure(length, width, MASS * GRAVITY, (0.0, 0.0), 4))


def _stepped(step: Callable[[State], State], state: State) -> tuple[float, State]:
    """Time [s] of all steps from a state, and the final state."""
    step(state)  # compiled at the first use
    began = perf_counter()
    for _ in range(STEPS):
        state = step(state)
    return perf_counter() - began, state


def _batch() -> Pushed:
    half, width, _ = (0.5 * edge for edge in SIZE)
    bodies = PushedBodies(
        (-half, 0.0), (1.0, 0.0), (-width, width), TIP_FRICTION, _rho()
    )
    pushes = bodies.initial_states(np.zeros((BODIES, 3)), OFF)
    velocities = np.broadcast_to((SPEED, 0.0), (BODIES, 2))
    spent, pushes = _stepped(
        lambda before: bodies.advance(before, velocities, TIME / STEPS), pushes
    )
    return Pushed(spent / BODIES, *pushes.poses[0].tolist())


def _alone() -> Pushed:
    from pushpressslide.core.pose import Pose2
    from pushpressslide.core.twist_path import integrate
    from pushpressslide.mechanics.friction import push_outcome
    from pushpressslide.mechanics.limit_surface import EllipsoidLimitSurface

    surface = EllipsoidLimitSurface(1.0, _rho())
    X = Pose2()
    place = OFF
    dt = TIME / STEPS
    began = perf_counter()
    for _ in range(STEPS):
        contact = (-0.5 * SIZE[0], place)
        velocity = X.unrotate((SPEED, 0.0))
        out = push_outcome(surface, contact, (1.0, 0.0), TIP_FRICTION, velocity)
        X = integrate(X, (out.twist.vx, out.twist.vy, out.twist.w), dt)
        place += out.slip_velocity * dt
    return Pushed(perf_counter() - began, X.x, X.y, X.yaw)


def _exact() -> Pushed:
    """Push by a compliant tip on the exact surface, on arrays."""
    half, width, _ = (0.5 * edge for edge in SIZE)
    face = face_pressure(Box(SIZE), (0.0, 0.0), (0.0, 0.0))
    assert face is not None
    world = PlanarWorld(
        polygon_support(face, FRICTION * MASS * GRAVITY),
        Faces([(-half, 0.0)], [(1.0, 0.0)], [(-width, width)]),
        Tips(RADIUS, TIP_FRICTION, STIFF),
        TIME / STEPS,
    )
    states = world.initial_states(np.zeros((EXACT_BODIES, 3)), [(-half - RADIUS, OFF)])
    velocities = [(SPEED, 0.0)]
    spent, states = _stepped(lambda before: world.step(before, velocities), states)
    return Pushed(spent / EXACT_BODIES, *states.poses[0].tolist())


def _planar() -> Pushed:
    """The same push on the planar engine, at height zero so that the centre of pressure
    stays fixed.
    """
    from pushpressslide.core.control import TipCommand
    from pushpressslide.core.plan import Contact
    from pushpressslide.core.pose import Pose2
    from pushpressslide.core.task import Box, ObjectModel, Robot, Support, Task
    from pushpressslide.planar.world import World

    none = (0.0, 0.0, 0.0)
    task = Task(
        "bench",
        ObjectModel(Box(SIZE), MASS, (0.0, 0.0)),
        Pose2(),
        Pose2(),
        (Robot("hand", none, tip_radius=RADIUS),),
        Support("table", FRICTION),
        contact_friction=TIP_FRICTION,
    )
    contact = Contact(0, "side", (-0.5 * SIZE[0], OFF), (1.0, 0.0), 0.0)
    world = World(task, (contact,), TIME / STEPS)
    dampings = (STIFF, STIFF, STIFF)
    ahead = (SPEED, 0.0, 0.0)
    command = TipCommand(none, none, ahead, none, dampings, 0.0, 0.0, 0.0, 0.0, 0.0)
    state = world.start(Pose2(), Pose2(), 0.0)
    began = perf_counter()
    for _ in range(STEPS):
        state = world.step(state, [command])
    X = state.X_WB
    return Pushed(perf_counter() - began, X.x, X.y, X.yaw)


MODEL = """
<mujoco>
  <option timestep="{step}" cone="elliptic" impratio="10" integrator="implicitfast"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 0.1"/>
    <body name="box" pos="0 0 {z}">
      <freejoint/>
      <geom name="box" type="box" size="{sx} {sy} {sz}" mass="{mass}"/>
    </body>
    <body name="ball" pos="{x} {y} {z}" gravcomp="1">
      <joint name="ahead" type="slide" axis="1 0 0"/>
      <geom name="ball" type="sphere" size="{radius}" mass="0.5"/>
    </body>
  </worldbody>
  <contact>
    <exclude body1="world" body2="ball"/>
    <pair geom1="box" geom2="floor" condim="3" friction="{mu} {mu} 0.001 0 0"/>
    <pair geom1="box" geom2="ball" condim="3" friction="{tip} {tip} 0.001 0 0"/>
  </contact>
  <actuator><velocity joint="ahead" kv="{kv}"/></actuator>
</mujoco>
"""


def _mujoco() -> Pushed | str:
    try:
        mujoco: Any = importlib.import_module("mujoco")
    except ModuleNotFoundError:
        return NO_MUJOCO
    half, width, height = (0.5 * edge for edge in SIZE)
    text = MODEL.format(
        step=PHYSICS_STEP,
        z=height,
        sx=half,
        sy=width,
        sz=height,
        mass=MASS,
        x=-half - RADIUS,
        y=OFF,
        radius=RADIUS,
        mu=FRICTION,
        tip=TIP_FRICTION,
        kv=STIFF,
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.ctrl[0] = SPEED
    began = perf_counter()
    for _ in range(round(TIME / PHYSICS_STEP)):
        mujoco.mj_step(model, data)
    spent = perf_counter() - began
    x, y, _, w, _, _, z = data.qpos[:7].tolist()
    return Pushed(spent, x, y, 2.0 * math.atan2(z, w))


def _drake() -> Pushed | str:
    try:
        from pushpressslide_studies.sim.bench_push import BoxPush, pushed_box
    except MissingPackageError:
        return NO_DRAKE
    push = BoxPush(SIZE, MASS, FRICTION, TIP_FRICTION, RADIUS, OFF, SPEED)
    return Pushed(*pushed_box(push, TIME, PHYSICS_STEP, STIFF))
