"""Claims are evaluated by the figures, with either verdict."""

from pathlib import Path

import pytest

from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper import bands
from pushpressslide_studies.paper.axle_claims import axle_claims
from pushpressslide_studies.paper.claim import Claim
from pushpressslide_studies.paper.claims import claims
from pushpressslide_studies.paper.evidence import Evidence, Outcome
from pushpressslide_studies.paper.experiment import Experiment, PaperFigure, Verdict
from pushpressslide_studies.paper.figures import FIGURES
from pushpressslide_studies.paper.identified_rho import IdentifiedRho
from pushpressslide_studies.paper.one_arm import (
    IDENTIFIED_RHO,
    JOINT_TRACKING,
    PRESS_SLIDE,
    REAR_PUSH,
    TOOL_USE,
)
from pushpressslide_studies.paper.table import outcome_lines, summary
from pushpressslide_studies.paper.two_arms import PIVOT_AND_MOVE, PRESS_FIT
from pushpressslide_studies.paper.virtual_axle import LIGHT, TASK, predict, result_of

RHO = IdentifiedRho(3.5, 1.05, 0.05, 0.099, 0.101, -0.02, -0.025)


GOOD = Verdict.reproduced
BAD = Verdict.not_reproduced


def made_up(
    value: float, success: bool = True, code: str = "", **figures: float
) -> dict[str, object]:
    reason = {
        "code": code or ("goal_reached" if success else "goal_missed"),
        "text": "" if success else "30 mm off",
    }
    return {
        **{row.key: value for row in FIGURES},
        "success": success,
        "reason": reason,
        **figures,
    }


def claims_of(experiment: Experiment, results, **digests: str) -> dict[str, Claim]:
    """Return the claims by their words; a result that is a text is a failure."""
    outcomes = {}
    for name, result in results.items():
        outcome = Outcome(Path(), result, digest=digests.get(name, ""))
        if isinstance(result, str):
            outcome = Outcome(Path(), None, result)
        outcomes[experiment.name, name] = outcome
    return {c.words: c for c in claims([experiment], Evidence(outcomes))}


@pytest.mark.parametrize(
    ("about", "measured", "verdict"),
    [
        ("within", 9.9, GOOD),
        ("within", 10.1, BAD),
        ("over", 10.1, GOOD),
        ("over", 9.9, BAD),
        ("about", 9.1, GOOD),
        ("about", 8.9, BAD),
        ("", 10.9, GOOD),
        ("", 11.1, BAD),
    ],
)
def test_a_bound_has_to_hold_and_a_value_to_be_near(
    about: str, measured: float, verdict: Verdict
) -> None:
    figure = PaperFigure(10.0, about)
    result = made_up(measured)
    assert bands.reproduced(figure, "motion_duration", result) is (verdict is GOOD)


def test_a_run_that_missed_gives_no_figure_but_a_lower_bound_on_time() -> None:
    late = made_up(290.0, False, "time_limit")
    lost = made_up(290.0, False, "contact_lost")
    over = PaperFigure(100.0, "over")
    assert bands.reproduced(over, "motion_duration", late)
    assert not bands.reproduced(over, "motion_duration", lost)
    within = PaperFigure(300.0, "within")
    assert not bands.reproduced(within, "motion_duration", late)


def test_a_slow_baseline_is_not_reproduced_by_a_fast_run() -> None:
    results = {v.name: made_up(36.7) for v in JOINT_TRACKING.variants}
    told = claims_of(JOINT_TRACKING, results)
    assert told["Force equal to friction, alone: time"].verdict is BAD


@pytest.mark.parametrize(("worst", "verdict"), [(0.0149, GOOD), (0.0151, BAD)])
def test_every_run_has_to_give_a_figure_that_several_share(
    worst: float, verdict: Verdict
) -> None:
    results = {
        "rear": made_up(0.001),
        "left": made_up(0.001, worst <= 0.015, final_position_error=worst),
    }
    (claim,) = claims_of(REAR_PUSH, results).values()
    assert claim.words == "Every run: distance from the goal"
    assert claim.paper == "≤ 15.0 mm, ≤ 2.00°"
    assert claim.measured == f"2 runs, at worst {1e3 * worst:.1f} mm, 0.06°"
    assert claim.verdict is verdict


def test_a_motion_that_is_run_twice_counts_once() -> None:
    results = {"rear": made_up(0.001), "left": made_up(0.001)}
    (claim,) = claims_of(REAR_PUSH, results, rear="same", left="same").values()
    assert claim.measured == "1.0 mm, 0.06°"


def test_a_run_that_is_refused_reproduces_nothing() -> None:
    results = {"rear": made_up(0.001), "left": "no path"}
    (claim,) = claims_of(REAR_PUSH, results).values()
    assert claim.verdict is BAD
    assert "no path" in claim.why


def test_what_was_not_run_is_no_verdict() -> None:
    (claim,) = claims_of(REAR_PUSH, {"rear": made_up(0.001)}).values()
    assert claim.verdict is Verdict.not_run


def test_experiments_without_figures_are_judged_by_all_their_goals() -> None:
    results = {
        "cube": made_up(0.001),
        "heavy": made_up(0.003),
        "aside": made_up(0.002),
    }
    (claim,) = claims_of(TOOL_USE, results).values()
    assert claim.words == "Every run: the goal is reached"
    assert claim.verdict is GOOD
    assert claim.measured.startswith("3 runs, at worst 3.0 mm")
    results["heavy"] = made_up(0.03, success=False)
    (claim,) = claims_of(TOOL_USE, results).values()
    assert claim.verdict is BAD
    assert "30 mm off" in claim.why


@pytest.mark.parametrize("experiment", [PIVOT_AND_MOVE, PRESS_FIT, JOINT_TRACKING])
def test_what_the_paper_does_not_say_cannot_be_judged(experiment: Experiment) -> None:
    told = claims_of(experiment, {})
    unstated = [c for c in told.values() if c.verdict is Verdict.unstated]
    assert unstated
    assert all("The paper" in claim.why for claim in unstated)


def test_what_the_paper_does_not_claim_is_not_judged() -> None:
    assert claims_of(IDENTIFIED_RHO, {"turn": made_up(0.1)}) == {}


@pytest.mark.parametrize(
    ("joined", "verdict"), [(30.0, GOOD), (31.0, BAD), (200.0, BAD)]
)
def test_the_joint_term_is_judged_at_a_force_equal_to_friction_alone(
    joined: float, verdict: Verdict
) -> None:
    results = {v.name: made_up(10.0) for v in JOINT_TRACKING.variants}
    # the other forces gain without bound
    results |= {"less": made_up(1e4), "more": made_up(1e4)}
    results |= {"force": made_up(101.0), "force-joint": made_up(joined)}
    claim = claims_of(JOINT_TRACKING, results)["With the joint term a push is faster"]
    assert claim.verdict is verdict
    assert claim.measured.startswith(f"101.0 s to {joined:.1f} s")
    assert "with 3 % less: 10000.0 s to 10.0 s" in claim.why


def test_a_joint_term_that_misses_the_goal_gains_nothing() -> None:
    results = {v.name: made_up(10.0) for v in JOINT_TRACKING.variants}
    results |= {"force": made_up(101.0), "force-joint": made_up(1.0, success=False)}
    claim = claims_of(JOINT_TRACKING, results)["With the joint term a push is faster"]
    assert claim.verdict is BAD
    assert "1.0 s (goal missed)" in claim.measured


@pytest.mark.parametrize(("error", "verdict"), [(0.0049, GOOD), (0.0051, BAD)])
def test_the_fixed_target_is_held_against_what_is_asked_of_the_others(
    error: float, verdict: Verdict
) -> None:
    results = {"fixed-target": made_up(0.001, final_position_error=error)}
    words = "A virtual target fixed beyond the goal aligns the object"
    claim = claims_of(PRESS_SLIDE, results)[words]
    assert claim.paper == "≤ 5.0 mm, ≤ 1.00°"
    assert claim.verdict is verdict


def test_rho_as_identified_is_told_beside_the_exact_one() -> None:
    outcomes = {("identified-rho", "turn"): Outcome(Path(), None, rho=RHO)}
    (sentence,) = outcome_lines(IDENTIFIED_RHO, Evidence(outcomes))
    assert "identified rho 99.0 mm, exact 101.0 mm (-2.0 %)" in sentence


def probed(error: float) -> dict[str, Claim]:
    task = load_task(TASK)
    rows = []
    for case in LIGHT:
        row = predict(task, case)
        axle = row["predicted"] + error
        band = (axle - 0.001, axle + 0.001)
        rows.append({**row, "measured": axle, "measured_axle_band": band})
    return {c.words: c for c in axle_claims(result_of(task, rows))}


def test_the_axle_is_judged_for_every_direction_of_the_force() -> None:
    told = probed(0.001)
    verdicts = {words: claim.verdict for words, claim in told.items()}
    assert verdicts == {
        "Axle from the CoM by the paper's formula": BAD,
        "Axle from the CoM as seen in simulation": BAD,
        "c falls from 0.6 to 0.43 under the arm's force": BAD,
        "The axle remains stable": GOOD,
        "The axle is invariant to the force's direction": BAD,
        "The abstraction is valid: the object turns about a predictable axle": GOOD,
    }
    assert told["The axle remains stable"].measured == "within 2.0 mm over time"


def test_an_axle_that_is_not_where_it_was_predicted_is_not_predictable() -> None:
    off = probed(0.03)
    words = "The abstraction is valid: the object turns about a predictable axle"
    assert off[words].verdict is BAD


def test_the_summary_counts_figures_and_statements_apart() -> None:
    outcomes = {
        (REAR_PUSH.name, "rear"): Outcome(Path(), made_up(0.001)),
        (REAR_PUSH.name, "left"): Outcome(Path(), made_up(0.05)),
        **{
            (TOOL_USE.name, v.name): Outcome(Path(), made_up(0.001))
            for v in TOOL_USE.variants
        },
    }
    told = summary(claims([REAR_PUSH, TOOL_USE, PRESS_FIT], Evidence(outcomes)))
    assert (
        told == "0 of 1 figures reproduced, 1 of 1 statements reproduced; "
        "of further claims 1 cannot be judged, 1 not run."
    )


@pytest.mark.parametrize(("slowest", "verdict"), [(3900.0, GOOD), (4100.0, BAD)])
def test_real_time_is_judged_by_the_999th_thousandth_of_the_slowest_run(
    slowest: float, verdict: Verdict
) -> None:
    outcomes = {}
    for name, p999 in (("fast", 1000.0), ("slow", slowest)):
        total = {"median": 900.0, "p99": 950.0, "p999": p999}
        outcomes["a", name] = Outcome(Path(), {"tick_us": {"total": total}})
    (claim,) = claims([], Evidence(outcomes))
    assert claim.verdict is verdict
    assert f"{slowest / 1e3:.1f} ms" in claim.measured
