"""Comparison of the closed forms with independent solvers, on random cases
(docs/mechanics.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pushpressslide.allocation.contact_line import FACING, ContactLine, Split
from pushpressslide.allocation.presses import (
    largest_scale,
    least_press,
    least_presses,
    two_press_allocator,
)
from pushpressslide.allocation.projections import WrenchCone
from pushpressslide.allocation.two_contacts import two_contact_allocator
from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Point
from pushpressslide_studies.bench.solvers import (
    clarabel_conic,
    cone_matrix,
    daqp_pushes,
    edge_matrix,
    grasp_matrix,
    push_cost,
)

Figures = dict[str, float]
COUNTS = ("feasible", "near_boundary", "flag_differs", "unsolved")
NEAR = 1e-9  # [N] to the boundary, of wrenches of about 1 N: so near a flag may differ
RHO = 0.08  # [m]
WEIGHTS = np.array([1.0, 1.0, 1.0 / RHO])  # of a wrench, to compare its parts
LEAST_DISTANCE = 0.03  # [m] between the contacts
TIGHT = {"tol_gap_abs": 1e-11, "tol_gap_rel": 1e-11, "tol_feas": 1e-11}


@dataclass
class Tally:
    """Counts and largest differences over all cases of a comparison."""

    figures: Figures

    @classmethod
    def zeros(cls, *names: str) -> Tally:
        """A tally with all figures at zero."""
        return cls(dict.fromkeys(names, 0.0))

    def count(self, name: str, happened: bool) -> None:
        """Count a case under ``name`` if it happened."""
        self.figures[name] += happened

    def note(self, name: str, value: float) -> None:
        """Record ``value`` if it is the largest so far."""
        self.figures[name] = max(self.figures[name], value)

    def over(self, cases: int) -> Figures:
        """All figures, with the number of cases. Counts are integers."""
        out: Figures = {"cases": cases}
        for name, value in self.figures.items():
            out[name] = int(value) if name in COUNTS else float(value)
        return out


def pushes(cases: int, seed: int, split: Split = "least_friction") -> Figures:
    """Differences of ``two_contact_allocator`` from DAQP and SciPy's NNLS.

    The result has counts and the largest differences of wrench, cone and forces, as
    fractions of the largest force. NNLS is used for projected wrenches. Contacts have
    arbitrary positions, normals and friction; every second wrench is a sum of forces
    inside the cones.
    """
    rng = np.random.default_rng(seed)
    tally = Tally.zeros(
        "feasible",
        "near_boundary",
        "flag_differs",
        "wrench",
        "cone",
        "shear",
        "forces",
        "moved_further",
    )
    for case in range(cases):
        _compare_push(rng, tally, split, feasible=case % 2 == 0)
    return tally.over(cases)


def _compare_push(
    rng: np.random.Generator, tally: Tally, split: Split, feasible: bool
) -> None:
    """Draw a case of two side contacts and compare its allocations."""
    from scipy.optimize import nnls

    points, normals, friction = _side_contacts(rng)
    grasp = grasp_matrix(points)
    edges = edge_matrix(normals, friction)
    if feasible:
        wrench = grasp @ edges @ rng.exponential(1.0, 4)
    else:
        wrench = rng.normal(size=3) / WEIGHTS
    fx, fy, tau = wrench.tolist()
    allocate = two_contact_allocator(points, normals, friction, RHO, split=split)
    ours = allocate(fx, fy, tau)
    solver = daqp_pushes(points, normals, friction, split=split, primal_tol=1e-11)
    theirs = solver(wrench)
    forces = np.array(ours.forces).ravel()
    scale = max(1.0, float(np.abs(forces).max()))
    cone = WrenchCone(points, normals, friction, RHO)
    near = abs(cone.margin(fx, fy, tau)) < NEAR
    possible = ours.status == "ok"
    tally.count("near_boundary", near)
    tally.count("flag_differs", possible != (theirs is not None) and not near)
    inside = float((cone_matrix(normals, friction) @ forces).min())
    tally.note("cone", -inside / scale)
    residual = WEIGHTS * (grasp @ forces - wrench)
    if not possible:
        least = nnls(WEIGHTS[:, None] * grasp @ edges, WEIGHTS * wrench)[1]
        tally.note("moved_further", float(np.linalg.norm(residual)) - least)
        return
    tally.count("feasible", True)
    tally.note("wrench", float(np.abs(residual).max()) / scale)
    if theirs is not None:
        cost = push_cost(points, normals, split)
        excess = forces @ cost @ forces - theirs @ cost @ theirs
        tally.note("shear", excess / scale**2)
        tally.note("forces", float(np.abs(forces - theirs).max()) / scale)


def presses(cases: int, seed: int) -> Figures:
    """Differences of ``two_press_allocator`` and of the minimum presses from the
    results of Clarabel.

    The result has counts and the largest differences. ``wrench`` and ``disc`` are
    fractions of the radius of the larger friction disc, ``shear`` is the excess of the
    antagonistic force over Clarabel's minimum, and all others are relative.
    """
    rng = np.random.default_rng(seed)
    tally = Tally.zeros(
        "feasible",
        "near_boundary",
        "flag_differs",
        "wrench",
        "disc",
        "shear",
        "scale",
        "press_in_ratio",
        "least_press",
        "unsolved",
    )
    for _ in range(cases):
        _compare_presses(rng, tally)
    return tally.over(cases)


def _compare_presses(rng: np.random.Generator, tally: Tally) -> None:
    """Draw a case of two presses and compare its allocations."""
    case = _pressed_case(rng)
    line = ContactLine(*case.points)
    grasp = grasp_matrix(case.points, case.cop)
    problem = PressProblem(line, grasp, case.wrench)
    scale, solved_scale = _compare_least_presses(tally, case, line, problem)
    allocate = two_press_allocator(case.points, case.friction)
    fx, fy, tau = case.wrench.tolist()
    ours = allocate(fx, fy, tau, case.normals, case.cop)
    possible = ours.status == "ok"
    near = abs(scale - 1.0) < NEAR
    tally.count("near_boundary", near)
    max_shear = case.max_shear
    if solved_scale is not None:
        tally.count("flag_differs", possible != (solved_scale >= 1.0) and not near)
    forces = np.array(ours.forces)
    beyond = float((np.hypot(*forces.T) - max_shear).max())
    tally.note("disc", beyond / max(max_shear))
    if not possible:
        return
    tally.count("feasible", True)
    residual = WEIGHTS * (grasp @ forces.ravel() - case.wrench)
    tally.note("wrench", float(np.abs(residual).max()) / max(1.0, *max_shear))
    least = problem.least_antagonism(max_shear)
    tally.count("unsolved", least is None)
    if least is not None:
        tally.note("shear", float(np.abs(forces @ line.e).sum()) - least)


@dataclass(frozen=True, slots=True)
class PressCase:
    """Two presses and a requested wrench."""

    points: tuple[Point, Point]  # [m]
    friction: float
    share: float  # of the second press
    normals: tuple[float, float]  # [N]
    cop: Point  # [m] about which the moment is
    wrench: Array  # (3,) [N, N m]

    @property
    def max_shear(self) -> tuple[float, float]:
        """Radii [N] of the friction discs."""
        left, right = self.normals
        return self.friction * left, self.friction * right


def _pressed_case(rng: np.random.Generator) -> PressCase:
    points = _two_points(rng)
    friction = float(rng.uniform(0.1, 1.4))
    share = float(rng.uniform(0.05, 0.95))
    left, right = rng.exponential(2.0, 2).tolist()
    x, y = rng.uniform(-0.2, 0.2, 2).tolist()
    wrench = rng.normal(size=3) / WEIGHTS
    return PressCase(points, friction, share, (left, right), (x, y), wrench)


def _compare_least_presses(
    tally: Tally, case: PressCase, line: ContactLine, problem: PressProblem
) -> tuple[float, float | None]:
    """Compare the minimum presses and the largest scale of the wrench.

    Returns the scale in closed form, and that of the solver or None.
    """
    friction = case.friction
    fx, fy, tau = case.wrench.tolist()
    parts = line.components(fx, fy, tau, case.cop)
    scale = largest_scale(parts, case.max_shear)
    solved_scale = problem.largest_scale(case.max_shear)
    ratio = (friction * (1.0 - case.share), friction * case.share)
    in_ratio = least_press(parts, friction, case.share)
    least = sum(least_presses(parts, friction))
    for name, solved, value in (
        ("scale", solved_scale, scale),
        ("press_in_ratio", problem.least_press(ratio), in_ratio),
        ("least_press", problem.least_presses(friction), least),
    ):
        tally.count("unsolved", solved is None)
        if solved is not None:
            tally.note(name, abs(value / solved - 1.0))
    return scale, solved_scale


class PressProblem:
    """Two presses as second-order cone programs.

    Forces inside discs must add up to a wrench.
    """

    def __init__(self, line: ContactLine, grasp: Array, wrench: Array) -> None:
        self._line = line
        self._grasp = grasp
        self._wrench = wrench

    def largest_scale(self, limits: Sequence[float]) -> float | None:
        """Largest factor of the wrench for discs with the radii ``limits`` [N]."""
        column = -self._wrench[:, None]
        return self._solve(
            [-1.0], np.zeros((2, 1)), limits, wrench_of=column, fixed=0.0
        )

    def least_press(self, radii: Sequence[float]) -> float | None:
        """Minimum sum [N] of normals, for discs with ``radii`` times this sum as their
        radii.
        """
        return self._solve([1.0], np.array(radii)[:, None], (0.0, 0.0))

    def least_presses(self, friction: float) -> float | None:
        """Minimum sum [N] of two normals."""
        return self._solve([1.0, 1.0], friction * np.eye(2), (0.0, 0.0))

    def least_antagonism(self, limits: Sequence[float]) -> float | None:
        """Minimum of |f_1.e| + |f_2.e| [N] for discs with the radii ``limits`` [N]."""
        along = np.zeros((4, 6))
        for i in range(2):
            for j, sign in enumerate((1.0, -1.0)):
                along[2 * i + j, 2 * i : 2 * i + 2] = sign * np.array(self._line.e)
                along[2 * i + j, 4 + i] = -1.0
        return self._solve([1.0, 1.0], np.zeros((2, 2)), limits, bounded=along)

    def _solve(
        self,
        linear: list[float],
        radii: Array,
        radius: Sequence[float],
        *,
        wrench_of: Array | None = None,
        fixed: float = 1.0,
        bounded: Array | None = None,
    ) -> float | None:
        """Sum of the y that minimise ``linear`` y. None if unsolved.

        The constraints on the forces f are |f_i| <= radius_i + (radii y)_i, bounded (f,
        y) <= 0, and G f + wrench_of y = fixed w.
        """
        extra = len(linear)
        if wrench_of is None:
            wrench_of = np.zeros((3, extra))
        if bounded is None:
            bounded = np.zeros((0, 4 + extra))
        balance = np.hstack([self._grasp, wrench_of])
        discs = np.zeros((6, 4 + extra))
        offsets = np.zeros(9 + len(bounded))
        for i in range(2):
            discs[3 * i, 4:] = -radii[i]
            discs[(3 * i + 1, 3 * i + 2), (2 * i, 2 * i + 1)] = -1.0
            offsets[3 + len(bounded) + 3 * i] = radius[i]
        offsets[:3] = fixed * self._wrench
        rows = np.vstack([balance, bounded, discs])
        cost = np.array([0.0] * 4 + linear)
        x = clarabel_conic(cost, rows, offsets, 3, len(bounded), 2, **TIGHT)
        return None if x is None else float(sum(x[4:]))


def _side_contacts(
    rng: np.random.Generator,
) -> tuple[tuple[Point, Point], tuple[Point, Point], float]:
    """Points [m], normals and friction of two contacts that do not face each other."""
    points = _two_points(rng)
    line = ContactLine(*points)
    while True:
        a, b = rng.uniform(-math.pi, math.pi, 2).tolist()
        normals = ((math.cos(a), math.sin(a)), (math.cos(b), math.sin(b)))
        if max(abs(line.in_axes(n)[1]) for n in normals) > FACING:
            return points, normals, float(rng.uniform(0.1, 1.4))


def _two_points(rng: np.random.Generator) -> tuple[Point, Point]:
    while True:
        (ax, ay), (bx, by) = rng.uniform(-0.3, 0.3, (2, 2)).tolist()
        if math.dist((ax, ay), (bx, by)) > LEAST_DISTANCE:
            return (ax, ay), (bx, by)
