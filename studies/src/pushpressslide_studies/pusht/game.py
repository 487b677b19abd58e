"""Episodes of gym_pusht/PushT-v0.

Only the package's public interface is used: reset with a seed, step with an action, and
the observed state.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.pose import Pose2
from pushpressslide_studies.pusht.policy import Observation, State, act, observation
from pushpressslide_studies.pusht.tee import RHO

NAME = "gym_pusht/PushT-v0"
STEP_LIMIT = 300  # of the package
Game = Any  # a gymnasium.Env, which is untyped where the package is not installed


@dataclass(frozen=True, slots=True)
class Episode:
    """Result of one episode."""

    seed: int  # of the reset
    steps: int
    overlap: float  # the greatest, as a share of the goal's area
    reward: float  # the greatest: the overlap over 0.95, at most 1
    success: bool  # as the package says
    plans: int  # that the policy made
    wall_time: float  # [s]


def open_game(picture_size: int = 96) -> Game:
    """Environment with pictures of ``picture_size`` [px].

    Raises PushPressSlideError if the package is not installed.
    """
    os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pygame's own about its imports
            import gym_pusht  # noqa: F401 - registers the environment
            import gymnasium
    except ImportError as error:
        raise PushPressSlideError(
            f"gym-pusht is not installed ({error.name} is missing); "
            "pip install 'pushpressslide-studies[pusht]' installs it"
        ) from error
    return gymnasium.make(
        NAME,
        obs_type="state",
        render_mode="rgb_array",
        visualization_width=picture_size,
        visualization_height=picture_size,
    )


def play(
    game: Game,
    seed: int,
    noise: float = 0.0,
    watch: Callable[[Game], None] | None = None,
) -> Episode:
    """Play one episode. ``watch`` is called after the reset and after each step.

    ``noise`` [px] is the standard deviation of each observed coordinate of the T's
    centre, and of its angle times rho.
    """
    random = np.random.default_rng(seed)
    start = perf_counter()
    values, _ = game.reset(seed=seed)
    state = State()
    overlap = 0.0
    reward = 0.0
    steps = 0
    over = False
    success = False
    while not over:
        if watch is not None:
            watch(game)
        observed = _blurred(observation(values.tolist()), noise, random)
        action, state = act(observed, state)
        sent = np.array(action, dtype=np.float32)
        values, gained, success, cut, about = game.step(sent)
        steps += 1
        overlap = max(overlap, float(about["coverage"]))
        reward = max(reward, float(gained))
        over = success or cut
    if watch is not None:
        watch(game)
    wall_time = perf_counter() - start
    return Episode(seed, steps, overlap, reward, bool(success), state.plans, wall_time)


def _blurred(
    observed: Observation, noise: float, random: np.random.Generator
) -> Observation:
    """An observation with noise [px] on the pose of the T."""
    x, y, turn = (noise * random.standard_normal(3)).tolist()
    X_WB = observed.X_WB
    seen = Pose2(X_WB.x + x, X_WB.y + y, X_WB.yaw + turn / RHO)
    return replace(observed, X_WB=seen)


def play_seeds(seeds: Iterable[int], noise: float = 0.0) -> list[Episode]:
    """Play an episode for each seed, in a separate environment."""
    game = open_game()
    try:
        return [play(game, seed, noise) for seed in seeds]
    finally:
        game.close()
