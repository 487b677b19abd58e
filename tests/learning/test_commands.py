"""Tips commanded tick by tick, on either engine, and every mode as a policy."""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest

gymnasium = pytest.importorskip(
    "gymnasium",
    reason="gymnasium is not installed: pip install 'pushpressslide[gym]'",
)

from gymnasium.utils.env_checker import check_env  # noqa: E402

import pushpressslide as pps  # noqa: E402
import pushpressslide.learning  # noqa: E402 - registers the environments
from pushpressslide.core.control import TipCommand  # noqa: E402
from pushpressslide.core.task import Limits, Motion  # noqa: E402
from pushpressslide.learning import command_env  # noqa: E402
from pushpressslide.learning.command_env import CommandEnv  # noqa: E402
from pushpressslide.learning.command_rows import (  # noqa: E402
    WIDTH,
    CommandScale,
    observation_row,
    row_measurement,
)
from pushpressslide.learning.mode_policy import ModePolicy  # noqa: E402
from pushpressslide.learning.registration import COMMANDS  # noqa: E402

DRAKE = pytest.mark.skipif(
    not importlib.util.find_spec("pydrake"), reason="Drake is not installed"
)
every_id = pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=DRAKE if "Drake" in name else ()) for name in COMMANDS],
)


def played(env, **asked):
    """Let the mode play an episode; return the observations and what is known last."""
    policy = ModePolicy(env)
    observation, info = env.reset(**asked)
    observations = [observation]
    over = False
    while not over:
        observation, _, ended, late, info = env.step(policy(observation))
        observations.append(observation)
        over = ended or late
    return np.array(observations), info


@every_id
@pytest.mark.filterwarnings("error")
def test_the_checker_has_nothing_to_say(name):
    check_env(gymnasium.make(name).unwrapped)


@pytest.mark.parametrize("mode", pps.modes.MODES)
def test_the_controller_of_every_mode_is_a_policy(mode, task_of_mode):
    env = CommandEnv(task_of_mode[mode])
    seen, info = played(env, seed=3)
    assert {segment.mode for segment in env.plan.segments} == {mode}
    assert info["success"]
    assert all(row in env.observation_space for row in seen)


@pytest.mark.long
@DRAKE
@pytest.mark.parametrize("mode", pps.modes.MODES)
def test_the_controller_of_every_mode_is_a_policy_in_drake(mode, task_of_mode):
    _, info = played(CommandEnv(task_of_mode[mode], engine="drake"), seed=3)
    assert info["success"]


def test_an_episode_of_the_mode_is_a_run():
    task = pps.load_task("press-slide")
    start = (task.start.x, task.start.y, task.start.yaw)
    seen, _ = played(CommandEnv(task), options={"start": start})
    record = pps.run(task, engine="planar")
    first = int(np.searchsorted(record.arrays["time"], seen[0, 0] - 1e-9))
    poses = record.arrays["object_pose"][first : first + len(seen)]
    assert np.allclose(seen[:, 1:4], poses, atol=1e-6)


def test_a_seed_draws_the_same_start_again():
    env = CommandEnv()
    first, again, other = (env.reset(seed=seed)[0] for seed in (5, 5, 6))
    assert (first == again).all()
    assert (first != other).any()


def test_a_command_and_a_measurement_come_back_from_their_numbers():
    scale = CommandScale(Motion(), Limits())
    command = TipCommand(
        force=(1.0, -2.0, -10.0),
        position=(0.4, 0.1, 0.05),
        velocity=(0.05, 0.0, 0.0),
        stiffness=(0.0, 0.0, 2000.0),
        damping=(500.0, 500.0, 300.0),
        normal_yaw=1.0,
        tool_yaw=-7.0,
        tool_yaw_rate=0.1,
        servo_cap=25.0,
        progress=0.3,
        catches_up=False,
    )
    row = scale.row(command)
    assert row.shape == (WIDTH,)
    back = scale.command(row)
    assert back.catches_up is False
    for name in ("force", "position", "stiffness", "tool_yaw", "progress"):
        assert getattr(back, name) == pytest.approx(getattr(command, name))
    assert not scale.row(None).any()
    env = CommandEnv()
    seen, _ = env.reset(seed=0)
    measurement = row_measurement(seen)
    assert (observation_row(measurement, env.task.goal) == seen).all()


def test_what_is_no_task_of_one_placement_is_refused_in_one_line(monkeypatch):
    with pytest.raises(pps.TaskError, match="one goal"):
        CommandEnv("swap")
    with pytest.raises(pps.PushPressSlideError, match="known: drake, planar"):
        CommandEnv(engine="mujoco")
    env = CommandEnv("pivot-and-move")
    start = env.task.start
    asked = {"start": (start.x, start.y, start.yaw)}
    with pytest.raises(pps.InfeasibleTaskError, match="2 placements"):
        env.reset(options=asked)
    task = pps.load_task("press-slide")
    heavy = replace(task, object=replace(task.object, mass=900.0))
    monkeypatch.setattr(command_env, "DRAWS", 2)  # each is planned in vain
    with pytest.raises(pps.InfeasibleTaskError):
        CommandEnv(heavy).reset(seed=0)


def test_a_commanded_task_has_pictures_goals_and_a_threshold() -> None:
    env = CommandEnv("press-slide", render_mode="rgb_array", threshold=(0.5, 3.0))
    goal = pps.load_task("press-slide").goal
    near = (goal.x - 0.02, goal.y, goal.yaw)
    observation, _ = env.reset(seed=0, options={"goal": near})
    assert observation[4:7].tolist() == pytest.approx(near)
    picture = env.render()
    assert picture is not None
    assert picture.shape == (96, 96, 3)
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) == 5
    assert env.task.tolerance.position == 0.5
    assert CommandEnv("press-slide").render() is None
