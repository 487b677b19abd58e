"""The page of the paper's experiments: its figures beside the measured ones, and what they say."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import write_whole
from pushpressslide.experiments.paper import Comparison, Experiment, PaperFigure, Variant
from pushpressslide.report import style
from pushpressslide.report.files import load_run
from pushpressslide.report.page import document, image
from pushpressslide.report.page_tables import Row, comparison_table, shown, table
from pushpressslide.report.plots import comparison_plot

FIGURES: tuple[Row, ...] = (
    ("Time", "motion_duration", 1.0, "s", 1),
    ("RMS box", "rms_position_error", 1e3, "mm", 1),
    ("RMS tip", "rms_end_effector_error", 1e3, "mm", 1),
    ("RMS yaw", "rms_yaw_error", 57.29577951308232, "°", 2),
    ("End, position", "final_position_error", 1e3, "mm", 1),
    ("End, yaw", "final_yaw_error", 57.29577951308232, "°", 2),
)
LEGEND = (
    "Time: contact phase, from the first push to the release, in simulated seconds. RMS: over the contact "
    "phase, against the reference at the same time; who is late is far from it. End: distance from the goal."
)
SIGNS = {"over": "> ", "about": "≈ ", "within": "≤ ", "": ""}
TOLD = ("motion_duration", "rms_position_error", "rms_yaw_error", "final_position_error")  # in sentences
ALIKE = 0.03  # share by which two figures may differ and still be called alike


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one variant."""

    folder: Path
    result: Mapping[str, Any] | None  # contents of its result.json; None where it could not be run
    failure: str = ""


Outcomes = dict[tuple[str, str], Outcome]
"""By the names of experiment and variant."""


def write_page(experiments: Sequence[Experiment], outcomes: Outcomes, out: Path) -> Path:
    """Write ``out``/report.html and return its path."""
    page = out / "report.html"
    body = ["<h1>The paper's experiments</h1>", f"<p>{escape(LEGEND)}</p>"]
    body += [_section(experiment, outcomes, page) for experiment in experiments]
    return write_whole(page, document("The paper's experiments", "".join(body)))


def write_table(experiments: Sequence[Experiment], outcomes: Outcomes, path: Path) -> Path:
    """Write the figures as a Markdown file and return its path."""
    parts = [LEGEND + "\n"]
    for experiment in experiments:
        head = ["", "figures", *(label for label, *_ in FIGURES), "outcome"]
        lines = [head, ["---"] * 2 + ["---:"] * len(FIGURES) + ["---"]]
        for variant in experiment.variants:
            outcome = outcomes[experiment.name, variant.name]
            if variant.paper:
                lines.append([variant.title, "paper", *_paper_cells(variant), ""])
            title = "" if variant.paper else variant.title
            lines.append([title, "measured", *_measured_cells(outcome), _verdict(outcome)])
        rows = "\n".join(f"| {' | '.join(line)} |" for line in lines)
        said = " ".join([*findings(experiment, outcomes), experiment.why])
        parts.append(f"## {experiment.title}\n\n{rows}\n\n{said}\n")
    return write_whole(path, "\n".join(parts))


def findings(experiment: Experiment, outcomes: Outcomes) -> list[str]:
    """Return sentences that compare the measured figures of the experiment."""
    said = [_compared(experiment, comparison, outcomes) for comparison in experiment.comparisons]
    return [sentence for sentence in said if sentence]


def _compared(experiment: Experiment, comparison: Comparison, outcomes: Outcomes) -> str:
    """Say what a change did to time, RMS error and end; nothing where a run is missing."""
    base = outcomes[experiment.name, comparison.base].result
    changed = outcomes[experiment.name, comparison.changed].result
    if base is None or changed is None:
        return ""
    told = []
    for label, key, factor, unit, decimals in FIGURES:
        before, after = base[key], changed[key]
        if key not in TOLD or before is None or after is None:
            continue
        values = f"{factor * before:.{decimals}f} to {shown(changed, key, factor, unit, decimals)}"
        told.append(f"{label} {values}{_ratio(before, after)}")
    words = comparison.words[0].upper() + comparison.words[1:]
    end = "" if changed["success"] else f" It ends with: {changed['reason']['text']}."
    return f"{words}: {'; '.join(told)}.{end}"


def _ratio(before: float, after: float) -> str:
    if before <= 0.0 or after <= 0.0:
        return ""
    if abs(after / before - 1.0) <= ALIKE:
        return " (alike)"
    ratio = after / before
    return f" (× {ratio:.2f})" if ratio < 10.0 else f" (× {ratio:.0f})"


def _section(experiment: Experiment, outcomes: Outcomes, page: Path) -> str:
    done: dict[str, Outcome] = {}
    titles = []
    for variant in experiment.variants:
        outcome = outcomes[experiment.name, variant.name]
        if outcome.result is not None:
            done[variant.name] = outcome
            titles.append(variant.title)
    said = "".join(f"<li>{escape(sentence)}</li>" for sentence in findings(experiment, outcomes))
    parts = [
        f"<h2>{escape(experiment.title)}</h2>",
        f"<p>{escape(experiment.source)}. {escape(experiment.claim)}</p>",
        _paper_table(experiment, outcomes, page),
        "<h3>What comes out</h3>" + (f"<ul>{said}</ul>" if said else "") + f"<p>{escape(experiment.why)}</p>",
    ]
    runs = [load_run(outcome.folder) for outcome in done.values()]
    curves = [(title, run.record, run.task, run.plan) for title, run in zip(titles, runs, strict=True)]
    if runs:
        parts.append(image(style.png(comparison_plot(curves)), "errors over time"))
    if len(runs) > 1:
        parts.append("<h3>All figures</h3>" + comparison_table(list(done), [run.result for run in runs]))
    return f"<section>{''.join(parts)}</section>"


def _paper_table(experiment: Experiment, outcomes: Outcomes, page: Path) -> str:
    """Paper's figures and measured ones, a group of rows for each variant."""
    rows, marks = [], []
    width = len(FIGURES) + 2
    for variant in experiment.variants:
        outcome = outcomes[experiment.name, variant.name]
        settings = " ".join(f"<code>{escape(text)}</code>" for text in variant.overrides)
        rows.append([f'<th colspan="{width}" scope="rowgroup">{escape(variant.title)} {settings}</th>'])
        if variant.paper:
            cells = [f'<td class="n">{escape(cell)}</td>' for cell in _paper_cells(variant)]
            rows.append(['<th scope="row">Paper</th>', *cells, "<td></td>"])
        name = "Measured"
        if outcome.result is not None:
            target = Path(os.path.relpath(outcome.folder.resolve(), page.resolve().parent)) / "report.html"
            name = f'<a href="{escape(target.as_posix())}">Measured</a>'
        cells = [f'<td class="n">{escape(cell)}</td>' for cell in _measured_cells(outcome)]
        good = outcome.result is not None and bool(outcome.result["success"])
        verdict = f'<td class="n {"ok" if good else "no"}">{escape(_verdict(outcome))}</td>'
        rows.append([f'<th scope="row">{name}</th>', *cells, verdict])
        marks += [' class="group"', *[""] * (2 if variant.paper else 1)]
    head = ("", *(label for label, *_ in FIGURES), "Outcome")
    return table(head, rows, marks, numbers=len(FIGURES) + 1)


def _paper_cells(variant: Variant) -> list[str]:
    cells = []
    for _, key, factor, unit, decimals in FIGURES:
        figure: PaperFigure | None = variant.paper.get(key)
        value = None if figure is None else figure.value
        text = shown({key: value}, key, factor, unit, decimals)
        cells.append(text if figure is None else SIGNS[figure.about] + text)
    return cells


def _measured_cells(outcome: Outcome) -> list[str]:
    return [
        shown(outcome.result or {}, key, factor, unit, decimals) for _, key, factor, unit, decimals in FIGURES
    ]


def _verdict(outcome: Outcome) -> str:
    if outcome.result is None:
        return f"not run: {outcome.failure}"
    return str(outcome.result["reason"]["code"]).replace("_", " ")
