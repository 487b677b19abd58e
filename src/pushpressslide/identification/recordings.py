"""Reader of recorded pushes: the text logs of the MLab_EXP repository (Zhou et al.,
ICRA 2016).

One log holds N pushes: poses of the object before and after, forces and poses of the
probe during the push. Fields are separated by white space; blank lines are ignored:

    N                                number of pushes
    then for each push:
      x y z qw qx qy qz              object before: mm, unit quaternion, world frame
      x y z qw qx qy qz              object after
      m                              number of force samples
      t fx fy            (m lines)   seconds, newtons, in the sensor's frame
      q                              number of probe samples
      t x y z qw qx qy qz (q lines)  probe tip: seconds, mm, quaternion, world frame
"""

from __future__ import annotations

import codecs
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import PushPressSlideError

Row = tuple[int, str]  # line number and text

MM = 1e-3
POSE = "7 numbers: x y z [mm] and a unit quaternion w x y z"
FORCE = "3 numbers: time [s], fx, fy [N]"
PROBE = "8 numbers: time [s], x y z [mm] and a unit quaternion w x y z"
# tolerance of a quaternion's norm; the logs round to three digits
NORM_TOLERANCE = 0.05


@dataclass(frozen=True, eq=False)
class RecordedPush:
    """One push as recorded; poses in the world frame, positions in metres."""

    before: Array  # (7,) object: x, y, z [m], quaternion w, x, y, z
    after: Array  # (7,)
    forces: Array  # (m, 3) time [s], fx, fy [N] on the sensor, in its frame
    probe: Array  # (q, 8) time [s], tip: x, y, z [m], quaternion w, x, y, z


@dataclass(frozen=True, eq=False)
class Recording:
    """One log file."""

    path: Path
    # number of pushes in the first line; an interrupted session holds fewer
    announced: int
    pushes: tuple[RecordedPush, ...]


def read_recording(path: Path) -> Recording:
    """Pushes of a log. Blank lines are skipped.

    The recorder first writes the number of pushes, then each push when it is complete.
    A log may therefore hold fewer pushes than its first line states, or none. For any
    other deviation, PushPressSlideError gives the line and its expected content.
    """
    rows = _rows(path)
    if not rows:
        raise PushPressSlideError(f"{path}: is empty; expected a log of pushes")
    announced = _count(path, rows, 0, "the number of pushes")
    pushes = []
    at = 1
    while at < len(rows):
        before, after = _block(path, rows, at, 2, POSE)
        at += 2
        blocks = []
        for what, form in (
            ("the number of force samples", FORCE),
            ("the number of probe samples", PROBE),
        ):
            count = _count(path, rows, at, what)
            blocks.append(_block(path, rows, at + 1, count, form))
            at += 1 + count
        forces, probe = blocks
        probe[:, 1:4] *= MM
        before[:3] *= MM
        after[:3] *= MM
        pushes.append(RecordedPush(before, after, forces, probe))
    return Recording(path, announced, tuple(pushes))


def find_recordings(data: Path) -> tuple[list[Path], list[Path]]:
    """Logs in ``data``, a log or a folder with logs at any depth, and the text files
    that are not logs.

    In a folder, every .txt file whose first line is a number counts as a log, except
    the recorder's lists of commanded pushes ("pushaction"). Raises PushPressSlideError
    if there is no log.
    """
    if data.is_file():
        return [data], []
    if not data.is_dir():
        raise PushPressSlideError(
            f"{data}: there is no such file or folder; give a log of pushes, or a "
            "folder"
        )
    texts = sorted(path for path in data.rglob("*.txt") if path.is_file())
    logs = [
        path
        for path in texts
        if "pushaction" not in path.name and _starts_with_a_number(path)
    ]
    if not logs:
        raise PushPressSlideError(
            f"{data}: holds no log of pushes; expected .txt files, here or in its "
            "folders"
        )
    return logs, [path for path in texts if path not in set(logs)]


def _starts_with_a_number(path: Path) -> bool:
    with path.open("rb") as file:
        words = file.read(80).removeprefix(codecs.BOM_UTF8).split()
    return bool(words) and words[0].isdigit()


def _rows(path: Path) -> list[Row]:
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise PushPressSlideError(
            f"{path}: cannot be read ({error.strerror})"
        ) from None
    except UnicodeDecodeError:
        raise PushPressSlideError(
            f"{path}: is not text; expected a log of pushes"
        ) from None
    return [
        (number, line)
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip()
    ]


def _wrong(path: Path, row: Row, expected: str) -> PushPressSlideError:
    text = row[1].strip()
    shown = repr(text if len(text) <= 60 else text[:57] + "...")
    return PushPressSlideError(
        f"{path}: line {row[0]}: {shown} is not allowed; expected {expected}"
    )


def _ended(path: Path, rows: Sequence[Row], expected: str) -> PushPressSlideError:
    return PushPressSlideError(
        f"{path}: line {rows[-1][0]}: the file ends within a push; expected {expected}"
    )


def _count(path: Path, rows: Sequence[Row], index: int, what: str) -> int:
    if index >= len(rows):
        raise _ended(path, rows, what)
    word = rows[index][1].strip()
    if not (word.isascii() and word.isdigit() and len(word) < 10):
        raise _wrong(path, rows[index], what)
    return int(word)


def _block(path: Path, rows: Sequence[Row], first: int, count: int, form: str) -> Array:
    """Array of ``count`` lines of numbers.

    The first number of ``form`` is the number of columns.
    """
    width = int(form[0])
    lines = rows[first : first + count]
    if len(lines) < count:
        raise _ended(path, rows, f"{count - len(lines)} more lines of {form}")
    if not lines:
        return np.zeros((0, width))
    values = _numbers(lines)
    if not _fits(values, width):
        raise _wrong(
            path, next(row for row in lines if not _fits(_numbers([row]), width)), form
        )
    return values


def _numbers(lines: Sequence[Row]) -> Array:
    """The lines as rows of numbers.

    The array has no columns if the lines are not numbers or differ in length.
    """
    try:
        return np.array([line.split() for _, line in lines], dtype=np.float64)
    except ValueError:
        return np.zeros((len(lines), 0))


def _fits(values: Array, width: int) -> bool:
    if values.shape[1] != width or not np.isfinite(values).all():
        return False
    if width == 3:
        return True
    return bool(
        (np.abs(np.linalg.norm(values[:, -4:], axis=1) - 1.0) < NORM_TOLERANCE).all()
    )
