"""Ellipsoids fitted to pushes: with one parameter (rho), and with all six.

Source: docs/mechanics.md, section 1; docs/identification.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.identification.pairs import LENGTH, Pairs, unit

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FittedEllipsoid:
    """H(W) = w^T M w with w = (fx, fy, tau / LENGTH); M is positive definite."""

    matrix: Array  # (3, 3) [1/N^2]; H is 1 at the typical push of the fit

    @property
    def rho(self) -> float:
        """Length rho [m]: root of the ratio of the mean translational to the rotational stiffness."""
        return LENGTH * math.sqrt(0.5 * (self.matrix[0, 0] + self.matrix[1, 1]) / self.matrix[2, 2])

    @property
    def max_force(self) -> float:
        """mu N [N]: the force that slides the object without a turn, mean over its directions."""
        return 1.0 / math.sqrt(0.5 * (self.matrix[0, 0] + self.matrix[1, 1]))

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Return the unit directions (n, 3) of sliding under ``wrenches`` (n, 3); heights play no part."""
        return unit(wrenches / (1.0, 1.0, LENGTH) @ self.matrix)


def fit_one_parameter(pairs: Pairs) -> FittedEllipsoid:
    """Return the ellipsoid, isotropic in translation, whose directions are nearest to the measured ones.

    Least squares over rho alone; mu N is the median over the pushes.
    """
    return _fit(pairs, lambda z: np.diag([1.0, 1.0, math.exp(2.0 * z[0])]), 1)


def fit_full(pairs: Pairs) -> FittedEllipsoid:
    """Return the ellipsoid of any shape, M = L L^T, whose directions are nearest to the measured ones."""

    def matrix(z: Array) -> Array:
        low = np.array([[1.0, 0.0, 0.0], [z[1], math.exp(z[2]), 0.0], [z[3], z[4], math.exp(z[0])]])
        return low @ low.T

    return _fit(pairs, matrix, 5)
