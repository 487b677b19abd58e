"""The layout of LeRobot's data sets, version 3."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from pushpressslide.cli import app
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.learning.demonstrations import Demonstrations, demonstrate
from pushpressslide.learning.lerobot import write_lerobot
from pushpressslide.learning.push_task import push_task

parquet = pytest.importorskip(
    "pyarrow.parquet",
    reason="pyarrow is not installed: pip install 'pushpressslide[lerobot]'",
)
TEXT = "Push a cube to its goal"


@pytest.fixture(scope="module")
def shown() -> Demonstrations:
    return demonstrate(push_task("rear-push-rear"), (0, 1, 2))


@pytest.fixture(scope="module")
def folder(shown, tmp_path_factory) -> Path:
    return write_lerobot(shown, tmp_path_factory.mktemp("set") / "new", TEXT)


def test_the_files_are_those_of_version_3(folder) -> None:
    files = {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}
    assert files == {
        "meta/info.json",
        "meta/stats.json",
        "meta/tasks.parquet",
        "meta/episodes/chunk-000/file-000.parquet",
        "data/chunk-000/file-000.parquet",
    }


def test_frames_and_features_agree(folder, shown) -> None:
    info = json.loads((folder / "meta/info.json").read_text())
    assert (info["codebase_version"], info["fps"]) == ("v3.0", 20)
    assert (info["total_episodes"], info["splits"]) == (3, {"train": "0:3"})
    path = info["data_path"].format(chunk_index=0, file_index=0)
    table = parquet.read_table(folder / path)
    assert table.num_rows == info["total_frames"] == len(shown.actions)
    assert set(table.column_names) == set(info["features"])
    for name, feature in info["features"].items():
        (size,) = feature["shape"]
        rows = np.array(table[name].to_pylist())
        assert rows.shape[1:] == (() if size == 1 else (size,))
        kind = table.schema.field(name).type
        assert str(kind if size == 1 else kind.value_type) in (
            feature["dtype"],
            {"float32": "float"}.get(feature["dtype"]),
        )
        names = feature["names"]
        assert names is None or len(names) == size
    states = np.array(table["observation.state"].to_pylist())
    np.testing.assert_allclose(states, shown.states, atol=1e-6)
    actions = np.array(table["action"].to_pylist())
    np.testing.assert_allclose(actions, shown.actions, atol=1e-7)
    stamps = np.array(table["timestamp"].to_pylist())
    np.testing.assert_allclose(stamps * 20.0, table["frame_index"], atol=1e-4)
    assert sum(table["next.success"].to_pylist()) == shown.success.sum()


def test_an_episode_says_where_it_is(folder, shown) -> None:
    table = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet")
    frames = parquet.read_table(folder / "data/chunk-000/file-000.parquet")
    index = np.array(frames["episode_index"])
    for row in table.to_pylist():
        rows = slice(row["dataset_from_index"], row["dataset_to_index"])
        assert set(index[rows].tolist()) == {row["episode_index"]}
        assert len(index[rows]) == row["length"]
        assert row["tasks"] == [TEXT]
        states = shown.states[shown.episode == row["episode_index"]]
        lowest = row["stats/observation.state/min"]
        np.testing.assert_allclose(lowest, states.min(axis=0), atol=1e-6)
        assert row["stats/action/count"] == [len(states)]


def test_statistics_are_those_of_all_frames(folder, shown) -> None:
    stats = json.loads((folder / "meta/stats.json").read_text())
    mean = stats["observation.state"]["mean"]
    np.testing.assert_allclose(mean, shown.states.mean(axis=0), atol=1e-6)
    q50 = stats["action"]["q50"]
    np.testing.assert_allclose(q50, np.median(shown.actions, axis=0), atol=1e-6)


def test_the_task_is_the_index_of_its_table(folder) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    tasks = pandas.read_parquet(folder / "meta/tasks.parquet")
    assert tasks.loc[TEXT].task_index == 0
    assert tasks.index.name == "task"


def test_what_is_there_is_not_written_over(folder, shown) -> None:
    with pytest.raises(PushPressSlideError, match="a new or empty folder"):
        write_lerobot(shown, folder, TEXT)


def test_the_command_writes_both_or_says_what_is_missing(tmp_path, monkeypatch) -> None:
    words = ["demonstrate", "rear-push-rear", "--episodes", "1", "--quiet"]
    words += ["--out", str(tmp_path / "one.npz"), "--lerobot", str(tmp_path / "one")]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert (tmp_path / "one/meta/info.json").exists()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    refused = CliRunner().invoke(app, [*words, "--force"])
    assert refused.exit_code == 2
    (line,) = refused.stderr.splitlines()
    assert "pip install 'pushpressslide[lerobot]'" in line
