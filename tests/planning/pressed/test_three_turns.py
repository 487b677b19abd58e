"""Three turns about points of the body: every word leads to the goal, none in the wrong
direction.
"""

import cmath
import math
from itertools import accumulate

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pushpressslide.core.pose import Pose2
from pushpressslide.planning.dubins import shortest_path
from pushpressslide.planning.pressed.three_turns import least_times, words

CENTERS = np.array([0.1j, -0.1j, 20j, 0.05 + 0.2j, 0.05 - 0.2j, -0.02 + 0.03j])
SENSES = np.array([1.0, -1.0, 1.0, -1.0, 1.0, 1.0])
coordinate = st.floats(-0.5, 0.5)


@given(coordinate, coordinate, st.floats(-3.0, 3.0))
def test_every_word_leads_to_the_goal_the_way_that_can_be_driven(
    x: float, y: float, yaw: float
) -> None:
    found = words(
        CENTERS, SENSES, np.abs(CENTERS), np.full(6, 0.1), [Pose2(x, y, yaw)], 5
    )[0]
    assert found
    for word in found:
        position = 0j
        turned = 0.0
        for turn, angle in zip(word.turns, word.angles, strict=True):
            assert angle * SENSES[turn] > 0.0
            position += (
                cmath.exp(1j * turned) * (1.0 - cmath.exp(1j * angle)) * CENTERS[turn]
            )
            turned += angle
        # turns by less than round-off are left out
        assert abs(position - complex(x, y)) < 1e-3
        assert math.remainder(turned - yaw, 2.0 * math.pi) == pytest.approx(
            0.0, abs=1e-4
        )
    assert [word.time for word in found] == sorted(word.time for word in found)


@pytest.mark.parametrize("swing", [1.0, 2.0, math.pi])
def test_words_that_turn_no_further_are_the_quickest_of_those(swing: float) -> None:
    given = (CENTERS, SENSES, np.abs(CENTERS), np.full(6, 0.1))
    goals = [Pose2(0.2, 0.1 * i, 0.3) for i in range(-2, 3)]
    every = words(*given, goals, 1000)
    bounded = words(*given, goals, 1, swing)
    for found, best in zip(every, bounded, strict=True):
        within = [
            word.time
            for word in found
            if max(map(abs, accumulate(word.angles))) <= swing
        ]
        assert [word.time for word in best] == within[:1]
    assert any(bounded)


def test_with_the_turns_of_a_car_the_quickest_word_is_as_long_as_dubins_path() -> None:
    centers = np.array([0.1j, -0.1j, 50j])
    radius = np.array([0.1, 0.1, 50.0])
    for x, y, yaw in ((0.6, 0.2, 0.5), (0.4, -0.3, -1.0), (0.7, 0.0, 1.5)):
        best = words(
            centers,
            np.array([1.0, -1.0, 1.0]),
            radius,
            np.zeros(3),
            [Pose2(x, y, yaw)],
            1,
        )[0][0]
        wanted = shortest_path(Pose2(), Pose2(x, y, yaw), 10.0, 10.0).length
        assert best.time == pytest.approx(wanted, rel=0.01)


def test_of_many_bodies_the_least_time_of_each_is_that_of_its_quickest_word() -> None:
    rng = np.random.default_rng(0)
    goals = rng.uniform(-0.4, 0.4, (8, 2)) @ (1.0, 1.0j)
    yaws = rng.uniform(-2.0, 2.0, 8)
    bodies = CENTERS + 0.01 * rng.standard_normal((8, 6))
    bodies[1:, 5] = np.nan  # has one turn less
    senses = np.tile(SENSES, (8, 1))
    times = np.abs(bodies)
    found = least_times(bodies, senses, times, np.full((8, 6), 0.1), goals, yaws)
    for body, time, goal, yaw, least in zip(
        bodies, times, goals, yaws, found, strict=True
    ):
        n = np.isfinite(body).sum()
        pose = Pose2(goal.real, goal.imag, yaw)
        best = words(body[:n], SENSES[:n], time[:n], np.full(n, 0.1), [pose], 1)[0][0]
        assert least == pytest.approx(best.time)
