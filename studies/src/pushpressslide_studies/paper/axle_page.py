"""Page of the virtual-axle experiment: measured and predicted axles, and those of the
paper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide.report.page import document, image
from pushpressslide.report.page_tables import group_row, table
from pushpressslide_studies.paper.axle_figure import directions_figure

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
    """Write ``out``/report.html, table.md and axles.png and return the page's path."""
    png = style.png(directions_figure(result))
    write_whole(out / "axles.png", png)
    write_whole(out / "table.md", markdown(result))
    page = f"<h1>Virtual axle of a pressed object</h1>{page_body(result, png, 'h2')}"
    return write_whole(out / "report.html", document("Virtual axle", page))


def page_body(result: Mapping[str, Any], png: bytes, heading: str) -> str:
    """Verdict, figure ``png`` and tables as HTML.

    ``heading`` is the HTML tag of their headings.
    """
    tolerance = 1e3 * result["tolerance"]

    def error_class(row: Sequence[str]) -> str:
        """CSS class for a probe's prediction error [mm]. Empty if the probe was not
        run.
        """
        if not row[4]:
            return ""
        return "ok" if abs(float(row[4])) <= tolerance else "no"

    def titled(text: str) -> str:
        """A heading."""
        return f"<{heading}>{text}</{heading}>"

    css = "good" if _all_within(result) else "bad"
    parts = [
        f'<p class="verdict {css}">{escape(verdict(result))}</p>',
        image(
            png,
            "axle over force angle",
            "Dots: measured. Lines: predicted, for each press and height.",
        ),
        titled("The paper's figures, recomputed"),
        _html(FIGURE_COLUMNS, (("", row) for row in _figure_rows(result)), numbers=3),
        titled("Every probe"),
        f"<p>{escape(LEGEND)}</p>",
        _html(
            COLUMNS,
            _probe_rows(result),
            numbers=len(COLUMNS) - 2,
            css_class=error_class,
        ),
    ]
    if result["checks"]:
        parts += [
            titled("What the figures depend on"),
            _html(CHECK_COLUMNS, _check_rows(result), numbers=3),
        ]
    return "".join(parts)


def markdown(result: Mapping[str, Any]) -> str:
    """Verdict, recomputed figures, probes and checks as Markdown."""
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
    """Sentence on the number of probes that agree with the prediction, and on the
    errors of each formula.
    """
    s = result["summary"]
    skipped = s["probes"] - s["measured"]
    text = (
        f"{s['within_tolerance']} of {s['measured']} probes are within "
        f"{1e3 * result['tolerance']:.0f} mm of the prediction"
    )
    if skipped:
        text += f"; {skipped} were not run"
    text += "."
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
    """Measured minus expected value [mm] as text, without a minus sign before zero."""
    return f"{round(1e3 * (row['measured'] - row[key]), 1) + 0.0:+.1f}"


def _probe_rows(result: Mapping[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Yield the title of each probe's group and the probe's cells.

    A group is one height and one press.
    """
    settings = {(c["height"], c["load"]): c for c in result["curves"]}
    for row in result["rows"]:
        curve = settings[row["height"], row["load"]]
        title = (
            f"Contact {1e3 * row['height']:.0f} mm high, pressed with {row['load']:g} "
            "N: centre of pressure "
            f"{_mm(curve['cop'])} mm, d {_mm(curve['lever'])} mm; the paper's formula "
            f"{1e3 * curve['paper']:.0f} mm, "
            f"added up as it prints it {1e3 * curve['paper_printed']:.0f} mm away"
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
    rows = []
    for figure in result["paper_figures"]:
        exact = ".4f" if figure["unit"] == "m²" else ".3f"
        texts = [
            _with_unit(figure[key], form, figure["unit"])
            for key, form in (("paper", "g"), ("recomputed", exact), ("exact", exact))
        ]
        rows.append([figure["what"], figure["note"], *texts])
    return rows


def _with_unit(value: float | None, form: str, unit: str) -> str:
    """A figure in the given format. Empty for None."""
    if value is None:
        return ""
    return f"{value:{form}} {unit}".rstrip()


def _check_rows(result: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """The repeated probes, each below the probe of the table that it varies."""
    probes = {
        (row["angle"], row["load"], row["height"], row["variant"]): row
        for row in (*result["rows"], *result["checks"])
    }
    cases = dict.fromkeys(
        (row["angle"], row["load"], row["height"]) for row in result["checks"]
    )
    variants = dict.fromkeys(row["variant"] for row in result["checks"])
    out = []
    for case in cases:
        title = f"{case[0]:g}°, pressed with {case[1]:g} N, contact {1e3 * case[2]:.0f} mm high"
        for variant in ("", *variants):
            row = probes[*case, variant]
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
    css_class: Callable[[Sequence[str]], str] | None = None,
) -> str:
    """Rows of (title of the group, cells) as an HTML table.

    The last ``numbers`` columns are right-aligned. ``css_class`` returns the class of a
    row's fifth cell.
    """
    lines = []
    marks = []
    for title, group in groupby(rows, key=lambda pair: pair[0]):
        if title:
            lines.append(group_row(title, len(head)))
            marks.append(' class="group"')
        for _, row in group:
            css = [""] * (len(head) - numbers) + ["n"] * numbers
            if css_class is not None:
                css[4] += f" {css_class(row)}"
            lines.append(
                [
                    f'<td class="{c}">{escape(cell)}</td>'
                    for c, cell in zip(css, row, strict=True)
                ]
            )
            marks.append("")
    return table(head, lines, marks, numbers=numbers)
