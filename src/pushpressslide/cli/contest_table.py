"""Why a run took its mode, as text on the terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from pushpressslide.cli.goals import stage_text
from pushpressslide.cli.tables import simple_table
from pushpressslide.core.plan import Choice
from pushpressslide.report.files import PLAN, load_run
from pushpressslide.selection.contest import Contest, contests


def print_contests(folder: Path) -> None:
    """Print why each mode of the run in ``folder`` was preferred to its rivals.

    Prints nothing if the motions of the run were found by a search.
    """
    if not (folder / PLAN).is_file():
        return
    console = Console(markup=False, highlight=False)
    stages = load_run(folder).begun
    for number, stage in enumerate(stages, start=1):
        if len(stages) > 1:
            console.print(stage_text(number, stage.stage))
        for contest in contests(stage.plan, stage.choices):
            console.print(contest.sentence)
            if contest.rivals:
                console.print(_table(contest))


def _table(contest: Contest) -> Table:
    table = simple_table("mode", "time s", "verdict")
    table.add_row(contest.winner.mode, _time(contest.winner), "taken")
    for rival in contest.rivals:
        table.add_row(rival.mode, _time(rival), contest.verdict(rival))
    return table


def _time(choice: Choice) -> str:
    return "-" if choice.time is None else f"{choice.time:.1f}"
