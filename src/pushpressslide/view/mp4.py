"""Film of a run as MP4, by PyAV, the optional package av."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

from PIL import Image

from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.whole_file import whole

CODEC = "libx264"
# superfast: its files are half of ultrafast's, for a tenth more time
ENCODER = {"preset": "superfast", "crf": "23", "threads": "2"}
PIXELS = "yuv420p"  # the format that every player reads
MISSING = "av is not installed: pip install 'pushpressslide[video]'"


def has_encoder() -> bool:
    """Whether MP4 files can be written."""
    return importlib.util.find_spec("av") is not None


def write_mp4(
    count: int, draw: Callable[[int], Image.Image], out: Path, rate: float
) -> Path:
    """Write ``count`` images of ``draw`` at ``rate`` [1/s], completely or not at all.
    Return its path.

    Width and height are even. Raises MissingPackageError without av.
    """
    if not has_encoder():
        raise MissingPackageError(f"{out}: {MISSING}")
    import av

    with whole(out) as temporary, av.open(str(temporary), "w", format="mp4") as file:
        stream: Any = file.add_stream(
            CODEC, rate=Fraction(rate).limit_denominator(1000)
        )
        stream.pix_fmt = PIXELS
        stream.options = ENCODER
        for number in range(count):
            picture = draw(number)
            if number == 0:
                stream.width, stream.height = picture.size
            file.mux(stream.encode(av.VideoFrame.from_image(picture)))
        file.mux(stream.encode())
    return out
