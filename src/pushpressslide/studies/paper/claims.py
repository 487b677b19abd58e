"""What the paper claims of its experiments, and whether the runs reproduced it.

Every error and time that the paper gives, and every statement of its experiments. What
it derives is judged in ``corrections``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from pushpressslide.studies.paper.corrections_one_arm import BAR
from pushpressslide.studies.paper.evidence import Evidence, Result
from pushpressslide.studies.paper.experiment import Experiment, Variant
from pushpressslide.studies.paper.figures import figure_of, paper_figure

# of friction, in JOINT_TRACKING
FORCES = (("97 %", "less"), ("100 %", "force"), ("103 %", "more"))
FASTER = 100.0 / 30.0
TIGHTER = 0.095 / 0.085  # factors that the paper has between its two runs
RHO_WITHIN = 0.1  # share of the exact rho
SEEN = -0.2  # [m] virtual axle from the CoM, in the paper's simulation
SEEN_C = 0.43
STEADY = 0.005  # [m] within which an axle has to stay to be called steady
AXLE = "Virtual axle"
KINDS = (
    ("time", ("motion_duration",)),
    (
        "RMS of box, tip and yaw",
        ("rms_position_error", "rms_end_effector_error", "rms_yaw_error"),
    ),
    ("distance from the goal", ("final_position_error", "final_yaw_error")),
)


STATUS = {
    (True, True): "met or beaten",
    (True, False): "missed",
    (False, True): "reproduced",
    (False, False): "not reproduced",
}
"""In words, of a (figure, reproduced) claim."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim, and what was measured of it."""

    source: str
    words: str
    paper: str  # its figure, with unit; "" for none
    measured: str  # "" where it could not be measured
    reproduced: bool | None  # None: nothing measured
    why: str = ""
    # whether it is a figure of the paper, to be met or beaten, or a statement
    figure: bool = False

    @property
    def status(self) -> str:
        """What came of it, in words."""
        if self.reproduced is None:
            return "not run"
        return STATUS[self.figure, self.reproduced]


def claims(experiments: Sequence[Experiment], evidence: Evidence) -> list[Claim]:
    """Return the claims on the given experiments and the virtual axle, judged."""
    out: list[Claim] = []
    for experiment in experiments:
        for variant in experiment.variants:
            result = evidence.result(experiment.name, variant.name)
            out += _figures(experiment, variant, result)
        judge = STATEMENTS.get(experiment.name, _reached)
        out += judge(experiment, evidence)
    if evidence.axle is not None:
        out += _axle(evidence.axle)
    timed = [o.result for o in evidence.outcomes.values() if o.result is not None]
    return [*out, *_real_time(timed)]


def _title(experiment: Experiment, variant: Variant) -> str:
    return variant.title if len(experiment.variants) > 1 else experiment.title


def _figures(
    experiment: Experiment, variant: Variant, result: Result | None
) -> Iterator[Claim]:
    """Judge the figures that the paper gives for a variant, each kind as one claim."""
    title = _title(experiment, variant)
    for what, keys in KINDS:
        given = [key for key in keys if key in variant.paper]
        if not given:
            continue
        paper = ", ".join(paper_figure(variant.paper, key) for key in given)
        words = f"{title}: {what}"
        if result is None:
            yield Claim(
                experiment.title, words, paper, "", None, variant.why, figure=True
            )
            continue
        measured = ", ".join(figure_of(result, key) for key in given)
        met = all(result[key] <= variant.paper[key].value for key in given)
        why = _why(variant, result, met)
        yield Claim(experiment.title, words, paper, measured, met, why, figure=True)


def _why(variant: Variant, result: Result, good: bool) -> str:
    """Say why a variant does as it does, or how its run ended."""
    if good:
        return variant.why
    return str(result["reason"]["text"])


def _reached(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Judge experiments without figures by whether they reach their goals."""
    for variant in experiment.variants:
        if variant.paper:
            continue
        title = _title(experiment, variant)
        words = f"{title}: the goal is reached"
        result = evidence.result(experiment.name, variant.name)
        if result is None:
            outcome = evidence.outcomes.get((experiment.name, variant.name))
            why = "Not run." if outcome is None else outcome.failure
            yield Claim(experiment.title, words, "", "", None, why)
            continue
        measured = f"{figure_of(result, 'final_position_error')}, {figure_of(result, 'final_yaw_error')}"
        good = bool(result["success"])
        why = _why(variant, result, good)
        yield Claim(experiment.title, words, "", measured, good, why)


def _joint_term(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Judge whether the joint term makes a push by force faster and tighter."""
    for key, words, factor in (
        ("motion_duration", "is faster", FASTER),
        ("rms_position_error", "keeps the box closer to its reference", TIGHTER),
    ):
        pairs = []
        ratios = []
        for share, name in FORCES:
            alone, joined = (
                evidence.result(experiment.name, n) for n in (name, f"{name}-joint")
            )
            if alone is None or joined is None or not alone[key] or not joined[key]:
                continue
            before = figure_of(alone, key)
            pairs.append(f"{share}: {before} to {figure_of(joined, key)}")
            ratios.append(alone[key] / joined[key])
        why = (
            "So it is where the force falls short of friction; where it equals or "
            "exceeds it, the force "
            "alone can be as good. The paper does not say by how much its force "
            "differs from friction."
        )
        yield Claim(
            experiment.title,
            f"With the joint term a push {words}",
            f"{factor:.2f} times",
            "; ".join(pairs),
            max(ratios) >= factor if ratios else None,
            why,
        )


def _rho(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Judge rho as identified on the way."""
    outcome = evidence.outcomes.get((experiment.name, experiment.variants[0].name))
    rho = None if outcome is None else outcome.rho
    words = "rho identified on the way is within 10 % of the exact model's (ours, the paper reads off c)"
    if rho is None:
        yield Claim(experiment.title, words, "", "", None)
        return
    measured = (
        f"{1e3 * rho.identified:.1f} mm, exact {1e3 * rho.exact:.1f} mm "
        f"({100.0 * (rho.identified / rho.exact - 1.0):+.1f} %)"
    )
    why = (
        f"Planned with {1e3 * rho.predicted:.0f} mm; force at "
        f"{math.degrees(rho.force_angle):.0f}° for "
        f"{rho.time:.1f} s. Axle {1e3 * rho.axle:.0f} mm from the CoM, exact "
        f"{1e3 * rho.exact_axle:.0f} mm."
    )
    good = abs(rho.identified / rho.exact - 1.0) <= RHO_WITHIN
    yield Claim(experiment.title, words, "", measured, good, why)


def _fixed_target(experiment: Experiment, evidence: Evidence) -> Iterator[Claim]:
    """Judge the literal reading of the paper's virtual target by the paper's figures."""
    result = evidence.result(experiment.name, "fixed-target")
    asked = experiment.variants[0].paper
    words = "A virtual target fixed beyond the goal aligns the object"
    paper = ", ".join(paper_figure(asked, key) for key in asked)
    if result is None:
        yield Claim(experiment.title, words, paper, "", None)
        return
    measured = ", ".join(figure_of(result, key) for key in asked)
    good = all(result[key] <= figure.value for key, figure in asked.items())
    why = "It leaves part of the lateral error; one that slides along the path, as in the rows above, none."
    yield Claim(experiment.title, words, paper, measured, good, why)


STATEMENTS: dict[str, Callable[[Experiment, Evidence], Iterator[Claim]]] = {
    "joint-tracking": _joint_term,
    "press-slide": _fixed_target,
    "identified-rho": _rho,
}


def _axle(result: Result) -> list[Claim]:
    """Judge what the paper says of the virtual axle, by the axles measured.

    The rows are those of the paper's press at its height.
    """
    rows = [row for row in result["rows"] if row["measured"] is not None]
    high = max((row["height"] for row in rows), default=0.0)
    ours = [row for row in rows if row["height"] == high]
    if not ours:
        return []
    return [*_axle_places(result, ours, high), *_axle_steadiness(result, ours)]


def _axle_places(result: Result, rows: Sequence[Result], height: float) -> list[Claim]:
    """Judge where the axle is, by the force that pulls most and that pushes most."""
    pulled = min(rows, key=lambda row: row["angle"])
    pushed = max(rows, key=lambda row: row["angle"])
    axle = pushed["measured"]
    both = f"{1e3 * pulled['measured']:+.0f} mm pulled, {1e3 * axle:+.0f} mm pushed"
    shift = result["support_friction"] * height
    cs = [_c_of(pulled["measured"], shift), _c_of(axle, -shift)]
    tolerance = result["tolerance"]
    return [
        Claim(
            AXLE,
            "Axle from the CoM by the paper's formula",
            "0.82 m",
            both,
            abs(abs(axle) - 0.82) <= tolerance,
            f"By its own formula {1e3 * pulled['paper']:+.0f} mm; and c = 0.6 is not "
            "the pressed bar's.",
        ),
        Claim(
            AXLE,
            "Axle from the CoM as seen in simulation",
            f"{abs(SEEN):g} m",
            both,
            abs(axle - SEEN) <= tolerance,
            "So it is when pushed; pulled, drag at the tip's height moves the load the "
            "other way.",
        ),
        Claim(
            AXLE,
            "c falls from 0.6 to 0.43 under the arm's force",
            f"{SEEN_C:g}",
            f"{cs[0]:.2f} pulled, {cs[1]:.2f} pushed",
            all(abs(c - SEEN_C) <= 0.03 for c in cs),
            "From the measured axles and the moved centres of pressure: there is no "
            "single c.",
        ),
    ]


def _c_of(axle: float, shift: float) -> float:
    """Return c = rho / r0 of the bar that turns about ``axle`` [m] from the CoM.

    ``shift`` [m] is how far the drag moves the centre of pressure.
    """
    square = (BAR.cop[0] + shift - axle) * BAR.lever
    return math.sqrt(max(square, 0.0)) / BAR.half_diagonal


def _axle_steadiness(result: Result, rows: Sequence[Result]) -> list[Claim]:
    """Judge whether the axle moves over time, with the force, and off its prediction."""
    bands = [row["measured_axle_band"] for row in rows]
    band = max(high - low for low, high in bands)
    axles = [row["measured"] for row in rows]
    spread = max(axles) - min(axles)
    worst = result["summary"]["predicted"]["max"]
    return [
        Claim(
            AXLE,
            "The axle remains stable",
            "",
            f"within {1e3 * band:.1f} mm over time",
            band <= STEADY,
            "For a force of constant direction in the body, 5th to 95th percentile.",
        ),
        Claim(
            AXLE,
            "The axle is invariant to the force's direction",
            "0 mm",
            f"moves by {1e3 * spread:.0f} mm",
            spread <= STEADY,
            "It moves with the direction through the exact surface's shape and the "
            "tip's height.",
        ),
        Claim(
            AXLE,
            "The abstraction is valid: the object turns about a predictable axle",
            "",
            f"predicted within {1e3 * worst:.1f} mm",
            worst <= result["tolerance"],
            "With the exact surface and the height of the contact, in every probe.",
        ),
    ]


def _real_time(results: Sequence[Result]) -> Iterator[Claim]:
    """Judge whether the closed forms keep up with the control period."""
    ticks = [r["tick_us"] for r in results if r.get("tick_us")]
    if not ticks:
        return
    slowest = max(t["total"]["median"] for t in ticks)
    allocate = max(t["allocate"]["median"] for t in ticks)
    worst = max(t["total"]["p99"] for t in ticks)
    yield Claim(
        "All experiments",
        "Optimization-free, in real time",
        "",
        f"a tick {slowest / 1e3:.2f} ms, its allocation {allocate:.0f} µs",
        slowest < 4e3,
        "The slowest run's medians, period 4 ms. Plans made anew on the way take "
        "longer: 99th percentile "
        f"{worst / 1e3:.1f} ms.",
    )
