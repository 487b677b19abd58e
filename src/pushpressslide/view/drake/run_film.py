"""Film of a run, drawn frame by frame with its forces, paths and a caption."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.view import film
from pushpressslide.view.canvas import Canvas
from pushpressslide.view.drake.frames import FrameRenderer
from pushpressslide.view.drake.overlay import Overlay
from pushpressslide.view.drake.playback import Placed
from pushpressslide.view.mp4 import LaterPart
from pushpressslide.view.timeline import run_timeline


@dataclass(frozen=True, slots=True)
class FilmedRun:
    """A run that is filmed, and how."""

    plan: Plan
    record: Record
    models: str = "generated"  # of the robots
    goals: Sequence[Placed] = ()  # as in ``Playback``
    size: tuple[int, int] = film.SIZE  # [pixels] width and height
    rate: float | None = None  # [1/s] of frames; None: the usual one of the format

    def rate_of(self, out: Path) -> float:
        """Frames per second [1/s] of the film ``out``."""
        return self.rate or film.film_rate(out)

    def ticks(self, out: Path) -> list[int]:
        """Tick of each frame of the film ``out``."""
        return film.film_ticks(self.record.arrays["time"], self.rate_of(out))


class RunFilm:
    """Draws the frames of a film."""

    def __init__(self, run: FilmedRun, ticks: Sequence[int]) -> None:
        """Prepare frames at ``ticks``. Raises SimulationError if this machine cannot
        render.
        """
        self._ticks = ticks
        self._renderer = FrameRenderer(
            run.plan, run.record, run.size, run.models, run.goals, coarse=True
        )
        self._overlay = Overlay(self._renderer.playback, self._renderer.view, run.size)
        self._timeline = run_timeline(run.plan, run.record, np.array(ticks))
        self._title = f"{run.plan.task.name}: {', '.join(run.record.modes)}"
        self._legend = film.legend(self._overlay.contacts.entries())

    def draw(self, frame: int) -> Any:
        """Picture of a frame, as a Pillow image."""
        tick = self._ticks[frame]
        canvas = Canvas(self._renderer.image_at(tick))
        self._overlay.draw(canvas, tick)
        canvas.paste(self._legend)
        film.caption(canvas, self._title, self._timeline, frame)
        return canvas.image()


def write_video(run: FilmedRun, out: Path, later: LaterPart | None = None) -> Path:
    """Write a run as an animated picture in real time and return its path.

    Format and usual rate follow from the name of ``out``: .mp4, .webp or .gif; a folder
    gets run.mp4, or run.webp without av. ``later``: frames of an mp4 that are drawn
    elsewhere. Raises SimulationError if this machine cannot render, or for another
    format.
    """
    out = film.film_path(out)
    ticks = run.ticks(out)
    draw = RunFilm(run, ticks).draw
    return film.write_film(len(ticks), draw, out, run.rate_of(out), later)
