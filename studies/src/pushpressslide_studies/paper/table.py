"""The paper's experiments as Markdown: the paper's figures and the measured figures,
findings, and claims.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from pushpressslide.core.whole_file import write_whole
from pushpressslide_studies.paper.bands import RULES
from pushpressslide_studies.paper.claim import Claim
from pushpressslide_studies.paper.evidence import Evidence, Outcome, Result
from pushpressslide_studies.paper.experiment import Comparison, Experiment, Verdict
from pushpressslide_studies.paper.experiments import EXPERIMENTS
from pushpressslide_studies.paper.figures import FIGURES, paper_figure
from pushpressslide_studies.paper.identified_rho import IdentifiedRho

LEGEND = (
    "Time: contact phase, from the first push to the release, in simulated seconds. "
    "RMS: over the contact "
    "phase, against the reference at the same time; who is late is far from it. End: "
    "distance from the goal."
)
# in sentences
MENTIONED = (
    "motion_duration",
    "rms_position_error",
    "rms_yaw_error",
    "final_position_error",
)
ALIKE = 0.03  # share by which two figures may differ and still be called alike


def write_table(
    experiments: Sequence[Experiment],
    evidence: Evidence,
    claims: Sequence[Claim],
    path: Path,
) -> Path:
    """Write figures and claims as a Markdown file and return its path."""
    parts = [f"{LEGEND}\n"]
    parts += [_experiment(experiment, evidence) for experiment in experiments]
    counted = scope(experiments) + summary(claims)
    parts.append(f"## Claims\n\n{counted}\n\n{_rules()}\n\n{_claims(claims)}\n")
    return write_whole(path, "\n".join(parts))


def scope(experiments: Sequence[Experiment]) -> str:
    """Beginning of the summary. It names the experiments if others were not run."""
    if len(experiments) == len(EXPERIMENTS):
        return ""
    names = ", ".join(experiment.name for experiment in experiments)
    return f"Run so far, of {len(EXPERIMENTS)} experiments: {names}. "


def _rules() -> str:
    lines = [["claim", "reproduced if", "reason"], ["---"] * 3]
    lines += [[rule.kind, rule.asked, rule.reason] for rule in RULES]
    return _rows(lines)


def _claims(claims: Sequence[Claim]) -> str:
    lines = [["", "claim", "paper", "measured", "verdict", "why"], ["---"] * 6]
    source = ""
    for claim in claims:
        shown = "" if claim.source == source else claim.source
        source = claim.source
        cells = [claim.words, claim.paper, claim.measured, claim.verdict, claim.why]
        lines.append([shown, *cells])
    return _rows(lines)


def _experiment(experiment: Experiment, evidence: Evidence) -> str:
    """Heading, table of figures and findings of one experiment."""
    head = ["", "figures", *(row.label for row in FIGURES), "outcome"]
    lines = [head, ["---"] * 2 + ["---:"] * len(FIGURES) + ["---"]]
    for variant in experiment.variants:
        outcome = evidence.outcomes[experiment.name, variant.name]
        title = variant.title
        if variant.paper:
            cells = [paper_figure(variant.paper, row.key) for row in FIGURES]
            lines.append([title, "paper", *cells, ""])
            title = ""
        cells = [row.text(outcome.result or {}) for row in FIGURES]
        lines.append([title, "measured", *cells, ending(outcome)])
    text = "\n".join(
        f"- {sentence}" for sentence in outcome_lines(experiment, evidence)
    )
    if text:
        text += "\n\n"
    return f"## {experiment.title}\n\n{_rows(lines)}\n\n{text}{experiment.why}\n"


def _rows(lines: Sequence[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def summary(claims: Sequence[Claim]) -> str:
    """Sentence on the number of reproduced figures and statements, and of claims that
    were not evaluated.
    """
    counts = []
    for figure, what in ((True, "figures"), (False, "statements")):
        verdicts = [c.verdict for c in claims if c.figure is figure]
        good = verdicts.count(Verdict.reproduced)
        run = good + verdicts.count(Verdict.not_reproduced)
        if run:
            counts.append(f"{good} of {run} {what} reproduced")
    every = [claim.verdict for claim in claims]
    further = [
        f"{every.count(verdict)} {verdict}"
        for verdict in (Verdict.unstated, Verdict.not_run)
        if verdict in every
    ]
    text = ", ".join(counts)
    if further:
        text += f"; of further claims {', '.join(further)}"
    return f"{text}."


def ending(outcome: Outcome) -> str:
    """Ending of a run, in words."""
    if outcome.result is None:
        return f"not run: {outcome.failure}"
    return str(outcome.result["reason"]["code"]).replace("_", " ")


def outcome_lines(experiment: Experiment, evidence: Evidence) -> list[str]:
    """Sentences on the measured figures of an experiment. Empty if a run is missing."""
    sentences = []
    for comparison in experiment.comparisons:
        base, changed = (
            evidence.result(experiment.name, n)
            for n in (comparison.base, comparison.changed)
        )
        if base is not None and changed is not None:
            sentences.append(_compared(comparison, base, changed))
    for variant in experiment.variants:
        outcome = evidence.outcomes.get((experiment.name, variant.name))
        if outcome is not None and outcome.rho is not None:
            sentences.append(identified(outcome.rho))
    return sentences


def identified(rho: IdentifiedRho) -> str:
    """Sentence on the parameters identified during a run, compared with the exact
    model.
    """
    return (
        f"Force at {math.degrees(rho.force_angle):.0f}° to the axis for {rho.time:.1f} "
        "s, planned with rho "
        f"{1e3 * rho.predicted:.0f} mm: identified rho {1e3 * rho.identified:.1f} mm, "
        "exact "
        f"{1e3 * rho.exact:.1f} mm ({100.0 * (rho.identified / rho.exact - 1.0):+.1f} "
        "%); virtual axle "
        f"{1e3 * rho.axle:+.0f} mm from the CoM, exact {1e3 * rho.exact_axle:+.0f} mm."
    )


def _compared(comparison: Comparison, base: Result, changed: Result) -> str:
    """Sentence on the effect of a change on time, RMS error and ending."""
    changes = []
    for row in FIGURES:
        before = base[row.key]
        after = changed[row.key]
        if row.key not in MENTIONED or before is None or after is None:
            continue
        changes.append(
            f"{row.label} {row.factor * before:.{row.decimals}f} to "
            f"{row.text(changed)}{_ratio(before, after)}"
        )
    words = comparison.words[0].upper() + comparison.words[1:]
    sentence = f"{words}: {'; '.join(changes)}."
    if changed["success"]:
        return sentence
    return f"{sentence} It ends with: {changed['reason']['text']}."


def _ratio(before: float, after: float) -> str:
    if before <= 0.0 or after <= 0.0:
        return ""
    if abs(after / before - 1.0) <= ALIKE:
        return " (alike)"
    ratio = after / before
    decimals = 2 if ratio < 10.0 else 0
    return f" (× {ratio:.{decimals}f})"
