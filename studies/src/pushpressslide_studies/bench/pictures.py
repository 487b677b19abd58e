"""Plot of the compared benchmarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from pushpressslide.report import style
from pushpressslide_studies.bench.compared import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

OVER = {"batches": "a copy of the same bytes"}  # what else ratios are to
BAR = 0.24  # [inch] of height for each
HEAD = 0.75  # [inch] for a panel's title and axis


def ratios(benchmarks: Mapping[str, Sequence[Row]]) -> Figure | None:
    """A panel of bars for each benchmark that has ratios of times to its first
    contestant. None if no benchmark has any.
    """
    shown = {
        name: [row for row in rows if row.get("ratio") is not None]
        for name, rows in benchmarks.items()
    }
    shown = {name: rows for name, rows in shown.items() if rows}
    if not shown:
        return None
    import matplotlib as mpl
    from matplotlib.figure import Figure

    heights = [HEAD + BAR * len(rows) for rows in shown.values()]
    with mpl.rc_context(style.SETTINGS):
        made = Figure(
            figsize=(style.WIDTH, sum(heights)), dpi=style.DPI, layout="constrained"
        )
        panels = made.subplots(len(shown), 1, height_ratios=heights, squeeze=False)
    for axes, (name, rows) in zip(panels.flat, shown.items(), strict=True):
        _bars(axes, name, rows)
    return made


def _bars(axes: Axes, name: str, rows: Sequence[Row]) -> None:
    """Draw the ratios of one benchmark, with the first contestant on top."""
    values = [row["ratio"] for row in rows]
    names = [f"{row['what']}{_rows(row)}" for row in rows]
    places = range(len(rows))
    colors = [style.ORANGE if value == 1.0 else style.BLUE for value in values]
    low = 0.5 * min(values)
    axes.barh(places, [v - low for v in values], left=low, color=colors, height=0.7)
    axes.set_xscale("log")
    axes.set_xlim(low, 4.0 * max(values))
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    for place, row in zip(places, rows, strict=True):
        text = f" {row['ratio']:.3g}x, {_time(row['median_us'])}"
        axes.text(row["ratio"], place, text, va="center", fontsize=8)
    style.title(axes, f"{name}: times {OVER.get(name, 'the first')}")


def _rows(row: Row) -> str:
    """Text on the number of data rows behind a figure, if it is stated."""
    return f", {row['rows']:,}" if "rows" in row else ""


def _time(microseconds: float) -> str:
    """A time with its unit."""
    for unit, size in (("s", 1e6), ("ms", 1e3), ("us", 1.0)):
        if microseconds >= size:
            return f"{microseconds / size:.3g} {unit}"
    return f"{1e3 * microseconds:.3g} ns"
