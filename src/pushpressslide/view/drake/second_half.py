"""Second half of a run's film, drawn by a second process while the first half is drawn.

The renderer holds Python's lock, so threads would wait for each other. The process is
``python -m`` this module, which imports nothing of the caller's script: the run comes on
stdin, the encoded half goes to stdout.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, TYPE_CHECKING

from pushpressslide.view.film import MP4, film_path
from pushpressslide.view.mp4 import LaterPart, Packet, encoded

if TYPE_CHECKING:
    from pushpressslide.view.drake.run_film import FilmedRun

# -P: no module is taken from the working folder
COMMAND = (sys.executable, "-P", "-m", "pushpressslide.view.drake.second_half")
SHORTEST = 100  # frames; fewer are drawn before a second process is ready


@contextmanager
def second_half(run: FilmedRun, out: Path) -> Iterator[LaterPart | None]:
    """Context of a process that draws the second half of the film ``out``, and ends with
    the block. None if the film is short or no mp4, on a single CPU, and if no such
    process can be started.
    """
    out = film_path(out)
    count = len(run.ticks(out))
    if out.suffix != MP4 or count < SHORTEST or _cpus() < 2:
        yield None
        return
    first = count // 2
    with TemporaryFile() as request, TemporaryFile() as answer:
        process = None
        # a class of the caller's script cannot be pickled, or Python not be started
        with suppress(pickle.PicklingError, AttributeError, TypeError, OSError):
            pickle.dump((run, out, first), request)
            request.seek(0)
            process = subprocess.Popen(
                COMMAND, stdin=request, stdout=answer, stderr=subprocess.DEVNULL
            )
        if process is None:
            yield None
            return
        try:
            yield LaterPart(first, partial(_packets, process, answer))
        finally:
            process.kill()
            process.wait()


def _cpus() -> int:
    """Number of CPUs that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _packets(process: subprocess.Popen[bytes], answer: IO[bytes]) -> list[Packet]:
    """Encoded frames of the process. Empty if it failed."""
    if process.wait() != 0:
        return []
    answer.seek(0)
    packets: list[Packet] = pickle.load(answer)
    return packets


def main() -> None:
    """Draw the frames asked for on stdin, and write them to stdout."""
    from pushpressslide.view.drake.run_film import RunFilm

    with os.fdopen(os.dup(1), "wb") as answer:
        os.dup2(2, 1)  # libraries may print
        run, out, first = pickle.load(sys.stdin.buffer)
        ticks = run.ticks(out)
        frames = range(first, len(ticks))
        draw = RunFilm(run, ticks).draw
        pickle.dump(encoded(frames, draw, run.rate_of(out)), answer)


if __name__ == "__main__":
    main()
