"""A convex polynomial of fourth order as a limit surface, without knowledge of the
support.

After Zhou, Paolini, Bagnell, Mason, "A convex polynomial force-motion model for planar
sliding", ICRA 2016. Here it is a sum of fourth powers with coefficients >= 0, which is
always convex.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.ellipsoid import fit_one_parameter
from pushpressslide.identification.pairs import LENGTH, Pairs, unit

# spread evenly over the half sphere; 15 would span all quartics, if all were allowed
POWERS = 60
RIDGE = 0.3  # toward the sphere; values from 0.1 to 0.5 predict alike
# weight of H = 1 at the measured wrenches, relative to the directions: friction
# scatters
LEVEL_WEIGHT = 0.1


@dataclass(frozen=True, eq=False)
class FittedQuartic:
    """Quartic H(W) = sum_k c_k (a_k . (fx, fy, tau / rho))^4, up to a factor."""

    axes: Array  # (k, 3) unit vectors a_k
    coefficients: Array  # (k,) c_k >= 0
    rho: float  # [m] of the one-parameter ellipsoid

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Unit directions (n, 3) of sliding under ``wrenches`` (n, 3).

        Heights are ignored.
        """
        along = wrenches / (1.0, 1.0, self.rho) @ self.axes.T
        return unit(
            (along**3 * self.coefficients) @ self.axes * (1.0, 1.0, LENGTH / self.rho)
        )


def fit_quartic(pairs: Pairs) -> FittedQuartic:
    """Sum of fourth powers whose directions are nearest to the measured ones.

    Directions and levels are fitted by non-negative least squares, with a ridge penalty
    towards the sphere in (fx, fy, tau/rho).
    """
    rho = fit_one_parameter(pairs).rho
    w = pairs.wrenches / (1.0, 1.0, rho)
    typical = float(np.median(np.linalg.norm(w, axis=1)))
    axes = _half_sphere(POWERS)
    along = w @ axes.T / typical
    gradients = 4.0 * along[:, None, :] ** 3 * (axes * (1.0, 1.0, LENGTH / rho)).T
    # the mean of (a . u)^4 over unit vectors is 1/5
    sphere = np.full(POWERS, 5.0 / POWERS)
    problem = _Residuals(gradients, along, pairs.directions, sphere)
    return FittedQuartic(axes, _least_squares(problem, sphere), rho)


@dataclass(frozen=True, eq=False)
class _Residuals:
    """Residuals of directions, levels and ridge for coefficients c (k,)."""

    gradients: Array  # (n, 3, k) of the powers at the measured wrenches
    along: Array  # (n, k) of the measured wrenches on the axes
    measured: Array  # (n, 3) unit directions
    sphere: Array  # (k,) coefficients of the sphere

    def evaluate(self, c: Array) -> tuple[Array, Array]:
        """Residuals (m,) and their derivatives (m, k)."""
        gradients = self.gradients
        g = gradients @ c
        size = np.linalg.norm(g, axis=1)[:, None, None]
        e = g[:, :, None] / size
        across = (gradients - e * (e * gradients).sum(1, keepdims=True)) / size
        level = LEVEL_WEIGHT * self.along**4
        off = (e[:, :, 0] - self.measured).ravel()
        value = np.concatenate(
            [off, level @ c - LEVEL_WEIGHT, RIDGE * (c - self.sphere)]
        )
        ridge = RIDGE * np.eye(POWERS)
        return value, np.vstack([across.reshape(-1, POWERS), level, ridge])


def _least_squares(residuals: _Residuals, c: Array) -> Array:
    """Coefficients >= 0 by Gauss-Newton steps from ``c``.

    Each step solves a linear problem with coefficients >= 0, and is halved until the
    error decreases.
    """
    from scipy import optimize

    value, slope = residuals.evaluate(c)
    for _ in range(30):
        step = optimize.nnls(slope, slope @ c - value)[0] - c
        length = 1.0
        while length > 1e-3:
            new_value, new_slope = residuals.evaluate(c + length * step)
            if new_value @ new_value < value @ value:
                break
            length *= 0.5
        else:
            break
        gain = 1.0 - (new_value @ new_value) / (value @ value)
        c = c + length * step
        value = new_value
        slope = new_slope
        if gain < 1e-4:
            break
    return c


def _half_sphere(n: int) -> Array:
    i = np.arange(n) + 0.5
    height = 1.0 - i / n
    angle = i * (math.pi * (1.0 + math.sqrt(5.0)))
    flat = np.sqrt(1.0 - height**2)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), height], axis=1)
