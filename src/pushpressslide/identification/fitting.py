"""What every fitted model offers, and the least squares that fits them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from pushpressslide.core.arrays import Array


class SlidingModel(Protocol):
    """Predicts the motion from the wrench."""

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Return the unit directions (n, 3), as in ``Pairs``, of sliding under
        ``wrenches`` (n, 3) [N, N m].

        The wrenches are about the CoM, in B; they act at ``heights`` (n,) [m] above the
        support.
        """


class Fit(NamedTuple):
    """Parameters that fit n measured directions."""

    parameters: Array  # (p,)
    errors: Array  # (n, 3) predicted less measured
    jacobian: Array  # (n, 3, p) of the predicted directions
    ridge: float

    def left_out(self) -> Array:
        """Return the chords (n,) by which each direction would be missed by a fit to
        the others, to first order.

        Each error is that of the fit times (I - H)^-1, H the part of the direction's
        own measurement in its prediction.
        """
        j = self.jacobian
        p = j.shape[2]
        normal = np.einsum("nip,niq->pq", j, j) + self.ridge**2 * np.eye(p)
        own = j @ np.linalg.solve(normal, j.transpose(0, 2, 1).reshape(-1, p, 3))
        missed = np.linalg.solve(np.eye(3) - own, self.errors[:, :, None])[:, :, 0]
        chords: Array = np.linalg.norm(missed, axis=1)
        return chords


def least_squares(
    predict: Callable[[Array], Array], measured: Array, start: Array, ridge: float
) -> Array:
    """Return the parameters whose directions ``predict(parameters)`` (n, 3) are nearest
    to ``measured``.

    Least squares of the chords between unit directions, plus ``ridge``^2 times the
    squared parameters: the scatter of a measured direction over the scatter that a
    parameter is believed to have.
    """
    return fitted(predict, measured, start, ridge).parameters


def fitted(
    predict: Callable[[Array], Array], measured: Array, start: Array, ridge: float
) -> Fit:
    """Return the fit of ``least_squares`` with its errors and their jacobian."""
    from scipy import optimize

    def residuals(parameters: Array) -> Array:
        """Return the chords and the ridge as one vector."""
        return np.append((predict(parameters) - measured).ravel(), ridge * parameters)

    found = optimize.least_squares(residuals, start, diff_step=1e-5, max_nfev=40)
    n = len(measured)
    errors = found.fun[: 3 * n].reshape(n, 3)
    jacobian = found.jac[: 3 * n].reshape(n, 3, len(start))
    return Fit(found.x, errors, jacobian, ridge)
