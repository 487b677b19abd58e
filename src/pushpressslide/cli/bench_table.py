"""The tables of ``pps bench``: one for each benchmark."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

HEADINGS = {
    "median_us": "median us",
    "ratio": "times the first",
    "possible": "possible, share",
    "symmetric": "paper's split, share",
    "bias": "paper's bias, wrench",
    "turned": "turned by rad",
    "drift": "drift / bias",
    "select_ms": "selection ms",
    "winner": "ranked first",
    "soonest": "soonest there",
    "times": "times to the goal",
}


def print_benchmarks(benchmarks: Mapping[str, Sequence[Mapping[str, Any]]]) -> None:
    """Print the rows of each benchmark under its name."""
    console = Console(markup=False, highlight=False)
    for name, rows in benchmarks.items():
        table = Table(
            title=name, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False
        )
        columns = [key for key in rows[0] if any(_tells(row.get(key)) for row in rows)]
        for key in columns:
            text = isinstance(rows[0][key], str)
            table.add_column(
                HEADINGS.get(key, key.replace("_", " ")),
                justify="left" if text else "right",
            )
        for row in rows:
            table.add_row(*(_shown(row.get(key)) for key in columns))
        console.print(table)


def _tells(value: object) -> bool:
    """Whether a figure has a place in a table: there is one, and it is no table itself."""
    return value not in (None, "") and not isinstance(value, Mapping)


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None:
        return "-"
    if isinstance(value, float):
        return (
            f"{value:.0f}"
            if value.is_integer() and abs(value) < 1e6
            else f"{value:.3g}"
        )
    return str(value)
