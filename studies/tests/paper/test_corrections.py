"""Corrections to the paper: both numbers against closed forms of docs/mechanics.md; the
page is current.
"""

import math
from pathlib import Path

import pytest

from pushpressslide_studies.paper.corrections import (
    ROWS,
    corrections,
    html,
    markdown,
    with_corrections,
)

PAGE = Path(__file__).parents[2] / "docs" / "corrections.md"
MECHANICS = (Path(__file__).parents[3] / "docs" / "mechanics.md").read_text("utf-8")
CORRECTIONS = dict(zip((row.__name__ for row in ROWS), corrections(), strict=True))

COP = 0.2 * 8.0 / 10.943
LEVER = 0.2 * 2.943 / 10.943  # of the bar pressed with 8 N
R0 = math.hypot(0.3, 0.1)
CUBE_POLE = (
    0.15 * (math.sqrt(2.0) + math.asinh(1.0)) / 6.0
)  # mean distance of a square's points to its centre
LARGEST_PUSHER = math.degrees(math.atan((1.0 + (0.075 / CUBE_POLE) ** 2) * 0.4))
# zeta = 1 / sqrt(8)
STANLEY_OVERSHOOT = 100.0 * math.exp(-math.pi / math.sqrt(8.0 - 1.0))

EXPECTED = {
    "distance_from_com": [(0.036 / LEVER + COP, 0.036 / LEVER - COP, 1e-6)],
    "pressure_constant": [
        (0.6, 0.521, 1e-3),
        (0.6, 0.6 / math.sqrt(12.0) / R0, 1e-3),
        (math.sqrt(0.346 * LEVER) / R0, 0.352, 1e-3),
        (math.sqrt(0.346 * LEVER) / R0, (0.3 - COP) / math.sqrt(2.0) / R0, 1e-3),
    ],
    "force_invariance": [
        (1.0, 0.220 / 0.196, 0.01),
        (1.0, 0.557 / 0.277, 0.01),
        (
            COP - 0.036 / LEVER,
            (COP + 0.03) - (0.3 - COP - 0.03) ** 2 / 2.0 / LEVER,
            1e-3,
        ),
        (
            COP - 0.036 / LEVER,
            (COP - 0.03) - (0.3 - COP + 0.03) ** 2 / 2.0 / LEVER,
            1e-3,
        ),
    ],
    "mobility_of_shift": [
        (0.03, 0.03 - 0.1**2, 1e-5),
        (0.03, (0.3 - COP) ** 2 / 2.0, 1e-5),
    ],
    "mobility_of_load": [(1.0 / 9.0, 1.0 / 3.0, 1e-9)],
    "moments_about_com": [(0.0, 0.1875 / 0.2**2, 1e-9), (0.0, 36.0, 1.0)],
    "stanley_signs": [
        (0.0, 43.0, 1.0),
        (0.0, 0.0, 0.01),
        (0.0, STANLEY_OVERSHOOT, 1.0),
    ],
    "steering_of_pusher": [
        (math.degrees(math.atan(0.4)), LARGEST_PUSHER, 0.01),
        (math.degrees(math.atan(0.4)), 53.0, 0.5),
    ],
    "differential_drive": [(0.0, 0.162, 1e-3)],
    "bias_is_external": [(0.0, math.sqrt(2.0), 1e-9)],
    "turning_regions": [
        (0.75 / 0.25, 1.25 / 0.75, 1e-9),
        (1.25 / 0.25, 1.5 / 0.5, 1e-9),
        (1, 0, 0),
        (0, 2, 0),
    ],
    "symmetric_split": [(100.0, 60.0, 1.0), (100.0, 71.0, 1.5)],
    "pivot_about_contact": [(0.0, 0.45 / 3.0, 0.01), (0.0, 0.15, 1e-9)],
    "virtual_target": [
        (5.0, 17.0, 1.0),
        (1.0, 4.8, 0.1),
        (5.0, 0.05, 0.05),
        (1.0, 0.03, 0.03),
    ],
    "one_friction": [(136.8, 136.8 / 3.0, 0.05)],
}


def test_every_row_of_the_page_is_checked() -> None:
    assert len(ROWS) == len(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_both_numbers_are_those_of_the_mechanics(name: str) -> None:
    figures = CORRECTIONS[name].figures
    for figure, (paper, holds, tolerance) in zip(figures, EXPECTED[name], strict=True):
        assert figure.paper == pytest.approx(paper, abs=max(tolerance, 1e-9)), (
            figure.what
        )
        assert figure.holds == pytest.approx(holds, abs=max(tolerance, 1e-9)), (
            figure.what
        )


@pytest.mark.parametrize("name", EXPECTED)
def test_every_correction_shows_a_difference_in_the_digits_that_it_prints(
    name: str,
) -> None:
    assert any(f.shown(f.paper) != f.shown(f.holds) for f in CORRECTIONS[name].figures)
    assert f"\n## {CORRECTIONS[name].section.split('.')[0]}." in MECHANICS


def test_the_page_is_current() -> None:
    text = PAGE.read_text("utf-8")
    assert with_corrections(text) == text, (
        "renew: python -m pushpressslide_studies.paper.corrections "
        "studies/docs/corrections.md"
    )


def test_a_page_without_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="lacks"):
        with_corrections("# A page")


def test_the_html_has_a_group_for_each() -> None:
    text = html(tuple(CORRECTIONS.values()))
    assert text.count('class="claim"') == len(ROWS)
    assert "0.82 m" in text
    assert "0.52 m" in text


def test_a_figure_says_which_rho_it_rests_on():
    rho = {name: [f.rho for f in row.figures] for name, row in CORRECTIONS.items()}
    assert rho["differential_drive"] == ["pole"]
    assert rho["pivot_about_contact"][0] == "fit"
    assert rho["mobility_of_shift"] == ["straight", "straight"]
    assert rho["force_invariance"][:2] == ["exact surface", "exact surface"]
    assert rho["bias_is_external"] == ["none"]
    figure = CORRECTIONS["differential_drive"].figures[0]
    assert f"| {figure.what} | pole |" in markdown(list(CORRECTIONS.values()))
