"""What every fitted model offers, and the least squares that fits them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

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


def least_squares(
    predict: Callable[[Array], Array], measured: Array, start: Array, ridge: float
) -> Array:
    """Return the parameters whose directions ``predict(parameters)`` (n, 3) are nearest
    to ``measured``.

    Least squares of the chords between unit directions, plus ``ridge``^2 times the
    squared parameters: the scatter of a measured direction over the scatter that a
    parameter is believed to have.
    """
    from scipy import optimize

    def residuals(parameters: Array) -> Array:
        """Return the chords and the ridge as one vector."""
        return np.append((predict(parameters) - measured).ravel(), ridge * parameters)

    found: Array = optimize.least_squares(
        residuals, start, diff_step=1e-5, max_nfev=40
    ).x
    return found
