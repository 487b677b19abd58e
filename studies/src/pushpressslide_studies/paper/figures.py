"""Texts of the figures by which runs are compared with the paper."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pushpressslide.report.page_tables import Row
from pushpressslide_studies.paper.experiment import PaperFigure

DEGREE = 180.0 / math.pi
FIGURES: tuple[Row, ...] = (
    Row("Time", "motion_duration", 1.0, "s", 1),
    Row("RMS box", "rms_position_error", 1e3, "mm", 1),
    Row("RMS tip", "rms_end_effector_error", 1e3, "mm", 1),
    Row("RMS yaw", "rms_yaw_error", DEGREE, "°", 2),
    Row("End, position", "final_position_error", 1e3, "mm", 1),
    Row("End, yaw", "final_yaw_error", DEGREE, "°", 2),
)
ROWS = {row.key: row for row in FIGURES}
SIGNS = {"over": "> ", "about": "≈ ", "within": "≤ ", "": ""}


def paper_figure(figures: Mapping[str, PaperFigure], key: str) -> str:
    """The paper's figure with its unit, or a dash if the paper states none."""
    if key not in figures:
        return figure_of({}, key)
    figure = figures[key]
    return SIGNS[figure.about] + figure_of({key: figure.value}, key)


def figure_of(result: Mapping[str, Any], key: str) -> str:
    """A run's figure with its unit, or a dash if there is none."""
    return ROWS[key].text(result)
