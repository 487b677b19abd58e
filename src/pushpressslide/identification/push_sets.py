"""Sets of recorded pushes: the object, its pins, and the pairs of wrench and motion.

The object of the published sets is an aluminium prism (docs/uncertainty.md). For other
logs a task describes the object. The name of a folder gives the pins under the object.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pushpressslide.core.constants import GRAVITY
from pushpressslide.core.errors import PushPressSlideError
from pushpressslide.core.pose import Point
from pushpressslide.identification.pairs import Pairs, measured_pairs
from pushpressslide.identification.recordings import (
    Recording,
    find_recordings,
    read_recording,
)
from pushpressslide.mechanics.pressure import (
    PressureSamples,
    pin_pressure,
    polygon_pressure,
)
from pushpressslide.mechanics.punch import punch_pressure

LEAST_PUSHES = 4  # smallest number of pushes for fit and test
WHOLE_BASE = "patch"  # in a folder's name: the object stands on its whole base
NUMBERS = re.compile(r"(?<![\d.])\d+(?:\.\d+)?(?:_\d+(?:\.\d+)?)*(?![\d.])")


@dataclass(frozen=True)
class PushedObject:
    """The object that was pushed, in its tracked frame G."""

    base: tuple[Point, ...]  # [m] corners of the base, counter-clockwise
    center_of_mass: Point  # [m] projected on the support
    weight: float  # [N] load on the support


PRISM = PushedObject(
    ((0.0, 0.0), (0.15, 0.0), (0.0, 0.15)), (0.05, 0.05), 1.5 * GRAVITY
)
"""The prism of the published sets, tracked at its right-angled corner."""


@dataclass(frozen=True, eq=False)
class PushSet:
    """The pushes of one folder, or of one recording."""

    name: str
    body: PushedObject
    logs: tuple[str, ...]  # names of the files
    # [m] in B, the frame at the CoM; none: the whole base touches
    pins: tuple[Point, ...]
    pairs: Pairs
    numbers: NDArray[np.intp]  # (n,) number of each pair's push
    refused: tuple[str, ...]  # pushes without a pair, and why
    notes: tuple[str, ...] = ()  # assumptions about the object and the logs

    @property
    def count(self) -> int:
        """Number of pushes that have pairs."""
        return len(np.unique(self.numbers))

    @property
    def weight(self) -> float:
        """Load on the support [N]."""
        return self.body.weight

    @property
    def base(self) -> tuple[Point, ...]:
        """Corners of the base [m] in B, counter-clockwise."""
        cx, cy = self.body.center_of_mass
        return tuple((x - cx, y - cy) for x, y in self.body.base)

    def static_pressure(self) -> PressureSamples:
        """Load at rest [N] in B.

        With pins it follows from statics. Otherwise it is the load of a rigid face, or
        of an elastic face if an edge of the rigid one would lift.
        """
        if self.pins:
            return pin_pressure(self.pins, (0.0, 0.0), self.weight)
        try:
            return punch_pressure(self.base, self.weight, (0.0, 0.0), resolution=3)
        except ValueError:
            return self._elastic_pressure()

    def uniform_pressure(self) -> PressureSamples | None:
        """Even load at rest [N] in B. None if the object stands on pins.

        If the CoM is off the centroid, the load varies linearly.
        """
        return None if self.pins else self._elastic_pressure()

    def _elastic_pressure(self) -> PressureSamples:
        return polygon_pressure(self.base, self.weight, (0.0, 0.0), resolution=4)


def load_sets(
    data: Path,
    progress: Callable[[float, float], None] | None = None,
    body: PushedObject = PRISM,
) -> tuple[list[PushSet], list[str]]:
    """One set for each folder with logs at or below ``data``, and a line for each
    skipped text file.

    ``body`` is the object that was pushed. A text file is skipped if it is not a log,
    or a log without a push. Raises PushPressSlideError for a log that cannot be read,
    for a set with fewer than ``LEAST_PUSHES`` pushes, and if no log holds a push.
    """
    logs, others = find_recordings(data)
    read: dict[Path, list[Recording]] = {}
    passed_over = [f"{path.name}: not a log of pushes." for path in others]
    for done, path in enumerate(logs, 1):
        recording = read_recording(path)
        if recording.pushes:
            read.setdefault(path.absolute().parent, []).append(recording)
        else:
            passed_over.append(
                f"{path.name}: holds no push, announces {recording.announced}."
            )
        if progress is not None:
            progress(done, len(logs))
    if not read:
        raise PushPressSlideError(f"{data}: holds no push; {passed_over[-1]}")
    names = _names(list(read))
    sets = [
        _push_set(names[folder], folder, found, body) for folder, found in read.items()
    ]
    return sets, passed_over


def pins_of_name(name: str) -> tuple[Point, ...]:
    """Pins [m] in the tracked frame, from a name that contains x1_x2_x3_y1_y2_y3 [mm].

    Words may precede and follow the numbers, and other numbers may precede them. Empty
    if the name does not contain six consecutive numbers.
    """
    for row in NUMBERS.findall(name):
        numbers = [1e-3 * float(word) for word in row.split("_")][-6:]
        if len(numbers) == 6:
            return tuple(zip(numbers[:3], numbers[3:], strict=True))
    return ()


def layout_note(name: str) -> str:
    """Note on what was assumed about the pins, if a folder's name is ambiguous.

    Empty for a plain x1_x2_x3_y1_y2_y3, and for a name with ``WHOLE_BASE``.
    """
    pins = pins_of_name(name)
    if not pins:
        if WHOLE_BASE in name.lower():
            return ""
        return "its name gives no pins; the whole base is assumed to touch."
    numbers = [
        f"{1e3 * v:.10g}" for v in (*(x for x, _ in pins), *(y for _, y in pins))
    ]
    if NUMBERS.fullmatch(name) and len(name.split("_")) == 6:
        return ""
    return f"its pins are assumed to be {'_'.join(numbers)}."


def _names(folders: Sequence[Path]) -> dict[Path, str]:
    """Short names that distinguish the folders."""
    depth = 1
    while len({folder.parts[-depth:] for folder in folders}) < len(folders):
        depth += 1
    return {folder: "/".join(folder.parts[-depth:]) for folder in folders}


def _push_set(
    name: str, folder: Path, recordings: list[Recording], body: PushedObject
) -> PushSet:
    pushes = [push for recording in recordings for push in recording.pushes]
    cx, cy = body.center_of_mass
    pairs, refused = measured_pairs(pushes, body.center_of_mass)
    check_count(str(folder), len(pairs), len(pushes), refused)
    note = layout_note(folder.name)
    made = PushSet(
        name,
        body,
        tuple(recording.path.name for recording in recordings),
        tuple((x - cx, y - cy) for x, y in pins_of_name(folder.name)),
        pairs,
        np.arange(len(pairs)),
        tuple(refused),
        (*((f"{name}: {note}",) if note else ()), *_broken_off(recordings)),
    )
    try:
        made.static_pressure()
    except ValueError as error:
        raise PushPressSlideError(
            f"{folder}: its name gives pins that cannot carry the object: {error}"
        ) from None
    return made


def check_count(source: str, used: int, count: int, refused: Sequence[str]) -> None:
    """Raise PushPressSlideError if fewer than ``LEAST_PUSHES`` of ``count`` pushes are
    ``used``. ``refused`` says why the others are not.
    """
    if used >= LEAST_PUSHES:
        return
    reason = f" ({refused[0]})" if refused else ""
    raise PushPressSlideError(
        f"{source}: {used} of {count} pushes can be used{reason}; at least "
        f"{LEAST_PUSHES} are needed"
    )


def _broken_off(recordings: Sequence[Recording]) -> list[str]:
    """A note on each log whose number of pushes differs from the announced one."""
    return [
        f"{recording.path.name}: announces {recording.announced} pushes, holds "
        f"{len(recording.pushes)}."
        for recording in recordings
        if len(recording.pushes) != recording.announced
    ]
