"""Synthetic pushes of an object on a known support, and the logs that would be
recorded.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

from pushpressslide.geometry.shapes import Box
from pushpressslide.identification.fitted_pressure import static_model
from pushpressslide.identification.pairs import Pairs
from pushpressslide.mechanics.limit_surface import exact_wrenches
from pushpressslide.mechanics.pressure import PressureSamples, support_pressure

COM = np.array([0.05, 0.05])
BASE = np.array([(0.0, 0.0), (0.15, 0.0), (0.0, 0.15)]) - COM
HEIGHT = 0.0125


def rotation(angle: float) -> np.ndarray:
    return np.array(
        [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    )


def entry(wrench: np.ndarray) -> np.ndarray | None:
    """Point at which the line of action enters the base. None if it misses."""
    force = wrench[:2]
    torque = wrench[2]
    size = math.hypot(*force)
    along = force / size
    # cross(foot, force) = torque
    foot = np.array([along[1], -along[0]]) * torque / size
    best = None
    for a, b in zip(BASE, np.roll(BASE, -1, axis=0), strict=True):
        system = np.column_stack([along, a - b])
        if abs(np.linalg.det(system)) < 1e-9:
            continue
        s, t = np.linalg.solve(system, a - foot)
        if 0.0 <= t <= 1.0 and (best is None or s < best[0]):
            best = (s, foot + s * along)
    return None if best is None else best[1]


@pytest.fixture(scope="session")
def sample_pairs() -> Callable[..., Pairs]:
    """Return a function: point pushes on the exact surface of a pressure, without
    height or noise.
    """

    def make(
        pressure: PressureSamples, friction: float, n: int, seed: int = 0
    ) -> Pairs:
        generator = np.random.default_rng(seed)
        rows: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        while len(rows) < n:
            nu = generator.normal(size=3)
            twist = nu / np.linalg.norm(nu) / (1.0, 1.0, 0.05)
            # both at the CoP
            (wrench,) = exact_wrenches(pressure, friction, twist[None])
            x, y = pressure.cop
            wrench[2] += x * wrench[1] - y * wrench[0]
            twist = twist + twist[2] * np.array((y, -x, 0.0))
            contact = entry(wrench)
            if contact is not None:
                rows.append((wrench, 0.01 * twist, contact))
        wrenches, twists, contacts = (
            np.array(column) for column in zip(*rows, strict=True)
        )
        return Pairs(wrenches, twists, contacts, np.zeros(n))

    return make


@pytest.fixture(scope="session")
def write_log() -> Callable[[Pairs, int], str]:
    """Return a function: the log of a session in which ``pairs`` happened, from random
    places.
    """

    def pose(position: Sequence[float], yaw: float) -> str:
        numbers = (
            *(1e3 * c for c in position),
            math.cos(0.5 * yaw),
            0.0,
            0.0,
            math.sin(0.5 * yaw),
        )
        return " ".join(f"{v:.9g}" for v in numbers)

    def write(pairs: Pairs, seed: int = 0) -> str:
        generator = np.random.default_rng(seed)
        lines = [str(len(pairs))]
        sensor = math.sqrt(0.5) * np.array([[1.0, 1.0], [1.0, -1.0]])
        for wrench, twist, contact in zip(
            pairs.wrenches, pairs.twists, pairs.contacts, strict=True
        ):
            yaw, probe_yaw = generator.uniform(-math.pi, math.pi, 2)
            com = generator.uniform(0.3, 0.6, 2)
            bias = generator.normal(0.0, 0.1, 2)
            shift = rotation(yaw + 0.5 * twist[2]) @ twist[:2]

            def body(
                way: float,
                yaw: float = yaw,
                com: np.ndarray = com,
                shift: np.ndarray = shift,
                turn: float = twist[2],
            ) -> tuple[np.ndarray, float]:
                return com + way * shift, yaw + way * turn

            for way in (0.0, 1.0):
                place, angle = body(way)
                lines.append(pose((*(place - rotation(angle) @ COM), 0.009), angle))
            free = 40
            touching = 160
            forces = []
            probe = []
            for i in range(free + touching):
                way = max(0.0, (i - free) / (touching - 1))
                place, angle = body(way)
                force = (
                    rotation(angle - probe_yaw) @ wrench[:2]
                    if i >= free
                    else np.zeros(2)
                )
                fx, fy = bias - sensor @ force
                time = 1.4e9 + 0.01 * i
                forces.append(f"{time:.9f} {fx:.9g} {fy:.9g}")
                tip = place + rotation(angle) @ contact
                probe.append(f"{time:.9f} {pose((*tip, 0.009 + HEIGHT), probe_yaw)}")
            lines += [str(len(forces)), *forces, str(len(probe)), *probe]
        return "\n".join(lines) + "\n"

    return write


@pytest.fixture(scope="session")
def model_pairs() -> Callable[..., Pairs]:
    """Return a function: pairs whose motions a pressure model predicts, pushed at a
    height.
    """

    def make(pressure: PressureSamples, pairs: Pairs, height: float) -> Pairs:
        heights = np.full(len(pairs), height)
        directions = static_model(pressure).directions(pairs.wrenches, heights)
        return Pairs(
            pairs.wrenches, directions / (1.0, 1.0, 0.05), pairs.contacts, heights
        )

    return make


@dataclass(frozen=True)
class Session:
    """Pushes of a box by a tip, sampled densely on one clock."""

    times: np.ndarray  # (n,) [s] at 1 kHz
    object: np.ndarray  # (n, 3) X_WG
    tip: np.ndarray  # (n, 3)
    force: np.ndarray  # (n, 2) on the object, world axes

    def sampled(
        self, rate: float, offset: float, seed: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Stamps, poses, tips and forces at a rate [Hz] of a clock that is ahead by an
        offset [s], with 2 % dropped and jitter.
        """
        generator = np.random.default_rng(seed)
        clock = np.arange(self.times[0] + 0.1, self.times[-1] - 0.1, 1.0 / rate)
        clock = clock[generator.random(len(clock)) > 0.02]
        clock += generator.uniform(-0.1, 0.1, len(clock)) / rate
        columns = [
            np.stack([np.interp(clock, self.times, c) for c in values.T], axis=1)
            for values in (self.object, self.tip, self.force)
        ]
        return clock + offset, *columns


Law = Callable[[np.ndarray], Callable[[np.ndarray], np.ndarray]]
"""Wrench about the CoM by the twist of the CoM, under a force (fx, fy) in B."""


def even_load(shape: Box, mass: float, friction: float, height: float) -> Law:
    """Exact friction of an even load, which a push at a height moves."""
    load = 9.81 * mass

    def law(force: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        cx, cy = height * force / load
        pressure = support_pressure(shape, load, cop=(cx, cy), resolution=4)

        def wrench_of(twist: np.ndarray) -> np.ndarray:
            w = twist[2]
            moved = twist + w * np.array((-cy, cx, 0.0))
            ((fx, fy, tau),) = exact_wrenches(pressure, friction, moved[None])
            return np.array((fx, fy, tau + cx * fy - cy * fx))

        return wrench_of

    return law


def ellipsoid(mass: float, friction: float, rho: float) -> Law:
    """Friction of an ellipsoid."""

    def wrench_of(twist: np.ndarray) -> np.ndarray:
        scaled = twist * (1.0, 1.0, rho**2)
        return 9.81 * mass * friction * scaled / math.sqrt(twist @ scaled)

    return lambda force: wrench_of


def sticking(
    wrench_of: Callable[[np.ndarray], np.ndarray],
    contact: np.ndarray,
    velocity: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Twist of the CoM and force at a contact that moves with a velocity."""
    x, y = contact

    def twist_of(w: float) -> np.ndarray:
        return np.array([velocity[0] + w * y, velocity[1] - w * x, w])

    def moment(w: float) -> float:
        fx, fy, tau = wrench_of(twist_of(w))
        return float(tau - x * fy + y * fx)

    w = brentq(moment, -5.0, 5.0, xtol=1e-9)
    return twist_of(w), wrench_of(twist_of(w))[:2]


def pushed_session(
    size: tuple[float, float], law: Law, pushes: int, height: float
) -> Session:
    """Pushes of a box at places around it, each at a speed of its own, with rests."""
    generator = np.random.default_rng(1)
    dt = 1e-2
    radius = 0.02
    a, b = 0.5 * np.array(size)
    pose = np.array([0.5, 0.1, 0.2])
    rows: list[np.ndarray] = []
    for k in range(pushes):
        share = generator.uniform(-0.7, 0.7)
        faces = (
            ((-a, share * b), (1.0, 0.0)),
            ((share * a, -b), (0.0, 1.0)),
            ((a, share * b), (-1.0, 0.0)),
            ((share * a, b), (0.0, -1.0)),
        )
        contact, normal = (np.array(part) for part in faces[k % 4])
        center = contact - radius * normal
        speed = generator.uniform(0.02, 0.06)
        velocity = speed * (rotation(pose[2] + generator.uniform(-0.15, 0.15)) @ normal)
        tip = pose[:2] + rotation(pose[2]) @ center
        away = 0.03 * (rotation(pose[2]) @ normal)
        # free and approaching, touching at rest, pushing, touching at rest, free
        rows += [
            np.array([*pose, *(tip - s * away), 0.0, 0.0])
            for s in np.linspace(1.0, 0.0, 60)
        ]
        force = np.zeros(2)
        for i in range(int(0.07 / speed / dt)):
            turn = rotation(pose[2])
            twist, on_object = sticking(law(turn.T @ force), contact, turn.T @ velocity)
            force = turn @ on_object
            if i == 0:
                rows += [
                    np.array([*pose, *tip, *(s * force)])
                    for s in np.linspace(0.0, 1.0, 15)
                ]
            rows.append(np.array([*pose, *tip, *force]))
            half = rotation(pose[2] + 0.5 * dt * twist[2])
            pose = pose + dt * np.array([*(half @ twist[:2]), twist[2]])
            tip = pose[:2] + rotation(pose[2]) @ center
        rows += [
            np.array([*pose, *tip, *(s * force)]) for s in np.linspace(0.9, 0.0, 25)
        ]
        away = 0.03 * (rotation(pose[2]) @ normal)
        rows += [
            np.array([*pose, *(tip - s * away), 0.0, 0.0])
            for s in np.linspace(0.0, 1.0, 60)
        ]
    table = np.array(rows)
    heights = np.full((len(table), 1), height)
    return Session(
        dt * np.arange(len(table)),
        table[:, :3],
        np.hstack([table[:, 3:5], heights]),
        table[:, 5:],
    )


BOX = (0.16, 0.10)
MASS = 0.9
FRICTION = 0.34
RHO = 0.055
HEIGHT_OF_TIP = 0.02
LATE = 0.02  # [s] that the clock of the poses is ahead of the arm's

BOX_TASK = """\
# a box of the laboratory
name: lab-box
support: {kind: table, friction: 0.5}   # a guess
object:
  shape: {box: [0.16, 0.10, 0.08]}
  mass: 0.9    # weighed
contact: {friction: 0.6}
start: {x: 0.45, y: -0.20, yaw_deg: 0}
goal: {x: 0.60, y: 0.10, yaw_deg: 20}
tolerance: {position: 0.01, yaw_deg: 2}
robots: [{model: hand, base: {x: 0, y: 0, z: 0.3, yaw_deg: 0}}]
modes: [rear_push]
"""


@dataclass(frozen=True)
class Recorded:
    """Streams as sensors record them: poses at 30 Hz, the arm's at 100 Hz."""

    pose_times: np.ndarray
    poses: np.ndarray  # (n, 3)
    times: np.ndarray
    tips: np.ndarray  # (m, 3)
    forces: np.ndarray  # (m, 2)


def recorded(session: Session, seed: int = 7) -> Recorded:
    """Noise of 0.3 mm, 0.17 degrees and 0.1 N, a bias of the force, 2 % dropped."""
    generator = np.random.default_rng(seed)
    pose_times, poses, _, _ = session.sampled(30.0, LATE, seed + 1)
    times, _, tips, forces = session.sampled(100.0, 0.0, seed + 2)
    return Recorded(
        pose_times,
        poses + generator.normal(size=poses.shape) * (3e-4, 3e-4, 3e-3),
        times,
        tips + generator.normal(size=tips.shape) * 1e-4,
        forces + generator.normal(size=forces.shape) * 0.1 + (0.3, -0.2),
    )


@pytest.fixture(scope="session")
def ellipsoid_pushes() -> Recorded:
    """Pushes of a box whose friction is an ellipsoid's."""
    law = ellipsoid(MASS, FRICTION, RHO)
    return recorded(pushed_session(BOX, law, 16, HEIGHT_OF_TIP))


@pytest.fixture(scope="session")
def even_pushes() -> Recorded:
    """Pushes of a box with an even load."""
    law = even_load(Box((*BOX, 0.08)), MASS, FRICTION, HEIGHT_OF_TIP)
    return recorded(pushed_session(BOX, law, 16, HEIGHT_OF_TIP))


@pytest.fixture(scope="session")
def box_task(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Text of the task file of the box that is pushed."""
    return BOX_TASK


@pytest.fixture(scope="session")
def long_form() -> Callable[[Recorded], str]:
    """Return a function: pushes as one CSV text in millimetres and degrees, with a row
    for each sample.
    """

    def write(pushes: Recorded) -> str:
        rows = [
            (t, f"{t:.6f},{1e3 * x:.5f},{1e3 * y:.5f},{math.degrees(yaw):.5f},,,,,")
            for t, (x, y, yaw) in zip(pushes.pose_times, pushes.poses, strict=True)
        ]
        arm = zip(pushes.times, pushes.tips, pushes.forces, strict=True)
        for t, tip, force in arm:
            cells = ",".join(f"{v:.6f}" for v in (*tip, *force))
            rows.append((t, f"{t:.6f},,,,{cells}"))
        head = (
            "t [s],object_x [mm],object_y [mm],object_yaw [deg],tip_x,tip_y,tip_z,fx,fy"
        )
        return "\n".join([head, *(row for _, row in sorted(rows))]) + "\n"

    return write
