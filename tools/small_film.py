"""Make a film of a run small enough for a page.

    python tools/small_film.py runs/x/run.mp4 docs/figures/x.webp

One picture of three, as quick as the run; from when the object starts to move.
"""

from __future__ import annotations

import sys
from pathlib import Path

import av
import numpy as np

from pushpressslide.core.control import PHASES

EVERY = 3  # pictures
QUALITY = 55  # of 100
LARGEST = 3_000_000  # [bytes]


def main() -> None:
    """Read a film, and write the small one."""
    source, target = map(Path, sys.argv[1:])
    start = moving_from(source.parent / "record.npz")
    pictures = []
    with av.open(str(source)) as film:
        rate = float(film.streams.video[0].average_rate)
        for i, frame in enumerate(film.decode(video=0)):
            if frame.time >= start and i % EVERY == 0:
                pictures.append(frame.to_image())
    first, *others = pictures
    first.save(
        target,
        save_all=True,
        append_images=others,
        duration=round(1e3 * EVERY / rate),
        loop=0,
        quality=QUALITY,
        method=4,
    )
    written = target.stat().st_size
    if written > LARGEST:
        sys.exit(f"{target}: {written} bytes, allowed {LARGEST}")


def moving_from(record: Path) -> float:
    """Time [s] since the start at which the object starts to be moved."""
    with np.load(record) as arrays:
        time = arrays["time"]
        return float(time[np.argmax(arrays["phase"] == PHASES.index("move"))] - time[0])


if __name__ == "__main__":
    main()
