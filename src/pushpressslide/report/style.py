"""Common style of all figures: colours, sizes, legends, time axes, PNG.

The colours can be told apart by the colour-blind (Okabe and Ito, 2008).
"""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pushpressslide.core.arrays import Array
from pushpressslide.core.control import PHASES
from pushpressslide.core.record import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE = "#0072B2"
ORANGE = "#D55E00"
GREEN = "#009E73"
PURPLE = "#CC79A7"
SKY = "#56B4E9"
AMBER = "#E69F00"
YELLOW = "#F0E442"
BLACK = "#222222"
GREY = "#8A8A8A"
PALE = "#D9D9D9"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, AMBER, SKY, BLACK)
PHASE_COLORS = {
    "approach": "#F1F1F1",
    "touch": "#E3EEF6",
    "move": "#FFFFFF",
    "release": "#F8ECE0",
    "done": "#F1F1F1",
}
DPI = 110
WIDTH = 7.2  # [inch] of every figure
LETTER = 0.014  # width of a letter of a phase's name, as a share of a panel
MOST_POINTS = 20000  # of a curve; more than a figure can show

SETTINGS = {
    "font.size": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.4,
}


def figure(
    rows: int = 1,
    height: float = 4.0,
    *,
    across: int = 1,
    width: float = WIDTH,
    share_x: bool = True,
) -> tuple[Figure, list[Axes]]:
    """A figure with ``rows`` by ``across`` panels, and its axes row by row. No global
    state is changed.

    ``height`` and ``width`` [inch] are those of the whole figure.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(SETTINGS):
        made = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
        axes = made.subplots(rows, across, sharex=share_x, squeeze=False)
    return made, list(axes.flat)


def png(made: Figure) -> bytes:
    """A figure as PNG data, reproducible to the byte."""
    import matplotlib as mpl

    buffer = BytesIO()
    with mpl.rc_context(SETTINGS):
        made.savefig(
            buffer,
            format="png",
            bbox_inches="tight",
            pad_inches=0.08,
            metadata={"Software": None},
        )
    return buffer.getvalue()


def title(axes: Axes, text: str, pad: float = 6.0) -> None:
    """Put a title above the panel's left edge."""
    axes.set_title(text, loc="left", fontsize=10.5, fontweight="bold", pad=pad)


def legend(axes: Axes, **options: Any) -> None:
    """Put the legend next to the panel, so that it hides no curve."""
    handles, _ = axes.get_legend_handles_labels()
    if handles:
        size = SETTINGS["legend.fontsize"]
        axes.legend(
            loc="upper left",
            bbox_to_anchor=(1.005, 1.02),
            frameon=False,
            fontsize=size,
            **options,
        )


def thin(time: Array, values: Array) -> tuple[Array, Array]:
    """A curve reduced to every n-th sample, at most about ``MOST_POINTS``."""
    step = max(1, len(time) // MOST_POINTS)
    return time[::step], values[::step]


def time_axis(axes: Sequence[Axes], record: Record, text: str) -> None:
    """Add phases, legends, a time axis and a title to stacked panels."""
    for i, ax in enumerate(axes):
        _shade_phases(ax, record, label=i == 0)
        legend(ax)
    title(axes[0], text, pad=18)
    axes[-1].set_xlabel("time [s]")


def _shade_phases(axes: Axes, record: Record, *, label: bool) -> None:
    """Tint the time of each phase, and mark the start of each further segment.

    With ``label`` the phases are named along the top.
    """
    time = record.arrays["time"]
    phase = record.arrays["phase"]
    edges = [0, *(np.flatnonzero(np.diff(phase)) + 1).tolist(), len(phase)]
    span = float(time[-1] - time[0]) or 1.0
    for first, stop in pairwise(edges):
        name = PHASES[int(phase[first])]
        start = float(time[first])
        end = float(time[min(stop, len(time) - 1)])
        axes.axvspan(start, end, color=PHASE_COLORS[name], zorder=0, linewidth=0)
        if first:
            axes.axvline(start, color=PALE, linewidth=0.7, zorder=0.5)
        if label and end - start > span * (LETTER * len(name) + LETTER):
            axes.text(
                0.5 * (start + end),
                1.02,
                name,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                fontsize=8.5,
                color=GREY,
            )
    for begun in np.flatnonzero(np.diff(record.arrays["stretch"])) + 1:
        axes.axvline(float(time[begun]), color=GREY, linewidth=0.9, ls=":", zorder=0.5)
    axes.set_xlim(float(time[0]), float(time[-1]) or 1.0)
