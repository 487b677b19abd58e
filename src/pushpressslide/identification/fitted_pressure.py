"""The exact limit surface of a pressure distribution, either from statics alone or
fitted to pushes.

The height of the push matters: a higher push moves load to the far side
(docs/mechanics.md, 1.2). Source: docs/mechanics.md, section 1; docs/uncertainty.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.fitting import fitted
from pushpressslide.identification.pairs import Pairs
from pushpressslide.identification.sliding import slide
from pushpressslide.mechanics.pressure import PressureSamples
from pushpressslide.mechanics.rho import rho_pole

# [m] torsional radius of a pin; the predictions hardly change from 1 to 5 mm
PIN_RADIUS = 2e-3
# ridges: scatter of a direction over that of a coefficient of the log pressure, tried
# in turn, each from the previous fit
RIDGES = (4.0, 2.0, 1.0, 0.5)
SURE = 1.5  # standard errors by which a fit must beat the pressure expected by statics


@dataclass(frozen=True, eq=False)
class PressureModel:
    """Loads at points, shifted by the push. The object slides by maximum dissipation."""

    points: Array  # (n, 2) [m] in B
    shares: Array  # (n,) of the load at rest, sum 1
    radii: Array  # (n,) [m] > 0, torsional
    weight: float  # [N]
    friction: float  # mu of the pair object/support

    @property
    def max_force(self) -> float:
        """mu N [N]."""
        return self.friction * self.weight

    @property
    def at_rest(self) -> PressureSamples:
        """Pressure without a push [N]."""
        return PressureSamples(self.points, self.weight * self.shares, self.radii)

    def directions(self, wrenches: Array, heights: Array) -> Array:
        """Unit directions (n, 3) of sliding under ``wrenches`` (n, 3) at ``heights``
        (n,) [m].
        """
        return self.slides(wrenches, heights)[0]

    def slides(self, wrenches: Array, heights: Array) -> tuple[Array, Array]:
        """Unit directions (n, 3) of sliding, and the friction mu N (n,) [N] for which
        each wrench is on the limit surface.
        """
        return slide(
            self.points, self.pushed_shares(wrenches, heights), self.radii, wrenches
        )

    def pushed_shares(self, wrenches: Array, heights: Array) -> Array:
        """Fractions of the load (m, n) under ``wrenches`` (m, 3) at ``heights`` (m,)
        [m].

        The centre of pressure moves by h F / N. Each load is multiplied by a factor
        that varies linearly over the base and is not negative. This is exact for three
        pins, and for an even load on an elastic foundation (Winkler).
        """
        arms = self.points - self.shares @ self.points
        spread = (self.shares[:, None] * arms).T @ arms
        shift = heights[:, None] * wrenches[:, :2] / self.weight
        pushed = self.shares * np.maximum(
            1.0 + shift @ np.linalg.solve(spread, arms.T), 0.0
        )
        out: Array = pushed / pushed.sum(axis=1, keepdims=True)
        return out


def static_model(pressure: PressureSamples, friction: float = 1.0) -> PressureModel:
    """Model without a fit, with ``pressure`` [N] at rest, about the centre of mass.

    The friction coefficient does not change the predicted directions.
    """
    radii = np.maximum(pressure.radii, PIN_RADIUS)
    load = pressure.total_load
    return PressureModel(pressure.points, pressure.loads / load, radii, load, friction)


def nearest_pressure(pairs: Pairs, loads: Sequence[PressureSamples]) -> PressureSamples:
    """The pressure at rest among ``loads`` that predicts ``pairs`` best without a fit."""
    if len(loads) == 1:
        return loads[0]

    def miss(pressure: PressureSamples) -> float:
        """Mean chord between predicted and measured directions."""
        model = static_model(pressure)
        predicted = model.directions(pairs.wrenches, pairs.heights)
        return float(np.linalg.norm(predicted - pairs.directions, axis=1).mean())

    return min(loads, key=miss)


def fit_pressure(pairs: Pairs, pressure: PressureSamples) -> PressureModel:
    """Model whose pressure and friction fit ``pairs``.

    ``pressure`` [N] is the pressure expected from statics. The pressure at rest is the
    expected pressure times the exponential of a quadratic polynomial in the position.
    Of all distributions with the same first and second moments, this is the nearest to
    the expected one. The five coefficients are fitted to the measured directions, with
    the ridge penalty that predicts each push best from the others. They are zero unless
    a ridge is significantly better than the expected pressure. The friction is the
    median of the values from all pushes.
    """
    expected = static_model(pressure)
    x, y = ((expected.points - pressure.cop) / rho_pole(pressure)).T
    terms = np.stack([x, y, x * x, x * y, y * y])

    def model(coefficients: Array) -> PressureModel:
        """Model whose pressure has the ``coefficients`` (5,)."""
        shares = expected.shares * np.exp(coefficients @ terms)
        return replace(expected, shares=shares / shares.sum())

    def predict(coefficients: Array) -> Array:
        """Directions (n, 3) that the coefficients predict for the measured wrenches."""
        return model(coefficients).directions(pairs.wrenches, pairs.heights)

    found = model(_sure_coefficients(predict, pairs.directions, len(terms)))
    levels = found.slides(pairs.wrenches, pairs.heights)[1]
    return replace(found, friction=float(np.median(levels)) / found.weight)


def _sure_coefficients(
    predict: Callable[[Array], Array], measured: Array, count: int
) -> Array:
    """Coefficients (count,) of the ridge regression with the largest gain on left-out
    pushes.

    ``SURE`` standard errors are subtracted from each gain. The coefficients are zero if
    no gain remains.
    """
    best = np.zeros(count)
    coefficients = best
    most = 0.0
    expected = np.linalg.norm(predict(best) - measured, axis=1)
    for ridge in RIDGES:
        fit = fitted(predict, measured, coefficients, ridge)
        coefficients = fit.parameters
        gains = expected - fit.left_out()
        error = gains.std(ddof=1) / math.sqrt(len(gains))
        sure = float(gains.mean() - SURE * error)
        if sure > most:
            most = sure
            best = coefficients
    return best
