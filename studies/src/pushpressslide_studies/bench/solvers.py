"""Allocation problems in the form that solvers require, to check the closed forms and
to compare them.

The module needs the extra ``bench``: DAQP for the friction cones of side contacts,
Clarabel for the discs of presses. It is never used in a control loop.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pushpressslide.allocation.contact_line import Split
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide.mechanics.friction import cone_edges

PushSolver = Callable[[Array], Array | None]
"""Function from a wrench (3,) [N, N m] to two forces (4,) [N] inside their cones. It
returns None if there are none.
"""
PressSolver = Callable[[Array, Array], Array | None]
"""Function from a wrench (3,) [N, N m] and two normal forces (2,) [N] to two forces
(4,) [N] inside their discs. It returns None if there are none.
"""


def grasp_matrix(points: Sequence[Point], about: Point = (0.0, 0.0)) -> Array:
    """Matrix G (3, 4): G f is the wrench of forces f at two points [m].

    The moment is about the point ``about`` [m].
    """
    (x1, y1), (x2, y2) = ((x - about[0], y - about[1]) for x, y in points)
    return np.array([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [-y1, x1, -y2, x2]])


def cone_matrix(normals: Sequence[Point], friction: float) -> Array:
    """Matrix C (4, 4): C f >= 0 if and only if both forces are inside their friction
    cones.
    """
    rows = np.zeros((4, 4))
    for i, normal in enumerate(normals):
        right, left = cone_edges(normal, friction)
        rows[2 * i, 2 * i : 2 * i + 2] = (-right[1], right[0])
        rows[2 * i + 1, 2 * i : 2 * i + 2] = (left[1], -left[0])
    return rows


def edge_matrix(normals: Sequence[Point], friction: float) -> Array:
    """Matrix E (4, 4): the forces inside both cones are E k with k >= 0.

    k [N] are normal forces.
    """
    edges = np.zeros((4, 4))
    for i, normal in enumerate(normals):
        edges[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = np.array(
            cone_edges(normal, friction)
        ).T
    return edges


def push_cost(
    points: Sequence[Point], normals: Sequence[Point], split: Split = "least_friction"
) -> Array:
    """Matrix H (4, 4): f^T H f is the cost that ``split`` minimises.

    H includes a term G^T G, which is constant for a given wrench. It makes H positive
    definite without shifting a minimum.
    """
    if split == "least_force":
        return np.eye(4)
    tangents = np.zeros((2, 4))
    for i, (nx, ny) in enumerate(normals):
        tangents[i, 2 * i : 2 * i + 2] = (-ny, nx)
    grasp = grasp_matrix(points)
    return np.asarray(tangents.T @ tangents + grasp.T @ grasp)


def daqp_pushes(
    points: Sequence[Point],
    normals: Sequence[Point],
    friction: float,
    *,
    split: Split = "least_friction",
    reuse: bool = False,
    **settings: float,
) -> PushSolver:
    """Solver of the problem of ``two_contact_allocator`` by DAQP.

    With ``reuse`` there is one workspace, in which a call changes only the bounds.
    ``settings`` are those of DAQP.
    """
    import daqp

    cost = push_cost(points, normals, split)
    linear = np.zeros(4)
    blocks = [grasp_matrix(points), cone_matrix(normals, friction)]
    rows = np.ascontiguousarray(np.vstack(blocks))
    upper = np.full(7, 1e30)
    lower = np.zeros(7)
    sense = np.array([5, 5, 5, 0, 0, 0, 0], dtype=np.int32)
    problem = (cost, linear, rows, upper, lower, sense)
    model = daqp.Model()
    model.setup(*problem)
    model.settings = settings

    def solve(wrench: Array) -> Array | None:
        """Forces (4,) [N]. None if there are none."""
        upper[:3] = lower[:3] = wrench
        if reuse:
            model.update(bupper=upper, blower=lower)
            forces, _, flag, _ = model.solve()
        else:
            forces, _, flag, _ = daqp.solve(*problem, **settings)
        return forces if flag > 0 else None

    return solve


def _quiet(**settings: float) -> Any:
    """Clarabel's options with some changes, and without printing."""
    import clarabel

    options = clarabel.DefaultSettings()
    options.verbose = False
    for name, value in settings.items():
        setattr(options, name, value)
    return options


def clarabel_conic(
    linear: Array,
    rows: Array,
    offsets: Array,
    equal: int,
    at_least: int,
    cones: int,
    **settings: float,
) -> Array | None:
    """The x that minimises ``linear`` x, by Clarabel. None if the problem has no
    solution.

    The vector offsets - rows x must lie in the cones. The rows are, in this order,
    ``equal`` zeros, ``at_least`` numbers >= 0 and ``cones`` second-order cones of size
    3.
    """
    import clarabel
    from scipy.sparse import csc_matrix

    kinds = [clarabel.ZeroConeT(equal), clarabel.NonnegativeConeT(at_least)]
    kinds += [clarabel.SecondOrderConeT(3) for _ in range(cones)]
    options = _quiet(**settings)
    n = len(linear)
    solver = clarabel.DefaultSolver(
        csc_matrix((n, n)), linear, csc_matrix(rows), offsets, kinds, options
    )
    solution = solver.solve()
    good = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
    return np.array(solution.x) if solution.status in good else None


def clarabel_presses(
    points: Sequence[Point], friction: float, *, reuse: bool = False
) -> PressSolver:
    """Solver of the problem of ``two_press_allocator`` by Clarabel.

    It minimises the sum of squared forces inside the discs; moments are about B's
    origin. With ``reuse`` there is one solver, in which a call changes only the
    right-hand side.
    """
    import clarabel
    from scipy.sparse import csc_matrix

    cost = csc_matrix(np.eye(4))
    linear = np.zeros(4)
    discs = np.zeros((6, 4))
    discs[(1, 2, 4, 5), (0, 1, 2, 3)] = -1.0
    rows = csc_matrix(np.vstack([grasp_matrix(points), discs]))
    disc = clarabel.SecondOrderConeT(3)
    cones = [clarabel.ZeroConeT(3), disc, disc]
    options = _quiet(presolve_enable=False)  # must be off to change data
    offsets = np.zeros(9)
    reused = clarabel.DefaultSolver(cost, linear, rows, offsets, cones, options)

    def solve(wrench: Array, normals: Array) -> Array | None:
        """Forces (4,) [N]. None if there are none."""
        offsets[:3] = wrench
        offsets[3], offsets[6] = friction * normals
        solver = reused
        if reuse:
            solver.update(b=offsets)
        else:
            solver = clarabel.DefaultSolver(cost, linear, rows, offsets, cones, options)
        solution = solver.solve()
        if solution.status != clarabel.SolverStatus.Solved:
            return None
        return np.array(solution.x)

    return solve
