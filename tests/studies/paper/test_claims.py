"""Claims are judged by the figures, each way."""

from dataclasses import replace
from pathlib import Path

import pytest

from pushpressslide.studies.paper.claims import claims
from pushpressslide.studies.paper.evidence import Evidence, Outcome
from pushpressslide.studies.paper.figures import FIGURES
from pushpressslide.studies.paper.identified_rho import IdentifiedRho
from pushpressslide.studies.paper.one_arm import (
    IDENTIFIED_RHO,
    JOINT_TRACKING,
    PRESS_SLIDE,
    REAR_PUSH,
    TOOL_USE,
)
from pushpressslide.studies.paper.table import findings, summary
from pushpressslide.studies.paper.two_arms import PRESS_FIT
from pushpressslide.studies.paper.virtual_axle import LIGHT, TASK, predict, result_of
from pushpressslide.taskfile.load import load_task

RHO = IdentifiedRho(3.5, 1.05, 0.05, 0.099, 0.101, -0.02, -0.025)


def made_up(value: float, success: bool = True, **figures: float) -> dict[str, object]:
    reason = {
        "code": "goal_reached" if success else "goal_missed",
        "text": "" if success else "30 mm off",
    }
    return {
        **{row.key: value for row in FIGURES},
        "success": success,
        "reason": reason,
        **figures,
    }


def judged(experiment, results, rho=None):
    outcomes = {
        (experiment.name, name): Outcome(Path(), r, rho=rho)
        for name, r in results.items()
    }
    return claims([experiment], Evidence(outcomes))


@pytest.mark.parametrize(("error", "met"), [(0.0149, True), (0.0151, False)])
def test_a_figure_is_reproduced_where_it_is_met_or_beaten(
    error: float, met: bool
) -> None:
    claim, other = judged(
        REAR_PUSH, {"rear": made_up(0.001, met, final_position_error=error)}
    )
    assert claim.words == "By the rear face: distance from the goal"
    assert claim.paper == "≤ 15.0 mm, ≤ 2.00°"
    assert claim.measured == f"{1e3 * error:.1f} mm, 0.06°"
    assert claim.reproduced is met
    assert claim.status == ("met or beaten" if met else "missed")
    assert claim.why == (REAR_PUSH.variants[0].why if met else "30 mm off")
    assert other.reproduced is None


def test_what_was_not_run_is_neither() -> None:
    assert [c.reproduced for c in judged(REAR_PUSH, {"rear": None})] == [None, None]


def test_experiments_without_figures_are_judged_by_their_goals() -> None:
    results = {
        "cube": made_up(0.001),
        "heavy": made_up(0.03, success=False),
        "aside": None,
    }
    cube, heavy, aside = judged(TOOL_USE, results)
    assert cube.reproduced is True
    assert heavy.reproduced is False
    assert heavy.status == "not reproduced"
    assert heavy.why == "30 mm off"
    assert aside.reproduced is None


def test_what_was_not_run_is_told() -> None:
    claim = claims([replace(PRESS_FIT, variants=PRESS_FIT.variants[:1])], Evidence({}))[
        0
    ]
    assert claim.words == "Press and fit: the goal is reached"
    assert claim.reproduced is None
    assert claim.why == "Not run."


@pytest.mark.parametrize(("joined", "reproduced"), [(20.0, True), (80.0, False)])
def test_the_joint_term_is_judged_by_the_force_that_gains_most(
    joined: float, reproduced: bool
) -> None:
    results = {v.name: made_up(10.0) for v in JOINT_TRACKING.variants}
    results |= {"less": made_up(112.0), "less-joint": made_up(joined)}
    faster, _ = (
        c for c in judged(JOINT_TRACKING, results) if "joint term a push" in c.words
    )
    assert faster.reproduced is reproduced
    assert faster.measured.startswith(
        f"97 %: 112.0 s to {joined:.1f} s; 100 %: 10.0 s to 10.0 s"
    )


@pytest.mark.parametrize(("error", "good"), [(0.0049, True), (0.0051, False)])
def test_the_fixed_target_is_held_against_what_is_asked_of_the_others(
    error: float, good: bool
) -> None:
    told = judged(
        PRESS_SLIDE, {"fixed-target": made_up(0.001, final_position_error=error)}
    )
    (claim,) = (c for c in told if "fixed beyond" in c.words)
    assert claim.paper == "≤ 5.0 mm, ≤ 1.00°"
    assert claim.reproduced is good
    assert not claim.figure


@pytest.mark.parametrize(
    ("identified", "good"), [(0.092, True), (0.090, False), (0.112, False)]
)
def test_rho_is_judged_within_ten_per_cent(identified: float, good: bool) -> None:
    (claim,) = judged(
        IDENTIFIED_RHO, {"turn": made_up(0.1)}, replace(RHO, identified=identified)
    )
    assert claim.reproduced is good
    assert (
        f"identified rho {1e3 * identified:.1f} mm, exact 101.0 mm"
        in findings(
            IDENTIFIED_RHO,
            Evidence(
                {
                    ("identified-rho", "turn"): Outcome(
                        Path(), None, rho=replace(RHO, identified=identified)
                    )
                }
            ),
        )[0]
    )


def test_a_turn_without_a_rho_is_not_judged() -> None:
    (claim,) = judged(IDENTIFIED_RHO, {"turn": made_up(0.1)})
    assert claim.reproduced is None


def axle_claims(error: float):
    task = load_task(TASK)
    rows = []
    for case in LIGHT:
        row = predict(task, case)
        axle = row["predicted"] + error
        rows.append(
            {
                **row,
                "measured": axle,
                "measured_axle_band": (axle - 0.001, axle + 0.001),
            }
        )
    return {c.words: c for c in claims([], Evidence({}, result_of(task, rows)))}


def test_the_axle_is_judged_by_its_probes() -> None:
    told = axle_claims(0.001)
    assert told["Axle from the CoM by the paper's formula"].reproduced is False
    assert told["Axle from the CoM as seen in simulation"].reproduced is True
    assert told["The axle is invariant to the force's direction"].reproduced is False
    assert told["The axle remains stable"].measured == "within 2.0 mm over time"
    assert (
        told[
            "The abstraction is valid: the object turns about a predictable axle"
        ].reproduced
        is True
    )
    off = axle_claims(0.02)
    assert off["Axle from the CoM as seen in simulation"].reproduced is False
    assert (
        off[
            "The abstraction is valid: the object turns about a predictable axle"
        ].reproduced
        is False
    )


def test_the_summary_counts_figures_and_statements_apart() -> None:
    outcomes = {
        (REAR_PUSH.name, "rear"): Outcome(Path(), made_up(0.001)),
        (REAR_PUSH.name, "left"): Outcome(Path(), made_up(0.05)),
        (TOOL_USE.name, "cube"): Outcome(Path(), made_up(0.001)),
    }
    told = summary(claims([REAR_PUSH, TOOL_USE], Evidence(outcomes)))
    assert (
        told == "1 of 2 figures met or beaten, 1 of 1 statements reproduced, 2 not run."
    )


def test_real_time_is_judged_by_the_slowest_median() -> None:
    for median, good in ((900.0, True), (4100.0, False)):
        ticks = {
            "total": {"median": median, "p99": 9000.0},
            "allocate": {"median": 12.0, "p99": 20.0},
        }
        outcomes = {("a", "b"): Outcome(Path(), {"tick_us": ticks})}
        (claim,) = claims([], Evidence(outcomes))
        assert claim.reproduced is good
        assert f"{median / 1e3:.2f} ms" in claim.measured
