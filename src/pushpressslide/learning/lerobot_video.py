"""The video of a LeRobot data set: a picture of every frame, in one MP4 file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.whole_file import PART
from pushpressslide.learning.demonstrations import Demonstrations
from pushpressslide.learning.picture import Picture, Pixels

IMAGE = "observation.images.top"
VIDEO = f"videos/{IMAGE}/chunk-000/file-000.mp4"
VIDEO_PATH = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
CODEC = "libx264"
SAMPLED = 100  # largest number of frames sampled for the statistics of the pixels
FIGURES = ("min", "max", "mean", "std")


@dataclass(frozen=True, slots=True, eq=False)
class Video:
    """A video of all frames, and the pictures sampled for its statistics."""

    fps: int
    side: int  # [pixels]
    sample: Array  # (m, side, side, 3) sampled pictures, in [0, 1]
    episode: Array  # (m,) episode of each sampled picture

    @property
    def feature(self) -> dict[str, Any]:
        """Description of the video in info.json."""
        return {
            "dtype": "video",
            "shape": [self.side, self.side, 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.fps": self.fps,
                "video.height": self.side,
                "video.width": self.side,
                "video.channels": 3,
                "video.codec": "h264",
                "video.pix_fmt": "yuv420p",
                "video.is_depth_map": False,
                "has_audio": False,
            },
        }

    def statistics(self, episode: int | None = None) -> dict[str, Any]:
        """Minimum, maximum, mean and standard deviation of each colour, for all
        episodes or for one.
        """
        own = slice(None) if episode is None else self.episode == episode
        pixels = self.sample[own].reshape(-1, 3)
        figures = [getattr(pixels, name)(axis=0) for name in FIGURES]
        out: dict[str, Any] = {
            name: [[[v]] for v in values.tolist()]
            for name, values in zip(FIGURES, figures, strict=True)
        }
        return out | {"count": [len(self.sample[own])]}


def write_video(shown: Demonstrations, picture: Picture, path: Path) -> Video:
    """Write a picture of each frame as an mp4, by ``av``."""
    import av

    fps = round(1.0 / shown.period)
    every = max(1, len(shown.states) // SAMPLED)
    begins = shown.frame == 0
    sample: list[Pixels] = []
    episode = []
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}{PART}")
    with av.open(str(part), "w", format="mp4") as file:
        stream: Any = file.add_stream(CODEC, rate=Fraction(fps))
        stream.pix_fmt = "yuv420p"
        stream.height, stream.width = picture(shown.states[0]).shape[:2]
        for i, state in enumerate(shown.states):
            pixels = picture(state)
            frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
            file.mux(stream.encode(frame))
            if begins[i] or i % every == 0:
                sample.append(pixels)
                episode.append(shown.episode[i])
        file.mux(stream.encode())
    part.replace(path)
    values = np.array(sample) / 255.0
    return Video(fps, values.shape[1], values, np.array(episode))


def video_columns(shown: Demonstrations, video: Video) -> dict[str, list[Any]]:
    """Columns of all episodes: their positions in the video and their statistics."""
    count = len(shown.seed)
    ends = np.cumsum(np.bincount(shown.episode, minlength=count)) / video.fps
    prefix = f"videos/{IMAGE}"
    out: dict[str, list[Any]] = {
        f"{prefix}/chunk_index": [0] * count,
        f"{prefix}/file_index": [0] * count,
        f"{prefix}/from_timestamp": [0.0, *ends[:-1].tolist()],
        f"{prefix}/to_timestamp": ends.tolist(),
    }
    for episode in range(count):
        for figure, value in video.statistics(episode).items():
            out.setdefault(f"stats/{IMAGE}/{figure}", []).append(value)
    return out
