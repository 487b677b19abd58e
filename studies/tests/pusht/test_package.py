"""Behaviour of the package gym-pusht, against the parameters and models used here."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from pushpressslide.core.pose import Pose2
from pushpressslide_studies.pusht.benchmark import benchmark
from pushpressslide_studies.pusht.film import film
from pushpressslide_studies.pusht.forward import predicted
from pushpressslide_studies.pusht.game import Game, open_game, play
from pushpressslide_studies.pusht.policy import (
    Observation,
    State,
    act,
    observation,
)
from pushpressslide_studies.pusht.pushes import curvature
from pushpressslide_studies.pusht.servo import Pusher
from pushpressslide_studies.pusht.steering import miss_between
from pushpressslide_studies.pusht.tee import FACES, GOAL, overlap

pytest.importorskip("gym_pusht", reason="gym-pusht is not installed (extra pusht)")

DEVELOPMENT = range(6)  # seeds
STRIDE = 4.0  # [px] of the pusher in one action


@pytest.fixture
def game() -> Iterator[Game]:
    opened = open_game()
    yield opened
    opened.close()


def sent(game: Game, action: tuple[float, float]) -> Observation:
    values, *_ = game.step(np.array(action, dtype=np.float32))
    return observation(values.tolist())


def started(game: Game, pusher: tuple[float, float], X_WB: Pose2) -> Observation:
    """Observation after a reset with T and pusher near the requested poses.

    The package sets the place first and then turns the T about its centre of mass.
    """
    x = X_WB.x
    y = X_WB.y - 45.0
    state = [*pusher, x, y, X_WB.yaw]
    values, _ = game.reset(seed=0, options={"reset_to_state": state})
    return observation(values.tolist())


def test_the_goal_is_the_packages_own(game: Game) -> None:
    _, about = game.reset(seed=0)
    assert about["goal_pose"] == pytest.approx((GOAL.x, GOAL.y, GOAL.yaw))


def test_the_overlap_is_the_packages_own(game: Game) -> None:
    for seed in DEVELOPMENT:
        game.reset(seed=seed)
        action = np.array([256.0, 256.0], dtype=np.float32)
        values, _, _, _, about = game.step(action)
        seen = observation(values.tolist())
        assert overlap(seen.X_WB) == pytest.approx(about["coverage"], abs=1e-9)


def test_the_pusher_follows_the_servo(game: Game) -> None:
    values, _ = game.reset(seed=4)
    pusher = Pusher(observation(values.tolist()).pusher, (0.0, 0.0))
    for action in ((300.0, 100.0), (50.0, 450.0), (500.0, 20.0)):
        seen = sent(game, action)
        pusher = pusher.after(action)
        assert seen.pusher == pytest.approx(pusher.position, abs=1e-6)


@pytest.mark.parametrize("index", range(len(FACES)))
def test_the_twist_of_a_push_is_that_of_the_limit_surface(
    game: Game, index: int
) -> None:
    # In the package's physics, within 3 %: in one action the contact slides along the
    # face by up to a pixel.
    face = FACES[index]
    wanted = Pose2(256.0, 256.0, 0.5)
    left = 0.5 * (face.left + face.right) + 3.0
    start = wanted.apply(face.pusher(left, 0.5))
    seen = started(game, start, wanted)
    pusher = Pusher(seen.pusher, (0.0, 0.0))
    nx, ny = wanted.rotate(face.normal)
    for _ in range(4):
        before = seen
        place = face.place(before.X_WB.unapply(pusher.position))
        x, y = pusher.position
        action = pusher.action_to((x + STRIDE * nx, y + STRIDE * ny))
        seen = sent(game, action)
        pusher = Pusher(seen.pusher, pusher.after(action).velocity)
    way = math.dist(seen.X_WB.position, before.X_WB.position)
    turn = math.remainder(seen.X_WB.yaw - before.X_WB.yaw, 2.0 * math.pi)
    place = 0.5 * (place + face.place(seen.X_WB.unapply(seen.pusher)))
    assert way > 0.3 * STRIDE
    assert turn / way == pytest.approx(curvature(face, place), rel=0.03)
    x, y = before.X_WB.rotate(face.normal)
    along = (seen.X_WB.x - before.X_WB.x) * x + (seen.X_WB.y - before.X_WB.y) * y
    assert along / way > 0.995


def test_the_forward_model_is_right_to_the_rounding_of_an_action(game: Game) -> None:
    # actions are sent in single precision; where the T touches a wall it is off
    errors = []
    for seed in DEVELOPMENT:
        values, _ = game.reset(seed=seed)
        seen = observation(values.tolist())
        state = State()
        for _ in range(40):
            pusher = Pusher(seen.pusher, state.velocity)
            action, state = act(seen, state)
            rounded = tuple(np.float32(action).astype(float).tolist())
            expected = predicted(seen.X_WB, pusher, rounded)
            before = seen
            seen = sent(game, action)
            if miss_between(before.X_WB, seen.X_WB) > 0.5:
                errors.append(miss_between(expected, seen.X_WB))
    assert len(errors) > 60
    assert np.quantile(errors, 0.95) < 1e-5


@pytest.mark.parametrize("seed", DEVELOPMENT)
def test_development_seeds_end_on_the_goal(game: Game, seed: int) -> None:
    episode = play(game, seed)
    assert episode.success
    assert episode.overlap > 0.97
    assert episode.steps < 100


def test_the_benchmark_leaves_a_row_an_episode(tmp_path: Path) -> None:
    figures = benchmark(range(3), tmp_path)
    assert figures.episodes == figures.successes == 3
    assert len((tmp_path / "episodes.jsonl").read_text().splitlines()) == 3


def test_a_film_has_a_picture_for_each_step(tmp_path: Path) -> None:
    from PIL import Image

    film(range(2), tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as picture:
        assert picture.size == (320, 160)
        assert picture.n_frames > 20


@pytest.mark.long
def test_ninety_percent_of_a_hundred_development_seeds_succeed(
    tmp_path: Path,
) -> None:
    figures = benchmark(range(100, 200), tmp_path)
    assert figures.success >= 0.9
    assert figures.overlap >= 0.97
