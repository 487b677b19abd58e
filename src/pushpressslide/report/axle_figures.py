"""Figures of the virtual axle over the force's direction, and over a run's time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.report import series, style
from pushpressslide.report.axle_series import AxleSeries, axle_series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARGIN = 40.0  # [mm] that a panel shows beyond what is predicted
MEASURED = style.BLACK
PREDICTED = style.BLUE
FLAT = style.AMBER
PAPER = style.ORANGE
PREDICTED_LABEL = "predicted"
FLAT_LABEL = "predicted without height"
PAPER_LABEL = "paper's formula"


def directions_figure(result: Mapping[str, Any]) -> Figure:
    """Return the axle over the force's angle.

    One panel for each height (row) and press (column). ``result`` is that of the
    virtual-axle study.
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


def axle_over_time(plan: Plan, record: Record) -> Figure | None:
    """Return the virtual axle and the tracking errors over the time of a run.

    None where the run was not one top press, or nothing moved. See ``AxleSeries``.
    """
    contacts = plan.contacts
    pressed = len(contacts) == 1 and contacts[0].kind == "top"
    if not pressed or not series.in_phase(record, "move").any():
        return None
    made, axes = style.figure(4, 8.0)
    axes[0].get_gridspec().set_height_ratios([2.5, 0.7, 2.0, 2.0])
    axles = axle_series(plan, record)
    _axle_panel(axes[0], axles, record.arrays["time"])
    _paper_panel(axes[1], axles)
    _error_panels(axes[2], axes[3], record)
    style.time_axis(axes, record, "Virtual axle and tracking errors")
    return made


def _axle_panel(ax: Axes, axles: AxleSeries, time: Array) -> None:
    predicted = 1e3 * axles.predicted
    flat = 1e3 * axles.without_height
    ax.plot(axles.time, predicted, color=PREDICTED, label=PREDICTED_LABEL)
    ax.plot(axles.time, flat, "--", color=FLAT, label=FLAT_LABEL)
    label = "measured, in steady turns"
    ax.plot(time, 1e3 * axles.measured, color=MEASURED, lw=1.2, label=label)
    ax.set_ylabel("axle from\nthe CoM [mm]")
    shown = [axles.predicted, axles.without_height]
    low = float(np.nanmin(shown, initial=0.0))
    high = float(np.nanmax(shown, initial=0.0))
    ax.set_ylim(1e3 * low - MARGIN, 1e3 * high + MARGIN)


def _paper_panel(ax: Axes, axles: AxleSeries) -> None:
    """Draw the paper's axle in a strip of its own, as it lies far from the others."""
    ax.plot(axles.time, 1e3 * axles.paper, color=PAPER, label=PAPER_LABEL)
    ax.set_ylabel("[mm]")
    middle = 0.0
    if np.isfinite(axles.paper).any():
        middle = float(np.nanmedian(axles.paper))
    ax.set_ylim(1e3 * middle - MARGIN, 1e3 * middle + MARGIN)


def _error_panels(upper: Axes, lower: Axes, record: Record) -> None:
    """Draw the errors to the reference, and those that the tracking law saw."""
    time, position, yaw = series.timed_errors(record)
    move = series.in_phase(record, "move")
    seen = np.where(move[:, None], record.arrays["tracking_error"], np.nan)
    for ax, values, color, label in (
        (upper, 1e3 * position, style.BLUE, "position, to the reference"),
        (upper, 1e3 * seen[:, 1], style.GREEN, "path to the left of the axle"),
        (lower, np.degrees(yaw), style.BLUE, "yaw, to the reference"),
        (lower, np.degrees(seen[:, 2]), style.GREEN, "heading, to the path"),
    ):
        ax.plot(time, values, color=color, label=label)
    upper.set_ylabel("error [mm]")
    lower.set_ylabel("error [deg]")
