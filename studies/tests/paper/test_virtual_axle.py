"""The paper's figures of the virtual axle, recomputed; skipped probes, with reasons;
the pages.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper.axle_page import markdown, verdict, write_virtual_axle
from pushpressslide_studies.paper.virtual_axle import (
    ANGLES,
    HEIGHTS,
    LIGHT,
    LOADS,
    TASK,
    VARIANTS,
    Case,
    paper_figures,
    predict,
    result_of,
)

FIGURES = {row["what"]: row for row in paper_figures(load_task(TASK))}


@pytest.mark.parametrize(
    ("what", "paper", "recomputed", "exact"),
    [
        ("lever d, centre of pressure to contact", 0.054, 0.0538, 0.0538),
        ("(c r0)^2 with c = 0.6", 0.036, 0.0360, 0.0118),
        ("axle to centre of pressure, c = 0.6", 0.67, 0.6693, 0.2199),
        ("axle from the CoM, c = 0.6", -0.82, -0.5231, -0.0736),
        ("c for the axle that the paper saw", 0.43, 0.4314, 0.3439),
        ("axle that the paper saw, from the CoM", -0.2, -0.1998, None),
        ("the same, pushed, drag at the top's height", None, None, -0.1978),
        ("the same, pulled, drag at the top's height", None, None, 0.0338),
    ],
)
def test_the_papers_figures_recomputed(what, paper, recomputed, exact) -> None:
    row = FIGURES[what]
    assert row["paper"] == paper
    for key, value in (("recomputed", recomputed), ("exact", exact)):
        assert (
            row[key] is None
            if value is None
            else row[key] == pytest.approx(value, abs=1e-4)
        )


def test_only_the_distance_from_the_com_contradicts_the_papers_own_formula() -> None:
    """0.82 m is the distance to the centre of pressure added, which its other figures take off."""
    for what, row in FIGURES.items():
        if row["paper"] is not None and row["recomputed"] is not None:
            agrees = row["recomputed"] == pytest.approx(row["paper"], abs=0.006)
            assert agrees == (what != "axle from the CoM, c = 0.6"), what
    cop = FIGURES["centre of pressure from the CoM"]["recomputed"]
    assert cop + FIGURES["axle to centre of pressure, c = 0.6"][
        "recomputed"
    ] == pytest.approx(0.82, abs=0.005)


def test_the_table_has_at_least_the_directions_presses_and_heights_that_were_asked_for() -> (
    None
):
    assert len(ANGLES) >= 8
    assert len(LOADS) >= 3
    assert len(HEIGHTS) >= 2
    assert min(ANGLES) < 90 < max(ANGLES)


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (Case(45, 1.0, 0.1), "slips: takes 1.31 of the tip's friction"),
        (Case(0, 16.0, 0.6), "tips: centre of pressure"),
    ],
)
def test_what_would_slip_or_tip_is_not_run_and_says_so(case: Case, words: str) -> None:
    row = predict(load_task(TASK), case)
    assert row["skipped"].startswith(words)


def as_measured(case: Case, error: float) -> Mapping[str, Any]:
    row = predict(load_task(TASK), case)
    if row["skipped"]:
        return {**row, "measured": None}
    figures = {"measured_turn_rate": 0.1, "measured_friction_use": 0.4}
    return {**row, "measured": row["predicted"] + error, **figures}


def test_the_page_counts_misses_and_skips_and_names_the_papers_formula(
    tmp_path: Path,
) -> None:
    cases = [
        (Case(15, 8.0, 0.1), 0.001),
        (Case(165, 8.0, 0.1), -0.012),
        (Case(15, 1.0, 0.1), 0.0),
    ]
    varied = [(Case(15, 8.0, 0.1, variant), 0.003) for variant in VARIANTS]
    result = result_of(
        load_task(TASK), [as_measured(case, error) for case, error in [*cases, *varied]]
    )
    assert verdict(result).startswith(
        "1 of 2 probes are within 10 mm of the prediction; 1 were not run."
    )
    page = write_virtual_axle(result, tmp_path).read_text(encoding="utf-8")
    assert page.count("data:image/png") == 1
    assert 'class="n ok">+1.0<' in page
    assert 'class="n no">-12.0<' in page
    text = markdown(result)
    assert (tmp_path / "table.md").read_text(encoding="utf-8") == text
    assert "the paper's formula -523 mm" in text
    assert "slips: takes 1.31" in text
    assert all(f"| {variant} |" in text for variant in VARIANTS)
    widths = {
        line.count("|")
        for line in text.splitlines()
        if "°" in line and line.startswith("| ")
    }
    assert len(widths) == 1
    assert (tmp_path / "axles.png").stat().st_size > 5000


def test_the_error_of_the_paper_is_that_of_its_formula_not_of_its_sign() -> None:
    result = result_of(load_task(TASK), [as_measured(Case(15, 8.0, 0.1), 0.0)])
    (row,) = result["rows"]
    assert result["summary"]["paper"]["max"] == pytest.approx(
        row["measured"] - (-0.5231), abs=1e-4
    )
    assert math.isclose(result["curves"][0]["paper_printed"], 0.8155, abs_tol=1e-4)


def test_the_light_form_has_the_papers_press_pulled_and_pushed_at_both_heights() -> (
    None
):
    assert {(case.load, case.height) for case in LIGHT} == {
        (8.0, height) for height in HEIGHTS
    }
    assert min(case.angle for case in LIGHT) < 90 < max(case.angle for case in LIGHT)
    assert not any(predict(load_task(TASK), case)["skipped"] for case in LIGHT)
