"""A run in Drake with other memory allocators. Memory allocation takes a quarter of the
physics time.

In a separate process, the dynamic linker loads each allocator before that of the C
library.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from ctypes.util import find_library
from pathlib import Path
from statistics import median

from pushpressslide.core.record import Record
from pushpressslide_studies.bench.compared import Row, missing

TASK = "rear-push-rear"
ROUNDS = 3
ALLOCATORS = ("jemalloc", "mimalloc")


def memory() -> list[Row]:
    """A row for each memory allocator: the wall time of a shipped task's run, and its
    ratio to the time with the C library's allocator in the same round.
    """
    own: list[Record] = []
    others: dict[str, list[Record]] = {name: [] for name in ALLOCATORS}
    lacking: dict[str, str] = {}
    for _ in range(ROUNDS):
        own.append(_run(""))
        for name, records in others.items():
            found = _run_with(name)
            if isinstance(found, str):
                lacking[name] = found
            else:
                records.append(found)
    rows = [_row("the C library's", own, own)]
    for name, records in others.items():
        row = _row(name, records, own) if records else missing(name, lacking[name])
        rows.append(row)
    return rows


def _row(name: str, records: Sequence[Record], own: Sequence[Record]) -> Row:
    """Row of a memory allocator. The object's final pose is the same with all
    allocators.
    """
    x, y, _ = records[0].arrays["object_pose"][-1]
    pairs = zip(records, own, strict=True)
    return {
        "what": name,
        "median_us": 1e6 * median(record.wall_time for record in records),
        "ratio": median(record.wall_time / first.wall_time for record, first in pairs),
        "x_mm": 1e3 * x,
        "y_mm": 1e3 * y,
        "note": "",
    }


def _run_with(allocator: str) -> Record | str:
    """Result of the run with a memory allocator, or the reason why there is none."""
    library = find_library(allocator)
    if not sys.platform.startswith("linux") or library is None:
        return f"not found: lib{allocator}"
    return _run(library)


def _run(library: str) -> Record:
    """Result of the run with a ``library`` loaded before all others."""
    from pushpressslide.report.files import load_run

    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        command = [
            sys.executable,
            "-m",
            "pushpressslide",
            "run",
            TASK,
            "--out",
            str(out),
        ]
        environment = {**os.environ, "LD_PRELOAD": library}
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
        return load_run(out).record
