"""Identified parameters of a run beside the belief, as text and as a table."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any, NamedTuple

from pushpressslide.report.page_tables import number_cells, table


class Label(NamedTuple):
    """Name and unit of a parameter."""

    name: str
    factor: float  # from SI to ``unit``
    unit: str
    decimals: int


LABELS = {
    "mass_times_friction": Label("mass times friction", 1.0, "kg", 3),
    "center_of_mass": Label("centre of mass", 1e3, "mm", 1),
    "pose_delay": Label("delay of pictures", 1e3, "ms", 1),
    "rho": Label("rho", 1e3, "mm", 1),
    "tip_friction": Label("friction of the tips", 1.0, "", 3),
    "tip_offset": Label("tip offset", 1e3, "mm", 1),
    "tip_offset_left": Label("left tip offset", 1e3, "mm", 1),
    "tip_offset_right": Label("right tip offset", 1e3, "mm", 1),
}


def parameter_lines(result: Mapping[str, Any]) -> list[str]:
    """A line for each parameter that a run identified."""
    lines = []
    for key, figures in _parameters(result).items():
        value, interval, belief = _texts(key, figures)
        line = f"{_name(key, figures)}: {value}, 95 % in {interval}, believed {belief}"
        if figures["contradicts_belief"]:
            line += ": contradicts belief"
        lines.append(line)
    return lines


def parameters_part(result: Mapping[str, Any]) -> str:
    """Heading and table of the parameters that a run identified. Empty without any."""
    rows = []
    for key, figures in _parameters(result).items():
        cells = number_cells(_texts(key, figures))
        verdict = "contradicts belief" if figures["contradicts_belief"] else ""
        name = escape(_name(key, figures).capitalize())
        rows.append(
            [f'<th scope="row">{name}</th>', f"<td>{verdict}</td>", *cells],
        )
    if not rows:
        return ""
    head = ("", "", "Identified", "95 % interval", "Believed")
    return f"<h3>Parameters</h3>{table(head, rows, numbers=3)}"


def _parameters(result: Mapping[str, Any]) -> Mapping[str, Any]:
    return result.get("parameters") or {}


def _name(key: str, figures: Mapping[str, Any]) -> str:
    name = LABELS[key].name
    if figures["direction"] is None:
        return name
    x, y = figures["direction"]
    return f"{name} along ({x:.2f}, {y:.2f})"


def _texts(key: str, figures: Mapping[str, Any]) -> tuple[str, str, str]:
    """Value, interval and belief, with units."""
    _, factor, unit, decimals = LABELS[key]
    value, low, high, belief = (
        f"{factor * figures[name]:.{decimals}f}"
        for name in ("value", "low", "high", "believed")
    )
    texts = (f"{value} {unit}", f"{low} to {high} {unit}", f"{belief} {unit}")
    value, interval, belief = (text.rstrip() for text in texts)
    return value, interval, belief
