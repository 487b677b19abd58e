"""The paper's experiments as Markdown: its figures beside the measured ones, what they
say, the claims.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from pushpressslide.core.whole_file import write_whole
from pushpressslide.studies.paper.claims import Claim
from pushpressslide.studies.paper.evidence import Evidence, Outcome, Result
from pushpressslide.studies.paper.experiment import Comparison, Experiment
from pushpressslide.studies.paper.figures import FIGURES, figure_of, paper_figure
from pushpressslide.studies.paper.identified_rho import IdentifiedRho

LEGEND = (
    "Time: contact phase, from the first push to the release, in simulated seconds. "
    "RMS: over the contact "
    "phase, against the reference at the same time; who is late is far from it. End: "
    "distance from the goal."
)
# in sentences
TOLD = (
    "motion_duration",
    "rms_position_error",
    "rms_yaw_error",
    "final_position_error",
)
ALIKE = 0.03  # share by which two figures may differ and still be called alike


def write_table(
    experiments: Sequence[Experiment],
    evidence: Evidence,
    judged: Sequence[Claim],
    path: Path,
) -> Path:
    """Write figures and claims as a Markdown file and return its path."""
    parts = [LEGEND + "\n"]
    for experiment in experiments:
        head = ["", "figures", *(label for label, *_ in FIGURES), "outcome"]
        lines = [head, ["---"] * 2 + ["---:"] * len(FIGURES) + ["---"]]
        for variant in experiment.variants:
            outcome = evidence.outcomes[experiment.name, variant.name]
            if variant.paper:
                cells = [paper_figure(variant.paper, key) for _, key, *_ in FIGURES]
                lines.append([variant.title, "paper", *cells, ""])
            title = "" if variant.paper else variant.title
            cells = [figure_of(outcome.result or {}, key) for _, key, *_ in FIGURES]
            lines.append([title, "measured", *cells, ending(outcome)])
        said = "\n".join(f"- {sentence}" for sentence in findings(experiment, evidence))
        text = f"{said}\n\n{experiment.why}" if said else experiment.why
        parts.append(f"## {experiment.title}\n\n{_rows(lines)}\n\n{text}\n")
    lines = [["claim", "paper", "measured", "status", "why"], ["---"] * 5]
    lines += [[c.words, c.paper, c.measured, c.status, c.why] for c in judged]
    parts.append(f"## Claims\n\n{summary(judged)}\n\n{_rows(lines)}\n")
    return write_whole(path, "\n".join(parts))


def _rows(lines: Sequence[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def summary(judged: Sequence[Claim]) -> str:
    """Say how many figures were met, how many statements reproduced, and how many were
    not run.
    """
    told = []
    for figure, what, good in (
        (True, "figures", "met or beaten"),
        (False, "statements", "reproduced"),
    ):
        run = [
            claim.reproduced
            for claim in judged
            if claim.figure is figure and claim.reproduced is not None
        ]
        if run:
            told.append(f"{sum(run)} of {len(run)} {what} {good}")
    rest = sum(claim.reproduced is None for claim in judged)
    told += [f"{rest} not run"] if rest else []
    return f"{', '.join(told)}."


def ending(outcome: Outcome) -> str:
    """Say how a run ended."""
    if outcome.result is None:
        return f"not run: {outcome.failure}"
    return str(outcome.result["reason"]["code"]).replace("_", " ")


def findings(experiment: Experiment, evidence: Evidence) -> list[str]:
    """Return sentences on the measured figures of the experiment; none where a run is
    missing.
    """
    said = []
    for comparison in experiment.comparisons:
        base, changed = (
            evidence.result(experiment.name, n)
            for n in (comparison.base, comparison.changed)
        )
        if base is not None and changed is not None:
            said.append(_compared(comparison, base, changed))
    for variant in experiment.variants:
        outcome = evidence.outcomes.get((experiment.name, variant.name))
        if outcome is not None and outcome.rho is not None:
            said.append(identified(outcome.rho))
    return said


def identified(rho: IdentifiedRho) -> str:
    """Say what was identified on the way, beside the exact model."""
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
    """Say what a change did to time, RMS error and end."""
    told = []
    for label, key, factor, _, decimals in FIGURES:
        before = base[key]
        after = changed[key]
        if key not in TOLD or before is None or after is None:
            continue
        told.append(
            f"{label} {factor * before:.{decimals}f} to "
            f"{figure_of(changed, key)}{_ratio(before, after)}"
        )
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
