"""Refinement of near misses by Drake's KinematicTrajectoryOptimization.

Continuation over a grid of tool yaws and tilts (postures.py) looks only one sample
ahead. If it just fails, a spline over the whole path may still exist: yaw and tilt
become unknowns, and the elbow can be placed where the path needs it later. The
optimiser needs a guess that is nearly a solution, and its failure proves nothing. It is
therefore only given near misses, and its result is evaluated like any other. The
iterations are limited instead of the time, so that the result does not depend on the
machine's load.
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

from pushpressslide.arms.paths.postures import LARGEST_STEP, Posture, TipPath
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
from pushpressslide.sim.clearance import DrakeClearance

Function = Callable[[Array], tuple[Array, Array]]
"""Value (m,) and Jacobian (m, size) at a point (size,)."""

MAJOR_LIMIT = 40
MINOR_LIMIT = 4000  # iterations of one optimisation, a second or two
POINT_STEP = 0.025  # [m] motion of the tip between control points
LEAST_POINTS = 10
MOST_POINTS = 30
# of the tip at the samples; removed afterwards by exact inverse kinematics
ANGLE_SLACK = 1e-3  # [rad]
POSITION_SLACK = 1e-4  # [m]
MARGIN_SLACK = 2e-3  # [rad] of the spline, on top of the joint margin
CLEARANCE_SLACK = 1e-3  # [m] of the samples, on top of the clearance
YAW_ROOM = 0.5  # [rad] by which the tool's yaw may differ from the guess
MOST_TILT = math.radians(45.0)
STEP_SHARE = 0.93  # share of the allowed step that the spline uses
DIFFERENCE = 1e-6  # [rad] for derivatives by yaw and tilt


def refined_move(
    kin: ArmKinematics,
    model: DrakeClearance,
    path: TipPath,
    guess: Posture,
    margin: float,
    clearance: float,
) -> Posture | None:
    """A posture near ``guess`` that follows ``path``, or None.

    It keeps ``margin`` [rad] from the joint limits at every sample, and ``clearance``
    [m] at the control points. The tip's error is at most 1e-6 [m; rad] at every sample.
    """
    n = kin.facts.size
    k = len(path.yaws)
    picked = _picked(path)
    spline = _guessed_spline(kin, guess, picked, margin)
    slack = np.repeat([ANGLE_SLACK, POSITION_SLACK], 3)
    for i in picked:
        u = i / (k - 1)
        error = _tip_error(kin, guess.attitude, path.positions[i], path.yaws[i])
        spline.constrain(u, error, -slack, slack)
        distance = _distance(model, path.objects[i], n)
        least = np.array([clearance + CLEARANCE_SLACK])
        spline.constrain(u, distance, least, np.array([np.inf]))
    values = spline.solution(k)
    tilt = float(np.clip(values[0, n + 1], 0.0, MOST_TILT))
    attitude = replace(guess.attitude, tilt=tilt)
    offset = float(values[0, n])
    exact = solve_ik(
        kin,
        path.positions,
        attitude,
        path.yaws + offset,
        values[:, None, :n],
        margin,
        search=IkSearch(first_found=True),
    )
    return Posture(attitude, offset, exact.q) if exact.converged.all() else None


def _picked(path: TipPath) -> Array:
    """Indices of the samples that are control points."""
    k = len(path.yaws)
    steps = np.linalg.norm(np.diff(path.positions, axis=0), axis=1)
    length = float(steps.sum())
    points = min(max(LEAST_POINTS, math.ceil(length / POINT_STEP)), MOST_POINTS, k)
    return np.unique(np.linspace(0, k - 1, points).round().astype(int))


def _guessed_spline(
    kin: ArmKinematics, guess: Posture, picked: Array, margin: float
) -> _Spline:
    """A spline through the joints, tool yaw offset and tilt of a guess.

    Joints stay within their bounds and the largest step. Offset and tilt are constant.
    """
    inset = margin + MARGIN_SLACK
    lower = np.append(kin.facts.lower + inset, [guess.offset - YAW_ROOM, 0.0])
    upper = np.append(kin.facts.upper - inset, [guess.offset + YAW_ROOM, MOST_TILT])
    tool = np.tile([guess.offset, guess.attitude.tilt], (len(picked), 1))
    spline = _Spline(lower, upper, np.column_stack([guess.q[picked], tool]))
    spline.hold_constant((kin.facts.size, kin.facts.size + 1))
    spline.limit_steps(STEP_SHARE * LARGEST_STEP, len(guess.q))
    return spline


def _tip_error(
    kin: ArmKinematics, attitude: ToolAttitude, position: Array, yaw: float
) -> Function:
    """The tip's error (6,) [rad; m] as a function of joints, tool yaw offset and tilt."""
    n = kin.facts.size
    step = DIFFERENCE

    def error(x: Array) -> tuple[Array, Array]:
        """Error and its Jacobian (6, n + 2)."""
        offset = x[n]
        tilt = min(max(x[n + 1], 0.0), MOST_TILT)
        tool = replace(attitude, tilt=tilt)
        tilted = replace(attitude, tilt=tilt + step)
        R = tool.rotation(yaw + offset)
        e, J = task_error(kin, x[:n], position, R, tool.axis)
        jacobian = np.zeros((6, n + 2))
        jacobian[:, :n] = -J
        turned = (tool.rotation(yaw + offset + step), tilted.rotation(yaw + offset))
        jacobian[:3, n:] = orientation_error(R, np.array(turned)).T / step
        return e, jacobian

    return error


def _distance(model: DrakeClearance, pose: Pose2, joints: int) -> Function:
    """Smallest distance [m] of the arm to everything else, with the object at ``pose``."""

    def distance(x: Array) -> tuple[Array, Array]:
        """Distance (1,) and its Jacobian (1, n + 2)."""
        least, gradient = model.smooth_least(x[:joints], pose, touching=True)
        padded = np.append(gradient, np.zeros(len(x) - joints))
        return np.array([least]), padded[None]

    return distance


class _Spline:
    """The shortest clamped cubic B-spline over [0, 1] within constraints."""

    def __init__(self, lower: Array, upper: Array, guess: Array) -> None:
        """Take bounds (size,) and the control points (m, size) of a guess."""
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
        """Keep some coordinates constant."""
        for row in rows:
            for a, b in zip(self.points[row], self.points[row, 1:], strict=False):
                self.program.AddLinearEqualityConstraint(a - b, 0.0)

    def limit_steps(self, largest: float, samples: int) -> None:
        """Bound the change of any coordinate between two of ``samples`` equal steps."""
        rate = np.full(self.size, largest * (samples - 1))
        self.problem.AddVelocityBounds(-rate, rate)

    def constrain(
        self, u: float, function: Function, lower: Array, upper: Array
    ) -> None:
        """Bound a function of the point at ``u``."""
        self.problem.AddPathPositionConstraint(
            _constraint(function, lower, upper, self.size), float(u)
        )

    def solution(self, samples: int) -> Array:
        """The optimiser's result (samples, size) at equal steps, whether converged or
        not.
        """
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
    """Drake's constraint for a function with its Jacobian."""

    def evaluated(x: Any) -> Any:
        """Value for plain numbers, with derivatives for AutoDiff."""
        if x.dtype == np.float64:
            return function(x)[0]
        value, jacobian = function(ExtractValue(x)[:, 0])
        return InitializeAutoDiff(value[:, None], jacobian @ ExtractGradient(x))[:, 0]

    program = MathematicalProgram()
    return program.AddConstraint(
        evaluated, lower, upper, program.NewContinuousVariables(size)
    ).evaluator()
