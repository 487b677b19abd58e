"""Intervals of identified parameters: bootstrap over whole pushes.

Windows of one push share errors, so whole pushes are resampled instead of windows. The
shape of the pressure is kept. The intervals do not include errors common to all pushes,
such as an error of the mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.identification.ellipsoid import fit_one_parameter
from pushpressslide.identification.scoring import Identification

DRAWS = 200
LEVELS = (2.5, 97.5)  # [%]
METHOD = f"95 %, bootstrap of whole pushes, {DRAWS} draws"


@dataclass(frozen=True)
class Interval:
    """A value and its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Larger of the distances from the value to either end."""
        return max(self.high - self.value, self.value - self.low)

    @property
    def relative(self) -> float:
        """Half width relative to the value."""
        return self.half_width / self.value


@dataclass(frozen=True)
class Intervals:
    """Intervals of the two parameters of a support."""

    friction: Interval
    rho: Interval  # [m] of the ellipsoid


def intervals(models: Identification, seed: int = 0) -> Intervals:
    """Intervals of friction and rho of an identified set."""
    push_set = models.push_set
    pairs = push_set.pairs
    levels = models.pressure.slides(pairs.wrenches, pairs.heights)[1] / push_set.weight
    pushes = np.unique(push_set.numbers)
    rows = [np.flatnonzero(push_set.numbers == push) for push in pushes]
    generator = np.random.default_rng(seed)
    frictions = []
    rhos = []
    for _ in range(DRAWS):
        drawn = generator.integers(len(rows), size=len(rows))
        chosen = np.concatenate([rows[i] for i in drawn])
        frictions.append(float(np.median(levels[chosen])))
        rhos.append(fit_one_parameter(pairs[chosen]).rho)
    return Intervals(
        _interval(models.pressure.friction, np.array(frictions)),
        _interval(models.ellipsoid.rho, np.array(rhos)),
    )


def _interval(value: float, draws: Array) -> Interval:
    low, high = np.percentile(draws, LEVELS)
    return Interval(value, min(float(low), value), max(float(high), value))
