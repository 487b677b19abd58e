"""The rows of a sweep: one line of JSON each, appended as the samples finish.

A row is reused only by a sweep with the same key: a hash of the resolved task, the
options, the library versions and the package's source files.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import writing

Row = dict[str, Any]
SOURCES = (".py", ".yaml", ".css")
ABSENT = -1
BLOCK = 4096  # [bytes] of a file that are searched for the end of a line


@cache
def source_hash() -> str:
    """Hash of all source files of the package."""
    digest = hashlib.sha256()
    root = Path(str(resources.files("pushpressslide")))
    for path in sorted(root.rglob("*")):
        if path.suffix in SOURCES:
            digest.update(str(path.relative_to(root)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(settings: Mapping[str, Any]) -> str:
    """Key of rows made with ``settings``, which must be JSON data."""
    text = json.dumps(settings, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class Rows:
    """Rows of one sweep in a file. Only their file positions are in memory."""

    def __init__(self, path: Path, key: str) -> None:
        """Find the rows with ``key`` in the file ``path``, and ignore all others."""
        self._path = path
        self._key = key
        self._places = array("q")  # in the file, of each sample's row; ABSENT: none yet
        self._codes = bytearray()  # of each sample's status, an index into _statuses
        self._statuses: list[str] = []
        self._forced: dict[tuple[int, int], int] = {}  # places by sample and rank
        if path.exists():
            for place, row in _lines(path):
                if row.get("key") == key:
                    self._note(row, place)

    def __contains__(self, index: int) -> bool:
        return index < len(self._places) and self._places[index] != ABSENT

    def __len__(self) -> int:
        return len(self._places) - self._places.count(ABSENT)

    def has_forced(self, index: int, rank: int) -> bool:
        """Whether the forced run of a choice of a refused sample is stored."""
        return (index, rank) in self._forced

    def status(self, index: int) -> str:
        """Final status of a sample."""
        return self._statuses[self._codes[index]]

    def add(self, row: Row) -> None:
        """Append a row."""
        self.extend([row])

    def extend(self, rows: Iterable[Row]) -> None:
        """Append rows."""
        keyed = [{"key": self._key, **row} for row in rows]
        lines = [(json.dumps(row) + "\n").encode() for row in keyed]
        with writing(self._path):
            place = self._append(lines)
        for row, line in zip(keyed, lines, strict=True):
            self._note(row, place)
            place += len(line)

    def _append(self, lines: Sequence[bytes]) -> int:
        """Append all lines or none to the file, and sync it. Return their position."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("ab+", buffering=0) as file:
            end = file.seek(0, os.SEEK_END)
            start = _whole_lines(file, end)
            try:
                # of a process that was killed: what follows must not join it
                file.truncate(start)
                left = memoryview(b"".join(lines))
                while left:
                    left = left[file.write(left) :]
                os.fsync(file.fileno())
            except BaseException:
                file.truncate(start)
                raise
        return start

    def read(self, count: int) -> Iterator[Row]:
        """Yield the rows of the first ``count`` samples in order."""
        yield from self._rows_at(self._places[i] for i in range(count))

    def read_forced(self, count: int) -> Iterator[Row]:
        """Yield the forced runs of the first ``count`` samples in order."""
        wanted = sorted(key for key in self._forced if key[0] < count)
        yield from self._rows_at(self._forced[key] for key in wanted)

    def _note(self, row: Row, place: int) -> None:
        index = int(row["index"])
        if "rank" in row:
            self._forced[index, int(row["rank"])] = place
            return
        missing = index + 1 - len(self._places)
        self._places.extend([ABSENT] * missing)
        self._codes.extend([0] * missing)
        status = str(row["status"])
        if status not in self._statuses:
            self._statuses.append(status)
        self._places[index] = place
        self._codes[index] = self._statuses.index(status)

    def _rows_at(self, places: Iterable[int]) -> Iterator[Row]:
        if not self._path.exists():
            return
        with self._path.open("rb") as file:
            for place in places:
                file.seek(place)
                row: Row = json.loads(file.readline())
                yield row


def _whole_lines(file: io.FileIO, end: int) -> int:
    """Position after the last complete line in a file, up to ``end``."""
    while end > 0:
        start = max(0, end - BLOCK)
        file.seek(start)
        place = file.read(end - start).rfind(b"\n")
        if place >= 0:
            return start + place + 1
        end = start
    return 0


def _lines(path: Path) -> Iterator[tuple[int, Row]]:
    """Yield each row with its position. A truncated line is skipped."""
    with path.open("rb") as file:
        place = 0
        for line in file:
            if not line.endswith(b"\n"):
                return
            with suppress(json.JSONDecodeError):
                yield place, json.loads(line)
            place += len(line)
