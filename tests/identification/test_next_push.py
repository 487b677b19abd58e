"""Intervals hold the truth, and the push that is advised narrows them most."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pushpressslide.identification.ellipsoid import FittedEllipsoid, fit_one_parameter
from pushpressslide.identification.fitted_pressure import static_model
from pushpressslide.identification.intervals import Interval, Intervals, intervals
from pushpressslide.identification.next_push import MORE, next_push, sensitivity
from pushpressslide.identification.pairs import LENGTH, Pairs
from pushpressslide.identification.push_sets import PushedObject, PushSet
from pushpressslide.identification.scoring import Identification
from pushpressslide.mechanics.pressure import pin_pressure

RHO = 0.055
BASE = ((-0.08, -0.05), (0.08, -0.05), (0.08, 0.05), (-0.08, 0.05))
CENTER = (0.3, 0.2)  # of mass, in G
CORNERS = tuple((x + CENTER[0], y + CENTER[1]) for x, y in BASE)
WEIGHT = 9.0


def ellipsoid(rho: float) -> FittedEllipsoid:
    return FittedEllipsoid(np.diag((1.0, 1.0, (LENGTH / rho) ** 2)) / 9.0)


def pushes(
    count: int, levers: np.ndarray, seed: int = 0, noise: float = 0.0
) -> PushSet:
    """Two windows of each push along x at a lever."""
    generator = np.random.default_rng(seed)
    rows = np.repeat(levers, 2)
    force = 3.0 / np.sqrt(1.0 + (rows / RHO) ** 2)
    wrenches = np.column_stack([force, 0.0 * force, rows * force])
    directions = ellipsoid(RHO).directions(wrenches, np.zeros(len(rows)))
    directions += noise * np.repeat(generator.normal(size=(count, 3)), 2, axis=0)
    twists = 0.01 * directions / (1.0, 1.0, LENGTH)
    none = np.zeros(len(rows))
    pairs = Pairs(wrenches, twists, np.column_stack([none, -rows]), none)
    body = PushedObject(CORNERS, CENTER, WEIGHT)
    return PushSet("set", body, (), (), pairs, np.repeat(np.arange(count), 2), ())


def known(friction: float, rho: float) -> Intervals:
    """Intervals of given relative half widths."""
    return Intervals(
        Interval(0.3, 0.3 * (1 - friction), 0.3 * (1 + friction)),
        Interval(RHO, RHO * (1 - rho), RHO * (1 + rho)),
    )


@pytest.mark.parametrize("lever", [0.0, 0.01, 0.03, 0.07])
def test_sensitivity_is_the_change_of_the_direction_with_log_rho(lever: float) -> None:
    wrench = np.array([[1.0, 0.0, lever]])
    step = 1e-5
    a, b = (
        ellipsoid(RHO * math.exp(sign * step)).directions(wrench, np.zeros(1))
        for sign in (1.0, -1.0)
    )
    change = float(np.linalg.norm(a - b)) / (2.0 * step)
    assert sensitivity(lever, RHO) == pytest.approx(change, abs=1e-6)


def test_the_advised_push_has_the_lever_that_says_most_about_rho() -> None:
    push_set = pushes(6, np.full(6, 0.01))
    push = next_push(push_set, known(0.01, 0.05))
    assert push.parameter == "rho"
    assert abs(push.lever) == pytest.approx(RHO**2 / LENGTH, abs=0.003)
    # on the outline, in G, into the object
    x, y = push.point[0] - CENTER[0], push.point[1] - CENTER[1]
    assert max(abs(x) / 0.08, abs(y) / 0.05) == pytest.approx(1.0)
    assert x * push.direction[0] + y * push.direction[1] < 0.0
    assert push.lever == pytest.approx(x * push.direction[1] - y * push.direction[0])


def test_a_friction_that_is_known_less_is_seen_without_a_lever() -> None:
    push = next_push(pushes(6, np.full(6, 0.03)), known(0.05, 0.01))
    assert push.parameter == "friction"
    assert push.lever == pytest.approx(0.0, abs=1e-3)
    assert push.narrowed == pytest.approx(math.sqrt(6 / (6 + MORE)))


def test_the_predicted_narrowing_is_that_of_more_such_pushes() -> None:
    levers = np.full(8, 0.012)
    push = next_push(pushes(8, levers), known(0.0, 0.05))
    more = np.append(levers, np.full(MORE, abs(push.lever)))

    def scatter(levers: np.ndarray) -> float:
        """Scatter of rho over many noisy sessions."""
        found = [
            fit_one_parameter(pushes(len(levers), levers, seed, 0.02).pairs).rho
            for seed in range(150)
        ]
        return float(np.std(found))

    assert scatter(more) / scatter(levers) == pytest.approx(push.narrowed, abs=0.15)


def test_intervals_by_bootstrap_hold_the_truth() -> None:
    levers = np.linspace(-0.07, 0.07, 16)
    pins = pin_pressure(((-0.05, -0.05), (0.05, -0.05), (0.0, 0.1)), (0.0, 0.0), WEIGHT)
    inside = 0
    for seed in range(30):
        push_set = pushes(16, levers, seed, 0.03)
        fitted = fit_one_parameter(push_set.pairs)
        found = Identification(push_set, fitted, static_model(pins), {})
        rho = intervals(found, seed).rho
        inside += rho.low <= RHO <= rho.high
        assert rho.low <= rho.value <= rho.high
    assert inside >= 25
    # windows of one push are no more pushes
    split = replace(push_set, numbers=np.arange(32))
    narrow = intervals(replace(found, push_set=split), seed).rho
    assert narrow.half_width < rho.half_width
