"""Film of a run as MP4, by PyAV, the optional package av."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from io import BytesIO
from pathlib import Path
from typing import Any, Self

from PIL import Image

from pushpressslide.core.errors import MissingPackageError
from pushpressslide.core.whole_file import whole

CODEC = "libx264"
# superfast: its files are half of ultrafast's, for a tenth more time
ENCODER = {"preset": "superfast", "crf": "23", "threads": "2"}
PIXELS = "yuv420p"  # the format that every player reads
Draw = Callable[[int], Image.Image]
MISSING = "av is not installed: pip install 'pushpressslide[video]'"


def has_encoder() -> bool:
    """Whether MP4 files can be written."""
    return importlib.util.find_spec("av") is not None


@dataclass(frozen=True, slots=True)
class Packet:
    """A compressed image. Times are numbers of images."""

    content: bytes
    shown: int
    decoded: int
    is_key: bool  # readable without others


@dataclass(frozen=True, slots=True)
class LaterPart:
    """Images of a film from ``first`` on that are drawn elsewhere."""

    first: int
    packets: Callable[[], Sequence[Packet]]  # waits for them; empty: it failed


def write_mp4(
    count: int, draw: Draw, out: Path, rate: float, later: LaterPart | None = None
) -> Path:
    """Write ``count`` images of ``draw`` at ``rate`` [1/s], completely or not at all.
    Return its path. Images of a ``later`` part that failed are drawn here.

    Width and height are even. Raises MissingPackageError without av.
    """
    if not has_encoder():
        raise MissingPackageError(f"{out}: {MISSING}")
    with whole(out) as temporary, _Encoder(str(temporary), rate) as encoder:
        first = count if later is None else later.first
        encoder.write(encoder.encode(range(first), draw))
        packets = () if later is None else later.packets()
        if not packets:
            encoder.write(encoder.encode(range(first, count), draw))
        encoder.write(encoder.flush())
        encoder.write(packets, first)
    return out


def encoded(frames: Iterable[int], draw: Draw, rate: float) -> list[Packet]:
    """The ``frames`` of ``draw`` at ``rate`` [1/s], to be written elsewhere."""
    with _Encoder(BytesIO(), rate) as encoder:
        return [*encoder.encode(frames, draw), *encoder.flush()]


class _Encoder:
    """Encodes images for an mp4, and writes it."""

    def __init__(self, file: str | BytesIO, rate: float) -> None:
        import av

        self._rate = Fraction(rate).limit_denominator(1000)
        self._file: Any = av.open(file, "w", format="mp4")
        self._stream: Any = self._file.add_stream(CODEC, rate=self._rate)
        self._stream.pix_fmt = PIXELS
        self._stream.options = ENCODER

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def encode(self, frames: Iterable[int], draw: Draw) -> Iterator[Packet]:
        """Packets of ``frames``, some images later than they are drawn."""
        import av

        for number in frames:
            picture = draw(number)
            if not self._stream.codec_context.is_open:
                self._stream.width, self._stream.height = picture.size
            yield from map(
                _packet, self._stream.encode(av.VideoFrame.from_image(picture))
            )

    def flush(self) -> Iterator[Packet]:
        """Packets that the encoder has held back. It takes no images after."""
        yield from map(_packet, self._stream.encode())

    def write(self, packets: Iterable[Packet], first: int = 0) -> None:
        """Write packets, with their times counted from image ``first``."""
        import av

        for packet in packets:
            made = av.Packet(packet.content)
            made.time_base = 1 / self._rate
            made.pts = first + packet.shown
            made.dts = first + packet.decoded
            made.is_keyframe = packet.is_key
            made.stream = self._stream
            self._file.mux(made)


def _packet(made: Any) -> Packet:
    """A packet from the encoder, as plain data."""
    return Packet(bytes(made), made.pts, made.dts, made.is_keyframe)
