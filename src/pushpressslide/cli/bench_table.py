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
}


def print_benchmarks(benchmarks: Mapping[str, Sequence[Mapping[str, Any]]]) -> None:
    """Print the rows of each benchmark under its name."""
    console = Console(markup=False, highlight=False)
    for name, rows in benchmarks.items():
        table = Table(title=name, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
        columns = [key for key in rows[0] if any(row.get(key) not in (None, "") for row in rows)]
        for key in columns:
            text = isinstance(rows[0][key], str)
            table.add_column(HEADINGS.get(key, key.replace("_", " ")), justify="left" if text else "right")
        for row in rows:
            table.add_row(*(_shown(row.get(key)) for key in columns))
        console.print(table)


def _shown(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.0f}" if value.is_integer() and abs(value) < 1e6 else f"{value:.3g}"
    return str(value)
