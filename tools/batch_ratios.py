"""Prints how fast batches are: a table of ratios, medians of rounds in which all
contestants take turns.

    python tools/batch_ratios.py [ROWS] [ROUNDS]

Each row of the table is one law on ROWS rows. A copy is that of an array as large as all
that the law reads and writes. What is not installed is left out aloud.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np

from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.batch import loops
from pushpressslide.batch.dubins import shortest_lengths, shortest_paths
from pushpressslide.batch.exact_surface import ExactSurface
from pushpressslide.batch.limit_surface import EllipsoidSurface
from pushpressslide.batch.one_contact import OneContact
from pushpressslide.batch.parallel import ParallelPushes
from pushpressslide.batch.press_and_push import PressAndPush
from pushpressslide.batch.presses import OnePress, TwoPresses
from pushpressslide.batch.pushing import SideContact
from pushpressslide.batch.tracking import (
    holonomic,
    lookahead_curvature,
    rear_stanley,
)
from pushpressslide.batch.two_contacts import TwoContacts
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.core.wrench import Twist, Wrench
from pushpressslide.mechanics.friction import push_outcome
from pushpressslide.mechanics.limit_surface import (
    EllipsoidLimitSurface,
    exact_slide,
    exact_wrench,
)
from pushpressslide.mechanics.pressure import rectangle_pressure
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.tracking import rear_stanley as stanley
from pushpressslide.tracking.lookahead_alignment import LookAheadAlignment

Call = Callable[[], object]
BEHIND = ((-0.1, 0.03), (-0.1, -0.03))
FORWARD = (1.0, 0.0)
RHO = 0.08
BOX = rectangle_pressure(0.2, 0.12, 10.0, (0.01, 0.0), 2)
SURFACE = EllipsoidLimitSurface(2.0, RHO)
SINGLE_ROWS = 200  # that a law for one row is timed on


@dataclass(frozen=True)
class Law:
    """One law, its contestants, and the numbers that it reads and writes for a row."""

    name: str
    numbers: int
    batch: Call
    # the law for one row, of a number; None: there is none alike
    single: Callable[[int], object] | None


def laws(rng: np.random.Generator, rows: int) -> Iterator[Law]:
    """Yield all laws on ``rows`` rows."""
    yield from allocators(rng, rows)
    yield from surfaces(rng, rows)
    yield from motions(rng, rows)


def allocators(rng: np.random.Generator, rows: int) -> Iterator[Law]:
    """Yield the allocators."""
    inside = np.stack(
        [
            rng.uniform(1.0, 2.0, rows),
            rng.uniform(-0.1, 0.1, rows),
            rng.uniform(-0.01, 0.01, rows),
        ],
        axis=1,
    )
    any_way = rng.normal(size=(rows, 3)) * (1.0, 1.0, 0.05)
    normals = (FORWARD, FORWARD)
    one = two_contact_allocator(BEHIND, normals, 0.5, RHO)
    pair = TwoContacts(BEHIND, normals, 0.5, RHO)
    for name, wrenches in (("possible", inside), ("any", any_way)):
        yield allocator(f"two contacts, {name} wrenches", 2, wrenches, pair, one)
    parallel = ParallelPushes(BEHIND, FORWARD, 0.5, RHO)
    one = parallel_push_allocator(BEHIND, FORWARD, 0.5, RHO)
    yield allocator("parallel pushes, possible wrenches", 2, inside, parallel, one)
    contact = OneContact((-0.1, 0.0), FORWARD, 0.5, RHO)
    one = one_contact_allocator((-0.1, 0.0), FORWARD, 0.5, RHO)
    given = inside * (1.0, 1.0, 0.0)
    given[:, 2] = -0.1 * given[:, 1]
    yield allocator("one contact, possible wrenches", 1, given, contact, one)
    yield allocator("one contact, any wrenches", 1, any_way, contact, one)
    press = OnePress((0.05, 0.02), 3.0, 0.5, RHO)
    one = one_press_allocator((0.05, 0.02), 3.0, 0.5, RHO)
    yield allocator("one press", 1, any_way, press, one)
    both = PressAndPush((0.05, 0.0), 3.0, (-0.1, 0.05), FORWARD, 0.5)
    one = press_and_push_allocator((0.05, 0.0), 3.0, (-0.1, 0.05), FORWARD, 0.5)
    yield allocator("press and push", 2, any_way, both, one)
    yield presses("two presses, possible wrenches", inside * (0.5, 1.0, 1.0))
    yield presses("two presses, any wrenches", any_way)


def allocator(
    name: str, contacts: int, wrenches: Array, batch: object, one: object
) -> Law:
    """Return the law of one allocator: a status counts as an eighth of a number."""
    rows = wrenches.tolist()
    return Law(
        name,
        3 + 3 * contacts + 4,
        lambda: batch.allocate(wrenches),  # type: ignore[attr-defined]
        lambda i: one(*rows[i]),  # type: ignore[operator]
    )


def presses(name: str, wrenches: Array) -> Law:
    """Return the law of two presses with loads of their own in each row."""
    loads = np.random.default_rng(1).uniform(2.0, 4.0, (len(wrenches), 2))
    pair = TwoPresses(BEHIND, 0.5)
    one = two_press_allocator(BEHIND, 0.5)
    rows = wrenches.tolist()
    normals = list(map(tuple, loads.tolist()))
    return Law(
        name,
        5 + 10,
        lambda: pair.allocate(wrenches, loads),
        lambda i: one(*rows[i], normals[i]),
    )


def surfaces(rng: np.random.Generator, rows: int) -> Iterator[Law]:
    """Yield the limit surfaces."""
    twists = rng.normal(size=(rows, 3)) * (1.0, 1.0, 10.0)
    wrenches = rng.normal(size=(rows, 3)) * (1.0, 1.0, 0.08)
    ellipsoid = EllipsoidSurface(2.0, RHO)
    exact = ExactSurface(BOX, 0.3)
    yield Law(
        "ellipsoid, wrench of a twist",
        6,
        lambda: ellipsoid.wrenches(twists),
        lambda i: SURFACE.wrench(Twist(*twists[i])),
    )
    yield Law(
        "ellipsoid, twist of a wrench",
        7,
        lambda: ellipsoid.twist_directions(wrenches),
        lambda i: SURFACE.twist_direction(Wrench(*wrenches[i])),
    )
    yield Law(
        f"exact surface of {len(BOX.loads)} samples, wrench of a twist",
        6,
        lambda: exact.wrenches(twists),
        lambda i: exact_wrench(BOX, 0.3, Twist(*twists[i], BOX.cop)),
    )
    yield Law(
        f"exact surface of {len(BOX.loads)} samples, twist of a wrench",
        7,
        lambda: exact.slides(wrenches),
        lambda i: exact_slide(BOX, 0.3, Wrench(*wrenches[i], BOX.cop)),
    )


def motions(rng: np.random.Generator, rows: int) -> Iterator[Law]:
    """Yield pushes with a velocity, tracking laws and Dubins paths."""
    velocities = rng.normal(size=(rows, 2))
    contact = SideContact((-0.1, 0.02), FORWARD, 0.4, RHO, 2.0)
    yield Law(
        "push with a velocity",
        9,
        lambda: contact.push(velocities),
        lambda i: push_outcome(
            SURFACE, (-0.1, 0.02), FORWARD, 0.4, tuple(velocities[i])
        ),
    )
    left, heading, curvature = rng.normal(size=(3, rows)) * [[0.05], [0.3], [1.0]]
    bounds = (-0.4, 0.4)
    steer = stanley.rear_stanley(0.07, bounds)
    yield Law(
        "rear Stanley",
        5,
        lambda: rear_stanley(
            left, heading, curvature, wheelbase=0.07, steering_bounds=bounds
        ),
        lambda i: steer(left[i], heading[i], curvature[i], 1.0),
    )
    law = LookAheadAlignment(0.2, 3.0)
    yield Law(
        "look-ahead alignment",
        5,
        lambda: lookahead_curvature(
            left, heading, curvature, look_ahead=0.2, limit=3.0
        ),
        lambda i: law.curvature((0.0, 0.0, 0.0), left[i], heading[i], curvature[i]),
    )
    errors = rng.normal(size=(rows, 3)) * (0.02, 0.02, 0.1)
    rates = rng.normal(size=(rows, 3))
    figures = {"speed": 0.03, "decay": 0.05, "radius": RHO}
    yield Law(
        "holonomic law",
        10,
        lambda: holonomic(errors, rates, **figures),
        None,
    )
    starts, goals = rng.uniform(-1.0, 1.0, (2, rows, 3)) * (4.0, 4.0, math.pi)
    yield Law(
        "Dubins paths",
        14,
        lambda: shortest_paths(starts, goals, 1.0, 1.0),
        lambda i: shortest_path(Pose2(*starts[i]), Pose2(*goals[i]), 1.0, 1.0),
    )


def dubins_poses(rows: int) -> tuple[Array, Array]:
    """Return random starts and goals, in a square of 8 m; all turn with a radius of 1 m."""
    poses = np.random.default_rng(0).uniform(-1.0, 1.0, (2, rows, 3))
    starts, goals = poses * (4.0, 4.0, math.pi)
    return starts, goals


def lengths_of(rows: int) -> Call:
    """Return our lengths of as many Dubins paths."""
    starts, goals = dubins_poses(rows)
    return lambda: shortest_lengths(starts, goals, 1.0, 1.0)


def ompl_lengths(rows: int) -> tuple[Call, Call] | None:
    """Return OMPL's lengths of the same paths: from numbers, and from states made
    before.
    """
    try:
        from ompl import base
    except ImportError:
        return None
    space = base.DubinsStateSpace(1.0)
    distance = space.distance
    starts, goals = map(np.ndarray.tolist, dubins_poses(rows))
    pairs = [(space.allocState(), space.allocState()) for _ in starts]

    def from_numbers() -> None:
        for (a, b), start, goal in zip(pairs, starts, goals, strict=True):
            a.setXY(start[0], start[1])
            a.setYaw(start[2])
            b.setXY(goal[0], goal[1])
            b.setYaw(goal[2])
            distance(a, b)

    return from_numbers, lambda: [distance(a, b) for a, b in pairs]


def seconds(call: Call) -> float:
    """Return how long a call takes after one like it."""
    call()
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def by_numpy(call: Call) -> float:
    """Return how long a call takes without numba."""
    with patch.object(loops, "compiler", lambda: None):
        return seconds(call)


def line(law: Law, rows: int, rounds: int) -> str:
    """Return a law's row of the table."""
    block = np.zeros(law.numbers * rows)
    times = [
        (seconds(block.copy), seconds(law.batch), by_numpy(law.batch), alone(law, rows))
        for _ in range(rounds)
    ]
    copy, fast, numpy, one = map(statistics.median, zip(*times, strict=True))
    singly = f"{one / fast:.0f}" if law.single else ""
    return (
        f"| {law.name} | {1e9 * fast / rows:.1f} | {fast / copy:.1f} "
        f"| {numpy / fast:.1f} | {singly} |"
    )


def alone(law: Law, rows: int) -> float:
    """Return how long the law takes for one row after the other, timed on a few."""
    single = law.single
    if single is None:
        return math.nan
    few = min(rows, SINGLE_ROWS)
    return seconds(lambda: [single(i) for i in range(few)]) * rows / few


def main() -> None:
    """Print the table."""
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 31
    if loops.compiler() is None:
        print(
            "numba is not installed: all is NumPy (pip install 'pushpressslide[fast]')"
        )
    print(f"{rows} rows, medians of {rounds} rounds\n")
    print("| law | ns a row | times a copy | NumPy takes | one at a time takes |")
    print("|---|---:|---:|---:|---:|")
    for law in laws(np.random.default_rng(0), rows):
        print(line(law, rows, rounds), flush=True)
    ompl = ompl_lengths(rows)
    if ompl is None:
        print("\nompl is not installed: no comparison for Dubins paths")
        return
    ours = lengths_of(rows)
    times = [(seconds(ours), seconds(ompl[0]), seconds(ompl[1])) for _ in range(rounds)]
    own, numbers, states = map(statistics.median, zip(*times, strict=True))
    print(
        f"\nDubins lengths: {1e9 * own / rows:.1f} ns a row; OMPL takes "
        f"{numbers / own:.1f} times from numbers, {states / own:.1f} times from states"
    )


if __name__ == "__main__":
    main()
