"""Ellipsoids fitted to pushes: either with one parameter (rho), or of any shape, about
the centre of mass.

Source: docs/mechanics.md, section 1; docs/uncertainty.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.fitting import least_squares
from pushpressslide.identification.pairs import LENGTH, Pairs, unit


@dataclass(frozen=True, eq=False)
class FittedEllipsoid:
    """Ellipsoid H(W) = w^T M w with w = (fx, fy, tau / LENGTH). The surface is H = 1."""

    matrix: Array  # (3, 3) [1/N^2], positive definite

    @property
    def max_force(self) -> float:
        """mu N [N], averaged over the directions of the force."""
        return 1.0 / math.sqrt(0.5 * float(self.matrix[0, 0] + self.matrix[1, 1]))

    @property
    def rho(self) -> float:
        """Largest moment divided by ``max_force`` [m]."""
        return LENGTH / (self.max_force * math.sqrt(float(self.matrix[2, 2])))

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Unit directions (n, 3) of sliding under ``wrenches`` (n, 3).

        Heights are ignored.
        """
        return unit(wrenches / (1.0, 1.0, LENGTH) @ self.matrix)


def fit_one_parameter(pairs: Pairs) -> FittedEllipsoid:
    """Ellipsoid, isotropic in translation, with the rho that fits the directions best.

    Its mu N is the median of the values from all pushes.
    """
    return _fit(pairs, lambda z: np.diag((1.0, 1.0, math.exp(z[0]))), 1)


def fit_full(pairs: Pairs) -> FittedEllipsoid:
    """Ellipsoid of any shape about the CoM that fits the directions best.

    Its mu N is the median of the values from all pushes.
    """

    def matrix(z: Array) -> Array:
        """Positive definite matrix (3, 3) with parameters ``z`` (5,)."""
        root = np.array(
            [
                [1.0, 0.0, 0.0],
                [z[1], math.exp(z[2]), 0.0],
                [z[3], z[4], math.exp(0.5 * z[0])],
            ]
        )
        product: Array = root @ root.T
        return product

    return _fit(pairs, matrix, 5)


def _fit(
    pairs: Pairs, matrix: Callable[[Array], Array], parameters: int
) -> FittedEllipsoid:
    w = pairs.wrenches / (1.0, 1.0, LENGTH)
    z = least_squares(
        lambda z: unit(w @ matrix(z)),
        pairs.directions,
        np.zeros(parameters),
        ridge=1e-3,
    )
    shape = matrix(z)
    return FittedEllipsoid(shape / np.median(np.einsum("ni,ij,nj->n", w, shape, w)))
