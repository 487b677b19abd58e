"""Demonstrations in the layout of LeRobot data sets, version 3: Parquet and JSON files.

Source: the package lerobot, whose ``LeRobotDatasetMetadata`` names files and fields.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.whole_file import write_whole
from pushpressslide.learning.demonstrations import Demonstrations
from pushpressslide.learning.lerobot_video import (
    IMAGE,
    VIDEO,
    VIDEO_PATH,
    video_columns,
    write_video,
)
from pushpressslide.learning.picture import Picture

VERSION = "v3.0"
INFO = "meta/info.json"
STATS = "meta/stats.json"
TASKS = "meta/tasks.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
DATA = "data/chunk-000/file-000.parquet"
DATA_PATH = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
Values = NDArray[Any]
Statistics = dict[str, dict[str, list[float]]]
# metadata that makes pandas use the column ``task`` as the index
INDEXED = {
    "index_columns": ["task"],
    "column_indexes": [],
    "columns": [
        {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy_kind,
            "metadata": None,
        }
        for name, kind, numpy_kind in (
            ("task_index", "int64", "int64"),
            ("task", "unicode", "object"),
        )
    ],
    "pandas_version": "2.0.0",
}


def write_lerobot(
    shown: Demonstrations, folder: Path, text: str, picture: Picture | None = None
) -> Path:
    """Write demonstrations into a new folder, and return it.

    ``text`` describes the task in words. With a function ``picture`` that draws a
    state, a video is added. Raises the errors of ``check_folder`` and ``check_video``.
    """
    check_folder(folder)
    arrow = _arrow()
    columns = _columns(shown)
    episodes = _episodes(shown, columns, text)
    statistics: dict[str, Any] = _statistics(columns)
    info = _info(shown, columns)
    if picture is not None:
        check_video(folder)
        video = write_video(shown, picture, folder / VIDEO)
        episodes |= video_columns(shown, video)
        statistics[IMAGE] = video.statistics()
        info["features"][IMAGE] = video.feature
        info["video_path"] = VIDEO_PATH
    _write_table(folder / DATA, {name: arrow(v) for name, v in columns.items()})
    _write_table(folder / EPISODES, episodes)
    tasks = {"task_index": [0], "task": [text]}
    _write_table(folder / TASKS, tasks, {"pandas": json.dumps(INDEXED)})
    write_whole(folder / STATS, json.dumps(statistics, indent=4))
    # written last: a folder with this file is complete
    write_whole(folder / INFO, json.dumps(info, indent=4))
    return folder


def _is_empty(folder: Path) -> bool:
    """Whether a folder contains nothing but hidden files, such as its writer's lock."""
    if not folder.is_dir():
        return False
    return all(item.name.startswith(".") for item in folder.iterdir())


def check_folder(folder: Path) -> None:
    """Raise PushPressSlideError if pyarrow is not installed, or if the folder is not
    empty.
    """
    try:
        import pyarrow  # noqa: F401
    except ImportError as error:
        raise PushPressSlideError(
            "pyarrow is not installed: pip install 'pushpressslide[lerobot]'"
        ) from error
    if folder.exists() and not _is_empty(folder):
        raise PushPressSlideError(
            f"--lerobot: {str(folder)!r} is not allowed; allowed: a new or empty folder"
        )


def check_video(folder: Path | None) -> None:
    """Raise PushPressSlideError if ``folder`` is None, or if av is not installed."""
    if folder is None:
        raise PushPressSlideError("--video: allowed with --lerobot DIR")
    try:
        import av  # noqa: F401
    except ImportError as error:
        raise PushPressSlideError(
            "av is not installed: pip install 'pushpressslide[lerobot]'"
        ) from error


def _arrow() -> Any:
    """Function that converts an array (n,) or (n, k) to a column."""
    import pyarrow

    def column(values: Values) -> Any:
        """Column of rows with k numbers, each as a list of length k."""
        if values.ndim == 1:
            return pyarrow.array(values)
        flat = pyarrow.array(values.reshape(-1))
        return pyarrow.FixedSizeListArray.from_arrays(flat, values.shape[1])

    return column


def _write_table(
    path: Path, columns: Mapping[str, Any], metadata: Mapping[str, str] | None = None
) -> None:
    """Write columns as a Parquet file."""
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table(dict(columns))
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(table.replace_schema_metadata(metadata), sink)
    write_whole(path, sink.getvalue().to_pybytes())


def _columns(shown: Demonstrations) -> dict[str, Values]:
    """Columns of all frames: (n,) or (n, k)."""
    count = len(shown.actions)
    last = np.append(shown.episode[1:] != shown.episode[:-1], True)
    return {
        "observation.state": shown.states.astype(np.float32),
        "action": shown.actions.astype(np.float32),
        "next.reward": shown.rewards.astype(np.float32),
        "next.done": last,
        "next.success": last & shown.success[shown.episode],
        "timestamp": (shown.period * shown.frame).astype(np.float32),
        "frame_index": shown.frame,
        "episode_index": shown.episode,
        "index": np.arange(count),
        "task_index": np.zeros(count, dtype=np.int64),
    }


def _info(shown: Demonstrations, columns: Mapping[str, Values]) -> dict[str, Any]:
    """Metadata of the data set."""
    names = {
        "observation.state": list(shown.state_names),
        "action": list(shown.action_names),
    }
    episodes = len(shown.seed)
    return {
        "codebase_version": VERSION,
        "robot_type": "tip",
        "total_episodes": episodes,
        "total_frames": len(shown.actions),
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 500,
        "fps": round(1.0 / shown.period),
        "splits": {"train": f"0:{episodes}"},
        "data_path": DATA_PATH,
        "video_path": None,
        "features": {
            name: {
                "dtype": str(values.dtype),
                "shape": list(values.shape[1:]) or [1],
                "names": names.get(name),
            }
            for name, values in columns.items()
        },
    }


def _episodes(
    shown: Demonstrations, columns: Mapping[str, Values], text: str
) -> dict[str, list[Any]]:
    """Columns of all episodes: their positions in the file and their statistics."""
    count = len(shown.seed)
    ends = np.cumsum(np.bincount(shown.episode, minlength=count)).tolist()
    starts = [0, *ends[:-1]]
    out: dict[str, list[Any]] = {
        "episode_index": list(range(count)),
        "tasks": [[text]] * count,
        "length": [b - a for a, b in zip(starts, ends, strict=True)],
        "data/chunk_index": [0] * count,
        "data/file_index": [0] * count,
        "dataset_from_index": starts,
        "dataset_to_index": ends,
        "meta/episodes/chunk_index": [0] * count,
        "meta/episodes/file_index": [0] * count,
    }
    for start, end in zip(starts, ends, strict=True):
        rows = {name: values[start:end] for name, values in columns.items()}
        for name, figures in _statistics(rows).items():
            for figure, value in figures.items():
                out.setdefault(f"stats/{name}/{figure}", []).append(value)
    return out


def _statistics(columns: Mapping[str, Values]) -> Statistics:
    """Statistics of each column, for each of its components."""
    out: Statistics = {}
    for name, values in columns.items():
        rows = values.reshape(len(values), -1).astype(np.float64)
        figures = {
            "min": rows.min(axis=0),
            "max": rows.max(axis=0),
            "mean": rows.mean(axis=0),
            "std": rows.std(axis=0),
            "count": np.array([len(rows)]),
        }
        for quantile in QUANTILES:
            figures[f"q{100.0 * quantile:02.0f}"] = np.quantile(rows, quantile, axis=0)
        out[name] = {key: value.tolist() for key, value in figures.items()}
    return out
