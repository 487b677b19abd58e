"""Common interface of the fitted models, and their least squares."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from pushpressslide.core.arrays import Array


class SlidingModel(Protocol):
    """A model that predicts motions from wrenches."""

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Unit directions (n, 3), as in ``Pairs``, of sliding under ``wrenches`` (n, 3)
        [N, N m].

        The wrenches are about the CoM, in B; they act at ``heights`` (n,) [m] above the
        support.
        """


class Fit(NamedTuple):
    """Parameters fitted to n measured directions."""

    parameters: Array  # (p,)
    errors: Array  # (n, 3) predicted less measured
    jacobian: Array  # (n, 3, p) of the predicted directions
    ridge: float

    def left_out(self) -> Array:
        """First-order chords (n,) between each direction and its prediction by a fit to
        the others.

        Each error is the error of the fit times (I - H)^-1, where H is the leverage of
        the direction's own measurement.
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
    """Parameters whose directions ``predict(parameters)`` (n, 3) are nearest to
    ``measured``.

    The cost is the sum of squared chords between unit directions, plus ``ridge``^2
    times the squared parameters. ``ridge`` is the scatter of a measured direction
    divided by the believed scatter of a parameter.
    """
    return fitted(predict, measured, start, ridge).parameters


def fitted(
    predict: Callable[[Array], Array], measured: Array, start: Array, ridge: float
) -> Fit:
    """Fit by ``least_squares``, with its errors and their Jacobian."""
    from scipy import optimize

    def residuals(parameters: Array) -> Array:
        """Chords and ridge as one vector."""
        return np.append((predict(parameters) - measured).ravel(), ridge * parameters)

    found = optimize.least_squares(residuals, start, diff_step=1e-5, max_nfev=40)
    n = len(measured)
    errors = found.fun[: 3 * n].reshape(n, 3)
    jacobian = found.jac[: 3 * n].reshape(n, 3, len(start))
    return Fit(found.x, errors, jacobian, ridge)
