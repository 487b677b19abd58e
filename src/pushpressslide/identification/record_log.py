"""Streams of a run of this package, from record.npz."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.streams import Streams, stream_of

NAMES = ("time", "object_pose", "tip_position", "measured_force")
IDLE = 0.5  # [N] largest force that an arm without a contact may measure


def read_record(path: Path, options: LogOptions) -> list[Streams]:
    """The recording in a run's record.npz, as the only element of a list.

    Raises PushPressSlideError for any other archive, and for a run in which two tips
    touched the object.
    """
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in NAMES if name in stored}
    except (OSError, ValueError, zipfile.BadZipFile):
        raise PushPressSlideError(f"{path}: is not a record of a run") from None
    return [streams_of_record(str(path), arrays)]


def streams_of_record(source: str, arrays: Mapping[str, Array]) -> Streams:
    """Streams of the pushing tip, from the arrays of a record.

    Raises PushPressSlideError as ``read_record`` does.
    """
    lacking = [name for name in NAMES if name not in arrays]
    if lacking:
        raise PushPressSlideError(
            f"{source}: has no array {lacking[0]}; allowed: the record.npz of a run"
        )
    times, pose, tips, forces = (arrays[name] for name in NAMES)
    busy = np.flatnonzero(np.nanmax(np.linalg.norm(forces, axis=2), axis=0) > IDLE)
    if len(busy) != 1:
        raise PushPressSlideError(
            f"{source}: {len(busy)} tips touch the object; allowed: one, that pushes"
        )
    arm = busy[0]
    pose = np.column_stack([pose[:, :2], np.unwrap(pose[:, 2])])
    return Streams(
        source,
        stream_of(source, "object", times, pose),
        stream_of(source, "tip", times, tips[:, arm]),
        stream_of(source, "force", times, forces[:, arm, :2]),
    )
