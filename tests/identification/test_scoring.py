"""Scores are of held-out pushes and repeatable, and the models use only the wrench of
these.
"""

from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.identification.pairs import Pairs, unit
from pushpressslide.identification.push_sets import PRISM, PushSet
from pushpressslide.identification.scoring import angles, fits_of, random_splits, score
from pushpressslide.mechanics.pressure import pin_pressure

PINS = ((-0.02, -0.02), (0.04, -0.02), (-0.02, 0.04))


@pytest.fixture(scope="module")
def push_set(sample_pairs) -> PushSet:
    pairs = sample_pairs(pin_pressure(PINS, (0.0, 0.0), 14.715), 0.3, 24)
    noise = np.random.default_rng(5).normal(size=(24, 3)) * (3e-4, 3e-4, 6e-3)
    return PushSet(
        "set",
        PRISM,
        (),
        PINS,
        replace(pairs, twists=pairs.twists + noise),
        np.arange(24),
        (),
    )


@pytest.mark.parametrize(
    ("n", "share", "cut"), [(50, 0.5, 25), (5, 0.5, 2), (10, 0.05, 1), (10, 0.95, 9)]
)
def test_a_split_puts_each_push_in_one_part(n: int, share: float, cut: int) -> None:
    for fitted, held_out in random_splits(n, share, 20, 0):
        assert len(fitted) == cut
        assert sorted([*fitted, *held_out]) == list(range(n))


def test_the_seed_fixes_the_splits() -> None:
    first, again, other = (random_splits(50, 0.5, 3, seed) for seed in (0, 0, 1))
    assert all((a[0] == b[0]).all() for a, b in zip(first, again, strict=True))
    assert any((a[0] != b[0]).any() for a, b in zip(first, other, strict=True))
    assert (first[0][0] != first[1][0]).any()


def test_the_error_is_the_angle() -> None:
    a = unit(np.random.default_rng(0).normal(size=(50, 3)))
    b = unit(np.random.default_rng(1).normal(size=(50, 3)))
    assert angles(a, b) == pytest.approx(np.arccos((a * b).sum(1)))
    assert angles(a, -a) == pytest.approx(np.full(50, np.pi))
    assert (angles(a, a) == 0.0).all()


def test_no_model_learns_from_the_motion_of_a_held_out_push(push_set: PushSet) -> None:
    splits = random_splits(24, 0.5, 1, 0)
    fitted, held_out = splits[0]
    fits = fits_of(push_set)
    honest = score(push_set.pairs, fits, splits)
    spoilt = push_set.pairs.twists.copy()
    spoilt[held_out] *= -1.0
    other = score(replace(push_set.pairs, twists=spoilt), fits, splits)
    for name in fits:
        predicted = honest[name].mean_directions
        assert np.isnan(predicted[fitted]).all()
        assert (predicted[held_out] == other[name].mean_directions[held_out]).all()
        assert other[name].errors[0] == pytest.approx(np.pi - honest[name].errors[0])


def test_a_fit_is_given_the_pushes_to_fit_and_no_other(push_set: PushSet) -> None:
    seen: list[Pairs] = []

    class StallWatch:
        def directions(self, wrenches: np.ndarray, heights: np.ndarray) -> np.ndarray:
            assert len(wrenches) == len(heights) == 12
            return np.tile((1.0, 0.0, 0.0), (len(wrenches), 1))

    def fit(pairs: Pairs) -> StallWatch:
        seen.append(pairs)
        return StallWatch()

    splits = random_splits(24, 0.5, 3, 0)
    result = score(push_set.pairs, {"still": fit}, splits)["still"]
    assert all(
        (pairs.twists == push_set.pairs.twists[rows]).all()
        for pairs, (rows, _) in zip(seen, splits, strict=True)
    )
    expected = [np.arccos(push_set.pairs.directions[rows][:, 0]) for _, rows in splits]
    assert result.errors == pytest.approx(np.array(expected))
    assert result.mean == pytest.approx(np.mean(expected))


def test_the_better_model_has_the_better_score(push_set: PushSet) -> None:
    scores = score(push_set.pairs, fits_of(push_set), random_splits(24, 0.5, 4, 0))
    assert scores["pressure"].mean < 0.75 * scores["ellipsoid"].mean
    assert "no_fit_uniform" not in scores
