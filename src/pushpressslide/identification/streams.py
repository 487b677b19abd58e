"""Streams of a recording: object, tip and force, each with its own stamps.

All readers of recordings return these streams. The object's pose is stamped by the
camera's clock, tip and force by the arm's clock.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError

LONGEST_GAP = 0.25  # [s] longest gap between two samples that is interpolated
LEAST_SAMPLES = 10  # smallest number of samples in a stream
NEEDED = ("object", "tip", "force")
"""Streams of a complete recording."""

Rows = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Stream:
    """Samples of one sensor."""

    times: Array  # (n,) [s] increasing
    values: Array  # (n, k)

    def values_at(self, times: Array) -> Array:
        """Values (m, k) at ``times`` (m,) [s], interpolated linearly."""
        columns = [np.interp(times, self.times, column) for column in self.values.T]
        return np.stack(columns, axis=1)

    def covers(self, times: Array) -> Rows:
        """Whether each of ``times`` (m,) [s] lies between samples that are at most
        ``LONGEST_GAP`` apart.
        """
        after = np.searchsorted(self.times, times).clip(1, len(self.times) - 1)
        gap = self.times[after] - self.times[after - 1]
        inside = (times >= self.times[0]) & (times <= self.times[-1])
        covered: Rows = inside & (gap <= LONGEST_GAP)
        return covered

    def shifted(self, seconds: float) -> Stream:
        """The stream with ``seconds`` added to its stamps."""
        return Stream(self.times + seconds, self.values)


@dataclass(frozen=True, eq=False)
class Streams:
    """A recording in world axes. Missing streams are None."""

    source: str  # names the file
    object: Stream | None = None  # x, y [m], yaw [rad] of G, continuous
    tip: Stream | None = None  # x, y, z [m] of its centre; z NaN if not recorded
    force: Stream | None = None  # fx, fy [N] of the tip on the object
    # [rad] yaw of the tip's axes, in which forces may be given
    tip_yaw: Stream | None = None
    notes: tuple[str, ...] = ()

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the streams that identification needs and the recording lacks."""
        return tuple(name for name in NEEDED if getattr(self, name) is None)


def stream_of(source: str, name: str, times: Array, values: Array) -> Stream:
    """Checked stream of a file.

    Raises PushPressSlideError if it is too short or not finite, or if its times do not
    increase.
    """
    if len(times) < LEAST_SAMPLES:
        raise PushPressSlideError(
            f"{source}: {name}: {len(times)} samples; at least {LEAST_SAMPLES} are needed"
        )
    steps = np.diff(times)
    if not (steps > 0.0).all():
        first = int(np.argmin(steps > 0.0))
        raise PushPressSlideError(
            f"{source}: {name}: time {times[first + 1]:.9g} s is not after "
            f"{times[first]:.9g} s (sample {first + 2}); allowed: increasing times"
        )
    return Stream(times, values)


def joined(parts: Sequence[Streams]) -> list[Streams]:
    """Recordings from several files: the complete recordings, and one joined from the
    partial ones.

    Raises PushPressSlideError if a stream is missing, or occurs in two partial
    recordings.
    """
    whole = [part for part in parts if not part.missing]
    rest = [part for part in parts if part.missing]
    return [*whole, _one(rest)] if rest else whole


def _one(parts: Sequence[Streams]) -> Streams:
    """One recording, joined from parts with different streams."""
    source = ", ".join(part.source for part in parts)
    found: dict[str, Stream] = {}
    for part in parts:
        for name in (*NEEDED, "tip_yaw"):
            stream = getattr(part, name)
            if stream is not None and name in found:
                raise PushPressSlideError(
                    f"{source}: {name} is in two of the files; allowed: one"
                )
            if stream is not None:
                found[name] = stream
    notes = tuple(note for part in parts for note in part.notes)
    made = Streams(source, notes=notes, **found)
    if made.missing:
        raise PushPressSlideError(
            f"{source}: {', '.join(made.missing)} missing; needed: object x y yaw, tip "
            "x y, force fx fy, in one file or in several"
        )
    return made
