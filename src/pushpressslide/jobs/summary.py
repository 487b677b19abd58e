"""Summary of a sweep's rows: counts with confidence intervals, spreads, and a table."""

from __future__ import annotations

import math
from array import array
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pushpressslide.core.whole_file import whole
from pushpressslide.jobs.rows import Row

ATTEMPTED = ("reached", "missed", "failed")
"""Outcomes of samples that were not refused."""
SPREADS = ("final_position_error", "final_yaw_error", "duration", "slip_distance")
CONFIDENCE = 0.95
HEAD = (
    "| sample | outcome | position error [mm] | yaw error [deg] | time [s] | why |\n"
    "|---|---|---|---|---|---|\n"
)


def summarise(rows: Iterable[Row], forced: Iterable[Row]) -> dict[str, Any]:
    """Counts, shares with their confidence intervals, and spreads. Values without rows
    are None.

    Rows are read once, and only one is held in memory.
    """
    counts: Counter[str] = Counter()
    values: dict[str, array[float]] = {name: array("d") for name in SPREADS}
    for row in rows:
        counts[row["status"]] += 1
        for name in SPREADS:
            if row.get(name) is not None:
                values[name].append(row[name])
    attempted = sum(counts[status] for status in ATTEMPTED)
    drawn = counts.total()
    return {
        "drawn": drawn,
        "attempted": attempted,
        "reached": counts["reached"],
        "missed": counts["missed"],
        "failed": counts["failed"],
        "refused": counts["refused"],
        "attempted_share": share(attempted, drawn),
        "attempted_interval": interval(attempted, drawn),
        "reached_share": share(counts["reached"], attempted),
        "reached_interval": interval(counts["reached"], attempted),
        "refusals": refusals(forced),
        **{name: _spread(values[name]) for name in SPREADS},
    }


def refusals(forced: Iterable[Row]) -> dict[str, Any]:
    """Outcomes of refused tasks whose best choices were run nevertheless.

    A refusal is true if no choice that could be run reached the goal. If none could be
    run, the refusal remains unchecked.
    """
    outcomes: defaultdict[int, set[str]] = defaultdict(set)
    for row in forced:
        outcomes[row["index"]].add(row["status"])
    ran = [o for o in outcomes.values() if o & {"reached", "missed"}]
    missed = sum("reached" not in o for o in ran)
    return {
        "checked": len(outcomes),
        "could_not_be_run": len(outcomes) - len(ran),
        "ran": len(ran),
        "missed": missed,
        "missed_share": share(missed, len(ran)),
        "missed_interval": interval(missed, len(ran)),
    }


def share(part: int, whole: int) -> float | None:
    """Ratio of ``part`` to ``whole``, or None if the latter is zero."""
    return part / whole if whole else None


def interval(part: int, whole: int) -> tuple[float, float] | None:
    """Wilson score interval of a share at 95 % confidence. None if the total is zero."""
    if not whole:
        return None
    from scipy.stats import binomtest

    bounds = binomtest(part, whole).proportion_ci(CONFIDENCE, method="wilson")
    return (float(bounds.low), float(bounds.high))


def _spread(values: array[float]) -> dict[str, float] | None:
    if not values:
        return None
    ordered = sorted(values)
    return {
        "median": ordered[len(ordered) // 2],
        "p95": ordered[int(0.95 * (len(ordered) - 1))],
        "max": ordered[-1],
    }


def write_table(path: Path, rows: Iterable[Row], forced: Iterable[Row]) -> None:
    """Write the rows as a Markdown table, followed by the forced runs of refused
    samples.

    The table is written row by row to a temporary file, which is renamed at the end.
    """
    with whole(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.write(HEAD)
        file.writelines(table_line(row) for row in rows)
        begun = False
        for row in forced:
            if not begun:
                file.write(f"\nRefused, but run anyway:\n\n{HEAD}")
                begun = True
            file.write(table_line(row))


def table_line(row: Row) -> str:
    """One row of the table."""
    names = ("final_position_error", "final_yaw_error", "duration")
    position, yaw, time = (row.get(name) for name in names)
    figures = " | | "
    if position is not None and yaw is not None and time is not None:
        figures = f"{1e3 * position:.1f} | {math.degrees(yaw):.2f} | {time:.1f}"
    reason = row.get("choice") if row["status"] == "reached" else row["reason"]
    cell = " ".join(str(reason).replace("|", "/").split())[:160]
    number = str(row["index"])
    if "rank" in row:
        number += f", choice {row['rank'] + 1}"
    return f"| {number} | {row['status']} | {figures} | {cell} |\n"
