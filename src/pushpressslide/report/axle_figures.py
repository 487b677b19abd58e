"""Figure of the virtual axle over the time of a run, and functions that draw axles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.report import series, style
from pushpressslide.report.axle_series import AxleSeries, axle_series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARGIN = 40.0  # [mm] margin of a panel around the prediction
MEASURED = style.BLACK
PREDICTED = style.BLUE
FLAT = style.AMBER
PAPER = style.ORANGE
PREDICTED_LABEL = "predicted"
FLAT_LABEL = "predicted without height"
PAPER_LABEL = "paper's formula"


def axle_over_time(plan: Plan, record: Record) -> Figure | None:
    """Virtual axle and the tracking errors over the time of a run.

    None if the run was not a single press, or nothing moved. See ``AxleSeries``.
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
    """Draw the paper's axle in a separate panel, since it is far from the others."""
    ax.plot(axles.time, 1e3 * axles.paper, color=PAPER, label=PAPER_LABEL)
    ax.set_ylabel("[mm]")
    middle = 0.0
    if np.isfinite(axles.paper).any():
        middle = float(np.nanmedian(axles.paper))
    ax.set_ylim(1e3 * middle - MARGIN, 1e3 * middle + MARGIN)


def _error_panels(upper: Axes, lower: Axes, record: Record) -> None:
    """Draw the errors to the reference, and those that the tracking law used."""
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
