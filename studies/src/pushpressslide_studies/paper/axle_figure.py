"""Figure of the virtual axle over the direction of the force."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pushpressslide.report import style
from pushpressslide.report.axle_figures import (
    FLAT,
    FLAT_LABEL,
    MEASURED,
    PAPER,
    PAPER_LABEL,
    PREDICTED,
    PREDICTED_LABEL,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def directions_figure(result: Mapping[str, Any]) -> Figure:
    """Figure of the axle over the force's angle.

    There is one panel for each height (row) and press (column). ``result`` is that of
    the virtual-axle study.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    curves = result["curves"]
    heights = sorted({c["height"] for c in curves})
    loads = sorted({c["load"] for c in curves})
    with mpl.rc_context(style.SETTINGS):
        made = Figure(
            figsize=(10.0, 0.9 + 2.7 * len(heights)),
            dpi=style.DPI,
            layout="constrained",
        )
        axes = made.subplots(
            len(heights), len(loads), sharex=True, sharey=True, squeeze=False
        )
    measured = [row for row in result["rows"] if row["measured"] is not None]
    for curve in curves:
        height = curve["height"]
        load = curve["load"]
        ax = axes[heights.index(height), loads.index(load)]
        rows = [r for r in measured if (r["height"], r["load"]) == (height, load)]
        _direction_panel(ax, curve, rows)
    for ax in axes[-1]:
        ax.set_xlabel("angle of the force [deg]")
    for ax in axes[:, 0]:
        ax.set_ylabel("axle from the CoM [mm]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    made.legend(
        handles, labels, loc="outside upper center", ncols=4, frameon=False, fontsize=9
    )
    return made


def _direction_panel(
    ax: Axes, curve: Mapping[str, Any], rows: list[Mapping[str, Any]]
) -> None:
    angle = curve["angle"]
    for key, color, dash, label in (
        ("predicted", PREDICTED, "-", PREDICTED_LABEL),
        ("without_height", FLAT, "--", FLAT_LABEL),
    ):
        ax.plot(
            angle,
            [math.nan if x is None else 1e3 * x for x in curve[key]],
            dash,
            color=color,
            label=label,
        )
    ax.plot(
        [row["angle"] for row in rows],
        [1e3 * row["measured"] for row in rows],
        "o",
        color=MEASURED,
        ms=4,
        label="measured",
    )
    style.title(ax, f"{curve['load']:g} N, {1e3 * curve['height']:.0f} mm high")
    ax.text(
        0.5,
        0.03,
        f"↓ {PAPER_LABEL}: {1e3 * curve['paper']:.0f} mm",
        transform=ax.transAxes,
        ha="center",
        color=PAPER,
        fontsize=8.5,
    )
    ax.set_xticks(range(0, 181, 45))
    ax.set_xlim(0, 180)
