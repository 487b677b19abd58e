"""The laws on arrays, by numba and in Python, compared with copying the same number of
bytes and with row-by-row alternatives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from pushpressslide.allocation.one_contact import one_contact_allocator
from pushpressslide.allocation.one_press import one_press_allocator
from pushpressslide.allocation.parallel import parallel_push_allocator
from pushpressslide.allocation.press_and_push import press_and_push_allocator
from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.batch.dubins import shortest_lengths, shortest_paths
from pushpressslide.batch.exact_surface import ExactSurface
from pushpressslide.batch.fast import installed, without_numba
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
from pushpressslide_studies.bench.compared import (
    Contestants,
    Row,
    compared,
    not_installed,
)

Call = Callable[[], object]
SIZES = (10_000, 300_000)  # rows of a batch
ROUND = 50_000  # rows, at least, that each contestant does in a round
ALONE = 200  # rows that are done one by one, and of a batch in Python
PATHS = 2_000  # Dubins paths that others find one by one
NO_NUMBA = not_installed("pushpressslide[fast]")
NO_OMPL = not_installed("pushpressslide-studies[bench]")
COPY = "copy"
COMPILED = "compiled"
PYTHON = "Python"
SINGLY = "one by one"
BEHIND = ((-0.1, 0.03), (-0.1, -0.03))
FORWARD = (1.0, 0.0)
RHO = 0.08
BOX = rectangle_pressure(0.2, 0.12, 10.0, (0.01, 0.0), 2)
SURFACE = EllipsoidLimitSurface(2.0, RHO)


def batches(seed: int) -> list[Row]:
    """A row for each law and size: the time per row of data, and its ratios to a copy
    and to the alternatives.

    The laws run by numba, or in Python if numba is not installed.
    """
    rows = []
    for size in SIZES:
        many, few = (laws(np.random.default_rng(seed), n) for n in (size, ALONE))
        rows += [_row(law, short, size) for law, short in zip(many, few, strict=True)]
    return rows


def _row(law: Law, short: Law, size: int) -> Row:
    """Row of one law.

    ``short`` is the same law for only ``ALONE`` rows.
    """
    block = np.zeros(law.numbers * size)
    contestants: dict[str, Call | str] = {
        COPY: block.copy,  # into new memory, as an answer is
        COMPILED: law.batch if installed() else NO_NUMBA,
        PYTHON: _in_python(short.batch),
    }
    single = law.single
    if single is not None:
        contestants[SINGLY] = lambda: [single(i) for i in range(ALONE)]
    few = {SINGLY: ALONE, PYTHON: ALONE}
    counts = dict.fromkeys(contestants, size) | few
    # a single call of few rows is at the mercy of what caches and memory held before
    repeats = dict.fromkeys(contestants, math.ceil(ROUND / size)) | dict.fromkeys(
        few, 1
    )
    found = {row["what"]: row for row in _compared(contestants, counts, repeats)}
    best = found[COMPILED]["ratio"] or found[PYTHON]["ratio"]
    times = {"python_over": PYTHON, "one_by_one_over": SINGLY}
    over = {
        name: found[other]["ratio"] / best if other in found else None
        for name, other in times.items()
    }
    fastest = COMPILED if installed() else PYTHON
    return {
        "what": law.name,
        "rows": size,
        "median_us": found[fastest]["median_us"],
        "ratio": best,
        **over,
        "note": found[COMPILED]["note"],
    }


def dubins(seed: int) -> list[Row]:
    """A row for each method of computing the lengths of the same Dubins paths. Ratios
    are to the batch.
    """
    size = SIZES[-1]
    poses = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, size, 3))
    starts, goals = poses * (4.0, 4.0, math.pi)

    def lengths() -> object:
        return shortest_lengths(starts, goals, 1.0, 1.0)

    def few() -> object:
        return shortest_lengths(starts[:ALONE], goals[:ALONE], 1.0, 1.0)

    def singly() -> None:
        for a, b in zip(starts[:ALONE], goals[:ALONE], strict=True):
            shortest_path(Pose2(*a), Pose2(*b), 1.0, 1.0)

    contestants: dict[str, Call | str] = {
        "batch, compiled": lengths if installed() else NO_NUMBA,
        "batch, Python": _in_python(few),
        SINGLY: singly,
        "OMPL, one by one": _ompl(starts[:PATHS], goals[:PATHS]),
    }
    counts = dict.fromkeys(contestants, size) | {
        "batch, Python": ALONE,
        SINGLY: ALONE,
        "OMPL, one by one": PATHS,
    }
    return _compared(contestants, counts)


def _compared(
    contestants: dict[str, Call | str],
    counts: dict[str, int],
    repeats: Mapping[str, int] = MappingProxyType({}),
) -> list[Row]:
    """Time [us] of each contestant per row of data, and its ratio to the first
    contestant.

    A round has ``repeats`` calls of each contestant, by default one.
    """
    calls: Contestants = {}
    for name, run in contestants.items():
        if isinstance(run, str):
            calls[name] = run
            continue
        run()  # what is compiled at the first use is not counted
        calls[name] = [(run, ())] * repeats.get(name, 1)
    return compared(calls, counts)


def _in_python(run: Call) -> Call:
    """A call that runs in Python, as if numba were not installed."""

    def run_interpreted() -> object:
        with without_numba():
            return run()

    return run_interpreted


def _ompl(start_poses: Array, goals: Array) -> Call | str:
    """A call of OMPL's Dubins space for each row, from prepared states."""
    try:
        from ompl import base
    except ModuleNotFoundError:
        return NO_OMPL
    space = base.DubinsStateSpace(1.0)

    def state(pose: Array) -> Any:
        out = space.allocState()
        out.setXY(float(pose[0]), float(pose[1]))
        out.setYaw(float(pose[2]))
        return out

    pairs = [(state(a), state(b)) for a, b in zip(start_poses, goals, strict=True)]
    return lambda: [space.distance(a, b) for a, b in pairs]


@dataclass(frozen=True)
class Law:
    """A law, its contestants, and the number of values read and written per row."""

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
    """Law of one allocator. A status counts as an eighth of a value."""
    rows = wrenches.tolist()
    return Law(
        name,
        3 + 3 * contacts + 4,
        lambda: batch.allocate(wrenches),  # type: ignore[attr-defined]
        lambda i: one(*rows[i]),  # type: ignore[operator]
    )


def presses(name: str, wrenches: Array) -> Law:
    """Law of two presses with separate loads in each row."""
    loads = np.random.default_rng(1).uniform(2.0, 4.0, (len(wrenches), 2))
    pair = TwoPresses(BEHIND, 0.5)
    one = two_press_allocator(BEHIND, 0.5)
    rows = wrenches.tolist()
    normals = [(a, b) for a, b in loads.tolist()]
    return Law(
        name,
        5 + 10,
        lambda: pair.allocate(wrenches, loads),
        lambda i: one(rows[i][0], rows[i][1], rows[i][2], normals[i]),
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
        lambda i: exact_wrench(BOX, 0.3, Twist(*twists[i])._replace(point=BOX.cop)),
    )
    yield Law(
        f"exact surface of {len(BOX.loads)} samples, twist of a wrench",
        7,
        lambda: exact.slides(wrenches),
        lambda i: exact_slide(BOX, 0.3, Wrench(*wrenches[i])._replace(about=BOX.cop)),
    )


def motions(rng: np.random.Generator, rows: int) -> Iterator[Law]:
    """Yield velocity pushes, tracking laws and Dubins paths."""
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
