"""Table of ``pps gym-pusht``: our figures and published figures."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table

from pushpressslide_studies.pusht.benchmark import Figures
from pushpressslide_studies.pusht.published import PUBLISHED

COLUMNS = ("episodes", "success", "95 %", "reward", "overlap", "steps")
NOTES = (
    "Means of the episodes' greatest reward and overlap, and of their steps. The reward "
    "is the overlap over 0.95, at most 1; an episode ends in success above 0.95. The "
    "published policies see pictures, this one the state."
)


def print_figures(figures: Figures) -> None:
    """Print our row, the published rows, and the failed episodes."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("policy", no_wrap=True)
    for column in COLUMNS:
        table.add_column(column, justify="right", no_wrap=True)
    low, high = figures.success_interval
    table.add_row(
        "pushpressslide",
        str(figures.episodes),
        f"{figures.success:.1%}",
        f"{100.0 * low:.1f}-{100.0 * high:.1f}",
        f"{figures.reward:.3f}",
        f"{figures.overlap:.3f}",
        f"{figures.steps:.1f}",
    )
    for row in PUBLISHED:
        reward = f"{row.reward:.3f}"
        share = f"{row.success:.1%}"
        table.add_row(row.name, str(row.episodes), share, "-", reward, "-", "-")
    console = Console(markup=False, highlight=False)
    console.print(table)
    console.print(NOTES)
    failed = ", ".join(map(str, figures.failed)) or "none"
    console.print(f"Seeds that failed: {failed}.")
