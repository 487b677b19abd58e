"""The record of a run for the viewer Rerun, if rerun-sdk is installed."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.record_columns import named_columns
from pushpressslide.core.whole_file import whole
from pushpressslide.report.files import Run

SERIES = ("object_", "reference_", "tracking_error_", "tip")
TIMELINE = "time"


def write_rerun(run: Run, path: Path) -> Path:
    """Write a recording of a run's time series and of the object's outline to ``path``.

    Raises MissingPackageError if rerun-sdk is not installed.
    """
    try:
        rerun = importlib.import_module("rerun")
    except ModuleNotFoundError:
        raise MissingPackageError(
            "--rerun: rerun-sdk is not installed: pip install rerun-sdk"
        ) from None
    recording = rerun.RecordingStream("pushpressslide")
    with whole(path) as temporary:
        recording.save(str(temporary))
        _log_series(rerun, recording, run)
        _log_object(rerun, recording, run)
        recording.flush()
        recording.disconnect()
    return path


def _log_series(rerun: Any, recording: Any, run: Run) -> None:
    """Log each column of object, reference and tips as a series of scalars."""
    arrays = run.record.arrays
    clock = rerun.TimeColumn(TIMELINE, duration=arrays["time"])
    for name, values in named_columns(arrays).items():
        if name.startswith(SERIES) and not isinstance(values, list):
            columns = rerun.Scalars.columns(scalars=np.nan_to_num(values))
            recording.send_columns(f"series/{name}", [clock], columns)


def _log_object(rerun: Any, recording: Any, run: Run) -> None:
    """Log the object's outline, and its pose in the plane at each tick."""
    arrays = run.record.arrays
    outline = np.array(run.task.object.shape.outline())
    closed = np.column_stack(
        [np.vstack([outline, outline[:1]]), np.zeros(len(outline) + 1)]
    )
    recording.log("object", rerun.LineStrips3D([closed]), static=True)
    clock = rerun.TimeColumn(TIMELINE, duration=arrays["time"])
    x, y, yaw = arrays["object_pose"].T
    none = np.zeros(len(x))
    turns = np.column_stack([none, none, np.sin(0.5 * yaw), np.cos(0.5 * yaw)])
    places = np.column_stack([x, y, none])
    columns = rerun.Transform3D.columns(translation=places, quaternion=turns)
    recording.send_columns("object", [clock], columns)
