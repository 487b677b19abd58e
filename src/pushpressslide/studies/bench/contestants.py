"""The contestants of the allocators' speed benchmarks: ours, and solvers beside them.

Every solver once with its problem built in the call, as it has to be where contacts or
presses change, and once with all of it kept but the numbers that change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from pushpressslide.allocation.presses import two_press_allocator
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.allocation import Allocation
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.studies.bench import solvers

Call = tuple[Callable[..., object], tuple[Any, ...]]
"""A function, and what to call it with."""
Contestants = dict[str, Sequence[Call] | str]
"""The calls of each contestant, or why there are none; ours first."""
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
ABSENT = "not installed: pip install 'pushpressslide[bench]'"


def push_contestants(seed: int) -> Contestants:
    """Return us, DAQP and Drake's solvers, on possible wrenches of two side contacts.

    Ours also by what it has to do: nothing but the split that is wanted, or go to the
    edge of a cone, or move a wrench that is not possible.
    """
    from pushpressslide.sim.bench_solvers import PUSH_SOLVERS, drake_pushes

    rng = np.random.default_rng(seed)
    cases = []
    for points, normals in PUSHES:
        span = solvers.grasp_matrix(points) @ solvers.edge_matrix(normals, FRICTION)
        cases.append(
            (points, normals, [span @ k for k in rng.exponential(1.0, (WRENCHES, 4))])
        )

    def calls(make: Callable[[Pair, Pair], Callable[[Array], object]]) -> list[Call]:
        """Return a call for every case; each problem is made once."""
        return [
            (solve, (w,))
            for p, n, wrenches in cases
            for solve in [make(p, n)]
            for w in wrenches
        ]

    out = _closed_form_pushes(cases)
    for name, reuse in (("DAQP", False), ("DAQP, workspace kept", True)):
        try:
            make = partial(solvers.daqp_pushes, friction=FRICTION, reuse=reuse)
            out[name] = calls(make)
        except ModuleNotFoundError:
            out[name] = ABSENT
    for name in PUSH_SOLVERS:

        def reused(
            points: Pair, normals: Pair, name: str = name
        ) -> Callable[[Array], object]:
            """Return a solver whose program is kept."""
            grasp = solvers.grasp_matrix(points)
            cones = solvers.cone_matrix(normals, FRICTION)
            return drake_pushes(name, grasp, cones, solvers.push_cost(points, normals))

        def fresh(
            points: Pair, normals: Pair, reused: Any = reused
        ) -> Callable[[Array], object]:
            """Return a solver that builds its program in each call."""
            return lambda wrench: reused(points, normals)(wrench)

        out[f"Drake {name}"] = calls(fresh)
        out[f"Drake {name}, program kept"] = calls(reused)
    return out


def _closed_form_pushes(
    cases: Sequence[tuple[Pair, Pair, Sequence[Array]]],
) -> Contestants:
    """Return our calls: all, and by whether a cone's edge or a move is needed."""
    ours = []
    moved = []
    for points, normals, wrenches in cases:
        allocate = two_contact_allocator(points, normals, FRICTION, RHO)
        ours += [(allocate, tuple(w.tolist())) for w in wrenches]
        moved += [(allocate, tuple((-w).tolist())) for w in wrenches]
    edge = [call for call in ours if call[0](*call[1]).margin == 0.0]
    return {
        "closed form": ours,
        "closed form, inside the cones": [call for call in ours if call not in edge],
        "closed form, edge of a cone": edge,
        "closed form, wrench moved": moved,
    }


def press_contestants(seed: int) -> Contestants:
    """Return us, Clarabel and Drake's solvers, on possible wrenches of two presses."""
    from pushpressslide.sim.bench_solvers import PRESS_SOLVERS, drake_presses

    rng = np.random.default_rng(seed)
    ours: list[Call] = []
    cases = []
    for points in PRESSES:
        allocate = two_press_allocator(points, FRICTION)
        possible = _possible_presses(rng, allocate)
        ours += [
            (allocate, (*wrench.tolist(), tuple(normals.tolist())))
            for wrench, normals in possible
        ]
        cases.append((points, possible))

    def calls(make: Callable[[Pair], Callable[[Array, Array], object]]) -> list[Call]:
        """Return a call for every case; each problem is made once."""
        return [
            (solve, case)
            for points, possible in cases
            for solve in [make(points)]
            for case in possible
        ]

    out: Contestants = {"closed form": ours}
    for name, reuse in (("Clarabel", False), ("Clarabel, solver kept", True)):
        try:
            out[name] = calls(
                partial(solvers.clarabel_presses, friction=FRICTION, reuse=reuse)
            )
        except ModuleNotFoundError:
            out[name] = ABSENT
    for name in PRESS_SOLVERS:

        def reused(points: Pair, name: str = name) -> Callable[[Array, Array], object]:
            """Return a solver whose program is kept."""
            return drake_presses(name, solvers.grasp_matrix(points), FRICTION)

        def fresh(
            points: Pair, reused: Any = reused
        ) -> Callable[[Array, Array], object]:
            """Return a solver that builds its program in each call."""
            return lambda wrench, normals: reused(points)(wrench, normals)

        out[f"Drake {name}"] = calls(fresh)
        out[f"Drake {name}, program kept"] = calls(reused)
    return out


def _possible_presses(
    rng: np.random.Generator, allocate: Callable[..., Allocation]
) -> list[tuple[Array, Array]]:
    """Draw ``WRENCHES`` wrenches (3,) with normal forces (2,) [N] that can give them."""
    possible: list[tuple[Array, Array]] = []
    while len(possible) < WRENCHES:
        wrench = rng.normal(size=3) * (1.0, 1.0, RHO)
        normals = rng.uniform(1.0, 10.0, 2)
        if allocate(*wrench.tolist(), tuple(normals.tolist())).status == "ok":
            possible.append((wrench, normals))
    return possible
