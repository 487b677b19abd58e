"""The laws on arrays: by NumPy, compiled, beside a copy of the same bytes, and beside
libraries that do the same row by row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pushpressslide.batch.dubins import shortest_lengths, shortest_paths
from pushpressslide.batch.loops import by_numpy, installed
from pushpressslide.batch.presses import TwoPresses
from pushpressslide.batch.pushing import SideContact
from pushpressslide.batch.two_contacts import TwoContacts
from pushpressslide.core.arrays import Array
from pushpressslide.studies.bench.compared import Contestants, Row, compared

ROWS = 200_000  # of each batch
ALONE = 2_000  # rows that are done one by one
FRICTION = 0.5
RHO = 0.08  # [m]
NO_NUMBA = "not installed: pip install 'pushpressslide[fast]'"
NO_OMPL = "not installed: pip install 'pushpressslide[bench]'"


@dataclass(frozen=True)
class Batch:
    """A law on many rows, and the arrays that it reads and writes."""

    name: str
    run: Callable[[], object]
    arrays: tuple[Array, ...]


def batches(seed: int) -> list[Row]:
    """Return a row for each law: the time of one row by numba and by NumPy, and of a
    copy of the same bytes; ratios to the copy.
    """
    rows = []
    for batch in _laws(np.random.default_rng(seed)):
        rows += _compared(batch)
    return rows


def dubins(seed: int) -> list[Row]:
    """Return a row for each way to the lengths of the same Dubins paths; ratios to
    the compiled batch.
    """
    starts, goals = np.random.default_rng(seed).uniform(-3.0, 3.0, (2, ROWS, 3))

    def lengths() -> object:
        return shortest_lengths(starts, goals, 1.0, 1.0)

    def alone() -> None:
        from pushpressslide.core.pose import Pose2
        from pushpressslide.planning.dubins import shortest_path

        for a, b in zip(starts[:ALONE], goals[:ALONE], strict=True):
            shortest_path(Pose2(*a), Pose2(*b), 1.0, 1.0)

    contestants: dict[str, Callable[[], object] | str] = {
        "batch, compiled": lengths if installed() else NO_NUMBA,
        "batch, NumPy": _numpy(lengths),
        "one by one": alone,
        "OMPL, one by one": _ompl(starts[:ALONE], goals[:ALONE]),
    }
    counts = {"one by one": ALONE, "OMPL, one by one": ALONE}
    return compared_rows("Dubins", contestants, counts)


def _laws(rng: np.random.Generator) -> list[Batch]:
    """Return the laws with random rows."""
    wrenches = rng.normal(size=(ROWS, 3)) * (1.0, 1.0, RHO)
    points = ((-0.1, 0.06), (-0.1, -0.06))
    normals = ((1.0, 0.0), (1.0, 0.0))
    pair = TwoContacts(points, normals, FRICTION, RHO)
    loads = rng.uniform(1.0, 10.0, (ROWS, 2))
    presses = TwoPresses(((0.0, 0.3), (0.0, -0.3)), FRICTION)
    contact = SideContact((-0.1, 0.02), (1.0, 0.0), FRICTION, RHO)
    velocities = rng.normal(size=(ROWS, 2))
    goals = rng.uniform(-3.0, 3.0, (ROWS, 3))
    pushed = contact.push(velocities)
    allocated = pair.allocate(wrenches)
    pressed = presses.allocate(wrenches, loads)
    paths = shortest_paths((0.0, 0.0, 0.0), goals, 1.0, 1.0)
    return [
        Batch(
            "two side contacts",
            lambda: pair.allocate(wrenches),
            (wrenches, *_arrays(allocated)),
        ),
        Batch(
            "two presses",
            lambda: presses.allocate(wrenches, loads),
            (wrenches, loads, *_arrays(pressed)),
        ),
        Batch(
            "a push: stick, slip, separate",
            lambda: contact.push(velocities),
            (velocities, *_arrays(pushed)),
        ),
        Batch(
            "Dubins paths",
            lambda: shortest_paths((0.0, 0.0, 0.0), goals, 1.0, 1.0),
            (goals, *_arrays(paths)),
        ),
    ]


def _arrays(answer: Any) -> tuple[Array, ...]:
    """Return the arrays of an answer of a law."""
    fields = getattr(answer, "__dataclass_fields__", None) or answer._fields
    found = (getattr(answer, name) for name in fields)
    return tuple(value for value in found if isinstance(value, np.ndarray))


def _compared(batch: Batch) -> list[Row]:
    """Return the rows of one law."""
    copies = [np.empty_like(array) for array in batch.arrays]

    def copy() -> None:
        for target, source in zip(copies, batch.arrays, strict=True):
            np.copyto(target, source)

    contestants: dict[str, Callable[[], object] | str] = {
        "copy of the bytes": copy,
        "compiled": batch.run if installed() else NO_NUMBA,
        "NumPy": _numpy(batch.run),
    }
    return compared_rows(batch.name, contestants, {})


def compared_rows(
    what: str,
    contestants: dict[str, Callable[[], object] | str],
    counts: dict[str, int],
) -> list[Row]:
    """Return how long [us] each contestant takes for one row of data, and the ratio to
    the first one; ``counts``: of the rows that a call does, by default ROWS.
    """
    calls: Contestants = {}
    for name, run in contestants.items():
        if isinstance(run, str):
            calls[name] = run
            continue
        run()  # what is compiled at the first use is not counted
        calls[name] = [(run, ())]
    rows = compared(calls, {name: counts.get(name, ROWS) for name in calls})
    return [row | {"what": f"{what}: {row['what']}"} for row in rows]


def _numpy(run: Callable[[], object]) -> Callable[[], object]:
    """Return a call with NumPy alone."""

    def call() -> object:
        with by_numpy():
            return run()

    return call


def _ompl(starts: Array, goals: Array) -> Callable[[], object] | str:
    """Return a call of OMPL's Dubins space for each row."""
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

    pairs = [(state(a), state(b)) for a, b in zip(starts, goals, strict=True)]

    def call() -> None:
        for a, b in pairs:
            space.distance(a, b)

    return call
