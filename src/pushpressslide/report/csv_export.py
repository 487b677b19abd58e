"""The record of a run as a CSV file with one row per tick."""

from __future__ import annotations

import math
from pathlib import Path

from pushpressslide.core.arrays import Array
from pushpressslide.core.record import Record
from pushpressslide.core.record_columns import named_columns
from pushpressslide.core.whole_file import write_whole


def write_csv(record: Record, path: Path) -> Path:
    """Write the columns of ``core.record_columns`` to ``path``, and return it.

    Numbers are written in full, so that reading them gives the same bits. NaN becomes
    an empty cell.
    """
    columns = named_columns(record.arrays)
    texts = [_texts(column) for column in columns.values()]
    lines = [",".join(columns), *(",".join(row) for row in zip(*texts, strict=True))]
    return write_whole(path, "\n".join(lines) + "\n")


def _texts(column: Array | list[str]) -> list[str]:
    """Cells of one column."""
    values = column if isinstance(column, list) else column.tolist()
    return [_cell(value) for value in values]


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else repr(value)
