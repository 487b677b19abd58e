"""Models identified from a set of pushes, and their held-out prediction errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.identification.ellipsoid import (
    FittedEllipsoid,
    fit_full,
    fit_one_parameter,
)
from pushpressslide.identification.fitted_pressure import (
    PressureModel,
    fit_pressure,
    nearest_pressure,
    static_model,
)
from pushpressslide.identification.fitting import SlidingModel
from pushpressslide.identification.pairs import Pairs, unit
from pushpressslide.identification.push_sets import PushSet
from pushpressslide.identification.quartic import fit_quartic
from pushpressslide.mechanics.pressure import PressureSamples

Rows = NDArray[np.intp]
Fit = Callable[[Pairs], SlidingModel]
Progress = Callable[[float, float], None]


@dataclass(frozen=True, eq=False)
class Score:
    """Held-out predictions of one model over s splits."""

    # each (t,) [rad] for the t rows of a test: angle from the measured to the predicted
    # direction
    errors: tuple[Array, ...]
    mean_directions: (
        # (n, 3) unit: mean held-out prediction of each push; NaN if it was never held
        # out
        Array
    )

    @property
    def mean(self) -> float:
        """Mean error [rad] over splits and pushes."""
        return float(np.concatenate(self.errors).mean())

    @property
    def spread(self) -> float:
        """Standard deviation [rad] of the mean errors of the splits."""
        return float(np.std([part.mean() for part in self.errors]))


@dataclass(frozen=True, eq=False)
class Identification:
    """Results for one set of pushes. The models are fitted to all of its pushes."""

    push_set: PushSet
    ellipsoid: FittedEllipsoid  # one parameter
    pressure: PressureModel
    scores: Mapping[str, Score]  # held out; the keys are those of ``fits_of``


def identified(
    push_set: PushSet,
    fit_share: float,
    splits: int,
    seed: int,
    progress: Progress | None = None,
) -> Identification:
    """Models fitted to all pushes of a set, and scores of models fitted to random
    subsets.

    There are ``splits`` subsets, each with a share ``fit_share`` of the pushes. The
    same seed gives the same subsets.
    """
    pairs = push_set.pairs
    parts = split_pushes(push_set.numbers, fit_share, splits, seed)
    scores = score(pairs, fits_of(push_set), parts, progress)
    pressure = fit_pressure(pairs, nearest_pressure(pairs, expected_loads(push_set)))
    return Identification(push_set, fit_one_parameter(pairs), pressure, scores)


def expected_loads(push_set: PushSet) -> tuple[PressureSamples, ...]:
    """Expected loads at rest [N], in B, on the set's object."""
    even = push_set.uniform_pressure()
    expected = push_set.static_pressure()
    return (expected,) if even is None else (expected, even)


def fits_of(push_set: PushSet) -> dict[str, Fit]:
    """Fitting function of every model, by name."""
    loads = expected_loads(push_set)
    fits: dict[str, Fit] = {
        "ellipsoid": fit_one_parameter,
        "full_ellipsoid": fit_full,
        "quartic": fit_quartic,
        "pressure": lambda pairs: fit_pressure(pairs, nearest_pressure(pairs, loads)),
        "no_fit": lambda pairs: static_model(loads[0]),
    }
    if len(loads) > 1:
        fits["no_fit_uniform"] = lambda pairs: static_model(loads[1])
    return fits


def split_pushes(
    numbers: Rows, fit_share: float, splits: int, seed: int
) -> list[tuple[Rows, Rows]]:
    """Random ``splits`` into rows to fit and rows to test. Each push is in one part
    only.

    ``numbers`` (n,) gives the push of each row.
    """
    pushes = np.unique(numbers)
    rows = [np.flatnonzero(numbers == push) for push in pushes]
    return [
        (
            np.concatenate([rows[i] for i in fitted]),
            np.concatenate([rows[i] for i in held_out]),
        )
        for fitted, held_out in random_splits(len(pushes), fit_share, splits, seed)
    ]


def random_splits(
    n: int, fit_share: float, splits: int, seed: int
) -> list[tuple[Rows, Rows]]:
    """Random ``splits`` of n pushes into rows to fit and rows to test, with at least
    one row in each part.
    """
    generator = np.random.default_rng(seed)
    cut = min(max(round(fit_share * n), 1), n - 1)
    orders = [generator.permutation(n) for _ in range(splits)]
    return [(order[:cut], order[cut:]) for order in orders]


def score(
    pairs: Pairs,
    fits: Mapping[str, Fit],
    splits: list[tuple[Rows, Rows]],
    progress: Progress | None = None,
) -> dict[str, Score]:
    """Score of each model, fitted to the first part of each split and tested on the
    second part.

    From a test push, a model gets only the wrench and the height of the contact.
    """
    measured = pairs.directions
    errors: dict[str, list[Array]] = {name: [] for name in fits}
    sums = {name: np.zeros((len(pairs), 3)) for name in fits}
    for done, (fitted, held_out) in enumerate(splits, 1):
        to_fit = pairs[fitted]
        to_test = pairs[held_out]
        for name, fit in fits.items():
            predicted = fit(to_fit).directions(to_test.wrenches, to_test.heights)
            errors[name].append(angles(predicted, measured[held_out]))
            sums[name][held_out] += predicted
        if progress is not None:
            progress(done, len(splits))
    with np.errstate(invalid="ignore"):
        return {name: Score(tuple(errors[name]), unit(sums[name])) for name in fits}


def angles(a: Array, b: Array) -> Array:
    """Angles [rad] (n,) between unit directions (n, 3)."""
    out: Array = 2.0 * np.arcsin(np.minimum(0.5 * np.linalg.norm(a - b, axis=1), 1.0))
    return out
