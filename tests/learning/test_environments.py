"""The environments of Gymnasium: its checker, seeds, exact resets, one and many."""

import math

import numpy as np
import pytest

gymnasium = pytest.importorskip(
    "gymnasium",
    reason="gymnasium is not installed: pip install 'pushpressslide[gym]'",
)

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

import pushpressslide as pps  # noqa: E402
import pushpressslide.learning  # noqa: E402 - registers the environments
from pushpressslide.batch import fast  # noqa: E402
from pushpressslide.core.errors import MissingPackageError  # noqa: E402
from pushpressslide.learning.environment import PushEnv  # noqa: E402
from pushpressslide.learning.expert import RearPushPolicy  # noqa: E402
from pushpressslide.learning.registration import (  # noqa: E402
    CHOICES,
    COMMANDS,
    ENVIRONMENTS,
)
from pushpressslide.learning.vector import PushVectorEnv  # noqa: E402

REGISTERED = list(ENVIRONMENTS)
every_environment = pytest.mark.parametrize("name", REGISTERED)
VECTORISED = [name for name in REGISTERED if gymnasium.spec(name).vector_entry_point]


def test_every_environment_is_registered() -> None:
    own = {name for name in gymnasium.registry if name.startswith("pushpressslide/")}
    assert own == {*ENVIRONMENTS, *COMMANDS, *CHOICES}


@every_environment
@pytest.mark.filterwarnings("error")
def test_the_checker_has_nothing_to_say(name) -> None:
    check_env(gymnasium.make(name).unwrapped)


@every_environment
def test_the_checker_has_nothing_to_say_about_pictures(name) -> None:
    env = gymnasium.make(name, render_mode="rgb_array")
    check_env(env.unwrapped)
    seen = gymnasium.wrappers.AddRenderObservation(env, render_only=True)
    picture, _ = seen.reset(seed=0)
    assert picture.shape == (96, 96, 3)
    assert picture in seen.observation_space


@every_environment
def test_a_seed_draws_the_same_episode_again(name) -> None:
    env = gymnasium.make(name)
    runs = []
    for seed in (7, 7, 8):
        first, _ = env.reset(seed=seed)
        env.action_space.seed(0)
        steps = [env.step(env.action_space.sample())[0] for _ in range(5)]
        runs.append(np.array([first, *steps]))
    np.testing.assert_array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


@pytest.mark.parametrize("exact", [False, True])
def test_a_reset_is_exactly_where_it_was_asked_for(exact) -> None:
    env = PushEnv(exact=exact)
    start = (0.31, 0.17, 0.2)
    first, info = env.reset(options={"start": start})
    np.testing.assert_allclose(first[:3], start, atol=1e-15)
    moved = [env.step(np.array([0.05, 0.0]))[0] for _ in range(20)]
    again, _ = env.reset(options={"start": start})
    np.testing.assert_array_equal(again, first)
    assert info["success"] is False
    back = [env.step(np.array([0.05, 0.0]))[0] for _ in range(20)]
    np.testing.assert_array_equal(moved, back)


@pytest.mark.parametrize("exact", [False, True])
def test_a_goal_may_be_asked_for(exact) -> None:
    env = PushEnv(exact=exact)
    goal = (0.7, 0.1, 0.3)
    first, _ = env.reset(seed=0, options={"goal": goal})
    np.testing.assert_allclose(first[3:6], goal, atol=1e-15)
    policy = RearPushPolicy(env.push)
    over = False
    while not over:
        first, _, over, late, info = env.step(policy(first))
        over = over or late
    assert info["success"]
    again, _ = env.reset(seed=0)
    assert again[3:6].tolist() != first[3:6].tolist()


def test_many_have_goals_of_their_own() -> None:
    many = PushVectorEnv(2)
    goals = [(0.7, 0.1, 0.3), (0.6, 0.0, -0.2)]
    first, _ = many.reset(seed=0, options={"goal": goals})
    np.testing.assert_allclose(first[:, 3:6], goals, atol=1e-15)


def test_a_far_goal_has_more_steps() -> None:
    near = PushEnv()
    near.reset(options={"start": (0.38, 0.22, 0.0), "goal": (3.0, 0.22, 0.0)})
    for _ in range(near.push.steps + 1):
        *_, truncated, _ = near.step(np.zeros(2))
    assert not truncated


def test_a_threshold_replaces_the_tolerance() -> None:
    goal = pps.load_task("rear-push-rear").goal
    off = (goal.x + 0.03, goal.y, goal.yaw)
    for threshold, success in ((None, False), ((0.04, 0.1), True)):
        env = gymnasium.make(REGISTERED[0], threshold=threshold).unwrapped
        env.reset(options={"start": off})
        *_, info = env.step(np.zeros(2))
        assert info["success"] == success


def test_wrong_resets_and_actions_are_one_line() -> None:
    env = PushEnv()
    with pytest.raises(
        ValueError, match=r"option 'aim' is not allowed; allowed: start, goal"
    ):
        env.reset(options={"aim": (0.0, 0.0, 0.0)})
    with pytest.raises(ValueError, match=r"goal of shape \(2,\) is not allowed"):
        env.reset(options={"goal": (0.0, 0.0)})
    with pytest.raises(ValueError, match=r"shape \(2,\) is not allowed"):
        env.reset(options={"start": (0.0, 0.0)})
    with pytest.raises(ValueError, match=r"allowed: x and y in \[-10, 10\] m"):
        env.reset(options={"start": (11.0, 0.0, 0.0)})
    env.reset(seed=0)
    with pytest.raises(ValueError, match="nan"):
        env.step(np.array([math.nan, 0.0]))
    with pytest.raises(ValueError, match="allowed: rgb_array"):
        PushEnv(render_mode="human")
    with pytest.raises(ValueError, match="2 seeds are not allowed; allowed: 3"):
        PushVectorEnv(3).reset(seed=[0, 1])


@pytest.mark.parametrize("exact", [False, True])
def test_a_tip_that_passes_its_face_ends_the_episode(exact) -> None:
    env = PushEnv(exact=exact)
    env.reset(seed=0)
    for velocity in [(-0.1, 0.2)] * 10 + [(0.2, 0.0)] * 10:
        *_, terminated, truncated, info = env.step(np.array(velocity))
        if terminated:
            break
    assert terminated
    assert not truncated
    assert not info["success"]


@pytest.mark.parametrize("exact", [False, True])
def test_an_episode_is_cut_off_after_its_steps(exact) -> None:
    env = PushEnv(exact=exact)
    env.reset(seed=0)
    for step in range(1, env.push.steps + 1):
        *_, terminated, truncated, _ = env.step(np.array([0.0, 0.0]))
        assert not terminated
        assert truncated == (step == env.push.steps)


@pytest.mark.parametrize("name", VECTORISED)
def test_many_go_as_one_does_step_for_step(name) -> None:
    """Past the end of episodes too: both begin anew in the step after it."""
    count = 6
    singles = gymnasium.make_vec(name, num_envs=count, vectorization_mode="sync")
    many = gymnasium.make_vec(
        name, num_envs=count, vectorization_mode="vector_entry_point"
    )
    assert many.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    assert many.observation_space == singles.observation_space
    assert many.action_space == singles.action_space
    first, info = many.reset(seed=3)
    others, other_info = singles.reset(seed=3)
    np.testing.assert_array_equal(first, others)
    assert info.keys() == other_info.keys()
    rng = np.random.default_rng(0)
    ends = 0
    drift = rng.uniform(-0.2, 0.2, (count, 2))
    for _ in range(300):
        actions = np.clip(drift + rng.normal(0.0, 0.05, (count, 2)), -0.2, 0.2)
        out = many.step(actions)
        other = singles.step(actions)
        for mine, its in zip(out[:4], other[:4], strict=True):
            np.testing.assert_allclose(mine, its, rtol=0.0, atol=1e-12)
        for key, value in out[4].items():
            np.testing.assert_allclose(value, other[4][key], rtol=0.0, atol=1e-12)
        ends += int(out[2].sum() + out[3].sum())
    assert ends > 0


def test_observations_stay_in_their_space() -> None:
    many = PushVectorEnv(16)
    observations, _ = many.reset(seed=0)
    many.action_space.seed(0)
    for _ in range(100):
        assert observations in many.observation_space
        observations, *_ = many.step(many.action_space.sample())


def test_a_step_leaves_what_was_returned_before() -> None:
    many = PushVectorEnv(2)
    first, _ = many.reset(seed=0)
    kept = first.copy()
    many.step(np.full((2, 2), 0.05))
    np.testing.assert_array_equal(first, kept)


def test_pictures_of_many_are_those_of_one() -> None:
    many = PushVectorEnv(2, render_mode="rgb_array")
    many.reset(seed=4)
    pictures = many.render()
    for seed, picture in zip((4, 5), pictures, strict=True):
        one = PushEnv(render_mode="rgb_array")
        one.reset(seed=seed)
        np.testing.assert_array_equal(one.render(), picture)
    assert not np.array_equal(*pictures)
    assert PushVectorEnv(1).render() is None
    assert PushEnv().render() is None


def test_on_the_exact_limit_surface_an_object_goes_nearly_as_the_ellipsoid() -> None:
    """A push beside the middle, over 8 cm: what differs is a hundredth of the way."""
    ends = []
    for exact in (False, True):
        env = PushEnv(exact=exact)
        first, _ = env.reset(options={"start": (0.3, 0.1, 0.0)})
        np.testing.assert_allclose(first[6:], (0.225, 0.1), atol=2e-6)
        for _ in range(40):
            observation, *_ = env.step(np.array([0.04, 0.01]))
        ends.append(observation)
    assert abs(ends[0][2]) > 0.1
    np.testing.assert_allclose(ends[0][:2], ends[1][:2], atol=2e-3)
    np.testing.assert_allclose(ends[0][2], ends[1][2], atol=0.05)
    np.testing.assert_allclose(ends[0][6:], (0.305, 0.12), atol=1e-3)
    np.testing.assert_allclose(ends[1][6:], (0.305, 0.12), atol=1e-3)


@pytest.mark.parametrize("exact", [False, True])
def test_what_is_believed_moves_nothing(exact) -> None:
    """Neither the tip's place nor what a push does."""
    told = pps.load_task(
        "rear-push-rear",
        ["belief.center_of_mass=[0.0, 0.01]", "belief.support_friction=0.5"],
    )
    ends = []
    for task in (told, "rear-push-rear"):
        env = PushEnv(task, exact=exact)
        env.reset(options={"start": (0.3, 0.1, 0.0)})
        for _ in range(10):
            observation, *_ = env.step(np.array([0.04, 0.01]))
        ends.append(observation)
    np.testing.assert_array_equal(*ends)


def test_many_objects_at_once_need_numba(monkeypatch) -> None:
    monkeypatch.setattr(fast, "installed", lambda: None)
    with pytest.raises(MissingPackageError) as caught:
        PushVectorEnv(2)
    assert str(caught.value) == (
        "vectorised environments need numba, which is not installed: "
        "pip install 'pushpressslide[fast]'"
    )
