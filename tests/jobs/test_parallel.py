"""Worker processes end with the one that started them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

PARENT = """
import multiprocessing, os, time
from pathlib import Path
from pushpressslide.jobs.parallel import worker_pool


def note(number):
    folder = Path({folder!r})
    (folder / f"{{os.getpid()}}.part").write_text("")
    os.replace(folder / f"{{os.getpid()}}.part", folder / str(os.getpid()))
    time.sleep(600)


if __name__ == "__main__":
    with worker_pool(2) as pool:
        for future in [pool.submit(note, i) for i in range(2)]:
            future.result()
"""
PATIENCE = 300.0  # [s] until the test gives up; it ends as soon as it knows


def alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    stat = Path(f"/proc/{process}/stat")
    # one that nobody has waited for is dead, too
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] != "Z"


def children_of(process: int) -> set[int]:
    """Return the processes that ``process`` has started, where /proc tells them."""
    listed = Path(f"/proc/{process}/task/{process}/children")
    return set(map(int, listed.read_text().split())) if listed.exists() else set()


def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    notes = tmp_path / "notes"
    notes.mkdir()
    script = tmp_path / "parent.py"
    script.write_text(PARENT.format(folder=str(notes)))
    deadline = time.monotonic() + PATIENCE
    with subprocess.Popen([sys.executable, script]) as parent:
        while len(workers := set(os.listdir(notes))) < 2 or ".part" in str(workers):
            assert parent.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        processes = {*map(int, workers), *children_of(parent.pid)}
        assert all(map(alive, processes))
        parent.send_signal(signal.SIGKILL)
        parent.wait()
    while any(map(alive, processes)):
        assert time.monotonic() < deadline, "a worker outlives its parent"
        time.sleep(0.05)
