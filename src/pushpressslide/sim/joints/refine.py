"""Near misses made good by trajectory optimisation, Drake's
KinematicTrajectoryOptimization.

Continuation over a grid of tool yaws and tilts (postures.py) looks one sample ahead;
where it just fails, a spline over the whole path may still be found: yaw and tilt are
unknowns too, and the elbow is placed where the path will need it. The optimiser needs a
start that is nearly a solution and proves nothing when it fails, so it is given near
misses only, and its result is judged by the same figures as any other. Iterations are
limited, not time: the answer must not depend on the machine's load.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff
from pydrake.planning import KinematicTrajectoryOptimization
from pydrake.solvers import Constraint, MathematicalProgram, SnoptSolver, SolverOptions

from pushpressslide.core.arrays import Array
from pushpressslide.core.pose import Pose2
from pushpressslide.robots.inverse import (
    IkSearch,
    orientation_error,
    solve_ik,
    task_error,
)
from pushpressslide.robots.kinematics import ArmKinematics
from pushpressslide.robots.tool import ToolAttitude
from pushpressslide.sim.joints.clearance import ClearanceModel
from pushpressslide.sim.joints.postures import LARGEST_STEP, Posture, TipPath

Function = Callable[[Array], tuple[Array, Array]]
"""Value (m,) and Jacobian (m, size) at a point (size,)."""

MAJOR_LIMIT = 40
MINOR_LIMIT = 4000  # iterations of one optimisation, a second or two
POINT_STEP = 0.025  # [m] of the tip between control points
LEAST_POINTS = 10
MOST_POINTS = 30
WAY_POINTS = 12
WAY_SAMPLES = 40
ANGLE_SLACK = 1e-3
POSITION_SLACK = 1e-4  # [rad], [m] of the tip at the samples, taken out afterwards
MARGIN_SLACK = 2e-3  # [rad] that the spline keeps on top of the joint margin
CLEARANCE_SLACK = 1e-3  # [m] that the samples keep on top of the clearance
YAW_ROOM = 0.5  # [rad] by which the tool's yaw may leave the guess
STEEPEST = math.radians(45.0)  # tilt
STEP_SHARE = 0.93  # of the allowed step that the spline uses


def refined_move(
    kin: ArmKinematics,
    model: ClearanceModel,
    path: TipPath,
    guess: Posture,
    margin: float,
    clearance: float,
) -> Posture | None:
    """Return a way near ``guess`` to follow ``path``, or None if the optimiser's is
    none.

    It keeps ``margin`` [rad] to the joint limits and ``clearance`` [m]; the tip is
    right to 1e-6 m and rad at every sample.
    """
    n = kin.facts.size
    k = len(path.yaws)
    way = float(np.linalg.norm(np.diff(path.positions, axis=0), axis=1).sum())
    points = min(max(LEAST_POINTS, math.ceil(way / POINT_STEP)), MOST_POINTS, k)
    picked = np.unique(np.linspace(0, k - 1, points).round().astype(int))
    inset = margin + MARGIN_SLACK
    lower = np.append(kin.facts.lower + inset, [guess.offset - YAW_ROOM, 0.0])
    upper = np.append(kin.facts.upper - inset, [guess.offset + YAW_ROOM, STEEPEST])
    held = np.column_stack(
        [
            guess.q[picked],
            np.tile([guess.offset, guess.attitude.tilt], (len(picked), 1)),
        ]
    )
    spline = _Spline(lower, upper, held)
    spline.hold_constant((n, n + 1))
    spline.limit_steps(STEP_SHARE * LARGEST_STEP, k)
    slack = np.repeat([ANGLE_SLACK, POSITION_SLACK], 3)
    for i in picked:
        u = i / (k - 1)
        spline.constrain(
            u, _tip(kin, guess.attitude, path.positions[i], path.yaws[i]), -slack, slack
        )
        spline.keep_clear(u, model, path.objects[i], clearance, n, touching=True)
    found = spline.solution(k)
    tilt = float(np.clip(found[0, n + 1], 0.0, STEEPEST))
    attitude = replace(guess.attitude, tilt=tilt)
    offset = float(found[0, n])
    exact = solve_ik(
        kin,
        path.positions,
        attitude,
        path.yaws + offset,
        found[:, None, :n],
        margin,
        search=IkSearch(first_found=True),
    )
    return Posture(attitude, offset, exact.q) if exact.converged.all() else None


def _tip(
    kin: ArmKinematics, attitude: ToolAttitude, position: Array, yaw: float
) -> Function:
    """The tip's error (6,) [rad; m] as a function of joints, tool yaw offset and tilt."""
    n = kin.facts.size
    step = 1e-6

    def error(x: Array) -> tuple[Array, Array]:
        offset = x[n]
        tilt = min(max(x[n + 1], 0.0), STEEPEST)
        tools = [replace(attitude, tilt=tilt), replace(attitude, tilt=tilt + step)]
        R = tools[0].rotation(yaw + offset)
        e, J = task_error(kin, x[:n], position, R, tools[0].axis)
        jacobian = np.zeros((6, n + 2))
        jacobian[:, :n] = -J
        turned = (
            tools[0].rotation(yaw + offset + step),
            tools[1].rotation(yaw + offset),
        )
        jacobian[:3, n:] = orientation_error(R, np.array(turned)).T / step
        return e, jacobian

    return error


class _Spline:
    """A clamped cubic B-spline over [0, 1] that is to be as short as its constraints
    allow.
    """

    def __init__(self, lower: Array, upper: Array, guess: Array) -> None:
        """Begin with bounds (size,) and the control points (m, size) of a guess."""
        points, self.size = guess.shape
        self.problem = KinematicTrajectoryOptimization(self.size, points, 4, 1.0)
        self.program = self.problem.get_mutable_prog()
        self.problem.AddDurationConstraint(1.0, 1.0)
        self.problem.AddPositionBounds(lower, upper)
        self.problem.AddPathEnergyCost(1.0)
        self.points = self.problem.control_points()
        self.program.SetInitialGuess(self.points, np.clip(guess, lower, upper).T)
        self.program.SetInitialGuess(self.problem.duration(), 1.0)

    def hold_constant(self, rows: Sequence[int]) -> None:
        """Keep some coordinates the same all along."""
        for row in rows:
            for a, b in zip(self.points[row], self.points[row, 1:], strict=False):
                self.program.AddLinearEqualityConstraint(a - b, 0.0)

    def limit_steps(self, largest: float, samples: int) -> None:
        """Bound what any coordinate does between two of ``samples`` equal steps."""
        rate = np.full(self.size, largest * (samples - 1))
        self.problem.AddVelocityBounds(-rate, rate)

    def pin(self, u: float, value: Array) -> None:
        """Pass through ``value`` at ``u``."""
        self.problem.AddPathPositionConstraint(value, value, u)

    def constrain(
        self, u: float, function: Function, lower: Array, upper: Array
    ) -> None:
        """Bound a function of the point at ``u``."""
        self.problem.AddPathPositionConstraint(
            _constraint(function, lower, upper, self.size), float(u)
        )

    def keep_clear(
        self,
        u: float,
        model: ClearanceModel,
        pose: Pose2,
        clearance: float,
        joints: int,
        *,
        touching: bool,
    ) -> None:
        """Keep the arm ``clearance`` [m] away from everything at ``u``, with the object
        at ``pose``.
        """

        def distance(x: Array) -> tuple[Array, Array]:
            least, gradient = model.smooth_least(x[:joints], pose, touching=touching)
            return np.array([least]), np.append(gradient, np.zeros(self.size - joints))[
                None
            ]

        self.constrain(
            u, distance, np.array([clearance + CLEARANCE_SLACK]), np.array([np.inf])
        )

    def solution(self, samples: int) -> Array:
        """Return the optimiser's result at equal steps (samples, size), good or not."""
        options = SolverOptions()
        for name, value in (
            ("Major iterations limit", MAJOR_LIMIT),
            ("Iterations limit", MINOR_LIMIT),
            ("Major optimality tolerance", 1e-2),
            ("Major feasibility tolerance", 1e-5),
        ):
            options.SetOption(SnoptSolver.id(), name, value)
        result = SnoptSolver().Solve(self.program, None, options)
        curve = self.problem.ReconstructTrajectory(result)
        out: Array = curve.vector_values(
            np.linspace(curve.start_time(), curve.end_time(), samples)
        ).T
        return out


def _constraint(
    function: Function, lower: Array, upper: Array, size: int
) -> Constraint:
    """A constraint of Drake's from a function with its Jacobian."""

    def evaluated(x: Any) -> Any:
        if x.dtype == np.float64:
            return function(x)[0]
        value, jacobian = function(ExtractValue(x)[:, 0])
        return InitializeAutoDiff(value[:, None], jacobian @ ExtractGradient(x))[:, 0]

    program = MathematicalProgram()
    return program.AddConstraint(
        evaluated, lower, upper, program.NewContinuousVariables(size)
    ).evaluator()
