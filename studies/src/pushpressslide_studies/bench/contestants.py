"""Contestants of the allocators' speed benchmarks: the closed forms, and solvers for
comparison.

Each solver is timed twice: with its problem built in the call, as necessary when
contacts or presses change, and with the problem built beforehand, so that only its
numbers change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np

from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.pose import Point
from pushpressslide_studies.bench import solvers
from pushpressslide_studies.bench.compared import Call, Contestants, not_installed

Make = Callable[..., Callable[..., object]]
"""Function that makes a solver from a problem."""
Case = tuple[tuple[Any, ...], Sequence[tuple[Any, ...]]]
"""A problem as arguments of ``Make``, and the inputs for which it is solved."""
Pair = tuple[Point, Point]
WRENCHES = 150  # for each pair of contacts
FRICTION = 0.5
RHO = 0.08
# points [m] and normals: orthogonal, parallel, neither
PUSHES: tuple[tuple[Pair, Pair], ...] = (
    (((-0.1, 0.0), (0.0, 0.1)), ((1.0, 0.0), (0.0, -1.0))),
    (((-0.1, 0.06), (-0.1, -0.06)), ((1.0, 0.0), (1.0, 0.0))),
    (((-0.1, 0.03), (0.04, 0.08)), ((1.0, 0.0), (-0.6, -0.8))),
)
# points [m]
PRESSES: tuple[Pair, ...] = (((0.0, 0.3), (0.0, -0.3)), ((-0.1, 0.2), (0.15, -0.2)))
ABSENT = not_installed("pushpressslide-studies[bench]")
NO_DRAKE = not_installed("pushpressslide[drake]")


def push_contestants(seed: int) -> Contestants:
    """The closed form, DAQP and Drake's solvers, on feasible wrenches of two side
    contacts.

    The closed form is also timed by case: the requested split alone, a shift to the
    edge of a cone, or the projection of an infeasible wrench.
    """
    rng = np.random.default_rng(seed)
    cases: list[Case] = []
    for points, normals in PUSHES:
        span = solvers.grasp_matrix(points) @ solvers.edge_matrix(normals, FRICTION)
        wrenches = [(span @ k,) for k in rng.exponential(1.0, (WRENCHES, 4))]
        cases.append(((points, normals), wrenches))
    out = _closed_form_pushes(cases)
    for name, reuse in (("DAQP", False), ("DAQP, workspace kept", True)):
        make: Make = partial(solvers.daqp_pushes, friction=FRICTION, reuse=reuse)
        out[name] = _calls_if_installed(make, cases)
    return out | _drakes(_push_solvers, _drake_push, cases)


def _push_solvers() -> tuple[Iterable[str], Make]:
    from pushpressslide_studies.sim.bench_solvers import PUSH_SOLVERS, drake_pushes

    return PUSH_SOLVERS, drake_pushes


def _press_solvers() -> tuple[Iterable[str], Make]:
    from pushpressslide_studies.sim.bench_solvers import PRESS_SOLVERS, drake_presses

    return PRESS_SOLVERS, drake_presses


def _drakes(
    find: Callable[[], tuple[Iterable[str], Make]],
    problem: Callable[..., Callable[..., object]],
    cases: Sequence[Case],
) -> Contestants:
    """Drake's solvers, each with its program rebuilt and with its program kept."""
    try:
        names, solver = find()
    except MissingPackageError:
        return {"Drake": NO_DRAKE}
    out: Contestants = {}
    for name in names:
        make = partial(problem, partial(solver, name))
        out[f"Drake {name}"] = _calls(partial(_rebuilt, make), cases)
        out[f"Drake {name}, program kept"] = _calls(make, cases)
    return out


def _calls(make: Make, cases: Sequence[Case]) -> list[Call]:
    """A call for every input of every case. Each problem is built once."""
    return [
        (solve, inputs)
        for problem, several in cases
        for solve in [make(*problem)]
        for inputs in several
    ]


def _calls_if_installed(make: Make, cases: Sequence[Case]) -> list[Call] | str:
    try:
        return _calls(make, cases)
    except ModuleNotFoundError:
        return ABSENT


def _rebuilt(make: Make, *problem: Any) -> Callable[..., object]:
    """A solver that builds its program in each call."""
    return lambda *inputs: make(*problem)(*inputs)


def _drake_push(drake: Make, points: Pair, normals: Pair) -> Callable[..., object]:
    grasp = solvers.grasp_matrix(points)
    cones = solvers.cone_matrix(normals, FRICTION)
    return drake(grasp, cones, solvers.push_cost(points, normals))


def _drake_press(drake: Make, points: Pair) -> Callable[..., object]:
    return drake(solvers.grasp_matrix(points), FRICTION)


def _closed_form_pushes(cases: Sequence[Case]) -> Contestants:
    """Calls of the closed form: all, and separately by whether a cone's edge or a
    projection is needed.
    """
    ours = []
    moved = []
    for (points, normals), wrenches in cases:
        allocate = two_contact_allocator(points, normals, FRICTION, RHO)
        ours += [(allocate, tuple(w.tolist())) for (w,) in wrenches]
        moved += [(allocate, tuple((-w).tolist())) for (w,) in wrenches]
    edge = [call for call in ours if call[0](*call[1]).margin == 0.0]
    return {
        "closed form": ours,
        "closed form, inside the cones": [call for call in ours if call not in edge],
        "closed form, edge of a cone": edge,
        "closed form, wrench moved": moved,
    }


def press_contestants(seed: int) -> Contestants:
    """The closed form, Clarabel and Drake's solvers, on feasible wrenches of two
    presses.
    """
    rng = np.random.default_rng(seed)
    ours: list[Call] = []
    cases: list[Case] = []
    for points in PRESSES:
        allocate = two_press_allocator(points, FRICTION)
        possible = _possible_presses(rng, allocate)
        ours += [
            (allocate, (*wrench.tolist(), tuple(normals.tolist())))
            for wrench, normals in possible
        ]
        cases.append(((points,), possible))
    out: Contestants = {"closed form": ours}
    for name, reuse in (("Clarabel", False), ("Clarabel, solver kept", True)):
        make: Make = partial(solvers.clarabel_presses, friction=FRICTION, reuse=reuse)
        out[name] = _calls_if_installed(make, cases)
    return out | _drakes(_press_solvers, _drake_press, cases)


def _possible_presses(
    rng: np.random.Generator, allocate: Callable[..., Allocation]
) -> list[tuple[Array, Array]]:
    """Draw ``WRENCHES`` wrenches (3,) with normal forces (2,) [N] that can produce
    them.
    """
    possible: list[tuple[Array, Array]] = []
    while len(possible) < WRENCHES:
        wrench = rng.normal(size=3) * (1.0, 1.0, RHO)
        normals = rng.uniform(1.0, 10.0, 2)
        if allocate(*wrench.tolist(), tuple(normals.tolist())).status == "ok":
            possible.append((wrench, normals))
    return possible
