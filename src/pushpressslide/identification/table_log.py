"""Logs as tables (CSV or Parquet) with named columns and one row per stamp.

In the long form a row holds only the streams sampled at its time; the other cells are
empty.
"""

from __future__ import annotations

import csv
import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.errors import MissingPackageError, PushPressSlideError
from pushpressslide.identification.columns import Column, find_columns
from pushpressslide.identification.log_options import LogOptions
from pushpressslide.identification.pairs import yaw_of
from pushpressslide.identification.streams import Stream, Streams, stream_of

EMPTY = ("", "nan", "NaN", "NAN", "null", "NA")
LARGEST_YAW = 6.5  # [rad] above which an angle without a unit is taken to be in degrees
OBJECT = ("object_x", "object_y", "object_yaw")
ROTATION = ("object_qw", "object_qx", "object_qy", "object_qz")
TIP = ("tip_x", "tip_y", "tip_z")
FORCE = ("tip_fx", "tip_fy")


@dataclass(frozen=True, eq=False)
class Table:
    """A table read from a file, by columns."""

    source: str
    titles: tuple[str, ...]
    values: Array  # (n, k) as in the file; NaN: an empty cell
    lines: tuple[int, ...]  # line of each row in the file
    word: str  # word for a row in messages: ``line`` or ``row``
    # row, column and text of each cell that is not a number
    texts: tuple[tuple[int, int, str], ...] = ()


def read_csv(path: Path, options: LogOptions) -> list[Streams]:
    """The recording, or the part of a recording, in a CSV file, as the only element of
    a list.

    The first line holds the names; lines that start with # are skipped. On a fault,
    PushPressSlideError names the line or the column.
    """
    return [streams_of(_csv_table(path), options)]


def read_parquet(path: Path, options: LogOptions) -> list[Streams]:
    """The recording, or the part of a recording, in a Parquet file, as the only element
    of a list.

    Raises PushPressSlideError as ``read_csv`` does, and MissingPackageError without
    pyarrow.
    """
    return [streams_of(_parquet_table(path), options)]


def streams_of(table: Table, options: LogOptions) -> Streams:
    """Streams of a table.

    Raises PushPressSlideError for missing or duplicate columns, for missing cells in a
    sample, and for times that do not increase.
    """
    columns = find_columns(table.source, table.titles, options)
    body = _Columns(table, columns)
    turned = all(name in columns for name in ROTATION)
    pose = (*OBJECT[:2], *ROTATION) if turned and OBJECT[2] not in columns else OBJECT
    placed = body.stream("object", pose)
    tip_names = TIP if TIP[2] in columns else TIP[:2]
    tip = body.stream("tip", tip_names)
    return Streams(
        table.source,
        None if placed is None else _continuous(table.source, placed, columns),
        None if tip is None else _with_height(tip),
        body.stream("force", FORCE),
        body.stream("tip", ("tip_yaw",)),
        _unused(table, columns),
    )


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns of a table by quantity."""

    table: Table
    columns: dict[str, Column]

    def stream(self, name: str, quantities: Sequence[str]) -> Stream | None:
        """Stream of some quantities. None if the table has none of them."""
        table = self.table
        present = [quantity for quantity in quantities if quantity in self.columns]
        if not present:
            return None
        lacking = [quantity for quantity in quantities if quantity not in self.columns]
        if lacking:
            raise PushPressSlideError(
                f"{table.source}: column {lacking[0]} is missing; its columns: "
                f"{', '.join(table.titles)}; --column {lacking[0]}=NAME names another"
            )
        values = np.stack([self._values(quantity) for quantity in quantities], axis=1)
        filled = np.isfinite(values)
        rows = filled.any(axis=1)
        self._check_whole(filled, rows, quantities)
        times = self._times(name)[rows]
        self._check_times(times, np.flatnonzero(rows))
        return stream_of(table.source, name, times, values[rows])

    def _values(self, quantity: str) -> Array:
        column = self.columns[quantity]
        for row, index, text in self.table.texts:
            if index == column.index:
                raise PushPressSlideError(
                    f"{self._place(row)}: column {column.title!r}: {text[:40]!r} is not "
                    "allowed; allowed: a number, or an empty cell"
                )
        values: Array = column.factor * self.table.values[:, column.index]
        return values

    def _times(self, name: str) -> Array:
        own = f"{name}_time"
        quantity = own if own in self.columns else "time"
        if quantity not in self.columns:
            raise PushPressSlideError(
                f"{self.table.source}: column time is missing; its columns: "
                f"{', '.join(self.table.titles)}; --column time=NAME names another"
            )
        return self._values(quantity)

    def _check_whole(self, filled: Any, rows: Any, quantities: Sequence[str]) -> None:
        """Raise PushPressSlideError for a row with an incomplete sample."""
        partial = rows & ~filled.all(axis=1)
        if not partial.any():
            return
        row = int(np.argmax(partial))
        lacking = quantities[int(np.argmin(filled[row]))]
        raise PushPressSlideError(
            f"{self._place(row)}: column {self.columns[lacking].title!r} is empty; allowed: "
            f"a number, as in the other columns of {', '.join(quantities)}"
        )

    def _check_times(self, times: Array, rows: Any) -> None:
        """Raise PushPressSlideError for a row whose time is missing, or not later than
        the previous one.
        """
        if len(times) == 0:
            return
        steps = np.diff(times, prepend=-np.inf)
        wrong = ~(np.isfinite(times) & (steps > 0.0))
        if not wrong.any():
            return
        k = int(np.argmax(wrong))
        if not np.isfinite(times[k]):
            raise PushPressSlideError(f"{self._place(rows[k])}: it has no time")
        raise PushPressSlideError(
            f"{self._place(rows[k])}: time {times[k]:.9g} s is not after "
            f"{times[k - 1]:.9g} s; allowed: times that increase"
        )

    def _place(self, row: int) -> str:
        table = self.table
        return f"{table.source}: {table.word} {table.lines[row]}"


def _continuous(source: str, placed: Stream, columns: dict[str, Column]) -> Stream:
    """The object's stream with a yaw [rad] that does not jump.

    Raises PushPressSlideError for a yaw without a unit that seems to be in degrees.
    """
    values = placed.values
    yaw = values[:, 2] if values.shape[1] == len(OBJECT) else yaw_of(values[:, 2:])
    largest = float(np.abs(yaw).max())
    column = columns.get(OBJECT[2])
    if largest > LARGEST_YAW and column is not None and not column.stated:
        raise PushPressSlideError(
            f"{source}: column {column.title!r}: {largest:.4g} rad is not allowed; "
            "allowed: at most one turn; --unit yaw=deg reads degrees, yaw=rad more turns"
        )
    return Stream(placed.times, np.column_stack([values[:, :2], np.unwrap(yaw)]))


def _with_height(tip: Stream) -> Stream:
    """The tip's stream with a height column. Unknown heights are NaN."""
    if tip.values.shape[1] == 3:
        return tip
    none = np.full(len(tip.times), np.nan)
    return Stream(tip.times, np.column_stack([tip.values, none]))


def _unused(table: Table, columns: dict[str, Column]) -> tuple[str, ...]:
    """Note on a second tip, whose columns are not used."""
    used = {column.title for column in columns.values()}
    second = [
        t for t in table.titles if t.lower().startswith("tip1_") and t not in used
    ]
    if not second:
        return ()
    return (f"{table.source}: tip1 is not used; the pushes are those of one tip.",)


def _csv_table(path: Path) -> Table:
    rows = _csv_rows(path)
    if len(rows) < 2:
        raise PushPressSlideError(
            f"{path}: has {len(rows)} lines; allowed: a line of column names, then lines "
            "of numbers"
        )
    _, first = rows[0]
    titles = tuple(title.strip() for title in first)
    values = np.full((len(rows) - 1, len(titles)), np.nan)
    texts = []
    for i, (line, cells) in enumerate(rows[1:]):
        if len(cells) != len(titles):
            raise PushPressSlideError(
                f"{path}: line {line}: {len(cells)} cells; allowed: {len(titles)}, one "
                "for each name in the first line"
            )
        for k, cell in enumerate(cells):
            text = cell.strip()
            if text in EMPTY:
                continue
            try:
                values[i, k] = float(text)
            except ValueError:
                texts.append((i, k, text))
    lines = tuple(line for line, _ in rows[1:])
    return Table(str(path), titles, values, lines, "line", tuple(texts))


def _csv_rows(path: Path) -> list[tuple[int, list[str]]]:
    """Numbered lines of a CSV file, without blank lines and comments."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise PushPressSlideError(
            f"{path}: cannot be read ({error.strerror})"
        ) from None
    except UnicodeDecodeError:
        raise PushPressSlideError(f"{path}: is not text; allowed: CSV") from None
    head = next((line for line in text.splitlines() if line.strip()), "")
    delimiter = max(",;\t", key=head.count)
    reader = csv.reader(text.splitlines(), delimiter=delimiter)
    return [
        (reader.line_num, cells)
        for cells in reader
        if cells and any(cells) and not cells[0].lstrip().startswith("#")
    ]


def _parquet_table(path: Path) -> Table:
    try:
        parquet = importlib.import_module("pyarrow.parquet")
    except ModuleNotFoundError:
        raise MissingPackageError(
            f"{path}: pyarrow is not installed: pip install pyarrow"
        ) from None
    try:
        read = parquet.read_table(path)
    except (OSError, ValueError):
        raise PushPressSlideError(f"{path}: is not a Parquet file") from None
    titles = []
    columns = []
    for title in read.column_names:
        cells = read[title].to_numpy()
        if np.issubdtype(cells.dtype, np.number):
            titles.append(title)
            columns.append(cells.astype(np.float64))
    values = np.stack(columns, axis=1) if columns else np.zeros((0, 0))
    lines = tuple(range(1, len(values) + 1))
    return Table(str(path), tuple(titles), values, lines, "row")
