"""Page of the paper's experiments: claims, figures, plots, corrections."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path

from pushpressslide.core.whole_file import write_whole
from pushpressslide.report import style
from pushpressslide.report.axle_figures import axle_over_time
from pushpressslide.report.files import Run, load_run
from pushpressslide.report.page import document, image
from pushpressslide.report.page_tables import (
    comparison_table,
    group_row,
    number_cells,
    table,
)
from pushpressslide.report.plane import path_figure
from pushpressslide.report.plots import comparison_plot
from pushpressslide_studies.paper import corrections
from pushpressslide_studies.paper.axle_figure import directions_figure
from pushpressslide_studies.paper.axle_page import page_body, write_virtual_axle
from pushpressslide_studies.paper.bands import RULES
from pushpressslide_studies.paper.claim import Claim
from pushpressslide_studies.paper.correction import Correction
from pushpressslide_studies.paper.evidence import Evidence, Outcome
from pushpressslide_studies.paper.experiment import Experiment, Variant, Verdict
from pushpressslide_studies.paper.experiments import AXLE
from pushpressslide_studies.paper.figures import FIGURES, paper_figure
from pushpressslide_studies.paper.pictures import CAPTION, NAME
from pushpressslide_studies.paper.table import (
    LEGEND,
    ending,
    outcome_lines,
    scope,
    summary,
)

TITLE = "The paper's experiments"
# style of a verdict
MARKS = {Verdict.reproduced: "ok", Verdict.not_reproduced: "no"}
INTRODUCTION = (
    "Push, Press, Slide: Mode-Aware Planar Contact Manipulation via Reduced-Order "
    "Models. Every experiment "
    "of the paper, run anew; its figures beside the measured ones, and what its text "
    "needs corrected."
)
AXLE_TITLE = "Where a pressed object turns about"
AXLE_CLAIM = (
    "Section IV-B. The paper's bar, pressed and dragged in a constant direction, open "
    "loop: measured, "
    "predicted by the exact model, and by the paper's formula."
)
CORRECTIONS_TEXT = (
    "What the paper's text claims or its formula gives, and what holds for the same "
    "case, both computed when "
    "this page was made. K is rho² / d; friction is 0.3 under the object and 0.9 at "
    "the tip where nothing "
    "else is said. Sections are those of the mechanics."
)


def write_page(
    experiments: Sequence[Experiment],
    evidence: Evidence,
    claims: Sequence[Claim],
    corrected: Sequence[Correction],
    out: Path,
    made_by: str,
) -> Path:
    """Write ``out``/report.html and return its path.

    If the virtual axle was analysed, a separate page for it is also written.
    """
    page = out / "report.html"
    sections = [("claims", "Claims", _claims(claims))]
    sections += [(e.name, e.title, _experiment(e, evidence, page)) for e in experiments]
    if evidence.axle is not None:
        write_virtual_axle(evidence.axle, out / AXLE)
        png = style.png(directions_figure(evidence.axle))
        body = f"<p>{escape(AXLE_CLAIM)}</p>{page_body(evidence.axle, png, 'h3')}"
        sections.append((AXLE, AXLE_TITLE, body))
    body = f"<p>{escape(CORRECTIONS_TEXT)}</p>{corrections.html(corrected)}"
    sections.append(("corrections", "Corrections to the paper", body))
    links = "".join(
        f'<li><a href="#{name}">{escape(title)}</a></li>' for name, title, _ in sections
    )
    counted = scope(experiments) + summary(claims)
    parts = [
        f"<h1>{TITLE}</h1>",
        f"<p>{escape(INTRODUCTION)}</p>",
        f'<p class="verdict"><strong>{escape(counted)}</strong></p>',
        f'<nav><ul class="contents">{links}</ul></nav>',
    ]
    parts += [
        f'<section id="{name}"><h2>{escape(title)}</h2>{body}</section>'
        for name, title, body in sections
    ]
    parts.append(f"<footer><p>{escape(made_by)}</p></footer>")
    return write_whole(page, document(TITLE, "".join(parts)))


def _claims(claims: Sequence[Claim]) -> str:
    """Table of the claims, with a group for each experiment."""
    rows = []
    marks = []
    source = ""
    for claim in claims:
        if claim.source != source:
            source = claim.source
            rows.append(group_row(source, 5))
            marks.append(' class="group"')
        css = MARKS.get(claim.verdict, "")
        rows.append(
            [
                f'<th scope="row">{escape(claim.words)}</th>',
                f"<td>{escape(_unbroken(claim.paper))}</td>",
                f"<td>{escape(_unbroken(claim.measured))}</td>",
                f'<td class="{css}">{escape(claim.verdict)}</td>',
                f'<td class="why">{escape(claim.why)}</td>',
            ]
        )
        marks.append("")
    text = (
        "Every error and time that the paper gives, and what it states of its "
        "experiments. What it derives is judged in the corrections."
    )
    body = table(("Claim", "Paper", "Measured", "Verdict", "Why"), rows, marks)
    return f'<p>{text} {escape(LEGEND)}</p>{_rules()}<div class="claims">{body}</div>'


def _rules() -> str:
    """Table of the rules by which claims are evaluated."""
    rows = [
        [
            f'<th scope="row">{escape(rule.kind)}</th>',
            f"<td>{escape(rule.asked)}</td>",
            f"<td>{escape(rule.reason)}</td>",
        ]
        for rule in RULES
    ]
    return table(("Claim", "Reproduced if", "Reason"), rows, [""] * len(rows))


def _unbroken(text: str) -> str:
    """``text`` with every number kept on the same line as its unit."""
    return re.sub(r"(?<=[\d≤≈>]) (?=[^ \d]{1,2}\b|\d|%)", "\u00a0", text)


def _experiment(experiment: Experiment, evidence: Evidence, page: Path) -> str:
    """Claim, pictures, figures, findings and plots of one experiment."""
    runs: dict[str, Run] = {}
    for variant in experiment.variants:
        outcome = evidence.outcomes[experiment.name, variant.name]
        if outcome.result is not None:
            runs[variant.title] = load_run(outcome.folder)
    titles = {variant.name: variant.title for variant in experiment.variants}
    pictured = [titles[name] for name in experiment.pictured]
    parts = [
        f"<p>{escape(experiment.source)}. {escape(experiment.claim)}</p>",
        *(_picture(runs[title], title) for title in pictured if title in runs),
        _figures(experiment, evidence, page),
        _outcome_list(experiment, evidence),
        _plots(experiment, runs, titles),
    ]
    if len(runs) > 1:
        rest = comparison_table(list(runs), [run.result for run in runs.values()])
        parts.append(
            f"<details><summary>All figures of these runs</summary>{rest}</details>"
        )
    return "".join(parts)


def _outcome_list(experiment: Experiment, evidence: Evidence) -> str:
    sentences = outcome_lines(experiment, evidence)
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    listed = f"<ul>{items}</ul>" if items else ""
    return f"<h3>What comes out</h3>{listed}<p>{escape(experiment.why)}</p>"


def _plots(
    experiment: Experiment, runs: Mapping[str, Run], titles: Mapping[str, str]
) -> str:
    """Plots of errors over time, and of the virtual axle for the variant that requests
    it.

    ``runs`` are by title, ``titles`` by the variants' names.
    """
    parts = []
    plotted: Iterable[str] = titles
    if experiment.plotted is not None:
        plotted = experiment.plotted
    curves = []
    for title in (titles[name] for name in plotted):
        if title in runs:
            run = runs[title]
            curves.append((title, run.record))
    if curves:
        parts.append(image(style.png(comparison_plot(curves)), "errors over time"))
    axle_title = titles.get(experiment.axle, "")
    if axle_title in runs:
        run = runs[axle_title]
        made = axle_over_time(run.plan, run.record)
        if made is not None:
            caption = f"{axle_title}: the virtual axle over time, and tracking errors."
            parts.append(image(style.png(made), "virtual axle over time", caption))
    return "".join(parts)


def _picture(run: Run, title: str) -> str:
    """Pictures of a run in progress, or the run from above if there are none."""
    pictures = run.folder / NAME
    if pictures.is_file():
        png = pictures.read_bytes()
        return image(png, f"{title}, on its way", f"{title}, {CAPTION}")
    png = style.png(path_figure(run.plan, run.record))
    return image(png, f"{title}, from above", title)


def _figures(experiment: Experiment, evidence: Evidence, page: Path) -> str:
    """Table of the paper's figures and the measured figures, with a group of rows for
    each variant.
    """
    rows = []
    marks = []
    width = len(FIGURES) + 2
    for variant in experiment.variants:
        outcome = evidence.outcomes[experiment.name, variant.name]
        name = _named(variant, outcome, page)
        rows.append([f'<th colspan="{width}" scope="rowgroup">{name}</th>'])
        marks.append(' class="group"')
        if variant.paper:
            cells = number_cells(paper_figure(variant.paper, r.key) for r in FIGURES)
            rows.append(['<th scope="row">Paper</th>', *cells, "<td></td>"])
            marks.append("")
        cells = number_cells(r.text(outcome.result or {}) for r in FIGURES)
        verdict = _outcome_cell(outcome)
        rows.append(['<th scope="row">Measured</th>', *cells, verdict])
        marks.append("")
    head = ("", *(row.label for row in FIGURES), "Outcome")
    return table(head, rows, marks, numbers=len(FIGURES) + 1)


def _outcome_cell(outcome: Outcome) -> str:
    css = "no"
    if outcome.result is not None:
        css = "n ok" if outcome.result["success"] else "n no"
    return f'<td class="{css}">{escape(ending(outcome))}</td>'


def _named(variant: Variant, outcome: Outcome, page: Path) -> str:
    """A variant's title, with links to replay and report, and its settings."""
    parts = [f"<strong>{escape(variant.title)}</strong>"]
    folder = Path(
        os.path.relpath(outcome.folder.resolve(), page.resolve().parent)
    ).as_posix()
    for file, label in (("replay.html", "replay"), ("report.html", "report")):
        if (outcome.folder / file).is_file():
            parts.append(f'<a href="{escape(folder)}/{file}">{label}</a>')
    shown = (variant.task, *variant.settings, variant.execution.changed)
    settings = " ".join(escape(text) for text in shown if text is not None)
    return " · ".join([*parts, f"<code>{settings}</code>"])
