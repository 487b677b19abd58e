"""Animation of a run: size, times, caption, and file."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import SimulationError
from pushpressslide.core.whole_file import whole, write_whole
from pushpressslide.view.canvas import Canvas, rgba, text_width
from pushpressslide.view.mp4 import LaterPart, has_encoder, write_mp4
from pushpressslide.view.timeline import RunTimeline, still_ticks

# [pixels] width and height. Without a graphics card a film takes time by its pixels
SIZE = (800, 450)
MP4 = ".mp4"
FORMATS = (MP4, ".webp", ".gif")
FRAMES_PER_SECOND = 25.0  # of an mp4
PICTURES_PER_SECOND = 15.0  # of the other formats, which hold whole pictures
NAME = "run"
PICTURES = "pictures"
"""Folder of the pictures of a run: start.webp, contact.webp and end.webp."""
CLOSE = "contact"
"""Name of the picture that may be a close-up."""
STILL_SIZE = (960, 540)  # [pixels] of these
QUALITY = 75  # of a .webp, up to 100
LINE = 16.0  # [pixels] between lines of the legend
LETTERS = 10.5  # [pixels] height of its letters
ROOM = 12.0  # [pixels] about words


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """A colour and its meaning."""

    color: str  # #rrggbb
    text: str


def film_ticks(time: Array, rate: float) -> list[int]:
    """Tick of each picture, at ``rate`` [1/s]. ``time`` (N,) [s] is that of each tick."""
    grid = np.arange(float(time[0]), float(time[-1]) + 0.5 / rate, 1.0 / rate)
    ticks = np.clip(np.searchsorted(time, grid), 0, len(time) - 1)
    return [int(tick) for tick in ticks]


def film_path(out: Path) -> Path:
    """File of a film. In a folder it is run.mp4, or run.webp if av is not installed.

    Raises SimulationError for an unsupported format.
    """
    if out.is_dir():
        kind = MP4 if has_encoder() else ".webp"
        return out / f"{NAME}{kind}"
    if out.suffix not in FORMATS:
        raise SimulationError(
            f"{out}: an animation is written as {' or '.join(FORMATS)}"
        )
    return out


def film_rate(out: Path) -> float:
    """Usual frame rate [1/s] of the format of ``out``."""
    return FRAMES_PER_SECOND if out.suffix == MP4 else PICTURES_PER_SECOND


class _Reel(Image.Image):
    """Sequence of pictures that Pillow reads like a multi-picture file, with only one
    in memory at a time.
    """

    def __init__(self, count: int, draw: Callable[[int], Image.Image]) -> None:
        super().__init__()
        self.n_frames = count
        self._draw = draw
        self._at = -1
        self._show(0)

    def _show(self, frame: int) -> None:
        picture = self._draw(frame)
        self.im = picture.im
        self._mode = picture.mode
        self._size = picture.size
        self._at = frame

    def seek(self, frame: int) -> None:
        """Go to a picture. Raises EOFError if there is none."""
        if frame >= self.n_frames:
            raise EOFError(f"there are {self.n_frames} pictures")
        if frame != self._at:
            self._show(frame)

    def tell(self) -> int:
        """Number of the picture."""
        return self._at


def write_film(
    count: int,
    draw: Callable[[int], Image.Image],
    out: Path,
    rate: float,
    later: LaterPart | None = None,
) -> Path:
    """Write ``count`` images of ``draw`` as an animation at ``rate`` [1/s], completely
    or not at all. Return its path. ``later``: images of an mp4 that are drawn elsewhere.

    Raises MissingPackageError for an mp4 without av.
    """
    if out.suffix == MP4:
        return write_mp4(count, draw, out, rate, later)
    reel = _Reel(count, draw)
    with whole(out) as temporary:
        reel.save(
            temporary,
            save_all=True,
            duration=round(1e3 / rate),
            loop=0,
            quality=QUALITY,
            method=2,
        )
    return out


def write_stills(
    phase: Array, draw: Callable[[str, int], Image.Image], out: Path
) -> list[Path]:
    """Write pictures of start, contact and end of a run into the folder
    ``out``/pictures. Return their paths.

    ``draw`` draws the picture for a name and a tick. ``phase`` (N,) is that of each
    tick.
    """
    paths = []
    for name, tick in still_ticks(phase).items():
        buffer = BytesIO()
        draw(name, tick).save(buffer, "webp", quality=QUALITY)
        path = out / PICTURES / f"{name}.webp"
        paths.append(write_whole(path, buffer.getvalue()))
    return paths


def caption(canvas: Canvas, title: str, timeline: RunTimeline, frame: int) -> None:
    """Write title, time, phase, force and distance to the goal along the lower edge of
    a picture.
    """
    width, height = canvas.size
    top = height - 34.0
    canvas.panel((0.0, top), (float(width), float(height)))
    canvas.text((ROOM, top + 8.0), title)
    words = moment(timeline, frame)
    canvas.text((width - text_width(words) - ROOM, top + 8.0), words)


def moment(timeline: RunTimeline, frame: int) -> str:
    """One line with the values of the timeline at a frame."""
    time = timeline.time[frame]
    phase = next(
        (span.name for span in reversed(timeline.phases) if span.start <= time), ""
    )
    parts = [f"{time:.1f} s", phase]
    parts += [mark.name for mark in timeline.marks if mark.time <= time][-1:]
    many = len(timeline.arms) > 1
    forces = [
        f"{name.removesuffix(' arm')} {row[frame]:.1f} N"
        if many
        else f"{row[frame]:.1f} N"
        for name, row in zip(timeline.arms, timeline.force, strict=True)
    ]
    parts.append("force " + ", ".join(forces))
    parts.append(
        f"to the goal {timeline.distance[frame]:.0f} mm, {timeline.turn[frame]:.0f}°"
    )
    return "   ".join(part for part in parts if part)


def legend(entries: Iterable[LegendEntry]) -> Canvas:
    """Meanings of the colours, drawn once for all pictures."""
    rows = list(entries)
    width = round(max(text_width(item.text, LETTERS) for item in rows) + 40.0)
    height = round(LINE * len(rows) + ROOM)
    canvas = Canvas(np.full((height, width, 3), 255, dtype=np.uint8))
    for i, item in enumerate(rows):
        y = 7.0 + LINE * i
        level = y + 0.6 * LETTERS
        canvas.line(((ROOM, level), (ROOM + 14.0, level)), rgba(item.color), 6.0)
        canvas.text((ROOM + 21.0, y), item.text, LETTERS)
    return canvas
