"""Plans, records and results as HTML in a notebook."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.report import style
from pushpressslide.report.page import image, verdict
from pushpressslide.report.page_tables import figures_table
from pushpressslide.report.plane import plan_figure
from pushpressslide.report.series import finite_part, ticks
from pushpressslide.view.planar.replay import write_replay

HEIGHT = 560  # [pixels] height of a replay


def plan_html(plan: Plan) -> str:
    """Picture of a plan."""
    return image(style.png(plan_figure(plan)), "plan", repr(plan))


def result_html(result: Mapping[str, Any]) -> str:
    """Outcome and the table of figures of a run."""
    return verdict(result) + figures_table(result)


def record_html(record: Record) -> str:
    """Ending of a run, its replay from above, and its figures if it was measured."""
    ending = f"<p>{escape(repr(record))}</p>"
    figures = ""
    if record.figures:
        ending = verdict(record.figures)
        table = figures_table(record.figures)
        figures = f"<details><summary>Figures</summary>{table}</details>"
    return ending + _replay(record) + figures


def _replay(record: Record) -> str:
    """Replay as an embedded page.

    Empty if nothing was recorded or nothing moved. Also empty for a run in stages,
    since the view from above does not show other bodies in motion.
    """
    moved = ticks(record) and record.plan.segments
    if not moved or "stage" in record.arrays:
        return ""
    shown = finite_part(record)
    with TemporaryDirectory() as folder:
        page = write_replay(record.plan, shown, Path(folder)).read_text("utf-8")
    return (
        f'<iframe srcdoc="{escape(page)}" width="100%" height="{HEIGHT}" '
        'title="replay" style="border: 0"></iframe>'
    )
