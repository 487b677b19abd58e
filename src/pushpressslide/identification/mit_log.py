"""Logs of the MIT pushing data set (Yu et al., IROS 2016), as HDF5 or as JSON with the
same contents.

A file holds one push: ``object_pose`` and ``tip_pose`` with rows t, x, y, yaw [s, m, m,
rad], ``ft_wrench`` with rows t, fx, fy, tau [s, N, N, N m].
"""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError, PushPressSlideError
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.streams import Stream, Streams, stream_of

SETS = ("object_pose", "tip_pose", "ft_wrench")
WIDTH = 4  # columns of each array


def read_hdf5(path: Path, options: LogOptions) -> list[Streams]:
    """The push in an HDF5 file, as the only element of a list.

    Raises PushPressSlideError for any other file, and MissingPackageError without h5py.
    """
    try:
        h5py = importlib.import_module("h5py")
    except ModuleNotFoundError:
        raise MissingPackageError(
            f"{path}: h5py is not installed: pip install 'pushpressslide[hdf5]'"
        ) from None
    try:
        with h5py.File(path, "r") as file:
            arrays = {name: np.array(file[name]) for name in SETS if name in file}
    except OSError:
        raise PushPressSlideError(f"{path}: is not an HDF5 file") from None
    return [_streams(path, arrays)]


def read_json_push(path: Path, options: LogOptions) -> list[Streams]:
    """The push in a JSON file with the contents of the HDF5 file, as the only element
    of a list.

    Raises PushPressSlideError for any other file.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        present = [name for name in SETS if name in content]
        arrays = {name: np.array(content[name], dtype=float) for name in present}
    except (OSError, ValueError, TypeError):
        raise PushPressSlideError(
            f"{path}: is not a JSON file with {', '.join(SETS)}"
        ) from None
    return [_streams(path, arrays)]


def _streams(path: Path, arrays: dict[str, Array]) -> Streams:
    for name in SETS:
        if name not in arrays:
            raise PushPressSlideError(f"{path}: {name} is missing; allowed: {SETS}")
        shape = arrays[name].shape
        if len(shape) != 2 or shape[1] < WIDTH or not np.isfinite(arrays[name]).all():
            raise PushPressSlideError(
                f"{path}: {name} {shape} is not allowed; allowed: rows of {WIDTH} numbers"
            )
    placed, tip, wrench = (_sorted(str(path), name, arrays[name]) for name in SETS)
    pose = np.column_stack([placed.values[:, :2], np.unwrap(placed.values[:, 2])])
    height = np.full((len(tip.times), 1), np.nan)
    return Streams(
        str(path),
        Stream(placed.times, pose),
        Stream(tip.times, np.hstack([tip.values[:, :2], height])),
        Stream(wrench.times, wrench.values[:, :2]),
        Stream(tip.times, tip.values[:, 2:3]),
    )


def _sorted(source: str, name: str, rows: Array) -> Stream:
    """Stream from rows of t and three values. One row is kept per stamp."""
    times, first = np.unique(rows[:, 0], return_index=True)
    return stream_of(source, name, times, rows[first, 1:WIDTH])
