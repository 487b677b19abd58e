"""Claims of the paper on its experiments, and whether the runs reproduced them.

All errors and times that the paper states, and all statements about its experiments,
are evaluated by the rules of ``bands``. The paper's derivations are evaluated in
``corrections``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from pushpressslide_studies.paper.axle_claims import axle_claims
from pushpressslide_studies.paper.bands import PERIOD, reproduced
from pushpressslide_studies.paper.claim import Claim, verdict
from pushpressslide_studies.paper.evidence import Evidence, Outcome, Result
from pushpressslide_studies.paper.experiment import (
    Experiment,
    PaperFigure,
    Variant,
    Verdict,
)
from pushpressslide_studies.paper.figures import figure_of, paper_figure

# what is judged together
KINDS = (
    ("time", ("motion_duration",)),
    (
        "RMS of box, tip and yaw",
        ("rms_position_error", "rms_end_effector_error", "rms_yaw_error"),
    ),
    ("distance from the goal", ("final_position_error", "final_yaw_error")),
)
ENDS = KINDS[2][1]
# pushes by a force, as shares of friction: without and with the joint term
JUDGED_FORCE = ("force", "force-joint")
OTHER_FORCES = (
    ("3 % less", "less", "less-joint"),
    ("3 % more", "more", "more-joint"),
)
FASTER = 100.0 / 30.0
TIGHTER = 0.095 / 0.085  # gains of the paper's run with the term


@dataclass(frozen=True, slots=True)
class Runs:
    """Runs relevant to one claim. Each motion is counted once."""

    variants: tuple[Variant, ...]
    results: tuple[Result, ...]
    repeated: int  # runs of a motion that another run had already
    failures: tuple[str, ...]  # of runs that could not be made
    missing: int  # runs that nobody asked for

    @property
    def count(self) -> str:
        """Number of runs, in words."""
        words = f"{len(self.results)} runs"
        if self.repeated:
            words += f" ({self.repeated} more like them)"
        return words


def claims(experiments: Sequence[Experiment], evidence: Evidence) -> list[Claim]:
    """Evaluated claims about the given experiments and the virtual axle."""
    out: list[Claim] = []
    for experiment in experiments:
        if experiment.ours:
            continue
        out += _figures(experiment, evidence)
        judge = STATEMENTS.get(experiment.name, _goals)
        out += judge(experiment, evidence)
        out += _settled(experiment)
    if evidence.axle is not None:
        out += axle_claims(evidence.axle)
    timed = [o.result for o in evidence.outcomes.values() if o.result is not None]
    return [*out, *_real_time(timed)]


def runs_of(
    experiment: Experiment, variants: Sequence[Variant], evidence: Evidence
) -> Runs:
    """Runs of some variants of an experiment."""
    results: list[Result] = []
    distinct: list[Variant] = []
    failures = []
    digests: set[str] = set()
    missing = 0
    repeated = 0
    for variant in variants:
        outcome = evidence.outcomes.get((experiment.name, variant.name))
        if outcome is None:
            missing += 1
        elif outcome.result is None:
            failures.append(f"{variant.title} could not be run: {outcome.failure}")
        elif _is_repeated(outcome, digests):
            repeated += 1
        else:
            distinct.append(variant)
            results.append(outcome.result)
    return Runs(tuple(distinct), tuple(results), repeated, tuple(failures), missing)


def _is_repeated(outcome: Outcome, digests: set[str]) -> bool:
    """Whether another run had the same motion. Also records the motion of this run."""
    if outcome.digest in digests:
        return True
    if outcome.digest:
        digests.add(outcome.digest)
    return False


def _figures(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Yield the claims about an experiment's figures, one for each kind of figure.

    Variants with the same figures form one claim, which each of them must reproduce.
    """
    for what, keys in KINDS:
        alike: dict[tuple[PaperFigure, ...], list[Variant]] = {}
        for variant in experiment.variants:
            given = tuple(variant.paper[key] for key in keys if key in variant.paper)
            if given:
                alike.setdefault(given, []).append(variant)
        for variants in alike.values():
            yield _figure(experiment, what, variants, keys, evidence)


def _figure(
    experiment: Experiment,
    what: str,
    variants: Sequence[Variant],
    keys: Sequence[str],
    evidence: Evidence,
) -> Claim:
    """Claim about one kind of figure, which all variants must reproduce."""
    paper = variants[0].paper
    given = [key for key in keys if key in paper]
    runs = runs_of(experiment, variants, evidence)
    title = variants[0].title
    if len(variants) > 1:
        title = "Every run"
    return _claim(
        experiment,
        f"{title}: {what}",
        ", ".join(paper_figure(paper, key) for key in given),
        runs,
        lambda result: all(reproduced(paper[key], key, result) for key in given),
        lambda results: _worst(results, given, paper),
    )


def _claim(
    experiment: Experiment,
    words: str,
    paper: str,
    runs: Runs,
    good: Callable[[Result], bool],
    shown: Callable[[Sequence[Result]], str],
) -> Claim:
    """Claim that each of some runs must confirm.

    A run that could not be made does not confirm it.
    """
    figure = bool(paper)
    if runs.missing or not (runs.results or runs.failures):
        return Claim(experiment.title, words, paper, "", Verdict.not_run, figure=figure)
    measured = shown(runs.results)
    if len(runs.results) > 1:
        measured = f"{runs.count}, at worst {measured}"
    bad = [
        _ending(variant, result)
        for variant, result in zip(runs.variants, runs.results, strict=True)
        if not good(result)
    ]
    bad += runs.failures
    reason = "; ".join(bad) or " ".join(dict.fromkeys(v.why for v in runs.variants))
    return Claim(
        experiment.title, words, paper, measured, verdict(not bad), reason, figure
    )


def _ending(variant: Variant, result: Result) -> str:
    """Reason why a run did not confirm the expected result, if it is known."""
    if result["success"]:
        return variant.why or f"{variant.title}: it reaches its goal"
    return f"{variant.title}: {result['reason']['text']}"


def _worst(
    results: Sequence[Result],
    keys: Sequence[str],
    paper: Mapping[str, PaperFigure],
) -> str:
    """Text on the figures that are farthest from being reproduced."""
    parts = []
    for key in keys:
        about = paper[key].about if key in paper else ""
        parts.append(figure_of(_worst_by(results, key, about), key))
    return ", ".join(parts)


def _worst_by(results: Sequence[Result], key: str, about: str) -> Result:
    """Result with the largest value of a figure, or with the smallest if the paper
    states a lower bound.
    """
    known = [result for result in results if result[key] is not None]
    known.sort(key=lambda result: float(result[key]))
    if not known:
        return {}
    return known[0] if about == "over" else known[-1]


def _goals(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Yield the claims about an experiment without figures, by whether its runs reach
    their goals.
    """
    variants = [variant for variant in experiment.variants if not variant.paper]
    if not variants:
        return
    yield _claim(
        experiment,
        "Every run: the goal is reached",
        "",
        runs_of(experiment, variants, evidence),
        lambda result: bool(result["success"]),
        lambda results: _worst(results, ENDS, {}),
    )


def _settled(experiment: Experiment) -> Iterator[Claim]:
    """Yield the claims about statements that no run can decide."""
    for known in experiment.settled:
        yield Claim(experiment.title, known.words, "", "", known.verdict, known.why)


def _joint_term(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Yield the claim that the joint term makes a push by force faster and more
    accurate.
    """
    for key, words, gain in (
        ("motion_duration", "is faster", FASTER),
        ("rms_position_error", "keeps the box closer to its reference", TIGHTER),
    ):
        words = f"With the joint term a push {words}"
        paper = f"{gain:.2f} times"
        pair = _pair(experiment, evidence, JUDGED_FORCE)
        if pair is None:
            yield Claim(experiment.title, words, paper, "", Verdict.not_run)
            continue
        gained = _gain(pair, key)
        yield Claim(
            experiment.title,
            words,
            paper,
            f"{_change(pair, key)} ({gained:.2f} times)",
            verdict(bool(pair[1]["success"]) and gained >= gain),
            _by_other_forces(experiment, evidence, key),
        )


def _pair(
    experiment: Experiment, evidence: Evidence, names: tuple[str, str]
) -> tuple[Result, Result] | None:
    """Results without and with the joint term. None if one is missing."""
    alone = evidence.result(experiment.name, names[0])
    joined = evidence.result(experiment.name, names[1])
    if alone is None or joined is None:
        return None
    return alone, joined


def _by_other_forces(experiment: Experiment, evidence: Evidence, key: str) -> str:
    """Text on the effect of the joint term at forces that are not evaluated."""
    parts = ["At a force equal to friction"]
    for share, *names in OTHER_FORCES:
        pair = _pair(experiment, evidence, (names[0], names[1]))
        if pair is not None:
            parts.append(f"with {share}: {_change(pair, key)}")
    return f"{'; '.join(parts)}."


def _gain(pair: tuple[Result, Result], key: str) -> float:
    """Ratio of a figure without the joint term to the same figure with it. 0 if
    unknown.
    """
    alone, joined = pair
    if not alone[key] or not joined[key]:
        return 0.0
    return float(alone[key]) / float(joined[key])


def _change(pair: tuple[Result, Result], key: str) -> str:
    """A figure without and with the joint term, and how the runs ended."""
    alone, joined = pair
    return f"{_figure_and_end(alone, key)} to {_figure_and_end(joined, key)}"


def _figure_and_end(result: Result, key: str) -> str:
    text = figure_of(result, key)
    if result["success"]:
        return text
    code = str(result["reason"]["code"]).replace("_", " ")
    return f"{text} ({code})"


def _fixed_target(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Yield the claims about the literal reading of the paper's virtual target,
    evaluated with the paper's figures.
    """
    paper = experiment.variants[0].paper
    variants = [v for v in experiment.variants if v.name == "fixed-target"]
    given = tuple(paper)
    yield _claim(
        experiment,
        "A virtual target fixed beyond the goal aligns the object",
        ", ".join(paper_figure(paper, key) for key in given),
        runs_of(experiment, variants, evidence),
        lambda result: all(reproduced(paper[key], key, result) for key in given),
        lambda results: _worst(results, given, paper),
    )


STATEMENTS: dict[str, Callable[[Experiment, Evidence], Iterator[Claim]]] = {
    "joint-tracking": _joint_term,
    "press-slide": _fixed_target,
}


def _real_time(results: Sequence[Result]) -> Iterator[Claim]:
    """Yield the claim that the closed forms keep up with the control period."""
    ticks = [r["tick_us"] for r in results if r.get("tick_us")]
    totals = [t["total"] for t in ticks if t["total"]]
    if not totals:
        return
    worst = 1e-6 * max(total["p999"] for total in totals)
    median = 1e-6 * max(total["median"] for total in totals)
    late = sum(1e-6 * total["p999"] >= PERIOD for total in totals)
    yield Claim(
        "All experiments",
        "Optimization-free, in real time",
        "",
        f"99.9th percentile {1e3 * worst:.1f} ms, median {1e3 * median:.2f} ms, "
        "of the slowest runs",
        verdict(late == 0),
        f"Of {len(totals)} runs {late} exceed {1e3 * PERIOD:g} ms. A tick that "
        "replans takes longest. Times depend on the machine.",
    )
