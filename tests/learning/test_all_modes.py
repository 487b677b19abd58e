"""Demonstrations of any mode, and the reasons of episodes that fail."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from pushpressslide.cli import app
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.learning.demonstrations import demonstrate, read_demonstrations
from pushpressslide.learning.lerobot import write_lerobot
from pushpressslide.learning.picture import Camera
from pushpressslide.learning.push_task import push_task

pytest.importorskip("gymnasium", reason="gymnasium is not installed")


def invoke(*words: str) -> Result:
    return CliRunner().invoke(app, ["demonstrate", *words])


@pytest.mark.long
@pytest.mark.parametrize(
    ("task", "arms"),
    [
        ("press-slide", 1),
        ("parallel-push", 2),
        ("orthogonal-push", 2),
        ("bimanual-slide", 2),
        ("pivot", 2),
    ],
)
def test_every_mode_is_demonstrated_by_its_commands(
    task: str, arms: int, tmp_path: Path
) -> None:
    path = tmp_path / "one.npz"
    result = invoke(task, "--episodes", "1", "--out", str(path), "--json")
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["successes"] == 1
    read = read_demonstrations(path)
    assert read.states.shape[1] == len(read.state_names) == 7 + 9 * arms
    assert read.actions.shape[1] == len(read.action_names) == 25 * arms
    assert read.period == 0.004


def test_an_episode_that_fails_says_why(tmp_path: Path) -> None:
    words = ("any-mode", "--episodes", "7", "--out", str(tmp_path / "any.npz"))
    shown = invoke(*words)
    assert shown.stdout.startswith("3 of 7 episodes reach the goal")
    reasons = " ".join(shown.stdout.split()).split(" seed ")[1:]
    assert len(reasons) == 4
    assert all("the longest time, are over (its path takes" in r for r in reasons)
    assert "refuses this start: the path turns by" in " ".join(shown.stdout.split())
    assert "from the goal" in " ".join(shown.stdout.split())
    read = read_demonstrations(tmp_path / "any.npz")
    assert (read.reason == "").tolist() == read.success.tolist()


def test_demonstrations_of_older_files_have_no_reasons(tmp_path: Path) -> None:
    path = demonstrate(push_task("rear-push-rear"), (0,)).write(tmp_path / "new.npz")
    with np.load(path) as stored:
        older = {name: stored[name] for name in stored.files if name != "reason"}
    np.savez(tmp_path / "old.npz", **older)
    assert read_demonstrations(tmp_path / "old.npz").reason.tolist() == [""]


def test_a_data_set_has_a_video_of_every_frame(tmp_path: Path) -> None:
    av = pytest.importorskip("av", reason="av is not installed")
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    push = push_task("rear-push-rear")
    shown = demonstrate(push, (0, 1))
    camera = Camera(push)
    folder = write_lerobot(shown, tmp_path / "set", "Push", camera.picture)
    info = json.loads((folder / "meta/info.json").read_text())
    key = "observation.images.top"
    assert info["features"][key]["dtype"] == "video"
    path = info["video_path"].format(video_key=key, chunk_index=0, file_index=0)
    with av.open(str(folder / path)) as file:
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
    assert len(frames) == len(shown.states)
    middle = len(frames) // 2
    wanted = camera.picture(shown.states[middle]).astype(float)
    assert np.abs(frames[middle] - wanted).mean() < 8.0
    rows = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet")
    begins = [row[f"videos/{key}/from_timestamp"] for row in rows.to_pylist()]
    assert begins == [0.0, np.count_nonzero(shown.episode == 0) / 20]
    stats = json.loads((folder / "meta/stats.json").read_text())[key]
    assert np.shape(stats["mean"]) == (3, 1, 1)
    assert 0.5 < stats["mean"][0][0][0] < 1.0


def test_a_video_needs_a_data_set_and_its_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("rear-push-rear", "--episodes", "1", "--out", str(tmp_path / "one.npz"))
    assert "--video: allowed with --lerobot" in invoke(*words, "--video").stderr
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    with pytest.raises(PushPressSlideError, match="av is not installed"):
        write_lerobot(
            demonstrate(push_task("rear-push-rear"), (0,)),
            tmp_path / "set",
            "Push",
            lambda state: np.zeros((2, 2, 3), np.uint8),
        )
