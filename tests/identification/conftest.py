"""Synthetic pushes of an object on a known support, and the logs that would be
recorded.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from pushpressslide.identification.fitted_pressure import static_model
from pushpressslide.identification.pairs import Pairs
from pushpressslide.mechanics.limit_surface import exact_wrenches
from pushpressslide.mechanics.pressure import PressureSamples

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
