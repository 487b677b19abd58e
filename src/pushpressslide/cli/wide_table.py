"""A table that may be wider than the terminal, without cutting words."""

from __future__ import annotations

from rich.console import Console
from rich.table import Column, Table

BOUNDLESS = 10_000
"""Width of a terminal, in columns, that fits any table."""


def print_table(table: Table, console: Console) -> None:
    """Print a table if its words fit, otherwise each row as a list of its columns."""
    boundless = console.options.update(width=BOUNDLESS)
    needed = console.measure(table, options=boundless)
    if needed.minimum > console.width:
        _print_rows(table, console)
        return
    if needed.maximum > console.width:
        _share(table, console.width - needed.minimum)
    console.print(table)


def _share(table: Table, spare: int) -> None:
    """Set column widths: the longest word, plus a share of ``spare`` characters.

    Columns with longer lines get more of the spare characters.
    """
    least = [_longest(column, whole=bool(column.no_wrap)) for column in table.columns]
    most = [_longest(column, whole=True) for column in table.columns]
    wanted = sum(most) - sum(least)
    for column, low, high in zip(table.columns, least, most, strict=True):
        column.width = low + (high - low) * spare // wanted


def _longest(column: Column, whole: bool) -> int:
    """Length of a column's longest cell (``whole``) or longest word."""
    texts = [str(column.header), *map(str, column.cells)]
    words = texts if whole else [word for text in texts for word in text.split()]
    return max(map(len, words), default=0)


def _print_rows(table: Table, console: Console) -> None:
    """Print each row as a list: its first cell, then the others with their headings."""
    if table.title:
        console.print(table.title)
    headings = [str(column.header) for column in table.columns]
    width = max(map(len, headings))
    for row in zip(*(column.cells for column in table.columns), strict=True):
        first, *others = zip(headings, row, strict=True)
        console.print(f"{first[1]}")
        for heading, cell in others:
            console.print(f"    {heading:<{width}}  {cell}")
