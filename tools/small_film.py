"""Make a film of a run small enough for a page.

    python tools/small_film.py runs/x/run.webp docs/figures/x.webp

Two thirds of the width, one picture of three, as quick as the run; from when the
object starts to move.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageSequence

from pushpressslide.core.control import PHASES

WIDTH = 800  # [pixels]
EVERY = 3  # pictures
QUALITY = 55  # of 100
LARGEST = 3_000_000  # [bytes]


def main() -> None:
    """Read a film, and write the small one."""
    source, target = map(Path, sys.argv[1:])
    start = 1e3 * moving_from(source.parent / "record.npz")
    pictures = []
    passed = spent = 0
    with Image.open(source) as film:
        size = (WIDTH, round(WIDTH * film.height / film.width))
        for i, picture in enumerate(ImageSequence.Iterator(film)):
            picture.load()
            duration = int(picture.info["duration"])
            passed += duration
            if passed < start:
                continue
            spent += duration
            if i % EVERY == 0:
                pictures.append(picture.convert("RGB").resize(size))
    first, *others = pictures
    first.save(
        target,
        save_all=True,
        append_images=others,
        duration=round(spent / len(pictures)),
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
