"""Recordings in files of any known kind, identified by suffix."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.bag_log import read_bag
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.mit_log import read_hdf5, read_json_push
from pushpressslide.identification.record_log import read_record
from pushpressslide.identification.streams import Streams, joined
from pushpressslide.identification.table_log import read_csv, read_parquet

Reader = Callable[[Path, LogOptions], list[Streams]]
"""Function that reads the recordings, or parts of recordings, in one file."""

READERS: dict[str, Reader] = {
    ".csv": read_csv,
    ".tsv": read_csv,
    ".parquet": read_parquet,
    ".mcap": read_bag,
    ".bag": read_bag,
    ".h5": read_hdf5,
    ".hdf5": read_hdf5,
    ".json": read_json_push,
    ".npz": read_record,
}
# files that this package writes next to its records
RESULTS = ("result.json", "plan.json", "select.json", "foxglove.json")
BAG = "metadata.yaml"  # in a folder of rosbag2
RECORD = "record.npz"  # in a folder of a run


def log_files(data: Sequence[Path]) -> list[Path]:
    """Stream files and rosbag2 folders among the paths of ``data`` or inside them.

    Empty if there are none; the data may then be text logs. Raises PushPressSlideError
    for a path that does not exist.
    """
    found: list[Path] = []
    for path in data:
        if not path.exists():
            raise PushPressSlideError(
                f"{path}: there is no such file or folder; give a log of pushes, or a "
                "folder"
            )
        found += _files_at(path)
    return found


def _files_at(path: Path) -> list[Path]:
    if path.is_file():
        return [path] if path.suffix.lower() in READERS else []
    if (path / BAG).is_file():
        return [path]
    if (path / RECORD).is_file():
        return [path / RECORD]
    inside = [_files_at(each) for each in sorted(path.iterdir()) if _may_hold(each)]
    return [file for files in inside for file in files]


def _may_hold(path: Path) -> bool:
    """Whether a file or folder may contain logs. Results of other commands do not."""
    return path.name not in RESULTS and not path.name.startswith(".")


def read_logs(files: Sequence[Path], options: LogOptions) -> list[Streams]:
    """Complete recordings of files.

    Raises PushPressSlideError for a file that cannot be read, and for a missing stream.
    """
    parts: list[Streams] = []
    for path in files:
        reader = read_bag if path.is_dir() else READERS[path.suffix.lower()]
        parts += reader(path, options)
    return joined(parts)
