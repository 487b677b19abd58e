"""The closed forms beside independent solvers, on random cases (docs/allocation.md)."""

from __future__ import annotations

import math
from collections.abc import Sequence

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
from pushpressslide.studies.bench.solvers import (
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
LEAST_DISTANCE = 0.03  # [m] between the contacts
TIGHT = {"tol_gap_abs": 1e-11, "tol_gap_rel": 1e-11, "tol_feas": 1e-11}


def pushes(cases: int, seed: int, split: Split = "least_friction") -> Figures:
    """Return how ``two_contact_allocator`` differs from DAQP, and from SciPy's NNLS
    where it moves a wrench.

    Counts, and the largest differences: wrench, cone and forces as parts of the largest
    force. Contacts at any places and normals, any friction; every second wrench is a
    sum of forces inside the cones.
    """
    from scipy.optimize import nnls

    rng = np.random.default_rng(seed)
    names = (
        "feasible",
        "near_boundary",
        "flag_differs",
        "wrench",
        "cone",
        "shear",
        "forces",
        "moved_further",
    )
    out = dict.fromkeys(names, 0.0)
    weights = np.array([1.0, 1.0, 1.0 / RHO])

    def note(name: str, value: float) -> None:
        out[name] = max(out[name], value)

    for case in range(cases):
        points, normals, friction = _side_contacts(rng)
        grasp = grasp_matrix(points)
        edges = edge_matrix(normals, friction)
        feasible = case % 2 == 0
        wrench = (
            grasp @ edges @ rng.exponential(1.0, 4)
            if feasible
            else rng.normal(size=3) / weights
        )
        ours = two_contact_allocator(points, normals, friction, RHO, split=split)(
            *wrench.tolist()
        )
        theirs = daqp_pushes(points, normals, friction, split=split, primal_tol=1e-11)(
            wrench
        )
        forces = np.array(ours.forces).ravel()
        scale = max(1.0, float(np.abs(forces).max()))
        near = (
            abs(WrenchCone(points, normals, friction, RHO).spare(*wrench.tolist()))
            < NEAR
        )
        out["near_boundary"] += near
        out["flag_differs"] += (ours.status == "ok") != (
            theirs is not None
        ) and not near
        note("cone", -float((cone_matrix(normals, friction) @ forces).min()) / scale)
        if ours.status == "ok":
            out["feasible"] += 1
            note(
                "wrench",
                float(np.abs(weights * (grasp @ forces - wrench)).max()) / scale,
            )
        if ours.status == "ok" and theirs is not None:
            cost = push_cost(points, normals, split)
            note("shear", (forces @ cost @ forces - theirs @ cost @ theirs) / scale**2)
            note("forces", float(np.abs(forces - theirs).max()) / scale)
        if ours.status != "ok":
            least = nnls(weights[:, None] * grasp @ edges, weights * wrench)[1]
            note(
                "moved_further",
                float(np.linalg.norm(weights * (grasp @ forces - wrench))) - least,
            )
    return _figures(cases, out)


def presses(cases: int, seed: int) -> Figures:
    """Return how ``two_press_allocator`` and the least presses differ from Clarabel's
    second-order cones.

    Counts, and the largest differences: wrench and discs as parts of the largest press,
    ``shear`` the antagonistic part of the forces beyond Clarabel's least, the rest
    relative.
    """
    rng = np.random.default_rng(seed)
    names = ("feasible", "near_boundary", "flag_differs", "wrench", "disc", "shear")
    out = dict.fromkeys(
        (*names, "scale", "press_in_ratio", "least_press", "unsolved"), 0.0
    )
    weights = np.array([1.0, 1.0, 1.0 / RHO])

    def note(name: str, value: float) -> None:
        out[name] = max(out[name], value)

    for _ in range(cases):
        points = _two_points(rng)
        friction = float(rng.uniform(0.1, 1.4))
        share = float(rng.uniform(0.05, 0.95))
        left, right, x, y = (
            rng.exponential(2.0, 2).tolist() + rng.uniform(-0.2, 0.2, 2).tolist()
        )
        most = (friction * left, friction * right)
        cop = (x, y)
        wrench = rng.normal(size=3) / weights
        fx, fy, tau = wrench.tolist()
        line = ContactLine(*points)
        grasp = grasp_matrix(points, cop)
        parts = line.parts(fx, fy, tau, cop)
        scale = largest_scale(parts, most)
        problem = PressProblem(line, grasp, wrench)
        theirs = {
            "scale": problem.largest_scale(most),
            "press_in_ratio": problem.least_press(
                (friction * (1.0 - share), friction * share)
            ),
            "least_press": problem.least_presses(friction),
        }
        values = (
            scale,
            least_press(parts, friction, share),
            sum(least_presses(parts, friction)),
        )
        for (name, solved), value in zip(theirs.items(), values, strict=True):
            out["unsolved"] += solved is None
            note(name, abs(value / solved - 1.0) if solved is not None else 0.0)
        ours = two_press_allocator(points, friction)(fx, fy, tau, (left, right), cop)
        near = abs(scale - 1.0) < NEAR
        out["near_boundary"] += near
        solved = theirs["scale"]
        out["flag_differs"] += (
            solved is not None and (ours.status == "ok") != (solved >= 1.0) and not near
        )
        forces = np.array(ours.forces)
        note("disc", float((np.hypot(*forces.T) - most).max()) / max(most))
        if ours.status == "ok":
            out["feasible"] += 1
            error = weights * (grasp @ forces.ravel() - wrench)
            note("wrench", float(np.abs(error).max()) / max(1.0, *most))
            least = problem.least_antagonism(most)
            out["unsolved"] += least is None
            note(
                "shear",
                float(np.abs(forces @ line.e).sum()) - least
                if least is not None
                else 0.0,
            )
    return _figures(cases, out)


def _figures(cases: int, found: Figures) -> Figures:
    return {"cases": cases} | {
        k: int(v) if k in COUNTS else float(v) for k, v in found.items()
    }


class PressProblem:
    """Two presses as second-order cone programs: forces inside discs that add up to a
    wrench.
    """

    def __init__(self, line: ContactLine, grasp: Array, wrench: Array) -> None:
        self._line = line
        self._grasp = grasp
        self._wrench = wrench

    def largest_scale(self, most: Sequence[float]) -> float | None:
        """Return the largest factor of the wrench for discs of radius ``most`` [N]."""
        x = self._solve(
            [-1.0], np.zeros((2, 1)), most, wrench_of=-self._wrench[:, None], fixed=0.0
        )
        return None if x is None else float(x[4])

    def least_press(self, radii: Sequence[float]) -> float | None:
        """Return the least sum [N] of normals for discs of radius ``radii`` times that
        sum.
        """
        x = self._solve([1.0], np.array(radii)[:, None], (0.0, 0.0))
        return None if x is None else float(x[4])

    def least_presses(self, friction: float) -> float | None:
        """Return the least sum [N] of two normals."""
        x = self._solve([1.0, 1.0], friction * np.eye(2), (0.0, 0.0))
        return None if x is None else float(x[4] + x[5])

    def least_antagonism(self, most: Sequence[float]) -> float | None:
        """Return the least |f_1.e| + |f_2.e| [N] for discs of radius ``most`` [N]."""
        along = np.zeros((4, 6))
        for i in range(2):
            for j, sign in enumerate((1.0, -1.0)):
                along[2 * i + j, 2 * i : 2 * i + 2] = sign * np.array(self._line.e)
                along[2 * i + j, 4 + i] = -1.0
        x = self._solve([1.0, 1.0], np.zeros((2, 2)), most, bounded=along)
        return None if x is None else float(x[4] + x[5])

    def _solve(
        self,
        linear: list[float],
        radii: Array,
        radius: Sequence[float],
        *,
        wrench_of: Array | None = None,
        fixed: float = 1.0,
        bounded: Array | None = None,
    ) -> Array | None:
        """Return (f, y) with ``linear`` y least, where |f_i| <= radius_i + (radii y)_i,
        bounded (f, y) <= 0 and G f + wrench_of y = fixed w.
        """
        extra = len(linear)
        balance = np.hstack(
            [self._grasp, np.zeros((3, extra)) if wrench_of is None else wrench_of]
        )
        bounds = np.zeros((0, 4 + extra)) if bounded is None else bounded
        discs = np.zeros((6, 4 + extra))
        offsets = np.zeros(9 + len(bounds))
        for i in range(2):
            discs[3 * i, 4:] = -radii[i]
            discs[(3 * i + 1, 3 * i + 2), (2 * i, 2 * i + 1)] = -1.0
            offsets[3 + len(bounds) + 3 * i] = radius[i]
        offsets[:3] = fixed * self._wrench
        rows = np.vstack([balance, bounds, discs])
        cost = np.array([0.0] * 4 + linear)
        return clarabel_conic(cost, rows, offsets, 3, len(bounds), 2, **TIGHT)


def _side_contacts(
    rng: np.random.Generator,
) -> tuple[tuple[Point, Point], tuple[Point, Point], float]:
    """Return points [m], normals and friction of two side contacts that do not face
    each other.
    """
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
