"""Tables of ``pps bench``, one for each benchmark."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Console, JustifyMethod
from rich.table import Table

from pushpressslide.cli.wide_table import print_table

HEADINGS = {
    "median_us": "median µs",
    "p99_us": "99th percentile µs",
    "ratio": "times the first",
    "python_over": "Python takes, times",
    "one_by_one_over": "one by one takes, times",
    "off_path_mm": "off the path mm",
    "end_mm": "off in the end mm",
    "end_deg": "deg",
    "tick_us": "median tick µs",
    "longest_us": "longest µs",
    "late": "ticks over the period",
    "run_over_played_back": "run over its torques played back",
    "wall_per_simulated": "wall s per simulated s",
    "planned_s": "planned s",
    "median_s": "median s",
    "p95_s": "95th percentile s",
    "way_m": "way m",
    "takes_s": "the way takes s",
    "checks": "poses checked",
    "apart_mm": "played back apart mm",
    "samples_s": "10,000 samples s",
    "possible": "possible, share",
    "symmetric": "paper's split, share",
    "bias": "paper's bias, wrench",
    "turned": "turned by rad",
    "drift": "drift / bias",
    "right": "right, share",
    "near": "wrong ones to their limit",
    "select_ms": "selection ms",
    "winner": "ranked first",
    "soonest": "soonest there",
    "times": "times to the goal",
}
JUSTIFY: dict[type, JustifyMethod] = {str: "left"}
WORDS = {True: "yes", False: "no"}


def print_benchmarks(benchmarks: Mapping[str, Sequence[Mapping[str, Any]]]) -> None:
    """Print the rows of each benchmark under its name."""
    console = Console(markup=False, highlight=False)
    for name, rows in benchmarks.items():
        table = Table(
            title=name, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False
        )
        columns = [key for key in rows[0] if any(_shows(row.get(key)) for row in rows)]
        for key in columns:
            heading = HEADINGS.get(key, key.replace("_", " "))
            justify = JUSTIFY.get(type(rows[0][key]), "right")
            table.add_column(heading, justify=justify)
        for row in rows:
            table.add_row(*(_text(row.get(key)) for key in columns))
        print_table(table, console)


def _shows(value: object) -> bool:
    """Whether a table shows a value: one that is neither empty nor itself a table."""
    return value not in (None, "") and not isinstance(value, Mapping)


def _text(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return WORDS[value]
    if not isinstance(value, float):
        return str(value)
    whole = value.is_integer() and abs(value) < 1e6
    return format(value, ".0f" if whole else ".3g")
