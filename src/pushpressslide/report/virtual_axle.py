"""The page of the virtual-axle experiment: one table of measured, predicted and the
paper's; its plots.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide.report.axle_figures import directions_figure
from pushpressslide.report.page import document, image
from pushpressslide.report.page_tables import table

COLUMNS = (
    "force",
    "direction",
    "measured",
    "predicted",
    "error",
    "no height",
    "error",
    "paper",
    "error",
    "turn rate",
    "grip",
)
LEGEND = (
    "Virtual axle on the line from the CoM to the contact, in mm: 0 at the CoM, "
    "positive towards the "
    "contact. Force: its angle from that line, the same in the body all the time; "
    "below 90° the contact is "
    "pulled forward, above it is pushed back. Predicted: exact limit surface under the "
    "load as the drag at "
    "the contact's height moves it; no height: the same, but the drag in the support's "
    "plane; paper: "
    "x_cop − (c r0)²/d with c = 0.6 and r0 the half diagonal, one value for all "
    "directions. Error: measured "
    "minus the column before. Turn rate in mrad/s. Grip: largest share of the tip's "
    "friction that was used."
)
FIGURE_COLUMNS = ("figure", "", "paper", "recomputed", "exact")
CHECK_COLUMNS = ("changed", "measured", "predicted", "error")


def write_virtual_axle(result: Mapping[str, Any], out: Path) -> Path:
    """Write ``out``/report.html, table.md and axles.png from a result; return the
    page's path.
    """
    png = style.png(directions_figure(result))
    write_whole(out / "axles.png", png)
    write_whole(out / "table.md", markdown(result))
    page = f"<h1>Virtual axle of a pressed object</h1>{page_body(result, png, 'h2')}"
    return write_whole(out / "report.html", document("Virtual axle", page))


def page_body(result: Mapping[str, Any], png: bytes, heading: str) -> str:
    """Return verdict, figure ``png`` and tables as HTML, under headings of the level
    ``heading``.
    """
    tolerance = 1e3 * result["tolerance"]

    def judged(row: Sequence[str]) -> str:
        return "" if not row[4] else "ok" if abs(float(row[4])) <= tolerance else "no"

    def titled(text: str) -> str:
        return f"<{heading}>{text}</{heading}>"

    parts = [
        f'<p class="verdict {"good" if _all_within(result) else "bad"}">{escape(verdict(result))}</p>',
        image(
            png,
            "axle over force angle",
            "Dots: measured. Lines: predicted, for each press and height.",
        ),
        titled("The paper's figures, recomputed"),
        _html(FIGURE_COLUMNS, (("", row) for row in _figure_rows(result)), numbers=3),
        titled("Every probe"),
        f"<p>{escape(LEGEND)}</p>",
        _html(COLUMNS, _probe_rows(result), numbers=len(COLUMNS) - 2, judge=judged),
    ]
    if result["checks"]:
        parts += [
            titled("What the figures depend on"),
            _html(CHECK_COLUMNS, _check_rows(result), numbers=3),
        ]
    return "".join(parts)


def markdown(result: Mapping[str, Any]) -> str:
    """Return verdict, recomputed figures, probes and checks as Markdown."""
    parts = [
        verdict(result),
        "## The paper's figures, recomputed",
        _markdown(FIGURE_COLUMNS, _figure_rows(result)),
        "## Every probe",
        LEGEND,
        *_grouped_markdown(COLUMNS, _probe_rows(result)),
    ]
    if result["checks"]:
        parts += [
            "## What the figures depend on",
            *_grouped_markdown(CHECK_COLUMNS, _check_rows(result)),
        ]
    return "\n\n".join(parts) + "\n"


def verdict(result: Mapping[str, Any]) -> str:
    """Say in how many probes measured and predicted agree, and how far off each formula
    is.
    """
    s = result["summary"]
    skipped = s["probes"] - s["measured"]
    text = (
        f"{s['within_tolerance']} of {s['measured']} probes are within "
        f"{1e3 * result['tolerance']:.0f} mm of "
        f"the prediction{f'; {skipped} were not run' if skipped else ''}."
    )
    for key, words in (
        ("predicted", "predicted with the contact's height"),
        ("without_height", "without the height"),
        ("paper", "by the paper's formula"),
    ):
        if s[key] is not None:
            text += f" Error {words}: median {_mm(s[key]['median'])} mm, largest {_mm(s[key]['max'])} mm."
    return text


def _all_within(result: Mapping[str, Any]) -> bool:
    s = result["summary"]
    return bool(s["measured"] and s["within_tolerance"] == s["measured"])


def _mm(value: float) -> str:
    return f"{1e3 * value:.1f}"


def _error(row: Mapping[str, Any], key: str) -> str:
    """Measured minus expected [mm]; no minus sign before a zero."""
    return f"{round(1e3 * (row['measured'] - row[key]), 1) + 0.0:+.1f}"


def _probe_rows(result: Mapping[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Yield the cells of every probe, each with the title of its group: one height and
    one press.
    """
    settings = {(c["height"], c["load"]): c for c in result["curves"]}
    for row in result["rows"]:
        at = settings[row["height"], row["load"]]
        title = (
            f"Contact {1e3 * row['height']:.0f} mm high, pressed with {row['load']:g} "
            "N: centre of pressure "
            f"{_mm(at['cop'])} mm, d {_mm(at['lever'])} mm; the paper's formula "
            f"{1e3 * at['paper']:.0f} mm, "
            f"added up as it prints it {1e3 * at['paper_printed']:.0f} mm away"
        )
        cells = [f"{row['angle']:g}°", row["direction"]]
        if row["measured"] is None:
            yield title, [*cells, row["skipped"], *[""] * (len(COLUMNS) - 3)]
            continue
        cells.append(_mm(row["measured"]))
        for key in ("predicted", "without_height", "paper"):
            cells += [_mm(row[key]), _error(row, key)]
        cells += [
            f"{1e3 * row['measured_turn_rate']:.0f}",
            f"{row['measured_friction_use']:.2f}",
        ]
        yield title, cells


def _figure_rows(result: Mapping[str, Any]) -> list[list[str]]:
    def shown(value: float | None, unit: str, decimals: int) -> str:
        return "" if value is None else f"{value:.{decimals}f} {unit}".rstrip()

    out = []
    for row in result["paper_figures"]:
        unit = row["unit"]
        decimals = 4 if unit == "m²" else 3
        paper = "" if row["paper"] is None else f"{row['paper']:g} {unit}".rstrip()
        figures = (shown(row[key], unit, decimals) for key in ("recomputed", "exact"))
        out.append([row["what"], row["note"], paper, *figures])
    return out


def _check_rows(result: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """The probes that were done again, each below the one of the table that it varies."""
    at = {
        (row["angle"], row["load"], row["height"], row["variant"]): row
        for row in result["rows"]
    }
    at |= {
        (row["angle"], row["load"], row["height"], row["variant"]): row
        for row in result["checks"]
    }
    cases = dict.fromkeys(
        (row["angle"], row["load"], row["height"]) for row in result["checks"]
    )
    variants = dict.fromkeys(row["variant"] for row in result["checks"])
    out = []
    for case in cases:
        title = f"{case[0]:g}°, pressed with {case[1]:g} N, contact {1e3 * case[2]:.0f} mm high"
        for variant in ("", *variants):
            row = at[*case, variant]
            cells = [variant or "nothing"]
            if row["measured"] is None:
                cells += [row["skipped"], "", ""]
            else:
                cells += [
                    _mm(row["measured"]),
                    _mm(row["predicted"]),
                    _error(row, "predicted"),
                ]
            out.append((title, cells))
    return out


def _grouped_markdown(
    head: Sequence[str], rows: Iterable[tuple[str, Sequence[str]]]
) -> list[str]:
    parts = []
    for title, group in groupby(rows, key=lambda pair: pair[0]):
        parts += [f"**{title}**", _markdown(head, [row for _, row in group])]
    return parts


def _markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _html(
    head: Sequence[str],
    rows: Iterable[tuple[str, Sequence[str]]],
    numbers: int,
    judge: Callable[[Sequence[str]], str] | None = None,
) -> str:
    """Return rows of (title of the group, cells) as an HTML table, the last ``numbers``
    columns to the right.

    ``judge`` gives the class of a row's fifth cell.
    """
    lines = []
    marks = []
    for title, group in groupby(rows, key=lambda pair: pair[0]):
        if title:
            lines.append(
                [f'<th colspan="{len(head)}" scope="rowgroup">{escape(title)}</th>']
            )
            marks.append(' class="group"')
        for _, row in group:
            css = ["n" if i >= len(head) - numbers else "" for i in range(len(row))]
            if judge is not None:
                css[4] += f" {judge(row)}"
            lines.append(
                [
                    f'<td class="{c}">{escape(cell)}</td>'
                    for c, cell in zip(css, row, strict=True)
                ]
            )
            marks.append("")
    return table(head, lines, marks, numbers=numbers)
