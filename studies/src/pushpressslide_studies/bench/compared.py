"""Comparison of contestants: medians of times, and ratios within the same rounds."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

Outcome = TypeVar("Outcome")
Row = dict[str, Any]
Call = tuple[Callable[..., object], tuple[Any, ...]]
"""A function with its arguments."""
Contestants = dict[str, Sequence[Call] | str]
"""The calls of each contestant, or the reason why there are none. Ours comes first."""
ROUNDS = 9


def times(calls: Sequence[Call]) -> list[float]:
    """Times [s] of single calls, each timed separately."""
    out = []
    for function, arguments in calls:
        started = perf_counter()
        function(*arguments)
        out.append(perf_counter() - started)
    return out


def compared(
    contestants: Contestants, counts: Mapping[str, int] | None = None
) -> list[Row]:
    """Median time of each contestant, the 99th percentile, and the ratio of its median
    to that of the first.

    Times are for one of the ``counts`` elements that a call handles. The contestants
    take turns in several rounds. The figures are medians over the rounds, so that other
    load on the machine affects all contestants equally. A text in place of calls is the
    reason why there are none; ratios are then to the first contestant that has calls.
    """
    counts = counts or {}
    medians: dict[str, list[float]] = {name: [] for name in contestants}
    highs: dict[str, list[float]] = {name: [] for name in contestants}
    for _ in range(ROUNDS):
        for name, calls in contestants.items():
            if isinstance(calls, str):
                continue
            spent = np.array(times(calls)) / counts.get(name, 1)
            medians[name].append(float(np.median(spent)))
            highs[name].append(float(np.percentile(spent, 99)))
    first = next(name for name in contestants if medians[name])
    rows: list[Row] = []
    for name, calls in contestants.items():
        row: Row = {"what": name, "median_us": None, "p99_us": None, "ratio": None}
        if isinstance(calls, str):
            rows.append(row | {"note": calls})
            continue
        pairs = zip(medians[name], medians[first], strict=True)
        figures = {
            "median_us": 1e6 * statistics.median(medians[name]),
            "p99_us": 1e6 * statistics.median(highs[name]),
            "ratio": statistics.median(time / ours for time, ours in pairs),
        }
        rows.append(row | figures | {"note": ""})
    return rows


def measured(what: str, median: float, first: float, **figures: float) -> Row:
    """Row of a contestant: its median time [s], its ratio to the first contestant, and
    other results.
    """
    times = {"median_us": 1e6 * median, "ratio": median / first}
    return {"what": what, **times, **figures, "note": ""}


def not_installed(extra: str) -> str:
    """Note on a contestant that an extra would provide, such as
    ``pushpressslide[drake]``.
    """
    return f"not installed: pip install '{extra}'"


def missing(what: str, note: str) -> Row:
    """Row of a missing contestant, with the reason."""
    return {"what": what, "median_us": None, "ratio": None, "note": note}


def rows_of_runs(
    runs: Mapping[str, Callable[[], Outcome | str]],
    rounds: int,
    seconds: Callable[[Outcome], float],
    figures: Callable[[Outcome, float], Mapping[str, float]],
) -> list[Row]:
    """Rows of contestants that make whole runs in several rounds, with the ratio of
    each median time to that of the first.

    ``seconds`` returns the time [s] of an outcome. ``figures`` returns the other values
    of a row, from the first outcome and the median [s]. A text in place of an outcome
    is the reason why there is none.
    """
    rows: list[Row] = []
    first: float | None = None
    for name, run in runs.items():
        found = [run() for _ in range(rounds)]
        outcomes = [one for one in found if not isinstance(one, str)]
        if not outcomes:
            rows.append(missing(name, str(found[0])))
            continue
        median = float(np.median([seconds(one) for one in outcomes]))
        first = first or median
        rows.append(measured(name, median, first, **figures(outcomes[0], median)))
    return rows
