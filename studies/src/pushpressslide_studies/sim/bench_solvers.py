"""Allocation problems for Drake's solvers, as contestants of the benchmarks.

Each problem is one program. A call changes the wrench and, for presses, the radii of
the discs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydrake.solvers import ClarabelSolver, MathematicalProgram, OsqpSolver, ScsSolver

from pushpressslide.core.arrays import Array

PUSH_SOLVERS = {"OSQP": OsqpSolver, "Clarabel": ClarabelSolver, "SCS": ScsSolver}
PRESS_SOLVERS = {"Clarabel": ClarabelSolver, "SCS": ScsSolver}


def drake_pushes(
    name: str, grasp: Array, cones: Array, cost: Array
) -> Callable[[Array], Array | None]:
    """A solver that minimises f^T H f with G f = wrench and C f >= 0.

    G (3, 4) is ``grasp``, C (4, 4) ``cones``, H (4, 4) ``cost``; ``name`` is a key of
    PUSH_SOLVERS. The solver returns None if it fails.
    """
    program = MathematicalProgram()
    solver = PUSH_SOLVERS[name]()
    forces = program.NewContinuousVariables(4)
    balance = program.AddLinearEqualityConstraint(
        grasp, np.zeros(3), forces
    ).evaluator()
    program.AddLinearConstraint(cones, np.zeros(4), np.full(4, np.inf), forces)
    program.AddQuadraticCost(2.0 * cost, np.zeros(4), forces)

    def solve(wrench: Array) -> Array | None:
        """Forces (4,) [N]. None if the solver fails."""
        balance.UpdateCoefficients(grasp, wrench)
        result = solver.Solve(program)
        if not result.is_success():
            return None
        return np.asarray(result.GetSolution(forces))

    return solve


def drake_presses(
    name: str, grasp: Array, friction: float
) -> Callable[[Array, Array], Array | None]:
    """A solver that minimises f^T f with G f = wrench and each force in its disc.

    G (3, 4) is ``grasp``; the disc's radius is ``friction`` times the normal force;
    ``name`` is a key of PRESS_SOLVERS. The solver returns None if it fails.
    """
    program = MathematicalProgram()
    solver = PRESS_SOLVERS[name]()
    forces = program.NewContinuousVariables(4)
    balance = program.AddLinearEqualityConstraint(
        grasp, np.zeros(3), forces
    ).evaluator()
    program.AddQuadraticCost(2.0 * np.eye(4), np.zeros(4), forces)
    rows = []
    discs = []
    for i in range(2):
        row = np.zeros((3, 4))
        row[(1, 2), (2 * i, 2 * i + 1)] = 1.0
        rows.append(row)
        discs.append(
            program.AddLorentzConeConstraint(row, np.zeros(3), forces).evaluator()
        )

    def solve(wrench: Array, normals: Array) -> Array | None:
        """Forces (4,) [N]. None if the solver fails."""
        balance.UpdateCoefficients(grasp, wrench)
        for row, disc, normal in zip(rows, discs, normals, strict=True):
            disc.UpdateCoefficients(row, np.array([friction * normal, 0.0, 0.0]))
        result = solver.Solve(program)
        if not result.is_success():
            return None
        return np.asarray(result.GetSolution(forces))

    return solve
