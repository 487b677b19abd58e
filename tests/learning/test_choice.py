"""The environment whose agent chooses where to push."""

import math

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from pushpressslide.learning.choice_env import PUSHES, ChoiceEnv  # noqa: E402
from pushpressslide.learning.registration import CHOICES  # noqa: E402

(ID,) = CHOICES
TRIES = 40


def greedy(env: ChoiceEnv, rng: np.random.Generator, faces: int) -> np.ndarray:
    """The best of random pushes at the first ``faces``, by the reward right after it."""
    actions = rng.uniform(-1.0, 1.0, (TRIES, 3))
    actions[:, 0] = rng.uniform(-1.0, -1.0 + 0.5 * faces, TRIES)
    rewards = [float(env.pushed(env._last[:3], a).rewards[0]) for a in actions]
    return actions[int(np.argmax(rewards))]


@pytest.mark.filterwarnings("error")
def test_the_checker_has_nothing_to_say() -> None:
    check_env(gymnasium.make(ID).unwrapped)
    check_env(gymnasium.make(ID, render_mode="rgb_array").unwrapped)


def test_starts_turn_all_the_way_round() -> None:
    env = ChoiceEnv()
    yaws = [env.reset(seed=seed)[0][2] for seed in range(40)]
    assert min(yaws) < -2.5
    assert max(yaws) > 2.5


@pytest.mark.parametrize("face", range(4))
def test_a_push_at_a_face_s_middle_leads_straight_ahead(face: int) -> None:
    env = ChoiceEnv()
    first, _ = env.reset(options={"start": (0.4, 0.1, 0.3)})
    place = (face + 0.5) / 4 * 2.0 - 1.0
    moved, *_ = env.step(np.array([place, 0.0, 1.0]))
    off = moved[:2] - first[:2]
    assert np.hypot(*off) == pytest.approx(0.1, abs=2e-3)
    assert abs(moved[2] - first[2]) < 0.02
    turns = (math.atan2(off[1], off[0]) - 0.3) / (0.5 * math.pi)
    assert turns == pytest.approx(round(turns), abs=0.02)


def test_the_four_faces_push_in_four_directions() -> None:
    env = ChoiceEnv()
    ways = set()
    for face in range(4):
        first, _ = env.reset(options={"start": (0.4, 0.1, 0.0)})
        moved, *_ = env.step(np.array([(face + 0.5) / 4 * 2.0 - 1.0, 0.0, 1.0]))
        ways.add(tuple(np.round((moved[:2] - first[:2]) / 0.1).astype(int)))
    assert len(ways) == 4


@pytest.mark.long
def test_an_agent_that_looks_one_push_ahead_gets_there_if_it_chooses_the_face() -> None:
    env = ChoiceEnv()
    rng = np.random.default_rng(0)
    reached = dict.fromkeys((4, 1), 0)
    for seed in range(4):
        for faces in reached:
            env.reset(seed=seed)
            over = late = False
            while not (over or late):
                *_, over, late, info = env.step(greedy(env, rng, faces))
            reached[faces] += info["success"]
    assert reached[4] >= 3
    assert reached[1] <= 1


def test_an_episode_ends_after_its_pushes() -> None:
    env = ChoiceEnv()
    env.reset(seed=0)
    for number in range(1, PUSHES + 1):
        *_, over, late, _ = env.step(np.array([0.0, 0.0, -1.0]))
        assert not over
        assert late == (number == PUSHES)
