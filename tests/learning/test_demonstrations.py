"""Demonstrations: contents of their file, and the command that writes it."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.learning.demonstrations import demonstrate, read_demonstrations
from pushpressslide.learning.push_task import push_task
from pushpressslide.learning.pushing import Pushing

TASK = "rear-push-rear"


def test_a_file_is_read_back_and_plays_again(tmp_path: Path) -> None:
    """From the first state of an episode its actions lead to its other states."""
    push = push_task(TASK)
    written = demonstrate(push, (3, 5))
    read = read_demonstrations(written.write(tmp_path / "two.npz"))
    assert read.seed.tolist() == [3, 5]
    assert read.success.tolist() == [True, True]
    assert (read.task, read.period) == (TASK, 0.05)
    assert read.state_names == ("x", "y", "yaw", "goal_x", "goal_y", "goal_yaw", "tip_x", "tip_y")  # fmt: skip
    assert read.action_names == ("tip_vx", "tip_vy")
    pushing = Pushing(push, 1)
    for episode in (0, 1):
        rows = read.episode == episode
        states, actions = read.states[rows], read.actions[rows]
        assert read.frame[rows].tolist() == list(range(len(states)))
        pushing.place(np.array([0]), states[0, :3])
        played = [pushing.step(action[None]) for action in actions]
        ends = np.array([out.observations[0] for out in played])
        np.testing.assert_allclose(ends[:-1], states[1:], rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(ends[-1], read.last_states[episode], atol=1e-12)
        rewards = [out.rewards[0] for out in played]
        np.testing.assert_allclose(rewards, read.rewards[rows], atol=1e-12)
        assert played[-1].success[0]


def test_demonstrations_start_where_the_environment_does() -> None:
    pytest.importorskip("gymnasium", reason="gymnasium is not installed")
    from pushpressslide.learning.environment import PushEnv

    shown = demonstrate(push_task(TASK), (11,))
    first, _ = PushEnv(TASK).reset(seed=11)
    np.testing.assert_array_equal(shown.states[0], first)


def test_another_file_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    with pytest.raises(PushPressSlideError, match="no demonstrations"):
        read_demonstrations(path)
    path.write_text("no archive")
    with pytest.raises(PushPressSlideError, match="no demonstrations"):
        read_demonstrations(path)
    np.savez(path, states=np.zeros(3))
    with pytest.raises(PushPressSlideError, match="pps demonstrate"):
        read_demonstrations(path)


def test_no_seed_gives_no_episode() -> None:
    with pytest.raises(ValueError, match="0 seeds"):
        demonstrate(push_task(TASK), ())


def run(*words: str) -> tuple[int, str, str]:
    """Return exit status, output and complaint of the command."""
    out = CliRunner().invoke(app, ["demonstrate", *words])
    return out.exit_code, out.stdout, out.stderr


def test_the_command_writes_what_it_says(tmp_path: Path) -> None:
    path = tmp_path / "shown.npz"
    status, text, _ = run(TASK, "--episodes", "2", "--out", str(path), "--json")
    assert status == 0
    said = json.loads(text)
    assert said["successes"] == said["episodes"] == 2
    read = read_demonstrations(path)
    assert len(read.actions) == said["frames"]
    status, _, complaint = run(TASK, "--episodes", "2", "--out", str(path))
    assert status == 2
    assert "holds shown.npz already" in complaint
    status, text, _ = run(TASK, "--episodes", "1", "--out", str(path), "--force")
    assert status == 0
    first, second = text.splitlines()
    assert first.startswith("1 of 1 episodes reach the goal, ")
    assert second == str(path)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((TASK, "--out", "shown.csv"), "a name that ends in .npz"),
        ((TASK, "--episodes", "0"), "'--episodes'"),
        (("post", "--mode", "rear_push"), "allowed to learn: none"),
        (("press-slide", "--exact"), "--exact: allowed with mode rear_push"),
        (("no-such-task",), "no such task"),
    ],
)
def test_what_is_wrong_is_one_line(words, said, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    status, text, complaint = run(*words)
    assert (status, text) == (2, "")
    (line,) = complaint.splitlines()
    assert said in line
    assert not list(tmp_path.rglob("*.npz"))


def test_without_gymnasium_demonstrations_are_written_all_the_same(
    monkeypatch, tmp_path
) -> None:
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    status, _, _ = run(TASK, "--episodes", "1", "--out", str(tmp_path / "one.npz"))
    assert status == 0


@pytest.mark.parametrize("name", ["environment", "vector"])
def test_a_missing_gymnasium_is_one_clear_line(name, monkeypatch) -> None:
    import importlib

    monkeypatch.setitem(sys.modules, "gymnasium", None)
    for part in ("utils.seeding", "vector", "vector.utils", "spaces"):
        monkeypatch.setitem(sys.modules, f"gymnasium.{part}", None)
    module = f"pushpressslide.learning.{name}"
    monkeypatch.delitem(sys.modules, module, raising=False)
    with pytest.raises(ImportError, match=r"pip install 'pushpressslide\[gym\]'"):
        importlib.import_module(module)
