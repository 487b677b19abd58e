"""Figures of the virtual axle: over the direction of the force, and over the time of a
run.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from pushpressslide.core.plan import Plan
from pushpressslide.core.record import Record
from pushpressslide.core.task import Task
from pushpressslide.mechanics.press_axle import Press
from pushpressslide.report import series, style
from pushpressslide.report.plots import timed_errors

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

LEAST_TURN_RATE = 0.02  # [rad/s] below which a measured axle is noise
LEAST_FORCE = 0.5  # [N] of drag and of press, below which nothing is predicted
WINDOW = 0.2  # [s] of the moving average
# share by which the turn rate may change over two windows: while a turn begins, inertia
# counts
STEADY = 0.25
MARGIN = 40.0  # [mm] that a panel shows beyond what is predicted
SAMPLES = 60  # of the predicted curves
MEASURED = style.BLACK
PREDICTED = style.BLUE
FLAT = style.AMBER
PAPER = style.ORANGE
PREDICTED_LABEL = "predicted"
FLAT_LABEL = "predicted without height"
PAPER_LABEL = "paper's formula"


def directions_figure(result: Mapping[str, Any]) -> Figure:
    """Return the axle over the force's angle, one panel for each height (row) and press
    (column).
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
        at = (curve["height"], curve["load"])
        ax = axes[heights.index(at[0]), loads.index(at[1])]
        _direction_panel(
            ax, curve, [row for row in measured if (row["height"], row["load"]) == at]
        )
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


def axle_over_time(task: Task, plan: Plan, record: Record) -> Figure | None:
    """Return the virtual axle and the tracking errors over the time of a run.

    None where it was not one top press, or nothing moved. Axles are coordinates on the
    line from the CoM to the contact, positive towards the contact. Predicted for the
    measured force and load, with the true friction; measured where the object turns
    fast enough, at a steady rate.
    """
    contacts = plan.contacts
    move = series.in_phase(record, "move")
    if len(contacts) != 1 or contacts[0].kind != "top" or not move.any():
        return None
    made, (top, strip, middle, bottom) = style.figure(4, 8.0)
    top.get_gridspec().set_height_ratios([2.5, 0.7, 2.0, 2.0])
    axles = axles_over_time(task, plan, record)
    time = record.arrays["time"]
    top.plot(
        axles["time"], 1e3 * axles["predicted"], color=PREDICTED, label=PREDICTED_LABEL
    )
    top.plot(
        axles["time"], 1e3 * axles["without_height"], "--", color=FLAT, label=FLAT_LABEL
    )
    top.plot(
        time,
        1e3 * axles["measured"],
        color=MEASURED,
        lw=1.2,
        label="measured, in steady turns",
    )
    top.set_ylabel("axle from\nthe CoM [mm]")
    shown = [axles["predicted"], axles["without_height"]]
    low = float(np.nanmin(shown, initial=0.0))
    high = float(np.nanmax(shown, initial=0.0))
    top.set_ylim(1e3 * low - MARGIN, 1e3 * high + MARGIN)
    strip.plot(axles["time"], 1e3 * axles["paper"], color=PAPER, label=PAPER_LABEL)
    strip.set_ylabel("[mm]")
    middle_of = (
        float(np.nanmedian(axles["paper"]))
        if np.isfinite(axles["paper"]).any()
        else 0.0
    )
    strip.set_ylim(1e3 * middle_of - MARGIN, 1e3 * middle_of + MARGIN)
    _, position, yaw = timed_errors(record)
    seen = np.where(move[:, None], record.arrays["tracking_error"], np.nan)
    middle.plot(
        time, 1e3 * position, color=style.BLUE, label="position, to the reference"
    )
    middle.plot(
        time, 1e3 * seen[:, 1], color=style.GREEN, label="path to the left of the axle"
    )
    middle.set_ylabel("error [mm]")
    bottom.plot(time, np.degrees(yaw), color=style.BLUE, label="yaw, to the reference")
    bottom.plot(
        time, np.degrees(seen[:, 2]), color=style.GREEN, label="heading, to the path"
    )
    bottom.set_ylabel("error [deg]")
    bottom.set_xlabel("time [s]")
    for i, ax in enumerate((top, strip, middle, bottom)):
        style.shade_phases(ax, record, label=i == 0)
        style.legend(ax)
    style.title(top, "Virtual axle and tracking errors", pad=18)
    return made


def axles_over_time(task: Task, plan: Plan, record: Record) -> dict[str, Array]:
    """Return ``measured`` (N,) [m] at every tick, and at ``time`` (M,) [s]
    ``predicted``, ``without_height`` and ``paper`` (M,) [m]; NaN where there is none.

    Of a run with one top press. Twist and forces are averaged over ``WINDOW``; nothing
    is measured while the object hardly turns, or a turn begins or ends.
    """
    (contact,) = plan.contacts
    size = math.hypot(*contact.point)
    ex = contact.point[0] / size
    ey = contact.point[1] / size
    move = series.in_phase(record, "move")
    time, yaw, twist = (
        record.arrays[name] for name in ("time", "object_pose", "object_twist")
    )
    c = np.cos(yaw[:, 2])
    s = np.sin(yaw[:, 2])
    w = twist[:, 2]
    x, y = task.object.center_of_mass
    vx = c * twist[:, 0] + s * twist[:, 1] - w * y
    vy = -s * twist[:, 0] + c * twist[:, 1] + w * x
    normals, tangents = series.contact_forces(plan, record)
    width = max(1, round(WINDOW / float(time[1] - time[0])))
    turn, across, load, fx, fy = (
        _smooth(values, width)
        for values in (w, ex * vy - ey * vx, normals[:, 0], *tangents[:, 0].T)
    )
    measured = np.full(len(time), np.nan)
    nearby = sliding_window_view(np.pad(turn, width, mode="edge"), 2 * width + 1)
    change = nearby.max(1) - nearby.min(1)
    told = move & (np.abs(turn) > LEAST_TURN_RATE) & (change < STEADY * np.abs(turn))
    measured[told] = -across[told] / turn[told]
    ticks = np.flatnonzero(move)[:: max(1, int(move.sum()) // SAMPLES)]
    out = np.full((3, len(ticks)), np.nan)
    for i, k in enumerate(ticks):
        if load[k] < LEAST_FORCE or math.hypot(fx[k], fy[k]) < LEAST_FORCE:
            continue
        thing = Press(task.object, task.support.friction, contact.point, float(load[k]))
        angle = math.atan2(ex * fy[k] - ey * fx[k], ex * fx[k] + ey * fy[k])
        with suppress(ValueError):  # the prediction tips
            out[:, i] = thing.axle(angle), thing.axle(angle, 0.0), thing.paper_axle()
    return {
        "measured": measured,
        "time": time[ticks],
        "predicted": out[0],
        "without_height": out[1],
        "paper": out[2],
    }


def _smooth(values: Array, width: int) -> Array:
    """Return the moving average over ``width`` ticks; what lies outside counts as the
    nearest value.
    """
    padded = np.pad(values, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")
