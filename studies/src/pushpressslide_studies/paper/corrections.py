"""Corrections to the paper's text: the paper's figures and the correct ones.

Both are computed on request, one row for each correction in docs/mechanics.md, section
12. Renew the page with ``python -m pushpressslide_studies.paper.corrections
studies/docs/corrections.md``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

from pushpressslide.core.whole_file import write_whole
from pushpressslide.report.page_tables import number_cells, table
from pushpressslide_studies.paper import corrections_one_arm as one
from pushpressslide_studies.paper import corrections_two_arms as two
from pushpressslide_studies.paper.correction import Compared, Correction
from pushpressslide_studies.paper.documents import renewed

ROWS: tuple[Callable[[], Correction], ...] = (
    one.distance_from_com,
    one.pressure_constant,
    one.force_invariance,
    one.mobility_of_shift,
    one.mobility_of_load,
    two.moments_about_com,
    one.stanley_signs,
    one.steering_of_pusher,
    two.differential_drive,
    two.bias_is_external,
    two.turning_regions,
    two.symmetric_split,
    two.pivot_about_contact,
    one.virtual_target,
    one.one_friction,
)


def corrections() -> tuple[Correction, ...]:
    """All corrections, computed by this call."""
    return tuple(row() for row in ROWS)


def html(rows: Sequence[Correction]) -> str:
    """Corrections as an HTML table, with a group of figures for each."""
    lines = []
    marks = []
    for row in rows:
        reason = f'<span class="why">{escape(row.why)} Mechanics {escape(row.section)}.</span>'
        lines.append(
            [f'<th colspan="4" scope="rowgroup">{escape(row.claim)}<br>{reason}</th>']
        )
        marks.append(' class="claim"')
        for figure in row.figures:
            cells = number_cells(map(figure.shown, (figure.paper, figure.holds)))
            rho = f"<td>{escape(_rho(figure))}</td>"
            lines.append([f'<th scope="row">{escape(figure.what)}</th>', rho, *cells])
            marks.append("")
    return table(("Claim and figure", "Rho", "Paper", "Holds"), lines, marks, numbers=2)


def _rho(figure: Compared) -> str:
    """The rho on which a figure is based, or "-"."""
    return "-" if figure.rho == "none" else figure.rho


def markdown(rows: Sequence[Correction]) -> str:
    """Corrections as Markdown, each with a heading, a line of text and a table."""
    parts = []
    for row in rows:
        lines = ["| figure | rho | paper | holds |", "|---|---|---:|---:|"]
        lines += [
            f"| {f.what} | {_rho(f)} | {f.shown(f.paper)} | {f.shown(f.holds)} |"
            for f in row.figures
        ]
        reason = f"{row.why} ([mechanics](../../docs/mechanics.md), {row.section})"
        parts.append(f"**{row.claim}.** {reason}\n\n" + "\n".join(lines))
    return "\n\n".join(parts)


def with_corrections(page: str) -> str:
    """A page with its corrections renewed.

    Raises ValueError for a page without the two marks.
    """
    return renewed(page, "corrections", markdown(corrections()))


if __name__ == "__main__":
    target = Path(sys.argv[1])
    write_whole(target, with_corrections(target.read_text(encoding="utf-8")))
